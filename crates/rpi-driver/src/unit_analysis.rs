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
use crate::program_memo::NetDiagnostics;
use crate::violation;

/// Unit (node, command or test) whose net has passed all analyses without errors.
pub(crate) struct AnalysedUnit {
    /// Net of the unit, with the results of the passes.
    pub(crate) net: AnalysedNet,
    /// Inputs of the unit, one entry for each scalar part.
    pub(crate) inputs: Vec<PortShape>,
    /// Outputs of the unit, one entry for each scalar part.
    pub(crate) outputs: Vec<PortShape>,
    /// Local flows of the unit, one entry for each scalar part; empty unless requested.
    pub(crate) locals: Vec<ObservableFlow>,
    /// Whether the unit contains claims (assertions or contracts).
    pub(crate) has_claims: bool,
}

/// Returns an analysed unit with the treatment `claims` of its claims (assertions and contracts). A unit without claims
/// is returned unchanged; for any other one, `elaborate` makes another net, which is analysed here. Returns `None` if
/// that net has errors.
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
    elaborated_again(front, unit, elaborate(), diagnostics)
}

/// Returns the unit with another net, `elaborated`, of the same source.
pub(crate) fn elaborated_again(
    front: &AnalysedProgram<'_>,
    unit: UnitId,
    elaborated: ElaboratedUnit,
    diagnostics: &mut Vec<Diagnostic>,
) -> Option<AnalysedUnit> {
    // The net with all claims has been checked, so the diagnostics of this one repeat them.
    match rpi_net::passes::analyse(elaborated.net, |_| false) {
        Ok(analysis) => Some(AnalysedUnit {
            net: AnalysedNet::from_analysis(analysis)?,
            inputs: elaborated.inputs,
            outputs: elaborated.outputs,
            locals: elaborated.locals,
            has_claims: elaborated.has_claims,
        }),
        Err(violation) => {
            let span = front.checked.unit(unit).span;
            diagnostics.push(violation::diagnostic(&violation, span));
            None
        }
    }
}

/// Elaborates one unit (node, command or test) to a net and analyses the net. Returns `None` if there are errors, or if the
/// results of an earlier analysis are used. The net contains all claims (assertions and contracts), because the passes
/// analyse them as well.
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
    let elaborate = || elaborate(units, front.facts, unit, args, ClaimPolicy::Report);
    if let Some(known) = &front.net_memo {
        let compute = || net_diagnostics(front, unit, args, elaborate());
        let found = known.get_or_compute(unit, args, front.machine, compute);
        front.node_budget.extract_element(found.node_count);
        let mut found = found.diagnostics.clone();
        front.out_ports.suppress_unused(units, unit, &mut found);
        diagnostics.append(&mut found);
        return None;
    }
    let elaborated = elaborate();
    front
        .node_budget
        .extract_element(elaborated.net.nodes.len());
    analyse_unit(front, unit, args, elaborated, diagnostics)
}

/// Analyses the net of a unit for its diagnostics only.
fn net_diagnostics(
    front: &AnalysedProgram<'_>,
    unit: UnitId,
    args: &[Argument],
    mut elaborated: ElaboratedUnit,
) -> NetDiagnostics {
    let node_count = elaborated.net.nodes.len();
    let mut diagnostics = std::mem::take(&mut elaborated.diagnostics);
    if !has_errors(&diagnostics) {
        run_passes(front, unit, args, &mut elaborated, &mut diagnostics);
    }
    NetDiagnostics {
        diagnostics,
        node_count,
    }
}

/// Runs the analyses on the net of a unit and adds their diagnostics. Returns `None` if the elaboration or a pass
/// reports errors.
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
    let units = &front.checked.units;
    front.out_ports.suppress_unused(units, unit, &mut found);
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

/// Runs the compiler passes on the net of a unit, which is moved out of `elaborated`. Returns the analysed net; `None`
/// if the net has a dependency cycle or is invalid.
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

/// Adds the diagnostics of the passes, and checks the time budgets and the initialisation of delays. Returns the net;
/// `None` if it has no order of evaluation.
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

/// Returns the diagnostics of the dependency cycles of a unit, each with every equation on its path. They are computed
/// from a second net, because the net for execution omits equations that only copy a flow.
fn dependency_cycles(
    front: &AnalysedProgram<'_>,
    unit: UnitId,
    args: &[Argument],
) -> Vec<Diagnostic> {
    let net = elaborate_dependency_steps(&front.checked.units, front.facts, unit, args);
    let analysis = rpi_net::passes::analyse(net, |_| false);
    analysis.map_or_else(|_| Vec::new(), |analysis| analysis.diagnostics)
}
