//! Invariants of typed units, checked after each pass in tests and debug builds.

use crate::typed::TypedKind;
use crate::typed::{Equation, ExprId, TargetPlace, Unit, UnitId};
use std::fmt;

/// Description of an invariant that a typed unit violates.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct InvalidUnitError(String);

impl fmt::Display for InvalidUnitError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl std::error::Error for InvalidUnitError {}

/// Checks the invariants of a unit, such as valid indices of operands. `units` is the number of units of the program.
///
/// # Errors
///
/// Returns a description of the first violation.
pub fn verify(unit: &Unit, units: usize) -> Result<(), InvalidUnitError> {
    for (id, expr) in (0..).map(ExprId).zip(&unit.exprs) {
        verify_expr(unit, units, id).map_err(|what| {
            InvalidUnitError(format!(
                "`{}`: expression {}: {what} ({:?})",
                unit.name, id.0, expr.kind
            ))
        })?;
    }
    for (k, block) in unit.blocks.iter().enumerate() {
        if block.parent.is_some_and(|parent| parent.0 as usize >= k) {
            let message = format!("`{}`: block {k} precedes its parent", unit.name);
            return Err(InvalidUnitError(message));
        }
        for equation in &block.equations {
            verify_equation(unit, equation)
                .map_err(|what| InvalidUnitError(format!("`{}`: {what}", unit.name)))?;
        }
    }
    Ok(())
}

fn verify_expr(unit: &Unit, units: usize, id: ExprId) -> Result<(), &'static str> {
    let expr = unit.expr(id);
    let mut forward = false;
    expr.kind.operands(&mut |operand| forward |= operand >= id);
    if forward {
        return Err("an operand does not precede it");
    }
    match &expr.kind {
        TypedKind::Flow(flow) if flow.0 as usize >= unit.flows.len() => Err("no such flow"),
        TypedKind::Call(call) if call.unit >= UnitId(u32::try_from(units).unwrap_or(u32::MAX)) => {
            Err("no such unit")
        }
        TypedKind::Const(leaves) if leaves.len() != expr.ty.leaf_count() => {
            Err("wrong number of leaves")
        }
        TypedKind::Part { base, at } => {
            let base = unit.expr(*base);
            let fits = base.ty.has_unknown()
                || *at as usize + expr.ty.leaf_count() <= base.ty.leaf_count();
            if fits {
                Ok(())
            } else {
                Err("part exceeds its base")
            }
        }
        _ => Ok(()),
    }
}

fn verify_equation(unit: &Unit, equation: &Equation) -> Result<(), String> {
    let value = &unit.expr(equation.value).ty;
    let taken: usize = equation
        .targets
        .iter()
        .map(|target| target.ty.leaf_count())
        .sum();
    let unknown = value.has_unknown() || equation.targets.iter().any(|t| t.ty.has_unknown());
    if !unknown && !equation.targets.is_empty() && taken != value.leaf_count() {
        return Err(format!(
            "an equation has targets for {taken} leaves, but its value has {}",
            value.leaf_count()
        ));
    }
    for target in &equation.targets {
        if let TargetPlace::Flow { flow, at } = target.place {
            let count = unit.flow(flow).ty.leaf_count();
            if !unknown && at as usize + target.ty.leaf_count() > count {
                return Err(format!(
                    "an equation defines leaves beyond the end of `{}`",
                    unit.flow(flow).name
                ));
            }
        }
    }
    Ok(())
}
