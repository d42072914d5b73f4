//! Name the arguments: arguments by position get the names of the parameters.

use lsp_types::CodeActionKind;
use rpi_diag::FileId;
use rpi_sema::query::DefKind;
use rpi_syntax::ast::{Arg, Call, ExprKind, Ident, ItemKind, Step, StepKind, Visitor, Walker};

use super::code_context::CodeContext;
use super::{Refactoring, insertion};

/// Returns the refactoring that names the arguments of the innermost call or step around the selection.
pub(super) fn name_arguments(context: &CodeContext<'_>) -> Vec<Refactoring> {
    let (callee, args) = match innermost_call(context) {
        Some(call) => (&call.callee.name, &call.args),
        None => match innermost_step(context) {
            Some(found) => found,
            None => return Vec::new(),
        },
    };
    naming(context, callee, args).into_iter().collect()
}

fn innermost_call<'s>(context: &CodeContext<'s>) -> Option<&'s Call> {
    let around = context.expressions.iter().rev();
    let calls = around.filter_map(|expr| match &expr.kind {
        ExprKind::Call(call) if expr.span.contains(context.selection) => Some((expr.span, &**call)),
        _ => None,
    });
    let innermost = calls.min_by_key(|(span, _)| span.end - span.start);
    innermost.map(|(_, call)| call)
}

fn innermost_step<'s>(context: &CodeContext<'s>) -> Option<(&'s Ident, &'s Vec<Arg>)> {
    let item = context.item?;
    matches!(item.kind, ItemKind::Task(_)).then_some(())?;
    let mut steps = Steps(Vec::new());
    Walker::new(&mut steps).item(item);
    let mut around = steps
        .0
        .into_iter()
        .filter(|step| step.span.contains(context.selection));
    around.next_back().and_then(|step| match &step.kind {
        StepKind::Run(run) => Some((&run.callee.name, &run.args)),
        _ => None,
    })
}

struct Steps<'s>(Vec<&'s Step>);

impl<'s> Visitor<'s> for Steps<'s> {
    fn visits_expressions(&self) -> bool {
        false
    }

    fn visit_step(&mut self, step: &'s Step) {
        self.0.push(step);
    }
}

fn naming(context: &CodeContext<'_>, callee: &Ident, args: &[Arg]) -> Option<Refactoring> {
    let index = context.seen.index();
    let def = index.reference_at(FileId(0), callee.span.start)?.def;
    let parameters = index.parameters(def).into_iter().map(|id| index.def(id));
    let values =
        parameters.filter(|def| !matches!(def.kind, DefKind::StaticParam | DefKind::TakenOver));
    let values: Vec<_> = values.collect();
    let unnamed = args.iter().take_while(|arg| arg.name.is_none());
    let unnamed: Vec<&Arg> = unnamed.collect();
    // An argument of several values, as `f(g(x))` with two outputs of `g`, has no single name.
    let is_complete = args.len() == values.len() || unnamed.len() < args.len();
    (!unnamed.is_empty() && is_complete && unnamed.len() <= values.len()).then_some(())?;
    let names = unnamed.iter().zip(&values);
    let edits = names
        .map(|(arg, parameter)| insertion(arg.value.span.start, format!("{}: ", parameter.name)));
    let title = match unnamed.len() {
        1 => "name the argument",
        _ => "name the arguments",
    };
    Some(Refactoring::new(
        title,
        CodeActionKind::REFACTOR_REWRITE,
        edits.collect(),
    ))
}
