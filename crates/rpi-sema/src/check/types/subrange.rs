//! Subrange types of `int`, and constants of these types.

use crate::check::bodies::body::Body;
use crate::check::bodies::locals;
use crate::check::bodies::statement;
use crate::check::diagnostics::report;
use crate::check::diagnostics::report::ExpectationReason;
use crate::check::exprs::expr;
use crate::check::types::consts;
use crate::program::{DeclKind, Lookup};
use crate::ty::subrange::outside_subrange;
use crate::ty::{Subrange, Ty};
use crate::typed::Leaf;
use crate::typed::predeclared::PREDECLARED_FLOWS;
use rpi_diag::{Code, Diagnostic, Span};
use rpi_syntax::Name;
use rpi_syntax::ast::{self, ExprKind};

/// Returns a subrange type such as `subrange [0, 7] of int`. Reports an error in the bounds and returns the type `int`.
pub(crate) fn subrange_type<'a>(cx: &mut Body<'_, 'a>, range: &'a ast::Subrange, span: Span) -> Ty {
    let [from, to] = [&range.lower, &range.upper].map(|bound| subrange_bound(cx, bound.as_ref()));
    let (Some(from), Some(to)) = (from, to) else {
        // The error has been reported.
        return Ty::Int;
    };
    let range = Subrange { from, to };
    if range.is_empty() {
        let message = format!("empty subrange {range}");
        let diagnostic = Diagnostic::new(Code::RPI2018, message)
            .primary(span, "the lower bound is greater than the upper bound")
            .help("write the smaller bound first");
        report::report_diagnostic(cx, diagnostic);
        return Ty::Int;
    }
    Ty::Subrange(range)
}

/// Whether a name has no meaning in the body or in the program.
fn is_undefined(cx: &Body<'_, '_>, name: &Name) -> bool {
    let is_predeclared = matches!(name.as_str(), "true" | "false" | "none")
        || PREDECLARED_FLOWS.iter().any(|flow| *name == flow.name);
    !is_predeclared
        && locals::find_local(cx, name).is_none()
        && cx.statics.get(name).is_none()
        && matches!(cx.checker.program.lookup(cx.module, name), Lookup::Missing)
}

/// Returns the value of a bound of a subrange; `Some(None)` if there is no bound (`*`), and `None` after an error.
fn subrange_bound<'a>(cx: &mut Body<'_, 'a>, bound: Option<&'a ast::Expr>) -> Option<Option<i64>> {
    let Some(bound) = bound else {
        return Some(None);
    };
    if let ExprKind::Name(name) = &bound.kind
        && is_undefined(cx, name)
    {
        let constants = |id| matches!(cx.checker.program.decl(id).kind, DeclKind::Const(_));
        let names = cx.checker.program.visible_names(cx.module, constants);
        let near = cx.checker.suggest(name, names);
        let diagnostic = report::undefined_name("constant", name, bound.span, near);
        let help = format!("declare it: `const {name}: int = ...;`");
        report::report_diagnostic(cx, diagnostic.help(help));
        return None;
    }
    let id = expr::check_expr(cx, bound);
    if !statement::expect_type(cx, id, &Ty::Int, &ExpectationReason::Unexplained) {
        return None;
    }
    let leaves = consts::fold(cx, id)?;
    let value = leaves.first().and_then(Leaf::as_int);
    value.map(Some)
}

/// Whether the leaves (scalar parts) of a constant are in the subranges of its type. Reports the first leaf that is
/// not.
pub(crate) fn is_in_subranges(cx: &mut Body<'_, '_>, leaves: &[Leaf], ty: &Ty, span: Span) -> bool {
    let out = ty.subranges(false).into_iter().find_map(|(leaf, range)| {
        let value = leaves.get(leaf)?.as_int()?;
        (!range.contains(value)).then_some((value, range))
    });
    if let Some((value, range)) = out {
        report::report_diagnostic(
            cx,
            outside_subrange(value, range).primary(span, "this constant"),
        );
    }
    out.is_none()
}
