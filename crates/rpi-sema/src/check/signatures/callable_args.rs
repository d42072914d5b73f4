//! Callables that are passed as static arguments, and the ports that their parameters require.

use crate::check::bodies::body::Body;
use crate::check::calls::callable::Callable;
use crate::check::calls::callee;
use crate::check::diagnostics::report;
use crate::check::signatures::alias;
use crate::check::signatures::static_args::StaticBindings;
use crate::check::signatures::static_params;
use crate::program::DeclId;
use crate::ty::Substitution;
use crate::ty::check_assignable;
use rpi_diag::{Code, Diagnostic, Span};
use rpi_syntax::ast::{Expr, ExprKind, Signature, StaticArg, StaticValue};

pub(crate) fn static_callable<'a>(cx: &mut Body<'_, 'a>, arg: &'a StaticArg) -> Option<Callable> {
    match &arg.value {
        StaticValue::Op(op) => Some(Callable::Op(*op)),
        StaticValue::Callee(callee) => {
            callee::resolve_callable(cx, &callee.name.name, &callee.statics, callee.span)
        }
        StaticValue::Expr(Expr {
            kind: ExprKind::Name(name),
            span,
        }) => callee::resolve_callable(cx, name, &[], *span),
        _ => {
            let diagnostic = Diagnostic::new(Code::RPI1010, "a node is expected here")
                .primary(arg.span, "not a node");
            report::report_diagnostic(cx, diagnostic);
            None
        }
    }
}

/// Returns the diagnostic for a callable whose ports differ from those that `signature`, a static parameter of
/// declaration `id`, requires; `None` if the ports match, or as far as they are not known.
pub(crate) fn port_mismatch<'a>(
    cx: &mut Body<'_, 'a>,
    id: DeclId,
    statics: &StaticBindings,
    signature: &'a Signature,
    callable: &Callable,
    span: Span,
) -> Option<Diagnostic> {
    let ports = alias::callable_ports(cx, callable, span)?;
    let wanted = [&signature.inputs, &signature.outputs];
    for (wanted, given) in wanted.into_iter().zip([&ports.inputs, &ports.outputs]) {
        let wanted = static_params::signature_port_types(
            cx.checker,
            id,
            statics,
            wanted.as_deref().unwrap_or_default(),
        );
        if wanted.len() != given.len() {
            let counts = (wanted.len(), given.len());
            return Some(node_port_mismatch(
                signature,
                span,
                "number of ports",
                counts,
            ));
        }
        for (wanted, given) in wanted.iter().zip(given) {
            if check_assignable(wanted, &given.ty, &mut Substitution::default()).is_err() {
                return Some(node_port_mismatch(
                    signature,
                    span,
                    &given.name,
                    (wanted, &given.ty),
                ));
            }
        }
    }
    None
}

/// Returns the callable that is passed as a static argument; `None` after an error.
pub(crate) fn static_callee<'a>(cx: &mut Body<'_, 'a>, arg: &'a StaticArg) -> Option<Callable> {
    static_callable(cx, arg)
}

/// Returns the diagnostic for a node whose ports do not match `signature`, the static parameter for which it is passed.
/// `what` is the difference, with the expected and the actual value.
fn node_port_mismatch<T: std::fmt::Display>(
    signature: &Signature,
    span: Span,
    what: &str,
    (wanted, given): (T, T),
) -> Diagnostic {
    let message = format!(
        "port mismatch: the node for `{}` has other ports",
        signature.name.name
    );
    Diagnostic::new(Code::RPI2001, message)
        .primary(
            span,
            format!("{what}: expected `{wanted}`, found `{given}`"),
        )
        .secondary(signature.name.span, "the expected ports are declared here")
        .help("pass a node with these ports, or write one that calls yours and adapts its ports")
}
