//! Units that can be run: commands, tests and tasks, each with its net.

use std::collections::BTreeSet;
use std::rc::Rc;

use rpi_diag::{Diagnostic, SourceMap};
use rpi_sema::CheckedProgram;
use rpi_sema::elab::{Argument, elaborate, elaborate_watched};
use rpi_sema::typed::{BlockId, TypedKind, Unit, UnitId, UnitKind};

use crate::analysed_net::AnalysedNet;
use crate::analysis_summary::{AnalysisSummary, record_task_summary};
use crate::compile::{CompileOptions, UnboundCommand};
use crate::faults::FaultLocation;
use crate::instance_diagnostics::InstanceDiagnostics;
use crate::modules::Modules;
use crate::program::{AnalysedProgram, with_reused_program};
use crate::program_memo::ProgramMemo;
use crate::program_tests::Test;
use crate::task::{self, Instance, Task};
use crate::unit_analysis::{AnalysedUnit, elaborate_and_analyse, elaborated_again, with_claims};
use crate::watch::{UnknownFlow, Watch};

/// Result of compiling the modules of a program: nets, tests and tasks, with the diagnostics of all stages.
pub(crate) struct BuildOutput {
    /// Nets of the commands: first those with default arguments in source order, then those with the arguments of
    /// tasks.
    pub(crate) nets: Vec<AnalysedNet>,
    /// Commands that cannot run on their own because a parameter has no value.
    pub(crate) unbound: Vec<UnboundCommand>,
    /// Tests of the program with their nets, in source order.
    pub(crate) tests: Vec<Test>,
    /// Diagnostics of all stages.
    pub(crate) diagnostics: Vec<Diagnostic>,
    /// Summaries of the analyses of each command, node and task; empty unless requested.
    pub(crate) summaries: Vec<AnalysisSummary>,
    /// Operations that can fault at run time, in source order; empty unless requested.
    pub(crate) faults: Vec<FaultLocation>,
    /// Tasks of the program with their plans, in source order.
    pub(crate) tasks: Vec<Task>,
    /// Names of watched flows that no command has.
    pub(crate) unknown_flows: Vec<UnknownFlow>,
}

/// Compiles parsed modules to nets, tests and tasks. Also returns the result of the checker.
pub(crate) fn build_modules(
    modules: &Modules,
    sources: &SourceMap,
    options: &CompileOptions,
) -> (BuildOutput, CheckedProgram) {
    build_reusing(modules, sources, options, None)
}

/// Checks parsed modules like [`build_modules`]. With `memo`, the results of an earlier check are reused, and the output
/// has no nets.
pub(crate) fn build_reusing(
    modules: &Modules,
    sources: &SourceMap,
    options: &CompileOptions,
    memo: Option<&mut ProgramMemo>,
) -> (BuildOutput, CheckedProgram) {
    let back = |front: &AnalysedProgram<'_>, diagnostics: &mut Vec<Diagnostic>| {
        build_roots(front, options, diagnostics)
    };
    let (roots, diagnostics, checked) = with_reused_program(modules, sources, memo, back);
    let built = BuildOutput {
        nets: roots.nets,
        unbound: roots.unbound,
        tests: roots.tests,
        summaries: roots.summaries,
        faults: roots.faults,
        tasks: roots.tasks,
        unknown_flows: roots.unknown_flows,
        diagnostics,
    };
    (built, checked)
}

/// Result of compiling the units that can be run, each to a net of its own: commands, tests and tasks, with the
/// requested reports.
#[derive(Default)]
struct Roots {
    nets: Vec<AnalysedNet>,
    unbound: Vec<UnboundCommand>,
    tests: Vec<Test>,
    summaries: Vec<AnalysisSummary>,
    faults: Vec<FaultLocation>,
    tasks: Vec<Task>,
    unknown_flows: Vec<UnknownFlow>,
}

