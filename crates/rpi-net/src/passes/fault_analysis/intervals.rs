//! Interval analysis: the range of every integer and Boolean flow of a net. It is the least fixed point, with widening,
//! of one loop of the net after the other.

use super::components::for_each_component;
use super::growth::counter_range;
use super::range::Interval;
use super::refine::Limits;
use super::transfer::output_range;
use crate::net::{AbsentPolicy, Activation, FragmentId, Input, Net, Node, NodeId, PortRef};
use crate::passes::Schedule;
use rpi_image::Role;
use std::collections::BTreeSet;

/// Number of iterations of a loop without widening. In later iterations, the interval of a delay is widened to the next
/// threshold.
const EXACT_ROUNDS: usize = 4;
/// Number of iterations after which an interval that still changes is widened to all values.
const ROUGH_ROUNDS: usize = 20;
/// Number of iterations after which the intervals of all delays of a loop are widened to all values.
const MAX_ROUNDS: usize = 40;
/// Largest magnitude of a threshold. The ends of the range of a type are none: near to them, counters would not be
/// recognised.
const FARTHEST: i64 = 1 << 43;
/// Maximum number of constants of a loop that are used as widening thresholds. Bounds the compile time.
const MAX_THRESHOLDS: usize = 256;

/// Interval analysis of a net: the interval of the values of each integer and Boolean flow.
pub(super) struct IntervalAnalysis<'a> {
    pub(super) net: &'a Net,
    /// For each node, the interval of its only out-port; `None` if no value has reached it yet (bottom).
    ranges: Vec<Option<Interval>>,
    /// For each fragment, limits on flows that hold because the fragment is active.
    limits: Vec<Limits>,
    /// Thresholds for widening in the present loop, in ascending order.
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
            thresholds: Vec::new(),
            counters: BTreeSet::new(),
        };
        known.find_limits();
        let mut position = vec![0; net.nodes.len()];
        for (k, id) in schedule.nodes().enumerate() {
            position[id.index()] = k;
        }
        for_each_component(net, |component| {
            component.sort_unstable_by_key(|id| position[id.index()]);
            known.stabilise(component);
        });
        known
    }

    /// Computes the intervals of the nodes of one component, which are given in the order of their evaluation. Those of
    /// all other nodes that they read are known.
    fn stabilise(&mut self, component: &[NodeId]) {
        if let [one] = component {
            let node = self.net.node(*one);
            match is_delay(node) {
                true if reads_itself(node, *one) => {}
                true => {
                    self.ranges[one.index()] = full_range(node).and_then(|_| self.input(node, 0));
                    return;
                }
                false => return self.compute(component),
            }
        }
        let is_analysed_delay = |id: &NodeId| {
            let node = self.net.node(*id);
            is_delay(node) && full_range(node).is_some()
        };
        let (delays, others): (Vec<NodeId>, Vec<NodeId>) =
            component.iter().partition(|id| is_analysed_delay(id));
        for round in 0..=MAX_ROUNDS {
            if round == EXACT_ROUNDS {
                self.thresholds = self.widening_thresholds(component);
            }
            self.compute(&others);
            if !self.update_delays(&delays, round) {
                return;
            }
        }
        self.compute(&others);
    }

    /// Returns the numbers at which the growth of the intervals of a loop may end, in ascending order: the constants in it
    /// and in the conditions of its fragments, the ends of the intervals that it reads, and the neighbours of all of them.
    fn widening_thresholds(&self, component: &[NodeId]) -> Vec<i64> {
        let mut stops = BTreeSet::from([-1, 0, 1]);
        let mut inside = component.to_vec();
        inside.sort_unstable();
        let is_inside = |id: NodeId| inside.binary_search(&id).is_ok();
        for id in component {
            let node = self.net.node(*id);
            let conditions = self.limits[node.fragment.index()].iter();
            let bounds = conditions.flat_map(|(_, limit)| limit.bounds());
            let inputs = node.inputs.iter().flat_map(|input| match input {
                Input::Const(value) => [value.as_int(); 2],
                Input::Port(port) if !is_inside(port.node) => {
                    let range = self.range_of(*port);
                    [range.map(|range| range.lo), range.map(|range| range.hi)]
                }
                Input::Port(_) | Input::Unconnected => [None; 2],
            });
            let stops_here = bounds.chain(inputs.flatten());
            for stop in stops_here.filter(|stop| (-FARTHEST..=FARTHEST).contains(stop)) {
                stops.extend([stop.saturating_sub(1), stop, stop.saturating_add(1)]);
            }
            if stops.len() >= MAX_THRESHOLDS {
                break;
            }
        }
        stops.into_iter().collect()
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

    /// Widens an interval that has grown from `old` to `new` to the next thresholds, at which growth often ends.
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

fn reads_itself(node: &Node, id: NodeId) -> bool {
    node.inputs
        .iter()
        .filter_map(Input::port)
        .any(|port| port.node == id)
}

fn is_delay(node: &Node) -> bool {
    matches!(node.desc().role, Role::Delay)
}
