//! Fix for commands that ignore a cancel request: a result for the motion that has stopped.

use rpi_diag::{Diagnostic, Fix};
use rpi_net::passes::is_cancel_ignored;
use rpi_sema::ty::Ty;
use rpi_sema::typed::{BlockId, Equation, TargetPlace, TypedKind, Unit, UnitId};
use rpi_syntax::ast::CommandEndKind;
use std::rc::Rc;

/// Name of the Boolean output by which a motion of the standard library reports that it rests because of a cancel
/// request.
const STOPPED: &str = "stopped";

/// Adds a fix to the warnings about a command that ignores a cancel request: a result for the motion that has stopped.
/// Only commands that make motions with an output `stopped` get the fix.
pub(crate) fn add_fixes(units: &[Rc<Unit>], unit: UnitId, found: &mut [Diagnostic]) {
    let command = &units[unit.0 as usize];
    for diagnostic in found.iter_mut().filter(|one| is_cancel_ignored(one)) {
        if let Some(fix) = stopped_condition(units, command).and_then(|when| fix(command, &when)) {
            *diagnostic = diagnostic.clone().fix(fix);
        }
    }
}

/// Returns the fix that inserts the result `stopped` with this condition before another result of the command: a
/// `fail`, if there is one. Returns `None` if the command has no result, or the other one is a `yield`.
fn fix(command: &Unit, condition: &str) -> Option<Fix> {
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
    let text = format!("{STOPPED} when {condition};\n  {keyword} ");
    Some(Fix::maybe(title).insert_before(next.span, text))
}

/// Returns the condition under which one of the motions of a command has stopped, such as `way.stopped`. The output of
/// a motion in a fragment is absent while the fragment is inactive, and counts as false then. Returns `None` if there
/// is no motion, or if the command has a flow named `stopped`.
fn stopped_condition(units: &[Rc<Unit>], command: &Unit) -> Option<String> {
    if command.flows.iter().any(|flow| flow.name == *STOPPED) {
        return None;
    }
    let mut outputs: Vec<String> = Vec::new();
    for (index, block) in (0..).zip(&command.blocks) {
        let path = block_path(command, BlockId(index));
        let motions = block
            .equations
            .iter()
            .filter_map(|equation| motion(units, command, equation));
        outputs.extend(motions.map(|motion| match path.is_empty() {
            true => format!("{motion}.{STOPPED}"),
            false => format!("({path}{motion}.{STOPPED} ?? false)"),
        }));
    }
    match &outputs[..] {
        [] => None,
        [only] => Some(only.trim_matches(['(', ')']).to_owned()),
        several => Some(several.join(" or ")),
    }
}

/// Returns the names of the fragments and states around the equations of a block, each followed by a dot; an empty text
/// for the body of the command itself.
fn block_path(command: &Unit, block: BlockId) -> String {
    let mut path = String::new();
    let mut next = Some(block);
    while let Some(id) = next {
        let block = command.block(id);
        if !block.name.is_empty() {
            path.insert_str(0, &format!("{}.", block.name));
        }
        next = block.parent;
    }
    path
}

fn motion<'u>(units: &[Rc<Unit>], command: &'u Unit, equation: &Equation) -> Option<&'u str> {
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
