//! Bounds for counters: a delay that changes by a bounded step per cycle does not overflow within the cycles that a
//! command can run.

use super::known::Known;
use super::range::Range;
use super::transfer::Op;
use crate::net::{Input, NodeId};

/// Number of cycles of the longest run considered: 139 years of 1 ms cycles.
pub(super) const CYCLES: i128 = 1 << 42;
/// Maximal number of nodes on the paths from a delay back to itself.
const NODES: u32 = 64;

/// Next value of a delay: its current value plus a step, an independent value, or either.
#[derive(Clone, Copy)]
struct Next {
    step: Option<(i128, i128)>,
    own: Option<Range>,
}

impl Next {
    fn of(own: Option<Range>) -> Next {
        Next { step: None, own }
    }

    fn or(self, other: Next) -> Next {
        let step = match (self.step, other.step) {
            (Some(a), Some(b)) => Some((a.0.min(b.0), a.1.max(b.1))),
            (a, b) => a.or(b),
        };
        let own = match (self.own, other.own) {
            (Some(a), Some(b)) => Some(a.or(b)),
            (a, b) => a.or(b),
        };
        Next { step, own }
    }
}

/// Range of values that a delay can reach in a run; `None` if its steps are not bounded.
pub(super) fn growth(known: &Known<'_>, delay: NodeId) -> Option<Range> {
    let mut walk = Walk {
        known,
        delay,
        left: NODES,
    };
    let node = known.net.node(delay);
    let next = walk.next(node.inputs.first()?)?;
    let ((down, up), own) = (next.step?, next.own?);
    let lo = i128::from(own.lo) + CYCLES * down.min(0);
    let hi = i128::from(own.hi) + CYCLES * up.max(0);
    Some(Range::of(i64::try_from(lo).ok()?, i64::try_from(hi).ok()?))
}

struct Walk<'k, 'a> {
    known: &'k Known<'a>,
    delay: NodeId,
    left: u32,
}

impl Walk<'_, '_> {
    fn next(&mut self, input: &Input) -> Option<Next> {
        let port = match input {
            Input::Const(value) => return Some(Next::of(Some(Range::of_value(value)?))),
            Input::Port(port) => *port,
            Input::Open => return None,
        };
        if port.node == self.delay {
            return Some(Next {
                step: Some((0, 0)),
                own: None,
            });
        }
        self.left = self.left.checked_sub(1)?;
        let node = self.known.net.node(port.node);
        let of = |walk: &mut Self, k: usize| walk.next(node.inputs.get(k)?);
        let own = Next::of(self.known.of(port));
        match node.desc().name {
            "Core::IntConditional" => Some(of(self, 1)?.or(of(self, 2)?)),
            "Rpi::IntCoalesce" | "Rpi::IntHold" => Some(of(self, 0)?.or(of(self, 1)?)),
            name => match Op::of(name) {
                Some((op @ (Op::Add | Op::Subtract), first)) => {
                    let (a, b) = (of(self, first)?, of(self, first + 1)?);
                    let moved = match (a.step, b.step, op) {
                        (None, None, _) => return Some(own),
                        (Some(_), None, _) => moved(a, b.own?, op)?,
                        (None, Some(_), Op::Add) => moved(b, a.own?, op)?,
                        _ => return None,
                    };
                    // A guarded operation returns 0 while its guard is false.
                    let idle = (first == 1).then_some(Range::FALSE);
                    Some(moved.or(Next::of(idle)))
                }
                _ => Some(own),
            },
        }
    }
}

/// Adds a range to a step, or subtracts it.
fn moved(next: Next, by: Range, op: Op) -> Option<Next> {
    let (down, up) = match op {
        Op::Add => (i128::from(by.lo), i128::from(by.hi)),
        _ => (-i128::from(by.hi), -i128::from(by.lo)),
    };
    let own = match next.own {
        Some(own) => Some(op.apply(own, by)?),
        None => None,
    };
    Some(Next {
        step: next.step.map(|(lo, hi)| (lo + down, hi + up)),
        own,
    })
}
