//! Suggestions for calls of names that cannot be called, such as `pow(x, 2.0)` or the name of a struct.

use crate::check::bodies::body::Body;
use crate::check::bodies::locals;
use crate::check::exprs::access::member_names;
use crate::check::exprs::expr;
use crate::check::exprs::names::plain_name;
use crate::check::types::type_decls;
use crate::program::{Lookup, NameSpace};
use crate::ty::{StructTy, Ty};
use crate::typed::ExprId;
use crate::typed::TypedKind;
use rpi_diag::{Code, Diagnostic, Fix, Quote, Span};
use rpi_syntax::Name;
use rpi_syntax::ast::{self, ExprKind};
use rpi_syntax::ops::BinaryOp;

/// Names of the power function in other languages, in lower case.
const POWER_NAMES: &[&str] = &["pow", "power", "powf", "powi", "expt"];

/// Adds a fix that writes `x ** 2.0` to the error reported about the undefined function in `pow(x, 2.0)`.
pub(crate) fn suggest_power_operator<'a>(cx: &mut Body<'_, 'a>, call: &'a ast::Call, span: Span) {
    let name = call.callee.name.name.to_lowercase();
    let (true, [base, exponent]) = (POWER_NAMES.contains(&name.as_str()), &call.args[..]) else {
        return;
    };
    let Some(diagnostic) = diagnostic_at(cx, call.callee.name.span, Code::RPI1001) else {
        return;
    };
    let (base, exponent) = (&base.value, &exponent.value);
    let [(open, close), (open_too, close_too)] = [base, exponent].map(parentheses_for);
    let sign = format!("{close} ** {open_too}");
    let meant = format!(
        "{} ** {}",
        Quote::operand(base.span),
        Quote::operand(exponent.span)
    );
    let fix = Fix::sure(format!("write `{meant}`"))
        .replace(
            span_between(span.start, base.span.start, span),
            format!("({open}"),
        )
        .replace(span_between(base.span.end, exponent.span.start, span), sign)
        .replace(
            span_between(exponent.span.end, span.end, span),
            format!("{close_too})"),
        );
    diagnostic.help.clear();
    diagnostic
        .help
        .push(format!("a power is written `{meant}`"));
    diagnostic.fixes = vec![fix];
}

/// Adds the syntax of a struct literal to the error reported about `P(x, y)` if `P` is a struct. Returns an expression
/// without a value, whose type is the struct.
pub(crate) fn suggest_struct_literal<'a>(
    cx: &mut Body<'_, 'a>,
    call: &'a ast::Call,
    span: Span,
) -> ExprId {
    let name = &call.callee.name;
    let Lookup::Found(id) = cx
        .checker
        .program
        .lookup_in(NameSpace::Type, cx.module, &name.name)
    else {
        return cx.error_expr(span);
    };
    let error = diagnostic_at(cx, name.span, Code::RPI1003);
    let Some(error) = error.map(|error| error.clone()) else {
        return cx.error_expr(span);
    };
    let Ty::Struct(ty) = type_decls::type_decl(cx.checker, id) else {
        return cx.error_expr(span);
    };
    let form = member_names(&ty.fields).map(|field| format!("{field} = ..."));
    let form = form.collect::<Vec<_>>().join("; ");
    let helped = error.help(format!(
        "write a value of this type as `{} {{{form}}}`",
        name.name
    ));
    let helped = match struct_literal_fix(&ty, call, span) {
        Some(fix) => helped.fix(fix),
        None => helped,
    };
    if let Some(diagnostic) = diagnostic_at(cx, name.span, Code::RPI1003) {
        *diagnostic = helped;
    }
    cx.add(TypedKind::Error, Ty::Struct(ty), span)
}

