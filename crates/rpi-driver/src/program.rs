//! Compilation of programs: from parsed modules to nets.

use std::cell::RefCell;
use std::collections::BTreeSet;
use std::path::Path;

use rpi_diag::{Diagnostic, Severity, SourceMap, Span};
use rpi_net::passes::{Analysis, MachineProfile, PossibleFault, over_budget};
use rpi_net::{FragmentId, Net};
use rpi_sema::elab::{
    Argument, ClaimPolicy, ElaboratedUnit, SizeBudget, elaborate, elaborate_dependency_steps,
    has_hidden_dependency_cycle,
};
use rpi_sema::facts::{self, Facts};
use rpi_sema::program::Program;
use rpi_sema::typed::{BlockId, TypedKind, Unit, UnitId, UnitKind};
use rpi_sema::{CheckedProgram, check};
use rpi_syntax::with_large_stack;

use crate::compile::{CompileOptions, UnboundCommand};
use crate::faults::{self, FaultLocation};
use crate::file_loader::DiskLoader;
use crate::instance_diagnostics::InstanceDiagnostics;
use crate::modules::Modules;
use crate::program_tests::Test;
use crate::task::{self, Instance, Task};
use crate::unused_outputs;
use crate::violation;

/// Result of compiling a program.
pub(crate) struct BuildOutput {
    /// Commands that can be run, in source order.
    pub(crate) nets: Vec<Net>,
    /// Commands that lack arguments.
    pub(crate) unbound: Vec<UnboundCommand>,
    /// Tests, in source order.
    pub(crate) tests: Vec<Test>,
    /// Diagnostics.
    pub(crate) diagnostics: Vec<Diagnostic>,
    /// Summaries of the analyses.
    pub(crate) summaries: Vec<AnalysisSummary>,
    /// Operations that can fault at run time, in source order, if requested.
    pub(crate) faults: Vec<FaultLocation>,
    /// Tasks, in source order.
    pub(crate) tasks: Vec<Task>,
}

/// Text of a program in a file.
pub(crate) struct SourceText<'t> {
    /// Name of the module.
    pub(crate) name: &'t str,
    /// Path of the file, for messages.
    pub(crate) path: &'t str,
    /// Text.
    pub(crate) text: &'t str,
    /// Folder in which other modules are searched for.
    pub(crate) folder: Option<&'t Path>,
}

impl SourceText<'_> {
    /// Parses the text and all modules that it needs.
    pub(crate) fn modules(&self, sources: &mut SourceMap) -> Modules {
        Modules::load(
            self.name,
            self.path,
            self.text,
            self.folder,
            &DiskLoader,
            sources,
        )
    }
}

/// Program whose units have been checked, with facts about its flows.
pub(crate) struct AnalysedProgram<'p> {
    pub(crate) program: &'p Program<'p>,
    pub(crate) checked: &'p CheckedProgram,
    pub(crate) sources: &'p SourceMap,
    pub(crate) facts: &'p [Facts],
    /// For each unit whether it has no errors so far.
    pub(crate) error_free: &'p [bool],
    pub(crate) machine: MachineProfile,
    /// Budget of nodes for all nets together, and its current use.
    pub(crate) node_budget: SizeBudget,
    /// Summaries of the units so far, if requested.
    summaries: RefCell<Option<Vec<AnalysisSummary>>>,
    /// Operations that can fault in the nets so far, if requested.
    faults: RefCell<Option<BTreeSet<FaultLocation>>>,
}

/// Summary of the analyses of one unit: its name, and one line per result.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct AnalysisSummary {
    /// Name of the unit.
    pub name: String,
    /// Lines: the name of the analysis and its result.
    pub lines: Vec<(&'static str, String)>,
}

