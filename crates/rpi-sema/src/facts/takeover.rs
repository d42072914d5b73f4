//! Checks takeovers in tasks: a value that a command takes over must be present in the last cycle of each possible
//! predecessor (M7.3).

use crate::clocks::ClockId;
use crate::facts::Facts;
use crate::typed::{BlockId, Export, FlowPresence, TakenOverValue, TaskStep, Unit};
use rpi_diag::{Code, Diagnostic};
use std::rc::Rc;

/// Reports values that commands of a task take over from preceding commands and that must be present but may be absent.
pub(super) fn value_sources(
    units: &[Rc<Unit>],
    facts: &[Rc<Facts>],
    task: &Unit,
    diagnostics: &mut Vec<Diagnostic>,
) {
    for step in &task.steps {
        let wrong = |handed: &&TakenOverValue| {
            must_be_present(units, step, handed) && may_be_absent(units, facts, handed)
        };
        // One error for each value, even if several predecessors lack it.
        let mut reported = Vec::new();
        for handed in step.taken_over.iter().filter(wrong) {
            if !reported.contains(&handed.flow) {
                reported.push(handed.flow);
                diagnostics.push(absent(units, step, handed));
            }
        }
    }
}

/// Returns whether the value that a command takes over must be present, because the command does not declare it
/// optional.
fn must_be_present(units: &[Rc<Unit>], step: &TaskStep, handed: &TakenOverValue) -> bool {
    let flow = units[step.unit.0 as usize].flow(handed.flow);
    flow.optional != FlowPresence::Declared(true)
}

fn may_be_absent(units: &[Rc<Unit>], facts: &[Rc<Facts>], handed: &TakenOverValue) -> bool {
    let (facts, value) = (
        &facts[handed.predecessor.0 as usize],
        export(units, handed).value,
    );
    facts.absence(value).any()
        || facts
            .clocks
            .expr_clocks(value)
            .iter()
            .any(|c| c != ClockId::BASE)
}

/// Returns the export of the preceding command that provides a value that is taken over.
fn export<'u>(units: &'u [Rc<Unit>], handed: &TakenOverValue) -> &'u Export {
    &units[handed.predecessor.0 as usize]
        .block(BlockId::ROOT)
        .exports[handed.export]
}

fn absent(units: &[Rc<Unit>], step: &TaskStep, handed: &TakenOverValue) -> Diagnostic {
    let to = &units[step.unit.0 as usize];
    let (flow, export) = (to.flow(handed.flow), export(units, handed));
    let name = &flow.name;
    let message = format!("`{}` takes over `{name}`, which may be absent", to.name);
    Diagnostic::new(Code::RPI8004, message)
        .primary(step.span, format!("`{name}` may have no value here"))
        .secondary(handed.span, format!("this runs before `{}`", to.name))
        .secondary(export.span, "may be absent in the last cycle")
        .secondary(flow.span, "must be present")
        .help(format!(
            "make it always present there: `{name} = ... ?? {};`; or take over an optional value: `{name}: {}?`",
            flow.ty.zero_or_dots(),
            flow.ty
        ))
}
