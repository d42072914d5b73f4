//! Tasks (M11): every label refers to a step, every result of a command leads somewhere, and a successor takes over the
//! devices that its predecessor may leave moving.
//!
//! | file | idea |
//! |---|---|
//! | `results.rs` | branches and the results of a command |
//! | `labels.rs` | labels of other lists of steps |
//! | `takeover.rs` | successors of a `yield` |
//! | `handover.rs` | values that a command takes over |
//! | `sequence.rs` | first and last steps of a list |
//! | `parallel.rs` | parallel branches must drive different devices |

pub(crate) mod handover;
mod labels;
mod parallel;
mod results;
pub(crate) mod sequence;
mod takeover;

pub(crate) use parallel::DeviceUses;

use crate::check::bodies::body::Body;
use crate::check::bodies::statement;
use crate::check::calls::args;
use crate::check::calls::call;
use crate::check::calls::call::MatchedCall;
use crate::check::diagnostics::foreign_idioms;
use crate::check::diagnostics::report;
use crate::check::diagnostics::report::ExpectationReason;
use crate::check::diagnostics::report::undefined_name;
use crate::check::diagnostics::report::wrong_kind_of_name;
use crate::check::exprs::expr;
use crate::check::exprs::names;
use crate::check::signatures::static_args;
use crate::check::signatures::unit;
use crate::check::task::handover::{Predecessors, Succession};
use crate::check::task::sequence::{entry_steps, first_steps, last_steps, run_of};
use crate::check::types::consts;
use crate::program::{DeclId, DeclKind, Lookup, duplicate_name_error};
use crate::ty::Ty;
use crate::typed::{ExprId, TaskStep};
use rpi_diag::{Code, Diagnostic, Quote};
use rpi_syntax::ast::{
    Expr, Ident, NextStep, ParallelBranch, Run, Step, StepKind, TaskDecl, VarDecl,
};

/// Maximum number of repetitions in a `repeat`. At one repetition per millisecond they take twelve days.
const MAX_REPETITIONS: i64 = 1 << 30;

/// Labels of steps to which a branch can lead, with their steps. The labels of the innermost list of steps come last.
type Labels<'a> = Vec<(&'a Ident, &'a Run)>;

/// Steps that run after a step without branches. There are several if parallel branches begin.
#[derive(Clone, Default)]
struct Continuation<'a> {
    runs: Vec<&'a Run>,
    /// Whether the steps start only after other parallel branches have ended as well.
    waits_for_branches: bool,
}

impl<'a> Continuation<'a> {
    fn sequential(runs: Vec<&'a Run>) -> Continuation<'a> {
        Continuation {
            runs,
            waits_for_branches: false,
        }
    }
}

/// Checks the steps of a task, the values that each step takes over from the ones before, and the devices that steps
/// drive in parallel.
pub(crate) fn check_task<'a>(cx: &mut Body<'_, 'a>, task: &'a TaskDecl) {
    let first = first_steps(&task.steps).into_iter();
    let mut follows: Vec<Succession<'a>> = first.map(|run| (Predecessors::None, run)).collect();
    let nothing = Continuation::default();
    let before = cx.diagnostics.len();
    check_steps(cx, &task.steps, &nothing, &mut Labels::new(), &mut follows);
    labels::hint_labels_elsewhere(&mut cx.diagnostics[before..], &task.steps);
    crate::check::task::handover::check_handover(cx, &follows);
    parallel::check_parallel_devices(cx, task);
}

/// Checks a list of steps and appends the successions of steps to `follows`. `again` are the steps that follow the last
/// one; in a `repeat`, they are the first steps of the list.
fn check_steps<'a>(
    cx: &mut Body<'_, 'a>,
    steps: &'a [Step],
    again: &Continuation<'a>,
    labels: &mut Labels<'a>,
    follows: &mut Vec<Succession<'a>>,
) {
    let outer = labels.len();
    for run in steps.iter().filter_map(run_of) {
        let Some(label) = &run.label else { continue };
        let same = labels[outer..]
            .iter()
            .find(|(known, _)| known.name == label.name);
        if let Some((first, _)) = same {
            let diagnostic = duplicate_name_error(&label.name, label.span, first.span);
            report::report_diagnostic(cx, diagnostic);
        }
        labels.push((label, run));
    }
    for (k, step) in steps.iter().enumerate() {
        let next = match steps.get(k + 1) {
            Some(next) => Continuation::sequential(entry_steps(next)),
            None => again.clone(),
        };
        match &step.kind {
            StepKind::Run(run) => {
                check_run(cx, run, &next.runs, labels);
                follows.extend(crate::check::task::handover::successor_steps(
                    run, &next, labels,
                ));
            }
            StepKind::Repeat { count, steps } => {
                check_repeat_count(cx, count.as_ref());
                let first = Continuation::sequential(first_steps(steps));
                check_steps(cx, steps, &first, labels, follows);
            }
            StepKind::Parallel(strands) => check_parallel(cx, strands, &next, follows),
            StepKind::Start(label) => {
                find_label(cx, label, labels);
            }
            StepKind::Error(_) => {}
        }
    }
    labels.truncate(outer);
}

