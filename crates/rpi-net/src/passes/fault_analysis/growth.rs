//! Bounds for counters: a delay that changes by a bounded step per cycle does not overflow within the cycles that a
//! command can run.

use super::intervals::IntervalAnalysis;
use super::range::Interval;
use super::transfer::IntOperation;
use crate::net::{Input, NodeId};

/// Number of cycles of the longest run for which counters are analysed: 2^42, which is 139 years with cycles of 1 ms.
pub(super) const CYCLES: i128 = 1 << 42;
/// Maximum number of nodes that are followed on the paths from a delay back to itself. Bounds the compile time.
const NODES: u32 = 64;

/// Next value of a delay as a function of its current one: the current value plus a step in a range, an independent
/// value in an interval, or either.
#[derive(Clone, Copy)]
struct NextValue {
    step: Option<(i128, i128)>,
    independent: Option<Interval>,
}

impl NextValue {
    fn independent(own: Option<Interval>) -> NextValue {
        NextValue {
            step: None,
            independent: own,
        }
    }

    fn or(self, other: NextValue) -> NextValue {
        let step = match (self.step, other.step) {
            (Some(a), Some(b)) => Some((a.0.min(b.0), a.1.max(b.1))),
            (a, b) => a.or(b),
        };
        let own = match (self.independent, other.independent) {
            (Some(a), Some(b)) => Some(a.join(b)),
            (a, b) => a.or(b),
        };
        NextValue {
            step,
            independent: own,
        }
    }
}

/// Returns the interval of the values that a delay can reach in the longest analysed run; `None` if its step per cycle
/// is not bounded.
pub(super) fn counter_range(known: &IntervalAnalysis<'_>, delay: NodeId) -> Option<Interval> {
    let mut walk = GrowthAnalysis {
        known,
        delay,
        left: NODES,
    };
    let node = known.net.node(delay);
    let next = walk.next(node.inputs.first()?)?;
    let ((down, up), own) = (next.step?, next.independent?);
    let lo = i128::from(own.lo) + CYCLES * down.min(0);
    let hi = i128::from(own.hi) + CYCLES * up.max(0);
    Some(Interval::new(
        i64::try_from(lo).ok()?,
        i64::try_from(hi).ok()?,
    ))
}

struct GrowthAnalysis<'k, 'a> {
    known: &'k IntervalAnalysis<'a>,
    delay: NodeId,
    left: u32,
}

impl GrowthAnalysis<'_, '_> {
    /// Returns whether a node has the same value as the delay in every cycle: each `pre n` in a program is a delay of its
    /// own.
    fn is_delay_of_same_flow(&self, id: NodeId) -> bool {
        let (one, other) = (self.known.net.node(id), self.known.net.node(self.delay));
        let is_same = || {
            (one.prim, one.fragment) == (other.prim, other.fragment)
                && (&one.inputs, &one.params) == (&other.inputs, &other.params)
        };
        id == self.delay || is_same()
    }

    fn next(&mut self, input: &Input) -> Option<NextValue> {
        let port = match input {
            Input::Const(value) => {
                return Some(NextValue::independent(Some(Interval::from_value(value)?)));
            }
            Input::Port(port) => *port,
            Input::Unconnected => return None,
        };
        if self.is_delay_of_same_flow(port.node) {
            return Some(NextValue {
                step: Some((0, 0)),
                independent: None,
            });
        }
        self.left = self.left.checked_sub(1)?;
        let node = self.known.net.node(port.node);
        let of = |walk: &mut Self, k: usize| walk.next(node.inputs.get(k)?);
        let own = NextValue::independent(self.known.range_of(port));
        match node.desc().name {
            "Core::IntConditional" => Some(of(self, 1)?.or(of(self, 2)?)),
            "Rpi::IntCoalesce" | "Rpi::IntHold" => Some(of(self, 0)?.or(of(self, 1)?)),
            name => match IntOperation::from_primitive(name) {
                Some((op @ (IntOperation::Add | IntOperation::Subtract), first)) => {
                    let (a, b) = (of(self, first)?, of(self, first + 1)?);
                    let moved = match (a.step, b.step, op) {
                        (None, None, _) => return Some(own),
                        (Some(_), None, _) => add_to_step(a, b.independent?, op)?,
                        (None, Some(_), IntOperation::Add) => add_to_step(b, a.independent?, op)?,
                        _ => return None,
                    };
                    // A guarded operation returns 0 while its guard is false.
                    let idle = (first == 1).then_some(Interval::FALSE);
                    Some(moved.or(NextValue::independent(idle)))
                }
                _ => Some(own),
            },
        }
    }
}

/// Adds the interval `by` to the step and to the independent value of a delay, or subtracts it; `None` on overflow.
fn add_to_step(next: NextValue, by: Interval, op: IntOperation) -> Option<NextValue> {
    let (down, up) = match op {
        IntOperation::Add => (i128::from(by.lo), i128::from(by.hi)),
        _ => (-i128::from(by.hi), -i128::from(by.lo)),
    };
    let own = match next.independent {
        Some(own) => Some(op.apply(own, by)?),
        None => None,
    };
    Some(NextValue {
        step: next.step.map(|(lo, hi)| (lo + down, hi + up)),
        independent: own,
    })
}
