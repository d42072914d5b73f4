//! Transfer functions: the range of a node's output from the ranges of its inputs, and whether the result fits.

use super::intervals::IntervalAnalysis;
use super::range::Interval;
use super::refine::Limits;
use crate::net::{Input, Node};

/// Integer operation of a primitive. A guarded primitive performs it only while its first input is true.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum IntOperation {
    Add,
    Subtract,
    Multiply,
    Divide,
    Modulo,
    Power,
    Negate,
    Absolute,
}

const OPS: &[(&str, &str, IntOperation)] = &[
    ("Core::IntAdd", "Rpi::GuardedIntAdd", IntOperation::Add),
    (
        "Rpi::IntSubtract",
        "Rpi::GuardedIntSubtract",
        IntOperation::Subtract,
    ),
    (
        "Core::IntMultiply",
        "Rpi::GuardedIntMultiply",
        IntOperation::Multiply,
    ),
    (
        "Core::IntDivide",
        "Rpi::GuardedIntDivide",
        IntOperation::Divide,
    ),
    (
        "Rpi::IntModulo",
        "Rpi::GuardedIntModulo",
        IntOperation::Modulo,
    ),
    ("Rpi::IntPower", "Rpi::GuardedIntPower", IntOperation::Power),
    (
        "Rpi::IntNegate",
        "Rpi::GuardedIntNegate",
        IntOperation::Negate,
    ),
    (
        "Rpi::IntAbsolute",
        "Rpi::GuardedIntAbsolute",
        IntOperation::Absolute,
    ),
];

impl IntOperation {
    /// Returns the operation of a primitive, with the index of the in-port of its first operand; `None` for other
    /// primitives.
    pub(super) fn from_primitive(name: &str) -> Option<(IntOperation, usize)> {
        OPS.iter().find_map(|(plain, guarded, op)| match name {
            _ if name == *plain => Some((*op, 0)),
            _ if name == *guarded => Some((*op, 1)),
            _ => None,
        })
    }

    /// Returns the interval of the results of the operation; the divisor 0 is ignored. `None` on overflow.
    pub(super) fn apply(self, a: Interval, b: Interval) -> Option<Interval> {
        match self {
            IntOperation::Add => a.combine_bounds(b, |a, b| a + b),
            IntOperation::Subtract => a.combine_bounds(b, |a, b| a - b),
            IntOperation::Multiply => a.combine_bounds(b, |a, b| a * b),
            IntOperation::Divide => a.div(b),
            IntOperation::Modulo => Some(a.modulo(b)),
            IntOperation::Power => a.power(b),
            IntOperation::Negate => a.combine_bounds(a, |a, _| -a),
            IntOperation::Absolute => {
                let size = a.combine_bounds(a, |a, _| a.abs())?;
                let lo = if a.lo <= 0 && a.hi >= 0 { 0 } else { size.lo };
                Some(Interval::new(lo, size.hi))
            }
        }
    }

    fn is_binary(self) -> bool {
        !matches!(self, IntOperation::Negate | IntOperation::Absolute)
    }
}

/// Returns the operation of a node and the intervals of both operands while its guard is true; `None` for other nodes,
/// or if no value has reached an operand yet. An operation with one operand gives it twice.
pub(super) fn operands(
    known: &IntervalAnalysis<'_>,
    node: &Node,
) -> Option<(IntOperation, Interval, Interval)> {
    let (op, first) = IntOperation::from_primitive(node.desc().name)?;
    let mut limits = Limits::new();
    if first == 1
        && let Some(Input::Port(guard)) = node.inputs.first()
    {
        known.assume(*guard, true, &mut limits);
    }
    let a = known.input_where(node, first, &limits)?;
    let b = match op.is_binary() {
        true => known.input_where(node, first + 1, &limits)?,
        false => a,
    };
    Some((op, a, b))
}

/// Returns the interval of a node's output; `None` if no value has reached it yet. `all` is the interval of all values
/// of its type.
pub(super) fn output_range(
    known: &IntervalAnalysis<'_>,
    node: &Node,
    all: Interval,
) -> Option<Interval> {
    let name = node.desc().name;
    if let Some((_, first)) = IntOperation::from_primitive(name) {
        let (op, a, b) = operands(known, node)?;
        let range = op.apply(a, b).unwrap_or(all);
        return Some(match first {
            // A guarded operation returns 0 while its guard is false.
            1 => range.join(Interval::FALSE),
            _ => range,
        });
    }
    let input = |k: usize| known.input(node, k);
    Some(match name {
        "Rpi::IntMinimum" => {
            let (a, b) = (input(0)?, input(1)?);
            Interval::new(a.lo.min(b.lo), a.hi.min(b.hi))
        }
        "Rpi::IntMaximum" => {
            let (a, b) = (input(0)?, input(1)?);
            Interval::new(a.lo.max(b.lo), a.hi.max(b.hi))
        }
        "Rpi::IntWithin" => {
            let value = input(1)?;
            match node.inputs.first() {
                Some(Input::Const(_)) => value.meet(Interval::new(input(2)?.lo, input(3)?.hi)),
                _ => value,
            }
        }
        "Core::IntConditional" | "Core::BooleanConditional" => conditional_range(known, node)?,
        "Rpi::IntCoalesce" | "Rpi::IntHold" | "Rpi::BooleanCoalesce" | "Rpi::BooleanHold" => {
            match (input(0), input(1)) {
                (Some(a), Some(b)) => a.join(b),
                (a, b) => a.or(b)?,
            }
        }
        "Core::IntSetNull" | "Core::BooleanSetNull" => input(0)?,
        _ => {
            let truth = super::truth::constant_value(known, node, &Limits::new());
            truth.map_or(all, |truth| Interval::from_bool(Some(truth)))
        }
    })
}

/// Returns the interval of `if c then x else y`. The condition narrows the values of both branches.
fn conditional_range(known: &IntervalAnalysis<'_>, node: &Node) -> Option<Interval> {
    let truth = known.input(node, 0)?.as_bool();
    let branch = |k: usize, holds: bool| {
        if truth == Some(!holds) {
            return None;
        }
        let mut limits = Limits::new();
        if let Some(Input::Port(condition)) = node.inputs.first() {
            known.assume(*condition, holds, &mut limits);
        }
        known.input_where(node, k, &limits)
    };
    match (branch(1, true), branch(2, false)) {
        (Some(yes), Some(no)) => Some(yes.join(no)),
        (yes, no) => yes.or(no),
    }
}
