//! Checks takeovers in tasks: a value that a command takes over must be present in the last cycle of each possible
//! predecessor (M7.3).

use crate::clocks::ClockId;
use crate::facts::Facts;
use crate::typed::{BlockId, Export, Handed, Optional, TaskStep, Unit};
use rpi_diag::{Code, Finding};

/// Reports values that a command in a task takes over and that may be absent.
pub(super) fn handed(units: &[Unit], facts: &[Facts], task: &Unit, findings: &mut Vec<Finding>) {
    for step in &task.steps {
        let wrong =
            |handed: &&Handed| is_wanted(units, step, handed) && may_lack(units, facts, handed);
        // One error for each value, even if several predecessors lack it.
        let mut told = Vec::new();
        for handed in step.handed.iter().filter(wrong) {
            if !told.contains(&handed.flow) {
                told.push(handed.flow);
                findings.push(absent(units, step, handed));
            }
        }
    }
}

/// Returns whether the value must be present.
fn is_wanted(units: &[Unit], step: &TaskStep, handed: &Handed) -> bool {
    let flow = units[step.unit.0 as usize].flow(handed.flow);
    flow.optional != Optional::Declared(true)
}

fn may_lack(units: &[Unit], facts: &[Facts], handed: &Handed) -> bool {
    let (facts, value) = (&facts[handed.by.0 as usize], export(units, handed).value);
    facts.absence(value).any() || facts.clocks.row(value).iter().any(|c| c != ClockId::BASE)
}

/// Returns the export that provides the value.
fn export<'u>(units: &'u [Unit], handed: &Handed) -> &'u Export {
    &units[handed.by.0 as usize].block(BlockId::ROOT).exports[handed.export]
}

fn absent(units: &[Unit], step: &TaskStep, handed: &Handed) -> Finding {
    let to = &units[step.unit.0 as usize];
    let (flow, export) = (to.flow(handed.flow), export(units, handed));
    let name = &flow.name;
    let message = format!("`{}` takes over `{name}`, which may be absent", to.name);
    Finding::new(Code::RPI8004, message)
        .at(step.span, format!("`{name}` may have no value here"))
        .also(handed.span, "this runs before it")
        .also(export.span, "may be absent in the last cycle")
        .also(flow.span, "must be present")
        .help(format!(
            "make it always present there: `x ?? other`; or take over an optional value: `{name}: {}?`",
            flow.ty
        ))
}
