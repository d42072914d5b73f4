//! Takeover: the successor of a command takes over the devices that the command may leave moving.

use crate::check::bodies::body::Body;
use crate::check::diagnostics::report;
use crate::check::diagnostics::report::listed;
use crate::check::exprs::names::ends_of;
use crate::check::exprs::names::plain_name;
use crate::check::signatures::unit;
use crate::check::task::Labels;
use crate::check::task::handover;
use crate::program::{DeclKind, Lookup};
use crate::ty::Ty;
use crate::typed::Place;
use rpi_diag::{Code, Finding};
use rpi_syntax::Name;
use rpi_syntax::ast::{
    self, Arg, Branch, CommandDecl, EndKind, Next, OnResult, Run, Statement, StatementKind,
};

/// Checks that the successors of a `yield` take over every device that may still be moving.
pub(super) fn check_successors<'a>(
    cx: &mut Body<'_, 'a>,
    command: &CommandDecl,
    run: &'a Run,
    next: &[&'a Run],
    labels: &Labels<'a>,
) {
    let moved = moved_params(cx, run);
    let moving = given_to(&moved.iter().collect::<Vec<_>>(), command, run);
    let yields = ends_of(command).into_iter();
    for end in yields.filter(|end| end.kind == EndKind::Yield) {
        let follows = target(run, &end.result.name, next, labels);
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

/// Returns the parameters of a command through which it writes values that can move a device.
fn moved_params(cx: &mut Body<'_, '_>, run: &Run) -> Vec<Name> {
    let Some(unit) = handover::command_of(cx, run) else {
        return Vec::new();
    };
    unit::check_unit_now(cx.checker, unit);
    let unit = &cx.checker.units[unit.0 as usize];
    let equations = unit.blocks.iter().flat_map(|block| &block.equations);
    let targets = equations.flat_map(|equation| &equation.targets);
    let moved = targets.filter_map(|target| match target.place {
        Place::Port { device, .. } if can_move(&target.ty) => Some(device),
        _ => None,
    });
    moved.map(|flow| unit.flow(flow).name.clone()).collect()
}

/// Returns the devices that these steps drive together; `None` if one of them does not run a command.
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
        taken.extend(given_to(&driven(successor), successor, run));
    }
    Some(taken)
}

/// Whether a port of this type may be the set-point of a motion. Booleans, integers and enum values switch at once.
fn can_move(ty: &Ty) -> bool {
    match ty {
        Ty::Bool | Ty::Int | Ty::Subrange(_) | Ty::Enum(_) => false,
        Ty::Array(element, _) => can_move(element),
        Ty::Struct(_) | Ty::Tuple(_) => ty.members().iter().any(|member| can_move(&member.ty)),
        _ => true,
    }
}

/// Returns the steps that follow a result; several if parallel branches begin.
fn target<'a>(run: &'a Run, result: &Name, next: &[&'a Run], labels: &Labels<'a>) -> Vec<&'a Run> {
    let named = |on: &OnResult| matches!(on, OnResult::Named(name) if name.name == *result);
    let any = |on: &OnResult| matches!(on, OnResult::Any(_));
    let branch = |is: &dyn Fn(&OnResult) -> bool| -> Option<&'a Branch> {
        run.branches.iter().find(|branch| branch.on.iter().any(is))
    };
    match branch(&named).or_else(|| branch(&any)) {
        Some(branch) => match &branch.then {
            Next::Step(label) => {
                let found = labels
                    .iter()
                    .rev()
                    .find(|(known, _)| known.name == label.name);
                found.map(|(_, run)| *run).into_iter().collect()
            }
            Next::End(_) => Vec::new(),
        },
        None if run.branches.is_empty() => next.to_vec(),
        None => Vec::new(),
    }
}

/// Returns the parameters of a command through which it writes to devices.
pub(super) fn driven(command: &CommandDecl) -> Vec<&Name> {
    let mut written = Vec::new();
    targets(&command.body.statements, &mut written);
    let params = command.params.iter().flat_map(|param| &param.names);
    params
        .map(|param| &param.name)
        .filter(|param| written.contains(param))
        .collect()
}

/// Collects the names of which statements define a part, also in fragments and states.
fn targets<'s>(statements: &'s [Statement], written: &mut Vec<&'s Name>) {
    for statement in statements {
        match &statement.kind {
            StatementKind::Equation(equation) => {
                let parts = equation.targets.iter().filter(|t| !t.path.is_empty());
                written.extend(parts.map(|target| &target.name.name));
            }
            StatementKind::Fragment(fragment) => targets(&fragment.body.statements, written),
            StatementKind::Automaton(automaton) => {
                let states = automaton.states.iter();
                states.for_each(|state| targets(&state.body.statements, written));
            }
            _ => {}
        }
    }
}

/// Returns the names that a step passes for these parameters; arguments that are not plain names are skipped.
fn given_to<'r>(params: &[&Name], command: &CommandDecl, run: &'r Run) -> Vec<&'r str> {
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

fn not_taken_over(command: &CommandDecl, end: &ast::End, follows: &Run, left: &[&str]) -> Finding {
    let (successor, devices) = (&follows.callee.name, listed(left.iter().copied()));
    let message = format!(
        "`{}` does not take over {devices} from `{}`",
        successor.name, command.name.name
    );
    Finding::new(Code::RPI6201, message)
        .at(successor.span, format!("it does not drive {devices}"))
        .also(end.result.span, format!("here {devices} may still be moving"))
        .help("the command ignores this `yield` and continues until it is at rest; drive the device in the successor, or branch on another result")
}