/// Reports a call such as `map(f, a)` of an iterator whose static arguments are missing or written among the arguments,
/// and returns an expression without a value.
pub(crate) fn iterator_without_statics<'a>(
    cx: &mut Body<'_, 'a>,
    name: &'static str,
    call: &'a ast::Call,
    span: Span,
) -> ExprId {
    let first = call.args.first().and_then(|arg| plain_name(&arg.value));
    let callee = first.filter(|name| is_callable_name(cx, name));
    let rest = &call.args[usize::from(callee.is_some())..];
    let given: Vec<ExprId> = rest
        .iter()
        .map(|arg| expr::check_expr(cx, &arg.value))
        .collect();
    let size = given.iter().find_map(|id| match cx.ty_of(*id) {
        Ty::Array(_, n) => Some(n.to_string()),
        _ => None,
    });
    let is_known = callee.is_some() && size.is_some();
    let callee = callee.map_or("node", Name::as_str);
    let size = size.unwrap_or_else(|| "size".to_owned());
    let form = match name {
        "boolred" => "<<least; most; size>>".to_owned(),
        _ => format!("<<{callee}, {size}>>"),
    };
    let message = format!("`{name}` lacks its static arguments");
    let diagnostic = Diagnostic::new(Code::RPI1010, message)
        .primary(call.callee.span, "static arguments expected after the name")
        .help(format!("write `{name}{form}(...)`"));
    let diagnostic = match &call.args[..] {
        [first, second, ..] if is_known => {
            let moved = span_between(first.value.span.start, second.value.span.start, span);
            let fix = Fix::sure(format!("write `{name}{form}`")).replace(moved, "");
            diagnostic.fix(fix.insert_after(call.callee.span, form))
        }
        _ => diagnostic,
    };
    cx.report_error_expr(diagnostic, span)
}

/// Whether a name refers to a declaration that can be called, and not to a local name.
fn is_callable_name(cx: &Body<'_, '_>, name: &Name) -> bool {
    let found = cx
        .checker
        .program
        .lookup_in(NameSpace::Callable, cx.module, name);
    let is_callee =
        |id| crate::check::signatures::unit::is_callable(cx.checker.program.decl(id).kind);
    locals::find_local(cx, name).is_none() && matches!(found, Lookup::Found(id) if is_callee(id))
}

/// Returns the latest diagnostic of the body with this code and this primary location; `None` if there is none.
pub(crate) fn diagnostic_at<'s>(
    cx: &'s mut Body<'_, '_>,
    span: Span,
    code: Code,
) -> Option<&'s mut Diagnostic> {
    let mut diagnostics = cx.diagnostics.iter_mut().rev();
    diagnostics.find(|diagnostic| diagnostic.code == code && diagnostic.span() == span)
}

/// Returns the opening and closing parentheses that an operand of `**` needs; empty texts for a name or a number.
fn parentheses_for(operand: &ast::Expr) -> (&'static str, &'static str) {
    match operand.kind {
        ExprKind::Name(_) | ExprKind::Number(_) => ("", ""),
        _ => ("(", ")"),
    }
}

/// Returns the span from `start` to `end` (byte offsets) in the file of the span `around`.
fn span_between(start: u32, end: u32, around: Span) -> Span {
    Span {
        start,
        end,
        ..around
    }
}

/// Returns the fix that turns a call into a struct literal; `None` if the arguments are not as many as the fields.
fn struct_literal_fix(ty: &StructTy, call: &ast::Call, span: Span) -> Option<Fix> {
    if call.args.is_empty() || call.args.len() != ty.fields.len() {
        return None;
    }
    // `P(x = 1)` parses as a comparison: the fields may be named already, so the fix is uncertain.
    let is_by_name =
        |arg: &ast::Arg| matches!(&arg.value.kind, ExprKind::Binary(of) if of.op == BinaryOp::Eq);
    let mut fix = match call.args.iter().any(is_by_name) {
        true => Fix::maybe("write the fields"),
        false => Fix::sure("write the fields"),
    };
    let mut from = call.callee.span.end;
    for (k, (arg, field)) in call.args.iter().zip(member_names(&ty.fields)).enumerate() {
        let name = arg.name.as_ref().map_or(field, |name| name.name.as_str());
        let opening = if k == 0 { " {" } else { "; " };
        let text = format!("{opening}{name} = ");
        fix = fix.replace(span_between(from, arg.value.span.start, span), text);
        from = arg.value.span.end;
    }
    Some(fix.replace(span_between(from, span.end, span), "}"))
}