/// Compiles parsed modules with all further stages. Also returns the result of the checker.
pub(crate) fn build_modules(
    modules: &Modules,
    sources: &SourceMap,
    asked: CompileOptions,
) -> (BuildOutput, CheckedProgram) {
    let back = |front: &AnalysedProgram<'_>, diagnostics: &mut Vec<Diagnostic>| {
        build_roots(front, asked, diagnostics)
    };
    let (roots, diagnostics, checked) = with_checked_program(modules, sources, back);
    let built = BuildOutput {
        nets: roots.nets,
        unbound: roots.unbound,
        tests: roots.tests,
        summaries: roots.summaries,
        faults: roots.faults,
        tasks: roots.tasks,
        diagnostics,
    };
    (built, checked)
}

/// Checks parsed modules and calls `back`, which makes nets of the units without errors.
pub(crate) fn with_checked_program<T>(
    modules: &Modules,
    sources: &SourceMap,
    back: impl FnOnce(&AnalysedProgram<'_>, &mut Vec<Diagnostic>) -> T,
) -> (T, Vec<Diagnostic>, CheckedProgram) {
    with_large_stack(|| check_and_build(modules, sources, back))
}

fn check_and_build<T>(
    modules: &Modules,
    sources: &SourceMap,
    back: impl FnOnce(&AnalysedProgram<'_>, &mut Vec<Diagnostic>) -> T,
) -> (T, Vec<Diagnostic>, CheckedProgram) {
    let texts = modules.sources();
    let (program, mut diagnostics) =
        Program::collect_with_library(&texts, crate::modules::LIBRARY_NAMES);
    diagnostics.splice(0..0, modules.diagnostics.iter().cloned());
    let mut checked = check(&program);
    diagnostics.append(&mut checked.diagnostics);
    let mut diagnostics =
        rpi_sema::without_undefined_flows_in_unclosed_bodies(&program, diagnostics);
    let sound = rpi_sema::sound_units(&program, &checked.units, &diagnostics);
    let (facts, mut found) = facts::analyse(&checked.units, &sound);
    diagnostics.append(&mut found);
    let sound = rpi_sema::sound_units(&program, &checked.units, &diagnostics);
    let front = AnalysedProgram {
        program: &program,
        checked: &checked,
        sources,
        facts: &facts,
        error_free: &sound,
        machine: modules.machine,
        node_budget: SizeBudget::for_program(&program, &checked.units),
        summaries: RefCell::default(),
        faults: RefCell::default(),
    };
    let (is_faulty, before) = (has_errors(&diagnostics), diagnostics.len());
    let made = back(&front, &mut diagnostics);
    if is_faulty {
        // An error may hide a use of this text, so it may not be unused.
        let needless = |f: &Diagnostic| f.code.is_unnecessary();
        let mut found = diagnostics.split_off(before);
        found.retain(|diagnostic| !needless(diagnostic));
        diagnostics.append(&mut found);
    }
    if !has_errors(&diagnostics) {
        let known: BTreeSet<_> = diagnostics.iter().map(|f| (f.code, f.span())).collect();
        let mut more = rpi_sema::unused_warnings(&program, &checked.units);
        more.retain(|f| !known.contains(&(f.code, f.span())));
        diagnostics.append(&mut more);
    }
    crate::fixes::type_initial_values(&mut diagnostics, &checked);
    // Warnings and notes about library modules are not useful for the user of the library.
    let own = texts.first().map_or(0, |root| root.files.len());
    diagnostics.retain(|diagnostic| {
        let file = diagnostic.span().file.0 as usize;
        diagnostic.severity() == Severity::Error || diagnostic.span().is_none() || file < own
    });
    (made, deduplicate(diagnostics), checked)
}

/// Units that can be run.
#[derive(Default)]
struct Roots {
    nets: Vec<Net>,
    unbound: Vec<UnboundCommand>,
    tests: Vec<Test>,
    summaries: Vec<AnalysisSummary>,
    faults: Vec<FaultLocation>,
    tasks: Vec<Task>,
}

fn build_roots(
    front: &AnalysedProgram<'_>,
    asked: CompileOptions,
    diagnostics: &mut Vec<Diagnostic>,
) -> Roots {
    let (claims, checked) = (asked.claims, front.checked);
    front.summaries.replace(asked.summaries.then(Vec::new));
    front.faults.replace(asked.faults.then(BTreeSet::new));
    let called = called_units(&checked.units);
    let (mut roots, mut found) = (Roots::default(), InstanceDiagnostics::default());
    for (_, unit) in &checked.runnable {
        let kind = checked.unit(*unit).kind;
        if !front.is_error_free(*unit) {
            continue;
        }
        if kind == UnitKind::Task {
            front.record_task_summary(*unit);
            continue;
        }
        if !kind.is_root() && called.contains(unit) && !is_bounded_alone(checked.unit(*unit)) {
            continue;
        }
        let args = default_arguments(front, *unit);
        let made = elaborate_and_analyse(front, *unit, &args, found.add_instance(*unit, None));
        if kind == UnitKind::Command {
            roots
                .unbound
                .extend(unbound_command(checked.unit(*unit), &args));
        }
        let made = made.filter(|_| !args.contains(&Argument::Unknown));
        match (kind, made) {
            (UnitKind::Command, Some(made)) => {
                roots
                    .nets
                    .push(with_claims(front, *unit, &args, made, claims).net);
            }
            (UnitKind::Test, Some(made)) => roots.tests.push(test(checked.unit(*unit), made)),
            _ => {}
        }
    }
    let (tasks, instances) = task::tasks(front, diagnostics);
    let nets = instances.into_iter();
    let nets = nets.filter_map(|made| instance(front, made, claims, &mut found));
    roots.nets.extend(nets);
    diagnostics.extend(found.merge());
    roots.tasks = tasks;
    roots.summaries = front.summaries.take().unwrap_or_default();
    roots.faults = front
        .faults
        .take()
        .unwrap_or_default()
        .into_iter()
        .collect();
    roots
}

/// Returns the net of a command for the arguments given by a task.
fn instance(
    front: &AnalysedProgram<'_>,
    instance: Instance,
    claims: ClaimPolicy,
    found: &mut InstanceDiagnostics,
) -> Option<Net> {
    let Instance {
        name,
        unit,
        args,
        span,
    } = instance;
    let run = Some((name.clone(), span));
    let made = elaborate_and_analyse(front, unit, &args, found.add_instance(unit, run))?;
    if let Some(told) = front
        .summaries
        .borrow_mut()
        .as_mut()
        .and_then(|told| told.last_mut())
    {
        told.name.clone_from(&name);
    }
    let made = with_claims(front, unit, &args, made, claims);
    Some(Net { name, ..made.net })
}

/// Returns whether a called unit has a budget that the analysis of its callers does not check: nodes are inlined into
/// their callers, so the budget must be checked separately.
fn is_bounded_alone(unit: &Unit) -> bool {
    let budget = unit.block(BlockId::ROOT).budget_ns;
    unit.kind != UnitKind::Fragment && budget.is_some()
}

fn test(unit: &Unit, made: ElaboratedUnit) -> Test {
    Test {
        title: unit.name.to_string(),
        span: unit.span,
        net: made.net,
    }
}

/// Elaborates a unit again with other treatment of its claims, if it has any.
pub(crate) fn with_claims(
    front: &AnalysedProgram<'_>,
    unit: UnitId,
    args: &[Argument],
    made: ElaboratedUnit,
    claims: ClaimPolicy,
) -> ElaboratedUnit {
    match claims == ClaimPolicy::Report || !made.has_claims {
        true => made,
        false => elaborate(&front.checked.units, front.facts, unit, args, claims),
    }
}

/// Elaborates and analyses one unit. Returns `None` if the passes report errors. Claims are always published here,
/// because the passes analyse them as well.
fn elaborate_and_analyse(
    front: &AnalysedProgram<'_>,
    unit: UnitId,
    args: &[Argument],
    diagnostics: &mut Vec<Diagnostic>,
) -> Option<ElaboratedUnit> {
    let units = &front.checked.units;
    if !front.node_budget.has_remaining() {
        diagnostics.extend(
            front
                .node_budget
                .report_exhausted(front.checked.unit(unit).span),
        );
        return None;
    }
    let made = elaborate(units, front.facts, unit, args, ClaimPolicy::Report);
    front.node_budget.extract_element(made.net.nodes.len());
    analyse_unit(front, unit, args, made, diagnostics)
}

/// Analyses the net of a unit. Returns `None` if the passes report errors.
pub(crate) fn analyse_unit(
    front: &AnalysedProgram<'_>,
    unit: UnitId,
    args: &[Argument],
    mut made: ElaboratedUnit,
    diagnostics: &mut Vec<Diagnostic>,
) -> Option<ElaboratedUnit> {
    let mut found = std::mem::take(&mut made.diagnostics);
    if !has_errors(&found) {
        // The analysis consumes the net and returns the optimised one.
        let net = std::mem::replace(&mut made.net, Net::new(""));
        match rpi_net::passes::analyse_unless_cyclic(net, |_| false) {
            Ok(None) => found.extend(dependency_cycles(front, unit, args)),
            // The net for execution omits equations that only copy a flow, so it can hide a dependency cycle through
            // them.
            Ok(Some(_)) if made.dropped_code && front.hides_dependency_cycle(unit, args) => {
                found.extend(dependency_cycles(front, unit, args));
            }
            Ok(Some(analysis)) => {
                found.extend(front.faults(unit, &analysis, &made));
                found.extend(analysis.diagnostics);
                let over = over_budget(&analysis.net, &analysis.work, front.machine);
                found.extend(over);
                made.net = analysis.net;
                found.extend(rpi_sema::init::check(&made.net));
            }
            Err(violation) => {
                let span = front.checked.unit(unit).span;
                found.push(violation::diagnostic(&violation, span));
            }
        }
    }
    unused_outputs::suppress_unused_outputs(&front.checked.units, unit, &mut found);
    let faulty = has_errors(&found);
    diagnostics.append(&mut found);
    (!faulty).then_some(made)
}

impl AnalysedProgram<'_> {
    /// Returns whether a unit and everything it depends on have no errors so far.
    pub(crate) fn is_error_free(&self, unit: UnitId) -> bool {
        self.error_free[unit.0 as usize]
    }

    fn hides_dependency_cycle(&self, unit: UnitId, args: &[Argument]) -> bool {
        has_hidden_dependency_cycle(&self.checked.units, self.facts, unit, args)
    }

    /// Records the summary of a task.
    fn record_task_summary(&self, unit: UnitId) {
        if let Some(told) = self.summaries.borrow_mut().as_mut() {
            let lines = rpi_sema::summary(&self.checked.units, unit);
            let name = self.checked.unit(unit).name.to_string();
            told.push(AnalysisSummary { name, lines });
        }
    }

    /// Returns the diagnostics about operations that can fault. They are computed only if a summary, the locations or
    /// warnings are needed.
    fn faults(&self, unit: UnitId, analysis: &Analysis, made: &ElaboratedUnit) -> Vec<Diagnostic> {
        let mut kept = self.faults.borrow_mut();
        let is_told = self.summaries.borrow().is_some();
        if !is_told && kept.is_none() && made.stateful_operands.is_empty() {
            return Vec::new();
        }
        let found = faults::faults_of_net(analysis);
        if let Some(kept) = kept.as_mut() {
            kept.append(&mut faults::locations(&found));
        }
        self.record_summary(unit, analysis, made, &found);
        faults::stateful_operand_warnings(&made.stateful_operands, &found)
    }

    /// Records the summary of a unit.
    fn record_summary(
        &self,
        unit: UnitId,
        analysis: &Analysis,
        made: &ElaboratedUnit,
        faults: &[PossibleFault],
    ) {
        let mut told = self.summaries.borrow_mut();
        let Some(told) = told.as_mut() else {
            return;
        };
        let mut lines = rpi_sema::summary(&self.checked.units, unit);
        lines.extend(analysis.summary.iter().cloned());
        lines.push(("initialisation", rpi_sema::init::summary(&analysis.net)));
        lines.push(("budget", budget(analysis, self.machine)));
        lines.extend(faults::lines(faults, self.sources));
        if made.has_claims {
            let count = analysis.net.claims.len();
            lines.push(("claims", format!("{count} assertions and contract clauses")));
        }
        let name = self.checked.unit(unit).name.to_string();
        told.push(AnalysisSummary { name, lines });
    }
}

/// Returns the summary of the work bound and the declared budgets.
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

/// Returns the arguments of a command that is run on its own: devices are bound by name, values to constants of the
/// same name.
fn default_arguments(front: &AnalysedProgram<'_>, unit: UnitId) -> Vec<Argument> {
    let unit = front.checked.unit(unit);
    let params = rpi_sema::elab::parameters(unit);
    let argument = |id| front.checked.root_argument(front.program, unit.flow(id));
    params.into_iter().map(argument).collect()
}

/// Returns a command that lacks arguments, or `None` if it lacks none.
fn unbound_command(unit: &Unit, args: &[Argument]) -> Option<UnboundCommand> {
    let params = rpi_sema::elab::parameters(unit).into_iter().zip(args);
    let lacking = params.filter(|(_, arg)| **arg == Argument::Unknown);
    let declared = |(id, _)| {
        let flow = unit.flow(id);
        format!("{}: {}", flow.name, flow.ty)
    };
    let params: Vec<String> = lacking.map(declared).collect();
    (!params.is_empty()).then(|| UnboundCommand {
        command: unit.name.to_string(),
        params,
    })
}

/// Returns the units that others call.
pub(crate) fn called_units<'u>(units: impl IntoIterator<Item = &'u Unit>) -> BTreeSet<UnitId> {
    let exprs = units.into_iter().flat_map(|unit| &unit.exprs);
    let calls = exprs.filter_map(|expr| match &expr.kind {
        TypedKind::Call(call) => Some(call.unit),
        _ => None,
    });
    calls.collect()
}