/// Checks the branches of a `parallel`. From inside of a branch, no step outside can be reached by its label. `next`
/// are the steps after the `parallel`.
fn check_parallel<'a>(
    cx: &mut Body<'_, 'a>,
    strands: &'a [ParallelBranch],
    next: &Continuation<'a>,
    follows: &mut Vec<Succession<'a>>,
) {
    let joined = Continuation {
        runs: next.runs.clone(),
        waits_for_branches: true,
    };
    for strand in strands {
        check_steps(cx, &strand.steps, &joined, &mut Labels::new(), follows);
    }
    let ends: Vec<Vec<&'a Run>> = strands.iter().map(|s| last_steps(&s.steps)).collect();
    if !next.waits_for_branches {
        let all = next.runs.iter().copied();
        follows.extend(all.map(|run| (Predecessors::Parallel(ends.clone()), run)));
    }
}

/// Returns the step with this label. Reports an undefined label and returns `None`.
fn find_label<'a>(cx: &mut Body<'_, 'a>, label: &Ident, labels: &Labels<'a>) -> Option<&'a Run> {
    let found = labels
        .iter()
        .rev()
        .find(|(known, _)| known.name == label.name);
    if found.is_none() {
        let names = labels.iter().map(|(known, _)| known.name.as_str());
        let near = cx.checker.suggest(&label.name, names);
        report::report_diagnostic(cx, {
            let is_near = near.is_some();
            let diagnostic = undefined_name("step", &label.name, label.span, near);
            match is_near {
                true => diagnostic,
                false => diagnostic.help(
                    "name a step of the same list: a branch cannot lead into `repeat` or `parallel`, or out of them",
                ),
            }
        });
    }
    found.map(|(_, run)| *run)
}

/// Checks the number of repetitions of a `repeat`: an integer that is known when the task is loaded. `None` means an
/// endless repetition.
fn check_repeat_count<'a>(cx: &mut Body<'_, 'a>, count: Option<&'a Expr>) {
    let Some(count) = count else { return };
    let value = expr::check_expr(cx, count);
    if !statement::expect_type(cx, value, &Ty::Int, &ExpectationReason::Unexplained)
        || !check_known_at_load(cx, value)
    {
        return;
    }
    let known = consts::try_fold(cx, value).ok();
    match known.and_then(|leaves| leaves.first()?.as_int()) {
        Some(times) if !(0..=MAX_REPETITIONS).contains(&times) => {
            repeat_count_out_of_range(cx, times, count)
        }
        _ => cx.unit.repeat_counts.push((count.span, value)),
    }
}

fn repeat_count_out_of_range(cx: &mut Body<'_, '_>, times: i64, count: &Expr) {
    let message = format!("number of repetitions out of range: {times}");
    let diagnostic = Diagnostic::new(Code::RPI8006, message)
        .primary(count.span, format!("must be from 0 to {MAX_REPETITIONS}"));
    report::report_diagnostic(
        cx,
        match times > 0 {
            true => diagnostic.help("`repeat let ... tel` repeats without end"),
            false => diagnostic.help("use a number that is not negative"),
        },
    );
}

/// Whether a value is known when the task is loaded. Reports a value that changes while commands run.
fn check_known_at_load(cx: &mut Body<'_, '_>, value: ExprId) -> bool {
    let known = args::is_load_time_constant(cx, value);
    if !known {
        let diagnostic = Diagnostic::new(Code::RPI2008, "a constant is needed here")
            .primary(cx.span_of(value), "this changes while commands run")
            .help("use a number, a constant or a parameter of the task");
        report::report_diagnostic(cx, diagnostic);
    }
    known
}

