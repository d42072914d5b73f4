//! Values that a command takes over (`given`). Each command that may run before it must export them under the same
//! names (M7.3).

use crate::check::bodies::body::Body;
use crate::check::diagnostics::report;
use crate::check::signatures::units_on_demand;
use crate::check::task::{Continuation, Labels};
use crate::program::DeclKind;
use crate::ty::Substitution;
use crate::ty::Ty;
use crate::ty::TypeMismatchError;
use crate::ty::check_assignable;
use crate::typed::{BlockId, FlowId, FlowRole, TakenOverValue, UnitId, UnitKind};
use rpi_diag::{Code, Diagnostic, Span};
use rpi_syntax::Name;
use rpi_syntax::ast::{NextStep, Run};

/// Steps of a task after which a certain step may run.
pub(super) enum Predecessors<'a> {
    /// No step runs before: the step is the first one of the task.
    None,
    /// This step runs directly before.
    Run(&'a Run),
    /// Parallel branches, each with the steps with which it can end. A value that a command takes over comes from the
    /// first branch in which all these steps provide it.
    Parallel(Vec<Vec<&'a Run>>),
}

/// A step of a task, and the steps after which it may run.
pub(super) type Succession<'a> = (Predecessors<'a>, &'a Run);

/// Returns the steps that may directly follow the step `run`: those at the labels of its branches, or the steps `next`
/// if it has no branches.
pub(super) fn successor_steps<'a>(
    run: &'a Run,
    next: &Continuation<'a>,
    labels: &Labels<'a>,
) -> Vec<Succession<'a>> {
    let by_branch = run.branches.iter().filter_map(|branch| match &branch.next {
        NextStep::Step(label) => {
            let mut known = labels.iter().rev();
            known.find(|(known, _)| known.name == label.name)
        }
        NextStep::End(_) => None,
    });
    let is_followed = run.branches.is_empty() && !next.waits_for_branches;
    let in_turn = next.runs.iter().filter(|_| is_followed).copied();
    let all = by_branch.map(|(_, run)| *run).chain(in_turn);
    all.map(|follower| (Predecessors::Run(run), follower))
        .collect()
}

/// Input of a command that takes the value from the command that runs before, and that has no default.
struct TakenOverInput {
    flow: FlowId,
    name: Name,
    ty: Ty,
    declared: Span,
}

/// Checks that the commands before each step provide the values that its command takes over, and records their sources.
/// Reports each missing value once for a step. Whether a provided value may be absent is checked later.
pub(super) fn check_handover<'a>(cx: &mut Body<'_, 'a>, follows: &[Succession<'a>]) {
    let mut reported: Vec<(Span, Name)> = Vec::new();
    for (before, run) in follows {
        let Some(step) = task_step_of(cx, run).filter(|step| is_command_step(cx, *step)) else {
            continue;
        };
        for taken in taken_over_inputs(cx, cx.unit.steps[step].unit) {
            let key = (run.callee.span, taken.name.clone());
            if reported.contains(&key) {
                continue;
            }
            match value_sources(cx, &taken, before, run) {
                Ok(handed) => cx.unit.steps[step].taken_over.extend(handed),
                Err(diagnostic) => {
                    report::report_diagnostic(cx, *diagnostic);
                    reported.push(key);
                }
            }
        }
    }
}

/// Returns the sources of a value that the step `run` takes over from the steps before it, or the diagnostic for a
/// missing value.
fn value_sources<'a>(
    cx: &mut Body<'_, 'a>,
    taken: &TakenOverInput,
    before: &Predecessors<'a>,
    run: &Run,
) -> Result<Vec<TakenOverValue>, Box<Diagnostic>> {
    match before {
        Predecessors::None => Err(Box::new(
            missing_handover(taken, run).help(format!(
                "no command runs before `{0}`: declare `{1}` as a parameter instead, `command {0} ({1}: {2})`",
                run.callee.name.name, taken.name, taken.ty
            )),
        )),
        Predecessors::Run(before) => sources_from_all(cx, taken, &[before], run),
        Predecessors::Parallel(strands) => {
            let mut wrong = None;
            for ends in strands.iter().filter(|ends| !ends.is_empty()) {
                match sources_from_all(cx, taken, ends, run) {
                    Ok(handed) => return Ok(handed),
                    Err(diagnostic) => wrong = wrong.or(Some(diagnostic)),
                }
            }
            wrong.map_or(Ok(Vec::new()), Err)
        }
    }
}

