//! The selection of a refactoring in the syntax tree: its statement, the body around it, its expression.

use rpi_diag::{FileId, Span};
use rpi_driver::Inspection;
use rpi_syntax::ast::{Expr, ExprKind, Item, Statement, StatementKind, Visitor, Walker};
use rpi_syntax::ops::BinaryOp;

/// Selection in a program, with the constructs around it.
pub(super) struct CodeContext<'s> {
    pub(super) seen: &'s Inspection,
    pub(super) text: &'s str,
    /// Selected range without white space at its ends.
    pub(super) selection: Span,
    /// Declaration at the top level that contains the selection.
    pub(super) item: Option<&'s Item>,
    /// Innermost statement that contains the selection.
    pub(super) statement: Option<&'s Statement>,
    /// All statements of the declaration, each before the statements in it.
    pub(super) statements: Vec<&'s Statement>,
    /// Expressions of the declaration that are evaluated at run time, each before its subexpressions.
    pub(super) expressions: Vec<&'s Expr>,
}

impl<'s> CodeContext<'s> {
    pub(super) fn new(seen: &'s Inspection, selection: Span) -> CodeContext<'s> {
        let text = seen.sources.text(FileId(0));
        let selection = trimmed(text, selection);
        let is_around = |span: Span| span.contains(selection);
        let mut items = seen.own_items();
        let item = items.find(|item| is_around(item.span));
        let mut parts = Parts::default();
        if let Some(item) = item {
            Walker::new(&mut parts).item(item);
        }
        let around = parts.statements.iter().rev();
        let mut around = around.filter(|statement| is_around(statement.span));
        CodeContext {
            seen,
            text,
            selection,
            item,
            statement: around.next().copied(),
            statements: parts.statements,
            expressions: parts.expressions,
        }
    }

    /// Returns the text of a range.
    pub(super) fn slice(&self, span: Span) -> &'s str {
        self.seen.sources.slice(span)
    }

    /// Returns the outermost expression with exactly the selected range.
    pub(super) fn selected_expression(&self) -> Option<&'s Expr> {
        let mut all = self.expressions.iter();
        all.find(|expr| expr.span == self.selection).copied()
    }

    /// Returns the offset of the start of the line that contains a byte offset, and the white space at its start.
    pub(super) fn line_start(&self, offset: u32) -> (u32, &'s str) {
        let before = &self.text[..offset as usize];
        let start = before.rfind('\n').map_or(0, |at| at + 1);
        let line = &self.text[start..];
        let indent = line.len() - line.trim_start_matches([' ', '\t']).len();
        let at = u32::try_from(start).unwrap_or(u32::MAX);
        (at, &line[..indent])
    }

    /// Returns the range of a statement with the lines that it fills: its doc comment is not included.
    pub(super) fn whole_lines(&self, span: Span) -> Span {
        let (start, indent) = self.line_start(span.start);
        let rest = &self.text[span.end as usize..];
        let line = rest.find('\n').map_or(rest.len(), |at| at + 1);
        let begins = span.start as usize == start as usize + indent.len();
        match begins && rest[..line].trim().is_empty() {
            true => {
                let end = span.end + u32::try_from(line).unwrap_or(0);
                Span::new(span.file, start, end)
            }
            false => {
                // The space to the next statement in the same line.
                let gap = rest.len() - rest.trim_start_matches(' ').len();
                Span::new(
                    span.file,
                    span.start,
                    span.end + u32::try_from(gap).unwrap_or(0),
                )
            }
        }
    }

    /// Returns a name that is undefined at the selection: `base`, or `base` with a number.
    pub(super) fn free_name(&self, base: &str) -> String {
        let is_free = |name: &String| {
            let index = self.seen.index();
            let known = index.resolve(FileId(0), self.selection.start, name);
            // A declaration further inside could hide the name, and another one could be hidden by it.
            known.is_none() && !self.text.contains(name.as_str())
        };
        let numbered = (2..).map(|n| format!("{base}_{n}"));
        let mut names = std::iter::once(base.to_owned()).chain(numbered);
        names.find(is_free).unwrap_or_default()
    }
}

