//! Constant Booleans: whether a Boolean has the same value in all cycles in which some limits hold.

use super::intervals::IntervalAnalysis;
use super::refine::Limits;
use crate::net::{Input, Node};

/// Maximum nesting depth of Boolean operations that the evaluation follows. Bounds the compile time.
const DEPTH: usize = 8;

/// Returns the value of a Boolean node if it is constant while it is present and the `limits` hold; `None` otherwise.
pub(super) fn constant_value(
    known: &IntervalAnalysis<'_>,
    node: &Node,
    limits: &Limits,
) -> Option<bool> {
    let name = node.desc().name;
    let range = |k: usize| known.input_where(node, k, limits);
    let truth = |k: usize| range(k).and_then(super::range::Interval::as_bool);
    match name {
        "Core::BooleanNot" => truth(0).map(|truth| !truth),
        "Core::BooleanAnd" => and(truth(0), truth(1)),
        "Core::BooleanOr" => and(truth(0).map(|a| !a), truth(1).map(|b| !b)).map(|both| !both),
        "Rpi::BooleanImplies" => and(truth(0), truth(1).map(|b| !b)).map(|both| !both),
        "Core::IntGreater" => {
            let (a, b) = (range(0)?, range(1)?);
            decide(a.lo > b.hi, a.hi <= b.lo)
        }
        "Rpi::IntGreaterOrEqual" => {
            let (a, b) = (range(0)?, range(1)?);
            decide(a.lo >= b.hi, a.hi < b.lo)
        }
        _ => None,
    }
}

fn and(a: Option<bool>, b: Option<bool>) -> Option<bool> {
    match (a, b) {
        (Some(false), _) | (_, Some(false)) => Some(false),
        (Some(true), Some(true)) => Some(true),
        _ => None,
    }
}

fn decide(always: bool, never: bool) -> Option<bool> {
    match (always, never) {
        (true, _) => Some(true),
        (_, true) => Some(false),
        _ => None,
    }
}

/// Returns whether it is proved that the condition of an assertion is never false. A guard of the condition counts as
/// true.
pub(super) fn always_holds(known: &IntervalAnalysis<'_>, check: &Node) -> bool {
    holds_where(known, check.inputs.first(), &Limits::new(), DEPTH)
}

fn holds_where(
    known: &IntervalAnalysis<'_>,
    input: Option<&Input>,
    limits: &Limits,
    depth: usize,
) -> bool {
    let port = match input {
        Some(Input::Const(value)) => return value.as_bool() == Some(true),
        Some(Input::Port(port)) if depth > 0 => *port,
        _ => return false,
    };
    let node = known.net.node(port.node);
    match node.desc().name {
        "Core::BooleanAnd" => {
            let mut inputs = node.inputs.iter();
            inputs.all(|input| holds_where(known, Some(input), limits, depth - 1))
        }
        "Rpi::BooleanImplies" => {
            let mut limits = limits.clone();
            if let Some(Input::Port(guard)) = node.inputs.first() {
                known.assume(*guard, true, &mut limits);
            }
            holds_where(known, node.inputs.get(1), &limits, depth - 1)
        }
        _ => constant_value(known, node, limits) == Some(true),
    }
}