fn check_run<'a>(cx: &mut Body<'_, 'a>, run: &'a Run, next: &[&'a Run], labels: &Labels<'a>) {
    if let Some(id) = resolve_run(cx, run) {
        check_run_arguments(cx, id, run);
        match cx.checker.program.decl(id).kind {
            DeclKind::Command(command) => {
                results::check_branches(cx, command, run);
                takeover::check_successors(cx, command, run, next, labels);
            }
            _ => results::report_task_results(cx, run),
        }
    }
    for branch in &run.branches {
        if let NextStep::Step(label) = &branch.next {
            find_label(cx, label, labels);
        }
    }
}

/// Returns the diagnostic for a step that runs a command with an undefined name.
fn undefined_command(cx: &Body<'_, '_>, name: &Ident) -> Diagnostic {
    let runs = |id: DeclId| is_runnable(cx.checker.program.decl(id).kind);
    let visible = cx.checker.program.visible_names(cx.module, runs);
    let near = cx.checker.suggest(&name.name, visible);
    let is_near = near.is_some();
    let diagnostic = undefined_name("command or task", &name.name, name.span, near);
    match foreign_idioms::step_help(&name.name) {
        Some(help) => diagnostic.help(help),
        None if is_near => diagnostic,
        None => diagnostic.help(format!(
            "declare `command {0} (...) let ... tel`, or use the module that declares it",
            name.name
        )),
    }
}

/// Returns the command or task that a step runs. Reports a name with another meaning and returns `None`.
fn resolve_run<'a>(cx: &mut Body<'_, 'a>, run: &'a Run) -> Option<DeclId> {
    let name = &run.callee.name;
    let Lookup::Found(id) = cx.checker.program.lookup(cx.module, &name.name) else {
        let diagnostic = undefined_command(cx, name);
        report::report_diagnostic(cx, diagnostic);
        return None;
    };
    let decl = cx.checker.program.decl(id);
    let (kind, span) = (decl.kind, decl.span);
    if is_runnable(kind) {
        return Some(id);
    }
    if !matches!(kind, DeclKind::Broken(_)) {
        let what = "a command or task";
        report::report_diagnostic(
            cx,
            wrong_kind_of_name(what, &name.name, kind.description(), name.span, span),
        );
    }
    None
}

/// Checks the arguments of a step that runs the command or task `id`, and adds the step to the unit of the task.
fn check_run_arguments<'a>(cx: &mut Body<'_, 'a>, id: DeclId, run: &'a Run) {
    let bound = static_args::bind_statics(cx, id, &run.callee.statics);
    let before = cx.diagnostics.len();
    let (mut given, all_named) = args::check_args_for(cx, id, &run.args.iter().collect::<Vec<_>>());
    hint_parameter_types(cx, id, run, before);
    given.extend(bound.ports);
    if bound.has_error || !all_named {
        return;
    }
    let span = run.callee.span;
    if let Ok(MatchedCall { header, args, .. }) =
        call::match_call(cx, id, bound.statics, given, span)
        && let Some(unit) = unit::instantiate(cx.checker, &header, span)
    {
        cx.unit.steps.push(TaskStep {
            span,
            decl: id,
            unit,
            args,
            taken_over: Vec::new(),
        });
    }
}

/// Adds the type of the parameter to the diagnostics from `before` on about undefined arguments of a step.
fn hint_parameter_types(cx: &mut Body<'_, '_>, id: DeclId, run: &Run, before: usize) {
    let params = match cx.checker.program.decl(id).kind {
        DeclKind::Command(command) => &command.params,
        DeclKind::Task(task) => &task.params,
        _ => return,
    };
    let all = params
        .iter()
        .flat_map(|param| param.names.iter().map(move |name| (name, param)));
    let all: Vec<(&Ident, &VarDecl)> = all.collect();
    for (k, arg) in run.args.iter().enumerate() {
        let by_name = |name: &Ident| all.iter().find(|(param, _)| param.name == name.name);
        let param = arg.name.as_ref().map_or(all.get(k), by_name);
        let (Some((_, param)), Some(name)) = (param, names::plain_name(&arg.value)) else {
            continue;
        };
        let task = &cx.unit.name;
        let mut found = cx.diagnostics.iter_mut().skip(before);
        let undefined = found.find(|it| it.code == Code::RPI1001 && it.span() == arg.value.span);
        if let Some(diagnostic) = undefined.filter(|it| it.fixes.is_empty()) {
            diagnostic.help = vec![format!(
                "declare the devices and values of a task as its parameters: `task {task} ({name}: {})`",
                Quote::text(param.ty.span)
            )];
        }
    }
}

fn is_runnable(kind: DeclKind<'_>) -> bool {
    matches!(kind, DeclKind::Command(_) | DeclKind::Task(_))
}
