//! Summaries of the analyses: one line per result.

use std::cell::RefCell;
use std::collections::BTreeSet;

use rpi_diag::Diagnostic;
use rpi_net::FragmentId;
use rpi_net::passes::{Analysis, MachineProfile, PossibleFault};
use rpi_sema::elab::ElaboratedUnit;
use rpi_sema::typed::UnitId;

use crate::compile::CompileOptions;
use crate::faults::{self, FaultLocation};
use crate::program::AnalysedProgram;

/// Summary of the compiler's analyses of one command, node or task: its name, and one line per result.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct AnalysisSummary {
    /// Name of the command, node or task.
    pub name: String,
    /// Lines of the summary: the name of the analysis and its result as text.
    pub lines: Vec<(&'static str, String)>,
}

/// Reports about nets that the user requested with command-line options, filled in while the nets are analysed.
#[derive(Default)]
pub(crate) struct RequestedReports {
    /// Summaries of the commands, nodes and tasks that are already compiled; `None` if they are not requested.
    summaries: RefCell<Option<Vec<AnalysisSummary>>>,
    /// Operations that can fault at run time in the nets that are already compiled; `None` if they are not requested.
    faults: RefCell<Option<BTreeSet<FaultLocation>>>,
}

impl RequestedReports {
    /// Starts the reports that the options request, and removes those of an earlier compilation.
    pub(crate) fn request(&self, options: &CompileOptions) {
        self.summaries.replace(options.summaries.then(Vec::new));
        self.faults.replace(options.faults.then(BTreeSet::new));
    }

    /// Removes and returns the reports: the summaries, and the operations that can fault in source order. Reports that
    /// were not requested are empty.
    pub(crate) fn take(&self) -> (Vec<AnalysisSummary>, Vec<FaultLocation>) {
        let faults = self.faults.take().unwrap_or_default();
        (
            self.summaries.take().unwrap_or_default(),
            faults.into_iter().collect(),
        )
    }

    /// Changes the name in the summary that was added last.
    pub(crate) fn rename_last(&self, name: &str) {
        let mut summaries = self.summaries.borrow_mut();
        if let Some(last) = summaries.as_mut().and_then(|all| all.last_mut()) {
            name.clone_into(&mut last.name);
        }
    }

    fn add_summary(&self, summary: impl FnOnce() -> AnalysisSummary) {
        if let Some(summaries) = self.summaries.borrow_mut().as_mut() {
            summaries.push(summary());
        }
    }
}

/// Adds a summary with the results of a task's checks, if summaries are requested.
pub(crate) fn record_task_summary(front: &AnalysedProgram<'_>, unit: UnitId) {
    front.reports.add_summary(|| AnalysisSummary {
        name: front.checked.unit(unit).name.to_string(),
        lines: rpi_sema::summary(&front.checked.units, unit),
    });
}

/// Adds the requested reports about the net of a unit (a node, command or test), and returns the warnings about its
/// operations that can fault. The operations are computed only if a report or a warning needs them.
pub(crate) fn record_reports(
    front: &AnalysedProgram<'_>,
    unit: UnitId,
    analysis: &Analysis,
    elaborated: &ElaboratedUnit,
) -> Vec<Diagnostic> {
    let reports = &front.reports;
    let mut locations = reports.faults.borrow_mut();
    let has_summary = reports.summaries.borrow().is_some();
    let operands = &elaborated.stateful_operands;
    let is_requested = has_summary || locations.is_some();
    if !is_requested && !faults::may_warn(operands, &analysis.net) {
        return Vec::new();
    }
    let possible = faults::faults_of_net(analysis);
    if let Some(locations) = locations.as_mut() {
        locations.append(&mut faults::locations(&possible));
    }
    reports.add_summary(|| unit_summary(front, unit, analysis, elaborated, &possible));
    faults::stateful_operand_warnings(operands, &possible)
}

fn unit_summary(
    front: &AnalysedProgram<'_>,
    unit: UnitId,
    analysis: &Analysis,
    elaborated: &ElaboratedUnit,
    faults: &[PossibleFault],
) -> AnalysisSummary {
    let mut lines = rpi_sema::summary(&front.checked.units, unit);
    lines.extend(analysis.summary.iter().cloned());
    lines.push(("initialisation", rpi_sema::init::summary(&analysis.net)));
    lines.push(("budget", budget(analysis, front.machine)));
    lines.extend(faults::lines(faults, front.sources));
    if elaborated.has_claims {
        let count = analysis.net.claims.len();
        lines.push(("claims", format!("{count} assertions and contract clauses")));
    }
    let name = front.checked.unit(unit).name.to_string();
    AnalysisSummary { name, lines }
}

/// Returns a line about time: the upper bound on a cycle of the net, the period of the machine, and the number of
/// budgets that the program declares.
fn budget(analysis: &Analysis, machine: MachineProfile) -> String {
    let bound = machine.time_of(analysis.work.bound(FragmentId::ROOT)) / 1e3;
    let fragments = analysis.net.fragments.iter();
    let stated = fragments
        .filter(|fragment| fragment.budget_ns.is_some())
        .count();
    format!(
        "at most {bound:.2} us of {} us at {} ns per operation; {stated} budgets declared",
        machine.period_ns / 1000,
        machine.ns_per_operation
    )
}
