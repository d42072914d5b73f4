//! Inline flow: the uses of a flow are replaced by the expression that defines it.

use lsp_types::CodeActionKind;
use rpi_diag::{FileId, Span};
use rpi_sema::query::{DefId, DefKind};
use rpi_syntax::ast::{Equation, Expr, ExprKind, Statement, StatementKind};
use rpi_syntax::ops::UnaryOp;

use super::code_context::{CodeContext, is_always_evaluated, is_total, own_expressions};
use super::{Refactoring, edit};

/// Returns the refactoring that replaces every use of the flow at the selection by its definition, and removes the
/// definition. An expression that is not total may have one use only, which must be evaluated in the same cycles.
pub(super) fn inline_flow(context: &CodeContext<'_>) -> Vec<Refactoring> {
    inlining(context).into_iter().collect()
}

fn inlining(context: &CodeContext<'_>) -> Option<Refactoring> {
    let index = context.seen.index();
    let name = index.reference_at(FileId(0), context.selection.start)?;
    let def = index.def(name.def);
    let is_inferred = def.kind == DefKind::Local && def.ty.is_none();
    (is_inferred && def.span.file == FileId(0) && def.doc.is_none()).then_some(())?;
    let (statement, equation) = definition(context, def.span)?;
    let uses: Vec<Span> = index
        .references(name.def)
        .filter(|span| *span != def.span)
        .collect();
    let reads: Vec<&Expr> = uses
        .iter()
        .filter_map(|span| read_at(context, *span))
        .collect();
    // An export, a use from outside of a fragment, or a second equation is not a plain read.
    (!reads.is_empty() && reads.len() == uses.len()).then_some(())?;
    reads
        .iter()
        .all(|read| keeps_names(context, &equation.value, read))
        .then_some(())?;
    let value = &equation.value;
    let is_same = is_total(value) && value_reads_no_state(context, name.def)
        || reads.len() == 1 && is_evaluated_together(context, statement, reads[0]);
    is_same.then_some(())?;
    let text = replacement(context, value);
    let mut edits: Vec<_> = reads
        .iter()
        .map(|read| edit(read.span, text.clone()))
        .collect();
    edits.push(edit(context.whole_lines(statement.span), ""));
    Some(Refactoring::new(
        format!("inline flow `{}`", def.name),
        CodeActionKind::REFACTOR_INLINE,
        edits,
    ))
}

/// Returns the only equation that defines a flow, if it defines nothing else.
fn definition<'s>(context: &CodeContext<'s>, name: Span) -> Option<(&'s Statement, &'s Equation)> {
    let equation = |statement: &&'s Statement| match &statement.kind {
        StatementKind::Equation(equation) => match &equation.targets[..] {
            [target] if target.path.is_empty() && target.name.span == name => {
                Some((*statement, &**equation))
            }
            _ => None,
        },
        _ => None,
    };
    context.statements.iter().find_map(equation)
}

/// Returns the expression that is just the name at a place.
fn read_at<'s>(context: &CodeContext<'s>, name: Span) -> Option<&'s Expr> {
    let is_name = |expr: &&&Expr| expr.span == name && matches!(expr.kind, ExprKind::Name(_));
    context.expressions.iter().find(is_name).copied()
}

/// Returns whether every name of an expression refers to the same declaration at another place.
fn keeps_names(context: &CodeContext<'_>, value: &Expr, read: &Expr) -> bool {
    let index = context.seen.index();
    let mut names = index.references_in(value.span).iter();
    names.all(|name| {
        let text = context.slice(name.span);
        let at = |place: &Expr| index.resolve(FileId(0), place.span.start, text);
        at(value) == at(read)
    })
}

/// Returns whether no use of a flow reads its value of an earlier cycle in any state (`last x`), which needs a name.
fn value_reads_no_state(context: &CodeContext<'_>, def: DefId) -> bool {
    let index = context.seen.index();
    let is_read = |operand: &Expr| {
        let name = index.reference_at(FileId(0), operand.span.start);
        name.is_some_and(|name| name.def == def && name.span == operand.span)
    };
    let mut all = context.expressions.iter();
    !all.any(|expr| match &expr.kind {
        ExprKind::Unary(UnaryOp::Last, operand) => is_read(operand),
        _ => false,
    })
}

/// Returns whether a read is evaluated exactly when the definition in `statement` is: in a statement of the same body,
/// and in no branch of a choice.
fn is_evaluated_together(context: &CodeContext<'_>, statement: &Statement, read: &Expr) -> bool {
    let around = |inner: Span| {
        let all = context.statements.iter().rev();
        let mut all = all.filter(move |one| one.span.contains(inner) && one.span != inner);
        all.next().map(|one| one.span)
    };
    let user = context
        .statements
        .iter()
        .rev()
        .find(|one| one.span.contains(read.span));
    let Some(user) = user else { return false };
    let roots = own_expressions(user);
    let root = roots.into_iter().find(|root| root.span.contains(read.span));
    // The condition of a fragment is evaluated in the body around it.
    around(user.span) == around(statement.span)
        && root.is_some_and(|root| is_always_evaluated(root, read))
}

/// Returns the text of an expression, in parentheses unless it is a single operand.
fn replacement(context: &CodeContext<'_>, value: &Expr) -> String {
    let text = context.slice(value.span);
    let is_operand = matches!(
        value.kind,
        ExprKind::Bool(_)
            | ExprKind::Number(_)
            | ExprKind::Quantity(_)
            | ExprKind::Name(_)
            | ExprKind::Field(_)
            | ExprKind::Index(_)
            | ExprKind::Call(_)
            | ExprKind::Paren(_)
            | ExprKind::Array(_)
            | ExprKind::Struct(_)
    );
    match is_operand {
        true => text.to_owned(),
        false => format!("({text})"),
    }
}
