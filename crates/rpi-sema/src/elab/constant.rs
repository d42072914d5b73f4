//! Evaluation of constants: an expression is constant if its elaboration folds to values.
//!
//! The checker calls this module for sizes and constants. The elaboration must not use the checker in turn.

use crate::elab::expr;
use crate::elab::scope::{FlowState, Scope};
use crate::elab::signal::{Signal, Wire};
use crate::elab::{Argument, ElabMode, Elaborator, Position, parameters};
use crate::typed::{ExprId, Leaf, Unit};
use rpi_diag::Span;
use std::rc::Rc;

/// Reason why an expression has no value at compile time.
#[derive(Clone, PartialEq, Debug)]
pub(crate) enum NotConstantError {
    /// The expression has an error that has been reported.
    Reported,
    /// The expression depends on a value that is known only at run time.
    RunTime(Span),
    /// The evaluation faults, for example by a division by zero: the location and the message.
    Fault(Span, String),
}

/// Evaluates a constant expression of a unit and returns the values of its leaves (scalar parts), or the reason why it
/// has no value.
pub(crate) fn evaluate_constant(
    units: &[Rc<Unit>],
    unit: &Unit,
    id: ExprId,
) -> Result<Rc<[Leaf]>, NotConstantError> {
    constant_with(units, unit, id, &[])
}

/// Evaluates an expression that depends only on the unit's parameters, of which the first have the values `args`. The
/// result is unknown if the expression has no value.
#[must_use]
pub fn evaluate_argument(
    units: &[Rc<Unit>],
    unit: &Unit,
    id: ExprId,
    args: &[Argument],
) -> Argument {
    match constant_with(units, unit, id, args) {
        Ok(leaves) => Argument::Value(leaves.to_vec()),
        Err(_) => Argument::Unknown,
    }
}

fn constant_with(
    units: &[Rc<Unit>],
    unit: &Unit,
    id: ExprId,
    args: &[Argument],
) -> Result<Rc<[Leaf]>, NotConstantError> {
    let mut elab = Elaborator::new(units, &[], ElabMode::Constant);
    let mut scope = Scope::constant(unit);
    let given = (!args.is_empty()).then(|| parameters(unit));
    for (flow, arg) in given.into_iter().flatten().zip(args) {
        let known: Wire = match (arg, unit.flow(flow).default) {
            (Argument::Value(leaves), _) => leaves.iter().cloned().map(Signal::Const).collect(),
            (Argument::Default, Some(default)) => {
                expr::elab_expr(&mut elab, &mut scope, default, Position::ROOT)
            }
            _ => continue,
        };
        *scope.state(flow) = FlowState::Done(known);
    }
    let wire = expr::elab_expr(&mut elab, &mut scope, id, Position::ROOT);
    if let Some(failure) = elab.failure.take() {
        return Err(failure);
    }
    let leaf = |signal: &Signal| match signal {
        Signal::Const(value) => Ok(value.clone()),
        _ => Err(NotConstantError::RunTime(unit.expr(id).span)),
    };
    wire.iter().map(leaf).collect()
}
