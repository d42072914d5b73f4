//! Printing of calls and their arguments.

use super::Printer;
use super::expr;
use super::layout::{Doc, concat, group, text, word};
use super::list;
use super::list::{PARENS, STATIC_ARGS};
use super::parens;
use super::ty;
use crate::Dialect;
use crate::ast::*;
use rpi_diag::Span;

pub(super) fn print_call(printer: &Printer<'_>, call: &Call) -> Doc {
    if let [
        StaticArg {
            value:
                StaticValue::Type(Type {
                    kind: TypeKind::Refinement(refined),
                    ..
                }),
            ..
        },
    ] = &call.callee.statics[..]
    {
        let head = format!("{} ", call.callee.name.name);
        return concat([text(head), ty::print_refined(printer, refined)]);
    }
    if is_of_types(printer, call) {
        let name = ty::print_name(printer, &call.callee.name);
        return concat([name, type_args(printer, "@<", &call.callee.statics)]);
    }
    let callee = print_callee(printer, &call.callee);
    let head = match &call.activation {
        Activation::Always => callee,
        Activation::Restart { every } => concat([
            word("(restart "),
            callee,
            word(" every "),
            expr::print_expr(printer, every),
            word(")"),
        ]),
        Activation::Activate {
            every,
            restart,
            default,
        } => {
            let mut parts = vec![
                word("(activate "),
                callee,
                word(" every "),
                expr::print_expr(printer, every),
            ];
            if let Some(default) = default {
                parts.extend([
                    word(" initial default "),
                    expr::print_expr(printer, default),
                ]);
            }
            if let Some(restart) = restart {
                parts.extend([word(" restart every "), expr::print_expr(printer, restart)]);
            }
            parts.push(word(")"));
            concat(parts)
        }
    };
    group(concat([head, print_args(printer, &call.args)]))
}

/// Returns whether a call is a non-deterministic value `any@<T>` or `choose@<T>`, which Kind 2 writes without argument
/// parentheses.
fn is_of_types(printer: &Printer<'_>, call: &Call) -> bool {
    let is_type = |arg: &StaticArg| {
        arg.name.is_none() && matches!(arg.value, StaticValue::Type(_) | StaticValue::Expr(_))
    };
    let statics = &call.callee.statics;
    printer.mode == Dialect::Lustre
        && matches!(&*call.callee.name.name, "any" | "choose")
        && matches!(call.activation, Activation::Always)
        && call.args.is_empty()
        && !statics.is_empty()
        && statics.iter().all(is_type)
}

pub(super) fn print_args(printer: &Printer<'_>, args: &[Arg]) -> Doc {
    list::print_list(printer, PARENS, args, arg_span, |p, arg| {
        let value = expr::print_expr(p, &arg.value);
        named(arg.name.as_ref(), value)
    })
}

/// Prints type arguments in a `.lus` file, as in `f@<int; real>`. `open` is the opening text, such as `@<`.
pub(super) fn type_args(printer: &Printer<'_>, open: &'static str, args: &[StaticArg]) -> Doc {
    let mut parts = Vec::new();
    for (i, arg) in args.iter().enumerate() {
        parts.push(word(if i == 0 { open } else { "; " }));
        parts.push(match &arg.value {
            StaticValue::Type(ty) => ty::print_ty(printer, ty),
            value => static_value(printer, value, false),
        });
    }
    parts.push(word(if args.is_empty() { "" } else { ">" }));
    concat(parts)
}

pub(super) fn print_callee(printer: &Printer<'_>, callee: &Callee) -> Doc {
    let name = ty::print_name(printer, &callee.name);
    let statics = match is_of_kind2(printer, callee) {
        true => type_args(printer, "@<", &callee.statics),
        false => static_args(printer, &callee.statics),
    };
    concat([name, statics])
}

/// Returns whether the source writes the static arguments as `f@<int>`, the only form that Kind 2 accepts, and not as
/// `f<<int>>`.
fn is_of_kind2(printer: &Printer<'_>, callee: &Callee) -> bool {
    let name = callee.name.span;
    let source = printer
        .source
        .filter(|_| printer.mode == Dialect::Lustre && !name.is_none());
    source.is_some_and(|source| source.token_from(name.end) == "@")
}

pub(super) fn static_args(printer: &Printer<'_>, args: &[StaticArg]) -> Doc {
    match args {
        [] => Doc::Concat(Vec::new()),
        args => list::print_list(
            printer,
            STATIC_ARGS,
            args,
            |arg| arg.span,
            |p, arg| {
                let is_last = args.last().is_some_and(|last| std::ptr::eq(last, arg));
                let value = static_value(p, &arg.value, is_last);
                named(arg.name.as_ref(), value)
            },
        ),
    }
}

fn static_value(printer: &Printer<'_>, value: &StaticValue, is_last: bool) -> Doc {
    match value {
        StaticValue::Expr(expr) if parens::static_argument(expr) => {
            concat([word("("), expr::print_expr(printer, expr), word(")")])
        }
        StaticValue::Expr(expr) => expr::print_expr(printer, expr),
        StaticValue::Op(op) => static_op(*op, is_last),
        StaticValue::Callee(callee) if callee.statics.is_empty() => {
            concat([word("node "), print_callee(printer, callee)])
        }
        StaticValue::Callee(callee) => print_callee(printer, callee),
        StaticValue::Type(ty) if is_plain(ty) => ty::print_ty(printer, ty),
        StaticValue::Type(ty) => concat([word("type "), ty::print_ty(printer, ty)]),
    }
}

fn named(name: Option<&Ident>, value: Doc) -> Doc {
    match name {
        Some(name) => concat([text(&*name.name), word(": "), value]),
        None => value,
    }
}

fn arg_span(arg: &Arg) -> Span {
    let name = arg.name.as_ref().map_or(Span::NONE, |name| name.span);
    name.merge(arg.value.span)
}

/// Prints an operator as a static argument. The last argument gets a space after it where it would join with `>>`.
fn static_op(op: StaticOp, is_last: bool) -> Doc {
    let spelling = match op {
        StaticOp::Unary(op) => op.spelling(),
        StaticOp::Binary(op) => op.spelling(),
        StaticOp::If => "if",
    };
    let runs_in = is_last && spelling.ends_with(['-', '=', '<', '>']);
    concat([word(spelling), word(if runs_in { " " } else { "" })])
}

/// Returns whether a type is written without the keyword `type` when it is a static argument.
fn is_plain(ty: &Type) -> bool {
    match &ty.kind {
        TypeKind::Bool | TypeKind::Int | TypeKind::Real(None) => true,
        TypeKind::Array(array) => is_plain(&array.element),
        TypeKind::Optional(inner) => is_plain(inner),
        _ => false,
    }
}
