//! What a command takes over is there in the last cycle of each command that may come before it (M7.3).

use super::Facts;
use crate::clocks::ClockId;
use crate::typed::{BlockId, Export, Handed, Optional, TaskStep, Unit};
use rpi_diag::{Code, Finding};

/// Reports what a task lets a command take over though it may be absent.
pub(super) fn handed(units: &[Unit], facts: &[Facts], task: &Unit, findings: &mut Vec<Finding>) {
    for step in &task.steps {
        let wrong =
            |handed: &&Handed| is_wanted(units, step, handed) && may_lack(units, facts, handed);
        // One message for each value, however many commands may come before.
        let mut told = Vec::new();
        for handed in step.handed.iter().filter(wrong) {
            if !told.contains(&handed.flow) {
                told.push(handed.flow);
                findings.push(absent(units, step, handed));
            }
        }
    }
}

/// Whether the value has to be there.
fn is_wanted(units: &[Unit], step: &TaskStep, handed: &Handed) -> bool {
    let flow = units[step.unit.0 as usize].flow(handed.flow);
    flow.optional != Optional::Declared(true)
}

fn may_lack(units: &[Unit], facts: &[Facts], handed: &Handed) -> bool {
    let (facts, value) = (&facts[handed.by.0 as usize], export(units, handed).value);
    facts.absence(value).any() || facts.clocks.row(value).iter().any(|c| c != ClockId::BASE)
}

/// What gives the value.
fn export<'u>(units: &'u [Unit], handed: &Handed) -> &'u Export {
    &units[handed.by.0 as usize].block(BlockId::ROOT).exports[handed.export]
}

fn absent(units: &[Unit], step: &TaskStep, handed: &Handed) -> Finding {
    let to = &units[step.unit.0 as usize];
    let (flow, export) = (to.flow(handed.flow), export(units, handed));
    let name = &flow.name;
    let message = format!("`{}` takes `{name}` over, which may be absent", to.name);
    Finding::new(Code::RPI8004, message)
        .at(step.span, format!("`{name}` may have no value here"))
        .also(handed.span, "this runs before it")
        .also(export.span, "absent in some cycles, maybe in the last")
        .also(flow.span, "always present")
        .help(format!(
            "make it always present there, `x ?? other`, or take over what may be absent: `{name}: {}?`",
            flow.ty
        ))
}
