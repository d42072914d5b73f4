//! Refinement by conditions: limits that a condition implies for the flows that it compares. Where `x > 0` holds, 0 is
//! excluded.

use super::intervals::IntervalAnalysis;
use super::range::Interval;
use crate::net::{Input, Node, PortRef};
use smallvec::SmallVec;

/// Maximum nesting depth of a condition down to which limits on the values of flows are derived. Bounds the compile
/// time.
const DEPTH: usize = 12;
/// Maximum number of limits on the values of flows that are derived from one condition. Bounds the compile time.
const MAX_LIMITS: usize = 32;

/// List of flows, each with a limit on its values.
pub(super) type Limits = SmallVec<[(PortRef, Limit); 4]>;

/// Limit on the values of one flow that follows from a condition.
#[derive(Clone, Copy, Debug)]
pub(super) enum Limit {
    Within(Interval),
    Not(i64),
}

impl Limit {
    pub(super) fn apply(self, range: Interval) -> Interval {
        match self {
            Limit::Within(limit) => range.meet(limit),
            Limit::Not(value) => range.without(value),
        }
    }

    /// Returns the two ends of the limit, which are equal for a single value.
    pub(super) fn bounds(self) -> [i64; 2] {
        match self {
            Limit::Within(limit) => [limit.lo, limit.hi],
            Limit::Not(value) => [value; 2],
        }
    }
}

impl IntervalAnalysis<'_> {
    /// Adds the limits that hold if the Boolean flow `port` has the value `truth` or is absent.
    ///
    /// An absent condition implies the same limits for flows that are present: a comparison of a present flow with a
    /// constant is present.
    pub(super) fn assume(&self, port: PortRef, truth: bool, limits: &mut Limits) {
        self.assume_within(port, truth, DEPTH, limits);
    }

    fn assume_within(&self, port: PortRef, truth: bool, depth: usize, limits: &mut Limits) {
        if depth == 0 || limits.len() >= MAX_LIMITS {
            return;
        }
        limits.push((port, Limit::Within(Interval::from_bool(Some(truth)))));
        let node = self.net.node(port.node);
        let mut below = |input: usize, truth: bool| {
            if let Some(Input::Port(port)) = node.inputs.get(input) {
                self.assume_within(*port, truth, depth - 1, limits);
            }
        };
        match (node.desc().name, truth) {
            ("Core::BooleanNot", _) => below(0, !truth),
            ("Core::BooleanAnd", true) | ("Core::BooleanOr", false) => {
                below(0, truth);
                below(1, truth);
            }
            ("Rpi::BooleanImplies", false) => {
                below(0, true);
                below(1, false);
            }
            ("Rpi::BooleanCoalesce", _) if constant(node, 1).is_some() => below(0, truth),
            // If the condition is absent, nothing is known about the branches.
            ("Core::BooleanConditional", _) => match [1, 2].map(|k| constant(node, k)) {
                [_, Some(no)] if (no != 0) != truth => below(0, true),
                [Some(yes), _] if (yes != 0) != truth => below(0, false),
                _ => {}
            },
            _ => assume_comparison(node, truth, limits),
        }
    }
}

fn constant(node: &Node, input: usize) -> Option<i64> {
    match node.inputs.get(input)? {
        Input::Const(value) => value.as_int().or(value.as_bool().map(i64::from)),
        _ => None,
    }
}

/// Returns the operands of a comparison of a flow with a constant integer: the flow, the constant, and whether the flow
/// is the first operand. `None` for other nodes.
fn flow_and_constant(node: &Node) -> Option<(PortRef, i64, bool)> {
    match (node.inputs.first()?, node.inputs.get(1)?) {
        (Input::Port(port), Input::Const(value)) => Some((*port, value.as_int()?, true)),
        (Input::Const(value), Input::Port(port)) => Some((*port, value.as_int()?, false)),
        _ => None,
    }
}

/// Adds the limit on an integer that follows if its comparison with a constant, at `node`, has the value `truth`.
fn assume_comparison(node: &Node, truth: bool, limits: &mut Limits) {
    let Some((port, value, is_first)) = flow_and_constant(node) else {
        return;
    };
    let up = |from: Option<i64>| from.map(|from| Interval::new(from, i64::MAX));
    let down = |to: Option<i64>| to.map(|to| Interval::new(i64::MIN, to));
    let (above, below) = (value.checked_add(1), value.checked_sub(1));
    let within = match (node.desc().name, is_first == truth) {
        ("Core::IntEquals", _) if !is_exact(node) => return,
        ("Core::IntEquals", _) if truth => Some(Interval::new(value, value)),
        ("Core::IntEquals", _) => return limits.push((port, Limit::Not(value))),
        // `x > k` and `not (k >= x)` are the same: exchanging the operands and negating gives the other comparison.
        ("Core::IntGreater", true) if is_first => up(above),
        ("Core::IntGreater", true) => up(Some(value)),
        ("Core::IntGreater", false) if is_first => down(Some(value)),
        ("Core::IntGreater", false) => down(below),
        ("Rpi::IntGreaterOrEqual", true) if is_first => up(Some(value)),
        ("Rpi::IntGreaterOrEqual", true) => up(above),
        ("Rpi::IntGreaterOrEqual", false) if is_first => down(below),
        ("Rpi::IntGreaterOrEqual", false) => down(Some(value)),
        _ => None,
    };
    limits.extend(within.map(|within| (port, Limit::Within(within))));
}

/// Returns whether a node that tests equality compares exactly, without a tolerance.
fn is_exact(node: &Node) -> bool {
    let slack = node.params.first();
    slack.is_none_or(|slack| slack.as_int() == Some(0) || slack.as_real() == Some(0.0))
}
