//! Interval analysis: the range of every integer and Boolean flow of a net. It is the least fixed point, with widening.

use super::growth::counter_range;
use super::range::Interval;
use super::refine::Limits;
use super::transfer::output_range;
use crate::net::{AbsentPolicy, Activation, FragmentId, Input, Net, Node, NodeId, PortRef};
use crate::passes::Schedule;
use rpi_image::Role;
use std::collections::BTreeSet;

/// Number of iterations without widening. In later iterations, the interval of a delay is widened to the next constant
/// of the program.
const EXACT_ROUNDS: usize = 4;
/// Number of iterations after which an interval that still changes is widened to all values.
const ROUGH_ROUNDS: usize = 20;
/// Number of iterations after which the intervals of all delays are widened to all values.
const MAX_ROUNDS: usize = 40;
/// Maximum number of constants of the program that are used as widening thresholds. Bounds the compile time.
const MAX_THRESHOLDS: usize = 256;

/// Interval analysis of a net: the interval of the values of each integer and Boolean flow.
pub(super) struct IntervalAnalysis<'a> {
    pub(super) net: &'a Net,
    /// For each node, the interval of its only out-port; `None` if no value has reached it yet (bottom).
    ranges: Vec<Option<Interval>>,
    /// For each fragment, limits on flows that hold because the fragment is active.
    limits: Vec<Limits>,
    thresholds: Vec<i64>,
    /// Delays whose values change by a bounded step per cycle.
    counters: BTreeSet<NodeId>,
}