fn build_roots(
    front: &AnalysedProgram<'_>,
    options: &CompileOptions,
    diagnostics: &mut Vec<Diagnostic>,
) -> Roots {
    let checked = front.checked;
    front.reports.request(options);
    let watch = Watch::new(&options.watch);
    let called = called_units(checked.units.iter().map(Rc::as_ref));
    let (mut roots, mut instances) = (Roots::default(), InstanceDiagnostics::default());
    for (_, unit) in &checked.runnable {
        let kind = checked.unit(*unit).kind;
        if !front.is_error_free(*unit) {
            continue;
        }
        if kind == UnitKind::Task {
            record_task_summary(front, *unit);
            continue;
        }
        if !kind.is_root() && called.contains(unit) && !is_bounded_alone(checked.unit(*unit)) {
            continue;
        }
        let args = default_arguments(front, *unit);
        let found = instances.add_instance(*unit, None);
        let analysed = elaborate_and_analyse(front, *unit, &args, found);
        if kind == UnitKind::Command {
            let command = unbound_command(checked.unit(*unit), &args);
            roots.unbound.extend(command);
        }
        let analysed = analysed.filter(|_| !args.contains(&Argument::Unknown));
        match (kind, analysed) {
            (UnitKind::Command, Some(analysed)) => {
                let names = [&*checked.unit(*unit).name];
                let options = (options, &watch);
                let net = command_net(front, (*unit, &names), &args, analysed, options, found);
                roots.nets.extend(net);
            }
            (UnitKind::Test, Some(analysed)) => {
                roots.tests.push(test(checked.unit(*unit), analysed));
            }
            _ => {}
        }
    }
    let (tasks, commands) = task::tasks(front, diagnostics);
    let nets = commands.into_iter();
    let nets =
        nets.filter_map(|command| instance_net(front, command, (options, &watch), &mut instances));
    roots.nets.extend(nets);
    diagnostics.extend(instances.merge());
    roots.tasks = tasks;
    roots.unknown_flows = watch.unknown_names();
    (roots.summaries, roots.faults) = front.reports.take();
    roots
}

/// Returns the net of a command for the arguments given by a task; `None` if the command has errors with these
/// arguments.
fn instance_net(
    front: &AnalysedProgram<'_>,
    instance: Instance,
    options: (&CompileOptions, &Watch<'_>),
    instances: &mut InstanceDiagnostics,
) -> Option<AnalysedNet> {
    let Instance {
        name,
        unit,
        args,
        span,
    } = instance;
    let run = Some((name.clone(), span));
    let found = instances.add_instance(unit, run);
    let analysed = elaborate_and_analyse(front, unit, &args, found)?;
    front.reports.rename_last(&name);
    let names = [name.as_str(), &front.checked.unit(unit).name];
    let net = command_net(front, (unit, &names), &args, analysed, options, found)?;
    Some(net.with_name(name))
}

/// Returns the net of an analysed command, which users know by `names`, with the requested treatment of its claims (assertions and contracts), and with the
/// exports of watched flows. It is compiled again if this makes a difference.
fn command_net(
    front: &AnalysedProgram<'_>,
    (unit, names): (UnitId, &[&str]),
    args: &[Argument],
    analysed: AnalysedUnit,
    (options, watch): (&CompileOptions, &Watch<'_>),
    diagnostics: &mut Vec<Diagnostic>,
) -> Option<AnalysedNet> {
    let (units, facts, claims) = (&front.checked.units, front.facts, options.claims);
    let selection = watch.selection_in(names);
    let analysed = match selection.is_empty() {
        true => {
            let again = || elaborate(units, facts, unit, args, claims);
            with_claims(front, unit, analysed, claims, diagnostics, again)?
        }
        false => {
            let (again, flows) = elaborate_watched(units, facts, unit, args, claims, selection);
            watch.record(names, &flows);
            elaborated_again(front, unit, again, diagnostics)?
        }
    };
    Some(analysed.net)
}

/// Returns whether a called unit has a time budget that the analysis of its callers does not check: nodes are inlined
/// into their callers, so the budget must be checked separately.
fn is_bounded_alone(unit: &Unit) -> bool {
    let budget = unit.block(BlockId::ROOT).budget_ns;
    unit.kind != UnitKind::Fragment && budget.is_some()
}

fn test(unit: &Unit, analysed: AnalysedUnit) -> Test {
    Test {
        title: unit.name.to_string(),
        span: unit.span,
        net: analysed.net,
    }
}

/// Returns the arguments of a command that is run on its own: devices of the cell by the names of its parameters, and
/// constants of the same names as its parameters, or defaults.
fn default_arguments(front: &AnalysedProgram<'_>, unit: UnitId) -> Vec<Argument> {
    let unit = front.checked.unit(unit);
    let params = rpi_sema::elab::parameters(unit);
    let argument = |id| front.checked.root_argument(front.program, unit.flow(id));
    params.into_iter().map(argument).collect()
}

/// Returns name and parameters of a command with parameters that have no value; `None` if every parameter has one.
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

/// Returns the units (nodes and functions) that the given units call directly.
pub(crate) fn called_units<'u>(units: impl IntoIterator<Item = &'u Unit>) -> BTreeSet<UnitId> {
    let exprs = units.into_iter().flat_map(|unit| &unit.exprs);
    let calls = exprs.filter_map(|expr| match &expr.kind {
        TypedKind::Call(call) => Some(call.unit),
        _ => None,
    });
    calls.collect()
}
