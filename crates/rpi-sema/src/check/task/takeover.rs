//! Takeover: the successor of a command takes over the devices that the command may leave moving.

use crate::check::bodies::body::Body;
use crate::check::diagnostics::report;
use crate::check::diagnostics::report::join_names;
use crate::check::exprs::names::end_statements;
use crate::check::exprs::names::plain_name;
use crate::check::signatures::units_on_demand;
use crate::check::task::Labels;
use crate::check::task::handover;
use crate::program::{DeclKind, Lookup};
use crate::ty::Ty;
use crate::typed::TargetPlace;
use rpi_diag::{Code, Diagnostic};
use rpi_syntax::Name;
use rpi_syntax::ast::{
    self, Arg, Branch, CommandDecl, CommandEndKind, NextStep, ResultPattern, Run, Statement,
    StatementKind,
};

/// Checks that, after each `yield` of a step's command, the next steps drive every device that may still be moving.
/// `next` are the steps that follow without a branch.
pub(super) fn check_successors<'a>(
    cx: &mut Body<'_, 'a>,
    command: &CommandDecl,
    run: &'a Run,
    next: &[&'a Run],
    labels: &Labels<'a>,
) {
    let moved = moved_params(cx, run);
    let moving = check_args_for(&moved.iter().collect::<Vec<_>>(), command, run);
    let yields = end_statements(command).into_iter();
    for end in yields.filter(|end| end.kind == CommandEndKind::Yield) {
        let follows = check_target(run, &end.result.name, next, labels);
        let Some(first) = follows.first() else {
            continue;
        };
        // The first steps of an inner task are not examined.
        let Some(taken) = devices_taken_by(cx, &follows) else {
            continue;
        };
        let left: Vec<&str> = moving
            .iter()
            .copied()
            .filter(|d| !taken.contains(d))
            .collect();
        if !left.is_empty() {
            report::report_diagnostic(cx, not_taken_over(command, end, first, &left));
        }
    }
}

/// Returns the parameters of the command that a step runs through which it writes set-points that can move a device.
fn moved_params(cx: &mut Body<'_, '_>, run: &Run) -> Vec<Name> {
    let Some(unit) = handover::command_of(cx, run) else {
        return Vec::new();
    };
    units_on_demand::check_for_task(cx.checker, unit);
    let unit = &cx.checker.units[unit.0 as usize];
    let equations = unit.blocks.iter().flat_map(|block| &block.equations);
    let targets = equations.flat_map(|equation| &equation.targets);
    let moved = targets.filter_map(|target| match target.place {
        TargetPlace::Port { device, .. } if is_motion_type(&target.ty) => Some(device),
        _ => None,
    });
    moved.map(|flow| unit.flow(flow).name.clone()).collect()
}

/// Returns the names of the devices that these steps drive together; `None` if one of the steps does not run a command.
fn devices_taken_by<'r>(cx: &Body<'_, '_>, runs: &[&'r Run]) -> Option<Vec<&'r str>> {
    let mut taken = Vec::new();
    for run in runs {
        let name = &run.callee.name.name;
        let Lookup::Found(id) = cx.checker.program.lookup(cx.module, name) else {
            return None;
        };
        let DeclKind::Command(successor) = cx.checker.program.decl(id).kind else {
            return None;
        };
        taken.extend(check_args_for(&driven_params(successor), successor, run));
    }
    Some(taken)
}

/// Whether a set-point of this type can move a device. Outputs that are Booleans, integers or enum values switch at
/// once.
fn is_motion_type(ty: &Ty) -> bool {
    match ty {
        Ty::Bool | Ty::Int | Ty::Subrange(_) | Ty::Enum(_) => false,
        Ty::Array(element, _) => is_motion_type(element),
        Ty::Struct(_) | Ty::Tuple(_) => {
            ty.members().iter().any(|member| is_motion_type(&member.ty))
        }
        _ => true,
    }
}

/// Returns the steps that run after the result `result` of the step's command; several if parallel branches begin, none
/// if the task ends. `next` are the steps that follow without a branch.
fn check_target<'a>(
    run: &'a Run,
    result: &Name,
    next: &[&'a Run],
    labels: &Labels<'a>,
) -> Vec<&'a Run> {
    let named =
        |on: &ResultPattern| matches!(on, ResultPattern::Named(name) if name.name == *result);
    let any = |on: &ResultPattern| matches!(on, ResultPattern::Any(_));
    let branch = |is: &dyn Fn(&ResultPattern) -> bool| -> Option<&'a Branch> {
        run.branches
            .iter()
            .find(|branch| branch.results.iter().any(is))
    };
    match branch(&named).or_else(|| branch(&any)) {
        Some(branch) => match &branch.next {
            NextStep::Step(label) => {
                let found = labels
                    .iter()
                    .rev()
                    .find(|(known, _)| known.name == label.name);
                found.map(|(_, run)| *run).into_iter().collect()
            }
            NextStep::End(_) => Vec::new(),
        },
        None if run.branches.is_empty() => next.to_vec(),
        None => Vec::new(),
    }
}

/// Returns the parameters of a command through which it writes set-points to devices.
pub(super) fn driven_params(command: &CommandDecl) -> Vec<&Name> {
    let mut written = Vec::new();
    written_names(&command.body.statements, &mut written);
    let params = command.params.iter().flat_map(|param| &param.names);
    params
        .map(|param| &param.name)
        .filter(|param| written.contains(param))
        .collect()
}

/// Appends to `written` the names on the left sides of equations of which a part is defined, as in `arm.tcp = ...`,
/// also inside of fragments and states.
fn written_names<'s>(statements: &'s [Statement], written: &mut Vec<&'s Name>) {
    for statement in statements {
        match &statement.kind {
            StatementKind::Equation(equation) => {
                let parts = equation.targets.iter().filter(|t| !t.path.is_empty());
                written.extend(parts.map(|target| &target.name.name));
            }
            StatementKind::Fragment(fragment) => written_names(&fragment.body.statements, written),
            StatementKind::Automaton(automaton) => {
                let states = automaton.states.iter();
                states.for_each(|state| written_names(&state.body.statements, written));
            }
            _ => {}
        }
    }
}

/// Returns the names of the devices that a step passes for the parameters `params` of its command. Arguments that are
/// not plain names are skipped.
fn check_args_for<'r>(params: &[&Name], command: &CommandDecl, run: &'r Run) -> Vec<&'r str> {
    let names: Vec<&Name> = command
        .params
        .iter()
        .flat_map(|param| &param.names)
        .map(|name| &name.name)
        .collect();
    let of = |(k, arg): (usize, &'r Arg)| {
        let param = match &arg.name {
            Some(name) => Some(&name.name),
            None => names.get(k).copied(),
        };
        let value = plain_name(&arg.value)?;
        params.contains(&param?).then_some(value.as_str())
    };
    run.args.iter().enumerate().filter_map(of).collect()
}

fn not_taken_over(
    command: &CommandDecl,
    end: &ast::CommandEnd,
    follows: &Run,
    left: &[&str],
) -> Diagnostic {
    let (successor, devices) = (&follows.callee.name, join_names(left.iter().copied()));
    let message = format!(
        "`{}` does not take over {devices} from `{}`",
        successor.name, command.name.name
    );
    Diagnostic::new(Code::RPI6201, message)
        .primary(successor.span, format!("`{}` does not drive {devices}", successor.name))
        .secondary(end.result.span, format!("here {devices} may still be moving"))
        .help(format!(
            "`{}` ignores this `yield` and continues until it is at rest: drive {devices} in `{}` as well, or run a command without a `yield` before it",
            command.name.name, successor.name
        ))
}
