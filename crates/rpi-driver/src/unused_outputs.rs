//! Suppression of warnings about unused outputs of called units: a caller need not use every output.

use std::collections::BTreeSet;

use rpi_diag::suppression::{Cause, suppress};
use rpi_diag::{Diagnostic, Span};
use rpi_sema::typed::{Equation, FlowRole, TargetPlace, Unit, UnitId};

/// Removes diagnostics about unused text in the net of `root` where the text defines an out-port of another unit, which
/// is called there: another caller may use the out-port.
pub(crate) fn suppress_unused_outputs(units: &[Unit], root: UnitId, found: &mut Vec<Diagnostic>) {
    if !found.iter().any(|f| f.code.is_unnecessary()) {
        return;
    }
    let others = units.iter().enumerate();
    let others = others.filter(|(k, _)| *k != root.0 as usize);
    let places: BTreeSet<Span> = others.flat_map(|(_, unit)| out_ports(unit)).collect();
    suppress(found, Cause::UsedElsewhere(&places));
}

/// Returns the source locations of the expressions that define the out-ports of a unit.
fn out_ports(unit: &Unit) -> impl Iterator<Item = Span> + '_ {
    let equations = unit.blocks.iter().flat_map(|block| &block.equations);
    let gives = |equation: &&Equation| {
        equation.targets.iter().any(|target| match &target.place {
            TargetPlace::Flow { flow, .. } => unit.flow(*flow).role == FlowRole::Output,
            _ => false,
        })
    };
    let given = equations.filter(gives);
    given.map(|equation| unit.expr(equation.value).span)
}
