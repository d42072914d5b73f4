//! Diagnostics for arguments in another order than the ports, and for arguments without a port.

use crate::check::bodies::body::Body;
use crate::check::calls::args::CallArgument;
use crate::check::calls::args::signature_text;
use crate::check::calls::args::without_statics;
use crate::check::diagnostics::report;
use crate::check::diagnostics::report::{join_names, members_help};
use crate::check::signatures::header::Header;
use crate::check::signatures::static_args;
use crate::ty::Substitution;
use crate::ty::check_assignable;
use crate::typed::ExprId;
use crate::typed::TypedKind;
use rpi_diag::{Code, Diagnostic, Fix, Span};
use rpi_syntax::Name;
use rpi_syntax::ast::Ident;

/// Maximum number of mismatched arguments for which another order is tried.
const MAX_REORDERED: usize = 5;

/// Whether at least two arguments do not match their ports but would match in another order. The error is reported.
pub(crate) fn report_wrong_order(
    cx: &mut Body<'_, '_>,
    header: &Header,
    args: &[Option<ExprId>],
    subst: &Substitution,
) -> bool {
    let mut trial = subst.clone();
    let mut misfits = Vec::new();
    for (k, (port, arg)) in header.inputs.iter().zip(args).enumerate() {
        let Some(arg) = arg else { continue };
        let found = cx.ty_of(*arg).clone();
        if check_assignable(&port.ty, &found, &mut trial).is_err() {
            misfits.push(k);
        }
    }
    if !(2..=MAX_REORDERED).contains(&misfits.len()) {
        return false;
    }
    let Some(order) = matching_order(cx, header, args, &misfits, &trial) else {
        return false;
    };
    let diagnostic = wrong_order(cx, header, args, &misfits, &order);
    report::report_diagnostic(cx, diagnostic);
    true
}

/// Returns an order of the mismatched arguments in which each matches its port; `None` if no such order is found.
/// `misfits` are the indices of the mismatched ports. The result has one argument for each of them.
fn matching_order(
    cx: &Body<'_, '_>,
    header: &Header,
    args: &[Option<ExprId>],
    misfits: &[usize],
    subst: &Substitution,
) -> Option<Vec<ExprId>> {
    let mut order: Vec<ExprId> = Vec::new();
    let mut left: Vec<ExprId> = misfits.iter().filter_map(|k| args[*k]).collect();
    let mut trial = subst.clone();
    for k in misfits {
        let port = &header.inputs[*k];
        let fits = |arg: &ExprId| {
            let mut trial = trial.clone();
            check_assignable(&port.ty, cx.ty_of(*arg), &mut trial).is_ok()
        };
        // Greedy: an order that is not found this way leaves one error for each argument.
        let at = left.iter().position(fits)?;
        let arg = left.remove(at);
        check_assignable(&port.ty, &cx.ty_of(arg).clone(), &mut trial).ok()?;
        order.push(arg);
    }
    Some(order)
}

fn wrong_order(
    cx: &Body<'_, '_>,
    header: &Header,
    args: &[Option<ExprId>],
    misfits: &[usize],
    order: &[ExprId],
) -> Diagnostic {
    let names = misfits.iter().map(|k| header.inputs[*k].name.as_str());
    let message = format!(
        "arguments for {} of `{}` are in the wrong order",
        join_names(names),
        header.name
    );
    let mut diagnostic = Diagnostic::new(Code::RPI2001, message);
    let mut given: Vec<(usize, ExprId)> = Vec::new();
    given.extend(misfits.iter().filter_map(|k| Some((*k, args[*k]?))));
    given.sort_by_key(|(_, arg)| cx.span_of(*arg).start);
    for (at, (k, arg)) in given.iter().enumerate() {
        let text = format!("`{}`, found `{}`", header.inputs[*k].ty, cx.ty_of(*arg));
        let text = format!("`{}` expects {text}", header.inputs[*k].name);
        diagnostic = match at {
            0 => diagnostic.primary(cx.span_of(*arg), text),
            _ => diagnostic.secondary(cx.span_of(*arg), text),
        };
    }
    let diagnostic = diagnostic.help(format!("it is declared as `{}`", signature_text(header)));
    match reorder_fix(cx, args, misfits, order) {
        Some(fix) => diagnostic.fix(fix),
        None => diagnostic,
    }
}

/// Returns the fix that reorders the arguments; `None` unless all of them are plain names. `misfits` are the indices of
/// the mismatched ports, and `order` has the argument for each.
fn reorder_fix(
    cx: &Body<'_, '_>,
    args: &[Option<ExprId>],
    misfits: &[usize],
    order: &[ExprId],
) -> Option<Fix> {
    let mut fix = Fix::maybe("pass the arguments in the order of the ports");
    for (k, arg) in misfits.iter().zip(order) {
        plain_flow_name(cx, args[*k]?)?;
        let name = plain_flow_name(cx, *arg)?;
        fix = fix.replace(cx.span_of(args[*k]?), name);
    }
    Some(fix)
}

/// Returns the name of the flow that an expression reads; `None` if the expression is more than a name.
fn plain_flow_name(cx: &Body<'_, '_>, id: ExprId) -> Option<String> {
    let TypedKind::Flow(flow) = &cx.unit.expr(id).kind else {
        return None;
    };
    let name = cx.unit.flow(*flow).name.to_string();
    let span = cx.span_of(id);
    ((span.end - span.start) as usize == name.len()).then_some(name)
}

/// Returns the diagnostic for a named argument that matches no port or parameter. `of` is the callee, `names` are its
/// ports and parameters, and `given` are all arguments of the call.
pub(crate) fn unknown_arg(
    of: &Name,
    declared: Span,
    names: &[&Name],
    name: &Ident,
    given: &[CallArgument<'_>],
) -> Diagnostic {
    let is_given = |other: &Name| {
        given
            .iter()
            .any(|arg| arg.name.is_some_and(|n| n.name == *other))
    };
    let open = names.iter().filter(|other| !is_given(other));
    let near = rpi_diag::suggest(&name.name, open.map(|name| name.as_str()));
    let label = members_help("port or parameter", names.iter().map(|name| name.as_str()));
    let is_static = given
        .iter()
        .any(|arg| arg.is_static && arg.name.is_some_and(|given| given.span == name.span));
    if is_static {
        return static_args::unknown_static_param(of, name, near).secondary(declared, label);
    }
    let of = without_statics(of);
    let message = format!("`{of}` has no in-port or parameter `{}`", name.name);
    let diagnostic = Diagnostic::new(Code::RPI1001, message)
        .primary(name.span, "not declared")
        .secondary(declared, label);
    match near {
        Some(near) => diagnostic.did_you_mean(name.span, Some(near)),
        None => diagnostic.help("correct the name, or leave out the argument"),
    }
}