impl<'a> IntervalAnalysis<'a> {
    pub(super) fn new(net: &'a Net, schedule: &Schedule) -> IntervalAnalysis<'a> {
        let mut known = IntervalAnalysis {
            net,
            ranges: vec![None; net.nodes.len()],
            limits: Vec::new(),
            thresholds: widening_thresholds(net),
            counters: BTreeSet::new(),
        };
        known.find_limits();
        let order: Vec<NodeId> = schedule.nodes().collect();
        let (delays, others): (Vec<NodeId>, Vec<NodeId>) =
            order.into_iter().partition(|id| is_delay(net.node(*id)));
        let delays: Vec<NodeId> = delays
            .into_iter()
            .filter(|id| full_range(net.node(*id)).is_some())
            .collect();
        for round in 0..=MAX_ROUNDS {
            known.compute(&others);
            if !known.update_delays(&delays, round) {
                return known;
            }
        }
        known.compute(&others);
        known
    }

    fn find_limits(&mut self) {
        for k in 0..self.net.fragments.len() {
            let id = FragmentId(u32::try_from(k).unwrap_or(u32::MAX));
            let mut limits = Limits::new();
            // Innermost first, since the nearest conditions are the most specific and the number is limited.
            for around in self.net.ancestors(id).take(8) {
                if let Activation::When {
                    condition,
                    if_absent: AbsentPolicy::Inactive,
                } = self.net.fragment(around).activation
                {
                    self.assume(condition, true, &mut limits);
                }
            }
            self.limits.push(limits);
        }
    }

    fn compute(&mut self, nodes: &[NodeId]) {
        for id in nodes {
            let node = self.net.node(*id);
            if let Some(all) = full_range(node) {
                self.ranges[id.index()] = output_range(self, node, all);
            }
        }
    }

    /// Updates the intervals of the delays from their inputs in the iteration `round`. Returns whether one of them
    /// changed.
    fn update_delays(&mut self, delays: &[NodeId], round: usize) -> bool {
        let mut changed = false;
        for id in delays {
            let node = self.net.node(*id);
            let all = full_range(node).unwrap_or(Interval::ALL);
            let before = self.ranges[id.index()];
            let next = match round {
                MAX_ROUNDS => Some(all),
                _ => self.next_delay_range(*id, round, all),
            };
            changed |= next != before;
            self.ranges[id.index()] = next;
        }
        changed
    }

    fn next_delay_range(&mut self, id: NodeId, round: usize, all: Interval) -> Option<Interval> {
        let before = self.ranges[id.index()];
        if self.counters.contains(&id) {
            return match counter_range(self, id) {
                _ if round > ROUGH_ROUNDS => Some(all),
                Some(range) => Some(before.map_or(range, |before| before.join(range))),
                None => Some(all),
            };
        }
        let Some(coming) = self.input(self.net.node(id), 0) else {
            return before;
        };
        let Some(old) = before else {
            return Some(coming);
        };
        let new = old.join(coming);
        if new == old || round < EXACT_ROUNDS {
            return Some(new);
        }
        let wide = match round > ROUGH_ROUNDS {
            true => all,
            false => self.widen(old, new).meet(all),
        };
        let is_open = wide.lo == i64::MIN || wide.hi == i64::MAX;
        match counter_range(self, id).filter(|_| is_open) {
            Some(range) => {
                self.counters.insert(id);
                Some(old.join(range))
            }
            None => Some(wide),
        }
    }

    /// Widens an interval that has grown from `old` to `new` to the next constants of the program, at which growth
    /// often ends.
    fn widen(&self, old: Interval, new: Interval) -> Interval {
        let up = self.thresholds.partition_point(|stop| *stop < new.hi);
        let down = self.thresholds.partition_point(|stop| *stop <= new.lo);
        let hi = self.thresholds.get(up).copied().unwrap_or(i64::MAX);
        let lo = down.checked_sub(1).map_or(i64::MIN, |k| self.thresholds[k]);
        Interval {
            lo: if new.lo < old.lo { lo } else { new.lo },
            hi: if new.hi > old.hi { hi } else { new.hi },
            no_zero: new.no_zero,
        }
    }

    /// Returns the interval of the values at in-port `k` of a node while its fragment is active; `None` if no value has
    /// reached it yet.
    pub(super) fn input(&self, node: &Node, k: usize) -> Option<Interval> {
        self.input_where(node, k, &Limits::new())
    }

    /// Returns the interval of the values at in-port `k` of a node, narrowed by additional limits; `None` if no value
    /// has reached it yet.
    pub(super) fn input_where(&self, node: &Node, k: usize, limits: &Limits) -> Option<Interval> {
        match node.inputs.get(k)? {
            Input::Const(value) => Interval::from_value(value),
            Input::Port(port) => {
                let own = &self.limits[node.fragment.index()];
                let all = own.iter().chain(limits);
                let of_port = all.filter(|(of, _)| of == port);
                let range = self.range_of(*port)?;
                Some(of_port.fold(range, |range, (_, limit)| limit.apply(range)))
            }
            Input::Unconnected => None,
        }
    }

    /// Returns the interval of a flow; `None` if no value has reached it yet, or if its type is not analysed.
    pub(super) fn range_of(&self, port: PortRef) -> Option<Interval> {
        let node = self.net.node(port.node);
        match node.outputs.len() {
            1 => self.ranges[port.node.index()],
            _ => Interval::from_type(*node.outputs.get(usize::from(port.port))?),
        }
    }
}

/// Returns the interval of all values that the type of a node's output allows; `None` if the type is not analysed.
pub(super) fn full_range(node: &Node) -> Option<Interval> {
    match node.outputs[..] {
        [one] => Interval::from_type(one),
        _ => None,
    }
}

fn is_delay(node: &Node) -> bool {
    matches!(node.desc().role, Role::Delay)
}

/// Returns the constants of a net and their neighbours in ascending order, as thresholds for widening.
fn widening_thresholds(net: &Net) -> Vec<i64> {
    let mut stops = BTreeSet::from([-1, 0, 1]);
    let inputs = net.nodes.iter().flat_map(|node| &node.inputs);
    for input in inputs {
        if stops.len() >= MAX_THRESHOLDS {
            break;
        }
        if let Input::Const(value) = input
            && let Some(value) = value.as_int()
        {
            stops.extend([value.saturating_sub(1), value, value.saturating_add(1)]);
        }
    }
    stops.into_iter().collect()
}