/// Returns a range without white space at its ends.
fn trimmed(text: &str, span: Span) -> Span {
    let Some(selected) = text.get(span.start as usize..span.end as usize) else {
        return span;
    };
    let start = selected.len() - selected.trim_start().len();
    let length = |n: usize| u32::try_from(n).unwrap_or(0);
    let selected = selected.trim();
    let start = span.start
        + if selected.is_empty() {
            0
        } else {
            length(start)
        };
    Span::new(span.file, start, start + length(selected.len()))
}

/// Collector of the statements and expressions of a declaration.
#[derive(Default)]
struct Parts<'s> {
    statements: Vec<&'s Statement>,
    expressions: Vec<&'s Expr>,
}

impl<'s> Visitor<'s> for Parts<'s> {
    fn visit_statement(&mut self, statement: &'s Statement) {
        self.statements.push(statement);
    }

    fn visit_flow(&mut self, expr: &'s Expr) {
        self.expressions.push(expr);
    }
}

/// Returns whether an expression is computed from the flows of the same cycle and cannot fault, so that it has the same
/// value wherever and however often it is evaluated.
pub(super) fn is_total(expr: &Expr) -> bool {
    use BinaryOp::{Add, And, Coalesce, Eq, Ge, Gt, Implies, Le, Lt, Mul, Ne, Or, Sub, Xor};
    let is_plain = match &expr.kind {
        ExprKind::Bool(_) | ExprKind::Number(_) | ExprKind::Quantity(_) | ExprKind::Name(_) => true,
        ExprKind::Field(_) | ExprKind::Paren(_) | ExprKind::If(_) => true,
        ExprKind::Unary(op, _) => {
            matches!(
                op,
                rpi_syntax::ops::UnaryOp::Neg | rpi_syntax::ops::UnaryOp::Not
            )
        }
        ExprKind::Binary(of) => matches!(
            of.op,
            Add | Sub | Mul | And | Or | Xor | Implies | Coalesce | Eq | Ne | Lt | Le | Gt | Ge
        ),
        _ => false,
    };
    is_plain && expr.children().into_iter().all(is_total)
}

/// Returns whether an expression is evaluated in every cycle in which the outer expression `root` is, and not only in
/// some of them: it is in no branch of a choice and not behind a delay or a clock.
pub(super) fn is_always_evaluated(root: &Expr, inner: &Expr) -> bool {
    if root.span == inner.span {
        return true;
    }
    let lazy = match &root.kind {
        ExprKind::If(of) => vec![&of.then_value, &of.else_value],
        ExprKind::Binary(of) => match of.op {
            BinaryOp::Arrow | BinaryOp::Fby => vec![&of.lhs, &of.rhs],
            BinaryOp::And | BinaryOp::Or | BinaryOp::Implies | BinaryOp::Coalesce => {
                vec![&of.rhs]
            }
            _ => Vec::new(),
        },
        ExprKind::When(_) | ExprKind::Merge(_) | ExprKind::Match(_) | ExprKind::Quantified(_) => {
            return false;
        }
        _ => Vec::new(),
    };
    if lazy.iter().any(|branch| branch.span.contains(inner.span)) {
        return false;
    }
    let mut inside = root.children().into_iter();
    inside.any(|child| child.span.contains(inner.span) && is_always_evaluated(child, inner))
}

/// Returns the expressions that a statement evaluates itself, without those of statements in it.
pub(super) fn own_expressions(statement: &Statement) -> Vec<&Expr> {
    match &statement.kind {
        StatementKind::Equation(equation) => vec![&equation.value],
        StatementKind::Call(call) => vec![call],
        StatementKind::Claim(claim) => vec![&claim.condition],
        StatementKind::CommandEnd(end) => vec![&end.condition],
        StatementKind::Fragment(fragment) => {
            fragment.when.iter().map(|when| &when.condition).collect()
        }
        _ => Vec::new(),
    }
}
