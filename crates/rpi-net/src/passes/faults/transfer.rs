//! Transfer functions: the range of a node's output from the ranges of its inputs, and whether the result fits.

use super::known::Known;
use super::range::Range;
use super::refine::Limits;
use crate::net::{Input, Node};

/// Integer operations, plain and guarded.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum Op {
    Add,
    Subtract,
    Multiply,
    Divide,
    Modulo,
    Power,
    Negate,
    Absolute,
}

const OPS: &[(&str, &str, Op)] = &[
    ("Core::IntAdd", "Rpi::GuardedIntAdd", Op::Add),
    ("Rpi::IntSubtract", "Rpi::GuardedIntSubtract", Op::Subtract),
    ("Core::IntMultiply", "Rpi::GuardedIntMultiply", Op::Multiply),
    ("Core::IntDivide", "Rpi::GuardedIntDivide", Op::Divide),
    ("Rpi::IntModulo", "Rpi::GuardedIntModulo", Op::Modulo),
    ("Rpi::IntPower", "Rpi::GuardedIntPower", Op::Power),
    ("Rpi::IntNegate", "Rpi::GuardedIntNegate", Op::Negate),
    ("Rpi::IntAbsolute", "Rpi::GuardedIntAbsolute", Op::Absolute),
];

impl Op {
    /// Operation of a primitive, with the index of its first operand; `None` for other primitives.
    pub(super) fn of(name: &str) -> Option<(Op, usize)> {
        OPS.iter().find_map(|(plain, guarded, op)| match name {
            _ if name == *plain => Some((*op, 0)),
            _ if name == *guarded => Some((*op, 1)),
            _ => None,
        })
    }

    /// Results of the operation; the divisor 0 is ignored. `None` on overflow.
    pub(super) fn apply(self, a: Range, b: Range) -> Option<Range> {
        match self {
            Op::Add => a.ends(b, |a, b| a + b),
            Op::Subtract => a.ends(b, |a, b| a - b),
            Op::Multiply => a.ends(b, |a, b| a * b),
            Op::Divide => a.divided(b),
            Op::Modulo => Some(a.modulo(b)),
            Op::Power => a.power(b),
            Op::Negate => a.ends(a, |a, _| -a),
            Op::Absolute => {
                let size = a.ends(a, |a, _| a.abs())?;
                let lo = if a.lo <= 0 && a.hi >= 0 { 0 } else { size.lo };
                Some(Range::of(lo, size.hi))
            }
        }
    }

    fn has_two(self) -> bool {
        !matches!(self, Op::Negate | Op::Absolute)
    }
}

/// Operation and operand ranges of a node while its guard is true; `None` if an operand is not reached yet.
pub(super) fn operands(known: &Known<'_>, node: &Node) -> Option<(Op, Range, Range)> {
    let (op, first) = Op::of(node.desc().name)?;
    let mut limits = Limits::new();
    if first == 1
        && let Some(Input::Port(guard)) = node.inputs.first()
    {
        known.assume(*guard, true, &mut limits);
    }
    let a = known.input_where(node, first, &limits)?;
    let b = match op.has_two() {
        true => known.input_where(node, first + 1, &limits)?,
        false => a,
    };
    Some((op, a, b))
}

/// Range of a node's output; `None` if it is not reached yet.
pub(super) fn result(known: &Known<'_>, node: &Node, all: Range) -> Option<Range> {
    let name = node.desc().name;
    if let Some((_, first)) = Op::of(name) {
        let (op, a, b) = operands(known, node)?;
        let range = op.apply(a, b).unwrap_or(all);
        return Some(match first {
            // A guarded operation returns 0 while its guard is false.
            1 => range.or(Range::FALSE),
            _ => range,
        });
    }
    let input = |k: usize| known.input(node, k);
    Some(match name {
        "Rpi::IntMinimum" => {
            let (a, b) = (input(0)?, input(1)?);
            Range::of(a.lo.min(b.lo), a.hi.min(b.hi))
        }
        "Rpi::IntMaximum" => {
            let (a, b) = (input(0)?, input(1)?);
            Range::of(a.lo.max(b.lo), a.hi.max(b.hi))
        }
        "Rpi::IntWithin" => {
            let value = input(1)?;
            match node.inputs.first() {
                Some(Input::Const(_)) => value.and(Range::of(input(2)?.lo, input(3)?.hi)),
                _ => value,
            }
        }
        "Core::IntConditional" | "Core::BooleanConditional" => chosen(known, node)?,
        "Rpi::IntCoalesce" | "Rpi::IntHold" | "Rpi::BooleanCoalesce" | "Rpi::BooleanHold" => {
            match (input(0), input(1)) {
                (Some(a), Some(b)) => a.or(b),
                (a, b) => a.or(b)?,
            }
        }
        "Core::IntSetNull" | "Core::BooleanSetNull" => input(0)?,
        _ => {
            let truth = super::truth::of(known, node, &Limits::new());
            truth.map_or(all, |truth| Range::of_truth(Some(truth)))
        }
    })
}

/// Range of `if c then x else y`: each branch is refined by the condition.
fn chosen(known: &Known<'_>, node: &Node) -> Option<Range> {
    let truth = known.input(node, 0)?.truth();
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
        (Some(yes), Some(no)) => Some(yes.or(no)),
        (yes, no) => yes.or(no),
    }
}
