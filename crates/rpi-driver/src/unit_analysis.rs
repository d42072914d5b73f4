//! Analysis of one unit: from its typed form to a net on which all passes have run.

use rpi_diag::Diagnostic;
use rpi_net::Net;
use rpi_net::passes::{Analysis, analyse_unless_cyclic, over_budget};
use rpi_sema::elab::{
    Argument, ClaimPolicy, ElaboratedUnit, ObservableFlow, PortShape, elaborate,
    elaborate_dependency_steps, has_hidden_dependency_cycle,
};
use rpi_sema::typed::UnitId;

use crate::analysed_net::AnalysedNet;
use crate::analysis_summary;
use crate::cancel_fix;
use crate::program::{AnalysedProgram, has_errors};
use crate::unused_outputs;
use crate::violation;

/// Unit whose net has passed all analyses without errors.
pub(crate) struct AnalysedUnit {
    /// Net with the results of the passes.
    pub(crate) net: AnalysedNet,
    /// Inputs, leaf by leaf.
    pub(crate) inputs: Vec<PortShape>,
    /// Outputs, leaf by leaf.
    pub(crate) outputs: Vec<PortShape>,
    /// Local flows of the unit, leaf by leaf, if requested.
    pub(crate) locals: Vec<ObservableFlow>,
    /// Whether the unit contains claims.
    pub(crate) has_claims: bool,
}

/// Returns a unit with other treatment of its claims. Without claims this is the same net; with claims it is another
/// net, which `elaborate` makes and which is analysed here.
pub(crate) fn with_claims(
    front: &AnalysedProgram<'_>,
    unit: UnitId,
    analysed: AnalysedUnit,
    claims: ClaimPolicy,
    diagnostics: &mut Vec<Diagnostic>,
    elaborate: impl FnOnce() -> ElaboratedUnit,
) -> Option<AnalysedUnit> {
    if claims == ClaimPolicy::Report || !analysed.has_claims {
        return Some(analysed);
    }
    let elaborated = elaborate();
    // The net with all claims has been checked, so the diagnostics of this one repeat them.
    match rpi_net::passes::analyse(elaborated.net, |_| false) {
        Ok(analysis) => Some(AnalysedUnit {
            net: AnalysedNet::from_analysis(analysis)?,
            inputs: elaborated.inputs,
            outputs: elaborated.outputs,
            locals: elaborated.locals,
            has_claims: true,
        }),
        Err(violation) => {
            let span = front.checked.unit(unit).span;
            diagnostics.push(violation::diagnostic(&violation, span));
            None
        }
    }
}

/// Elaborates and analyses one unit. Returns `None` if the passes report errors. Claims are always published here,
/// because the passes analyse them as well.
pub(crate) fn elaborate_and_analyse(
    front: &AnalysedProgram<'_>,
    unit: UnitId,
    args: &[Argument],
    diagnostics: &mut Vec<Diagnostic>,
) -> Option<AnalysedUnit> {
    if !front.node_budget.has_remaining() {
        let span = front.checked.unit(unit).span;
        diagnostics.extend(front.node_budget.report_exhausted(span));
        return None;
    }
    let units = &front.checked.units;
    let elaborated = elaborate(units, front.facts, unit, args, ClaimPolicy::Report);
    front
        .node_budget
        .extract_element(elaborated.net.nodes.len());
    analyse_unit(front, unit, args, elaborated, diagnostics)
}

/// Analyses the net of a unit. Returns `None` if the elaboration or a pass reports errors.
pub(crate) fn analyse_unit(
    front: &AnalysedProgram<'_>,
    unit: UnitId,
    args: &[Argument],
    mut elaborated: ElaboratedUnit,
    diagnostics: &mut Vec<Diagnostic>,
) -> Option<AnalysedUnit> {
    let mut found = std::mem::take(&mut elaborated.diagnostics);
    let mut net = None;
    if !has_errors(&found) {
        net = run_passes(front, unit, args, &mut elaborated, &mut found);
    }
    unused_outputs::suppress_unused_outputs(&front.checked.units, unit, &mut found);
    let has_errors = has_errors(&found);
    diagnostics.append(&mut found);
    Some(AnalysedUnit {
        net: net.filter(|_| !has_errors)?,
        inputs: elaborated.inputs,
        outputs: elaborated.outputs,
        locals: elaborated.locals,
        has_claims: elaborated.has_claims,
    })
}

/// Runs the passes on the net of a unit, which they consume and return.
fn run_passes(
    front: &AnalysedProgram<'_>,
    unit: UnitId,
    args: &[Argument],
    elaborated: &mut ElaboratedUnit,
    diagnostics: &mut Vec<Diagnostic>,
) -> Option<AnalysedNet> {
    let net = std::mem::replace(&mut elaborated.net, Net::new(""));
    match analyse_unless_cyclic(net, |_| false) {
        Ok(None) => diagnostics.extend(dependency_cycles(front, unit, args)),
        // The net for execution omits equations that only copy a flow, so it can hide a dependency cycle through them.
        Ok(Some(_)) if elaborated.dropped_code && hides_dependency_cycle(front, unit, args) => {
            diagnostics.extend(dependency_cycles(front, unit, args));
        }
        Ok(Some(analysis)) => {
            return checked_net(front, unit, analysis, elaborated, diagnostics);
        }
        Err(violation) => {
            let span = front.checked.unit(unit).span;
            diagnostics.push(violation::diagnostic(&violation, span));
        }
    }
    None
}

/// Reports the diagnostics of the passes, checks the budgets and the initialisation, and returns the net if there is no
/// error.
fn checked_net(
    front: &AnalysedProgram<'_>,
    unit: UnitId,
    mut analysis: Analysis,
    elaborated: &ElaboratedUnit,
    diagnostics: &mut Vec<Diagnostic>,
) -> Option<AnalysedNet> {
    diagnostics.extend(analysis_summary::record_reports(
        front, unit, &analysis, elaborated,
    ));
    cancel_fix::add_fixes(&front.checked.units, unit, &mut analysis.diagnostics);
    diagnostics.append(&mut analysis.diagnostics);
    diagnostics.extend(over_budget(&analysis.net, &analysis.work, front.machine));
    diagnostics.extend(rpi_sema::init::check(&analysis.net));
    AnalysedNet::from_analysis(analysis)
}

fn hides_dependency_cycle(front: &AnalysedProgram<'_>, unit: UnitId, args: &[Argument]) -> bool {
    has_hidden_dependency_cycle(&front.checked.units, front.facts, unit, args)
}

/// Returns the dependency cycles of a unit with every equation on the path. They are computed from a second net,
/// because the net for execution omits equations that only copy a flow.
fn dependency_cycles(
    front: &AnalysedProgram<'_>,
    unit: UnitId,
    args: &[Argument],
) -> Vec<Diagnostic> {
    let net = elaborate_dependency_steps(&front.checked.units, front.facts, unit, args);
    let analysis = rpi_net::passes::analyse(net, |_| false);
    analysis.map_or_else(|_| Vec::new(), |analysis| analysis.diagnostics)
}