pub(crate) fn has_errors(diagnostics: &[Diagnostic]) -> bool {
    diagnostics
        .iter()
        .any(|diagnostic| diagnostic.severity() == Severity::Error)
}

/// Removes duplicates and consequential diagnostics. A unit called in several places is analysed in each of them,
/// possibly with other names for its flows; diagnostics with the same fixes at the same location are the same error. A
/// diagnostic at the location of a syntax error is a consequence of it.
fn deduplicate(diagnostics: Vec<Diagnostic>) -> Vec<Diagnostic> {
    let syntax = diagnostics
        .iter()
        .filter(|diagnostic| is_syntax_error(diagnostic));
    let broken: Vec<Span> = syntax
        .flat_map(|f| &f.labels)
        .map(|label| label.span)
        .collect();
    let follows = |diagnostic: &Diagnostic| {
        let mut places = diagnostic.labels.iter().map(|label| label.span);
        !is_syntax_error(diagnostic)
            && places.any(|place| broken.iter().any(|fault| overlap(place, *fault)))
    };
    let (mut seen, mut mended) = (BTreeSet::new(), BTreeSet::new());
    let mut kept = diagnostics;
    kept.retain(|diagnostic| {
        let place = (diagnostic.code, diagnostic.span());
        !follows(diagnostic)
            && seen.insert((place, diagnostic.message.clone()))
            && (diagnostic.fixes.is_empty() || mended.insert((place, fix_edits(diagnostic))))
    });
    kept
}

/// Returns the changes that the fixes of a diagnostic make.
fn fix_edits(diagnostic: &Diagnostic) -> Vec<(Span, String)> {
    let edits = diagnostic.fixes.iter().flat_map(|fix| &fix.edits);
    edits.map(|edit| (edit.span, edit.text.clone())).collect()
}

/// Returns whether a diagnostic is a syntax error (group 0 of the codes).
fn is_syntax_error(diagnostic: &Diagnostic) -> bool {
    diagnostic.code.as_str().starts_with("RPI0") && diagnostic.severity() == Severity::Error
}

fn overlap(a: Span, b: Span) -> bool {
    a.file == b.file && a.start < b.end && b.start < a.end
}
