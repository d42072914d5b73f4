//! Fix for commands that ignore a cancel request: a result for the motion that has stopped.

use rpi_diag::{Diagnostic, Fix};
use rpi_net::passes::is_cancel_ignored;
use rpi_sema::ty::Ty;
use rpi_sema::typed::{BlockId, Equation, TargetPlace, TypedKind, Unit, UnitId};
use rpi_syntax::ast::CommandEndKind;

/// Output of a motion of the library: it rests because of a cancel request.
const STOPPED: &str = "stopped";

/// Adds the fix to the warnings about a command whose body makes one motion that says when it has stopped.
pub(crate) fn add_fixes(units: &[Unit], unit: UnitId, found: &mut [Diagnostic]) {
    let command = &units[unit.0 as usize];
    for diagnostic in found.iter_mut().filter(|one| is_cancel_ignored(one)) {
        if let Some(fix) = stopping_motion(units, command).and_then(|name| fix(command, name)) {
            *diagnostic = diagnostic.clone().fix(fix);
        }
    }
}

/// Inserts a result for a motion that has stopped before another one: a `fail`, if there is one.
fn fix(command: &Unit, motion: &str) -> Option<Fix> {
    let ends = &command.block(BlockId::ROOT).ends;
    let fails = ends.iter().rfind(|end| end.kind == CommandEndKind::Fail);
    let next = fails.or(ends.last())?;
    let keyword = match next.kind {
        CommandEndKind::Fail => "fail  ",
        CommandEndKind::Finish => "finish",
        CommandEndKind::Yield => return None,
    };
    let title = "end the command when the motion has stopped";
    // The span is that of the name: the keyword before it becomes that of the new result.
    let text = format!("{STOPPED} when {motion}.{STOPPED};\n  {keyword} ");
    Some(Fix::maybe(title).insert_before(next.span, text))
}

/// Name of the only call in the body of a command with an output `stopped`, if the command has no flow of that name.
fn stopping_motion<'u>(units: &'u [Unit], command: &'u Unit) -> Option<&'u str> {
    if command.flows.iter().any(|flow| flow.name == *STOPPED) {
        return None;
    }
    let equations = &command.block(BlockId::ROOT).equations;
    let mut motions = equations
        .iter()
        .filter_map(|equation| motion(units, command, equation));
    let only = motions.next();
    only.filter(|_| motions.next().is_none())
}

fn motion<'u>(units: &[Unit], command: &'u Unit, equation: &Equation) -> Option<&'u str> {
    let TypedKind::Call(call) = &command.expr(equation.value).kind else {
        return None;
    };
    let [target] = &equation.targets[..] else {
        return None;
    };
    let TargetPlace::Flow { flow, .. } = target.place else {
        return None;
    };
    let callee = &units[call.unit.0 as usize];
    let mut outputs = callee.outputs.iter().map(|output| callee.flow(*output));
    let says = outputs.any(|output| output.name == *STOPPED && output.ty == Ty::Bool);
    (says && callee.outputs.len() > 1).then(|| command.flow(flow).name.as_str())
}
