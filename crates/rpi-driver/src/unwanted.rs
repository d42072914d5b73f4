//! Suppression of warnings about unused outputs of called units: a caller need not use every output.

use std::collections::BTreeSet;

use rpi_diag::{Finding, Span};
use rpi_sema::typed::{Equation, FlowRole, Place, Unit, UnitId};

/// Removes diagnostics about unused text at locations where a called unit computes an out-port.
pub(crate) fn forgive(units: &[Unit], root: UnitId, found: &mut Vec<Finding>) {
    if !found.iter().any(|f| f.code.is_about_needless_text()) {
        return;
    }
    let others = units.iter().enumerate();
    let others = others.filter(|(k, _)| *k != root.0 as usize);
    let places: BTreeSet<Span> = others.flat_map(|(_, unit)| out_ports(unit)).collect();
    found.retain(|f| !(f.code.is_about_needless_text() && places.contains(&f.span())));
}

/// Returns the locations of the expressions that define the out-ports of a unit.
fn out_ports(unit: &Unit) -> impl Iterator<Item = Span> + '_ {
    let equations = unit.blocks.iter().flat_map(|block| &block.equations);
    let gives = |equation: &&Equation| {
        equation.targets.iter().any(|target| match &target.place {
            Place::Flow { flow, .. } => unit.flow(*flow).role == FlowRole::Output,
            _ => false,
        })
    };
    let given = equations.filter(gives);
    given.map(|equation| unit.expr(equation.value).span)
}
