//! Extract flow: a selected expression becomes a flow of its own.

use lsp_types::CodeActionKind;
use rpi_syntax::Dialect;
use rpi_syntax::ast::ExprKind;

use super::code_context::{CodeContext, is_always_evaluated, is_total, own_expressions};
use super::{Refactoring, edit, insertion};

/// Returns the refactoring that defines a flow by the selected expression, before the statement, and reads the flow
/// instead. The expression must be evaluated in the same cycles as the statement, or be total.
pub(super) fn extract_flow(context: &CodeContext<'_>) -> Vec<Refactoring> {
    extraction(context).into_iter().collect()
}

fn extraction(context: &CodeContext<'_>) -> Option<Refactoring> {
    // Flows of Lustre need a declaration.
    (context.seen.mode() == Dialect::Rpi).then_some(())?;
    let expr = context.selected_expression()?;
    if matches!(expr.unparen().kind, ExprKind::Name(_) | ExprKind::Str(_)) {
        return None;
    }
    let statement = context.statement?;
    let roots = own_expressions(statement);
    let root = roots
        .into_iter()
        .find(|root| root.span.contains(expr.span))?;
    let is_same = is_total(expr) || is_always_evaluated(root, expr);
    is_same.then_some(())?;
    let name = context.free_name("value");
    let (start, indent) = context.line_start(statement.span.start);
    let begins = statement.span.start as usize == start as usize + indent.len();
    let value = context.slice(expr.unparen().span);
    let definition = match begins {
        true => format!("{indent}{name} = {value};\n"),
        false => format!("{name} = {value}; "),
    };
    let at = if begins { start } else { statement.span.start };
    Some(Refactoring::new(
        "extract flow",
        CodeActionKind::REFACTOR_EXTRACT,
        vec![insertion(at, definition), edit(expr.span, name)],
    ))
}