/// Returns the sources of a value that each of the steps `before` must provide. Steps that run a task are skipped.
fn sources_from_all(
    cx: &mut Body<'_, '_>,
    taken: &TakenOverInput,
    before: &[&Run],
    run: &Run,
) -> Result<Vec<TakenOverValue>, Box<Diagnostic>> {
    let mut all = Vec::new();
    for before in before {
        if let Some(unit) = command_of(cx, before) {
            all.push(source_from(cx, taken, (unit, before.callee.span), run)?);
        }
    }
    Ok(all)
}

/// Returns the unit of the command that a step runs; `None` if the step runs a task, or if its arguments have not been
/// checked or have errors.
pub(super) fn command_of(cx: &Body<'_, '_>, run: &Run) -> Option<UnitId> {
    let step = task_step_of(cx, run).filter(|step| is_command_step(cx, *step))?;
    Some(cx.unit.steps[step].unit)
}

/// Returns the index of a step among the steps of the task's unit; `None` if its arguments have not been checked or
/// have errors.
fn task_step_of(cx: &Body<'_, '_>, run: &Run) -> Option<usize> {
    let mut steps = cx.unit.steps.iter();
    steps.position(|step| step.span == run.callee.span)
}

fn is_command_step(cx: &Body<'_, '_>, step: usize) -> bool {
    let decl = cx.checker.program.decl(cx.unit.steps[step].decl);
    matches!(decl.kind, DeclKind::Command(_))
}

fn taken_over_inputs(cx: &mut Body<'_, '_>, unit: UnitId) -> Vec<TakenOverInput> {
    units_on_demand::check_for_task(cx.checker, unit);
    let unit = &cx.checker.units[unit.0 as usize];
    let flows = unit.inputs.iter().map(|id| (*id, unit.flow(*id)));
    let given =
        flows.filter(|(_, flow)| flow.role == FlowRole::TakenOver && flow.default.is_none());
    given
        .map(|(id, flow)| TakenOverInput {
            flow: id,
            name: flow.name.clone(),
            ty: flow.ty.clone(),
            declared: flow.span,
        })
        .collect()
}

fn source_from(
    cx: &mut Body<'_, '_>,
    taken: &TakenOverInput,
    (before, span): (UnitId, Span),
    run: &Run,
) -> Result<TakenOverValue, Box<Diagnostic>> {
    let TakenOverInput { flow, name, ty, .. } = taken;
    units_on_demand::check_for_task(cx.checker, before);
    let unit = &cx.checker.units[before.0 as usize];
    debug_assert!(unit.kind == UnitKind::Command);
    let mut exports = unit.block(BlockId::ROOT).exports.iter().enumerate();
    let Some((index, export)) = exports.find(|(_, export)| export.key == name.as_str()) else {
        let help = format!(
            "define a flow `{name}: {ty}` in `{}` and add `export {name};`",
            unit.name
        );
        let diagnostic = missing_handover(taken, run)
            .secondary(span, format!("this runs before `{}`", run.callee.name.name));
        return Err(Box::new(diagnostic.help(help)));
    };
    let found = &unit.expr(export.value).ty;
    let [wanted, handed] = [ty, found].map(|ty| crate::ty::machine_types::external_type(ty).0);
    match check_assignable(&wanted, &handed, &mut Substitution::default()) {
        // Frames have the names of the parameters of each command, so they may differ.
        Ok(()) | Err(TypeMismatchError::Frame { .. }) => Ok(TakenOverValue {
            flow: *flow,
            predecessor: before,
            export: index,
            span,
        }),
        Err(_) => {
            let text = format!("this `{name}` is `{found}`, but `{ty}` is taken over");
            let help = format!(
                "export a value of the type `{ty}`, or take over `{name}: {found}` after `given`"
            );
            let mut diagnostic = missing_handover(taken, run).secondary(export.span, text);
            diagnostic.message = format!(
                "`{}` takes over `{name}` as `{ty}`, but its predecessor exports `{found}`",
                run.callee.name.name
            );
            if let Some(label) = diagnostic.labels.first_mut() {
                label.text = format!("`{name}` has another type here");
            }
            Err(Box::new(diagnostic.help(help)))
        }
    }
}

fn missing_handover(taken: &TakenOverInput, run: &Run) -> Diagnostic {
    let (name, command) = (&taken.name, &run.callee.name.name);
    Diagnostic::new(
        Code::RPI8004,
        format!("`{command}` takes over `{name}`, but no predecessor provides it"),
    )
    .primary(run.callee.span, format!("`{name}` has no value here"))
    .secondary(taken.declared, "taken over from the predecessor")
}
