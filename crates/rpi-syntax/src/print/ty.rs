//! Printing of types, units and variables.

use super::Printer;
use super::call;
use super::decl;
use super::expr;
use super::layout::{Doc, concat, empty, text, word};
use super::list;
use super::list::{PORTS, SPACED_COMMAS, SPACED_SEMIS, SQUARE, STATIC_PARAMS};
use crate::Dialect;
use crate::ast::*;
use crate::ops::BinaryOp;
use std::fmt::Write as _;

pub(super) fn print_ty(printer: &Printer<'_>, ty: &Type) -> Doc {
    match &ty.kind {
        TypeKind::Bool => printer.mark_offset(ty.span, word("bool")),
        TypeKind::Int => printer.mark_offset(ty.span, word("int")),
        TypeKind::Real(None) => printer.mark_offset(ty.span, word("real")),
        TypeKind::Real(Some(unit)) => concat([word("real["), print_unit(unit), word("]")]),
        TypeKind::Named(named) => named_type(printer, named),
        TypeKind::Array(array) => concat([
            print_ty(printer, &array.element),
            word("^"),
            print_size(printer, &array.size),
        ]),
        TypeKind::Optional(inner) => {
            // Two adjacent `?` would be lexed as `??`.
            let twice = matches!(inner.kind, TypeKind::Optional(_));
            concat([
                print_ty(printer, inner),
                word(if twice { " ?" } else { "?" }),
            ])
        }
        TypeKind::Subrange(range) => subrange(printer, range),
        TypeKind::Enum(values) => {
            let values = list::print_list(
                printer,
                SPACED_COMMAS,
                values,
                |v| v.name.span,
                |p, value| {
                    concat([
                        list::doc_lines(p, value.doc.as_ref()),
                        print_name(p, &value.name),
                    ])
                },
            );
            concat([word("enum "), values])
        }
        TypeKind::Tuple(types) => list::print_list(printer, SQUARE, types, |ty| ty.span, print_ty),
        TypeKind::Refinement(refined) => {
            concat([word("subtype "), print_refined(printer, refined)])
        }
        TypeKind::Datatype(all) => list::print_phrases(printer, all, |p, i, constructor| {
            let bar = word(if i == 0 { "" } else { "| " });
            let name = print_name(p, &constructor.name);
            let fields = match &constructor.fields[..] {
                [] => empty(),
                fields => concat([word(" "), print_ports(p, fields)]),
            };
            concat([bar, name, fields])
        }),
        TypeKind::Struct(fields) => {
            let fields = list::print_list(printer, SPACED_SEMIS, fields, |f| f.span, var_decl);
            concat([word("struct "), fields])
        }
        TypeKind::Error => empty(),
    }
}

/// Prints the part of a refinement type in braces: `{ x: int | x > 0 }`.
pub(super) fn print_refined(printer: &Printer<'_>, refined: &RefinementType) -> Doc {
    let name = print_name(printer, &refined.name);
    let (base, condition) = (
        print_ty(printer, &refined.base),
        expr::print_expr(printer, &refined.condition),
    );
    concat([
        word("{ "),
        name,
        word(": "),
        base,
        word(" | "),
        condition,
        word(" }"),
    ])
}

fn named_type(printer: &Printer<'_>, named: &NamedType) -> Doc {
    let args = match printer.mode {
        Dialect::Rpi => call::static_args(printer, &named.statics),
        Dialect::Lustre => call::type_args(printer, "<", &named.statics),
    };
    let head = concat([print_name(printer, &named.name), args]);
    let Some(frames) = &named.frames else {
        return head;
    };
    let in_frame = text(dotted(&frames.reference));
    let frames = match &frames.located {
        Some(of) => concat([text(dotted(of)), word(" in "), in_frame]),
        None => in_frame,
    };
    concat([head, word("("), frames, word(")")])
}

/// Prints the size in an array type, in parentheses unless it is plain arithmetic.
fn print_size(printer: &Printer<'_>, size: &Expr) -> Doc {
    let inner = expr::print_expr(printer, size);
    match is_arithmetic(size) {
        true => inner,
        false => concat([word("("), inner, word(")")]),
    }
}

fn subrange(printer: &Printer<'_>, range: &Subrange) -> Doc {
    let bound = |bound: &Option<Expr>| match bound {
        Some(bound) => expr::print_expr(printer, bound),
        None => word("*"),
    };
    let (from, to) = (bound(&range.lower), bound(&range.upper));
    concat([word("subrange ["), from, word(", "), to, word("] of int")])
}

pub(super) fn print_unit(unit: &Unit) -> Doc {
    let mut written = String::new();
    for factor in &unit.factors {
        let sign = match (written.is_empty(), factor.power < 0) {
            (true, false) => "",
            (true, true) => "1/",
            (false, false) => "*",
            (false, true) => "/",
        };
        let _ = write!(written, "{sign}{}", factor.unit.name);
        if factor.power.abs() != 1 {
            let _ = write!(written, "^{}", factor.power.abs());
        }
    }
    text(if written.is_empty() {
        "1".to_owned()
    } else {
        written
    })
}

/// Prints a declaration of variables: `a, b: T when c = d`.
pub(super) fn var_decl(printer: &Printer<'_>, var: &VarDecl) -> Doc {
    let head = if var.is_const { "const " } else { "" };
    let mut parts = vec![
        list::doc_lines(printer, var.doc.as_ref()),
        word(head),
        text(names(&var.names)),
        word(": "),
    ];
    parts.push(print_ty(printer, &var.ty));
    if let Some(clock) = &var.clock {
        parts.extend([word(" when "), expr::print_clock(printer, clock)]);
    }
    if let Some(default) = &var.default {
        parts.extend([word(" = "), expr::print_expr(printer, default)]);
    }
    concat(parts)
}

/// Prints a definition of constants: `a, b: T = e`.
pub(super) fn const_def(printer: &Printer<'_>, def: &ConstDef) -> Doc {
    let doc = list::doc_lines(printer, def.doc.as_ref());
    concat([doc, constant(printer, def)])
}

/// Prints a definition of constants without its doc comment.
fn constant(printer: &Printer<'_>, def: &ConstDef) -> Doc {
    let mut parts = vec![text(names(&def.names))];
    if let Some(ty) = &def.ty {
        parts.extend([word(": "), print_ty(printer, ty)]);
    }
    if let Some(value) = &def.value {
        parts.extend([word(" = "), expr::print_expr(printer, value)]);
    }
    concat(parts)
}

/// Prints a list of ports: `(a: T; b: U)`.
pub(super) fn print_ports(printer: &Printer<'_>, ports: &[VarDecl]) -> Doc {
    list::print_list(printer, PORTS, ports, |port| port.span, var_decl)
}

/// Prints static parameters with a space before them: `<<a: T; type t>>`.
pub(super) fn static_params(printer: &Printer<'_>, params: &[StaticParam]) -> Doc {
    match params {
        [] => empty(),
        params if printer.mode == Dialect::Lustre && params.iter().all(is_bare) => {
            type_params(params)
        }
        params => {
            let list = list::print_list(printer, STATIC_PARAMS, params, |p| p.span, static_param);
            concat([word(" "), list])
        }
    }
}

fn static_param(printer: &Printer<'_>, param: &StaticParam) -> Doc {
    let written = match &param.kind {
        StaticParamKind::Type(name, constraint) => {
            let constraint = constraint.as_ref().map_or_else(empty, |constraint| {
                concat([word(": "), print_name(printer, constraint)])
            });
            concat([word("type "), print_name(printer, name), constraint])
        }
        StaticParamKind::Value(def) => {
            // Lustre V6 requires a keyword before each static parameter.
            let head = if printer.mode == Dialect::Lustre {
                "const "
            } else {
                ""
            };
            concat([word(head), constant(printer, def)])
        }
        StaticParamKind::Node(kind, signature) => concat([
            word(kind.keyword()),
            word(" "),
            decl::print_signature(printer, signature),
        ]),
    };
    concat([list::doc_lines(printer, param.doc.as_ref()), written])
}

/// Prints a name, marked with its source offset.
pub(super) fn print_name(printer: &Printer<'_>, name: &Ident) -> Doc {
    printer.mark_offset(name.span, text(&*name.name))
}

/// Returns whether the size in an array type consists of arithmetic operators, names and literals, so that it needs no
/// parentheses.
fn is_arithmetic(size: &Expr) -> bool {
    use BinaryOp::{Add, Div, IntDiv, Mod, Mul, Sub};
    match &size.kind {
        ExprKind::Binary(binary) => {
            matches!(binary.op, Add | Sub | Mul | Div | IntDiv | Mod)
                && is_arithmetic(&binary.lhs)
                && is_arithmetic(&binary.rhs)
        }
        ExprKind::Unary(..) | ExprKind::If(_) | ExprKind::When(_) => false,
        _ => true,
    }
}

/// Returns the text of names separated by commas: `a, b`.
pub(super) fn names(names: &[Ident]) -> String {
    let names: Vec<&str> = names.iter().map(|name| name.name.as_str()).collect();
    names.join(", ")
}

/// Returns the text of a path of names: `a.b`.
pub(super) fn dotted(dotted: &Dotted) -> String {
    let parts: Vec<&str> = dotted.parts.iter().map(|part| part.name.as_str()).collect();
    parts.join(".")
}

/// Prints type parameters after the name of a type, or of a node of Kind 2: `<T; U>`.
pub(super) fn type_params(params: &[StaticParam]) -> Doc {
    let names = params.iter().filter_map(|param| match &param.kind {
        StaticParamKind::Type(name, _) => Some(name.name.as_str()),
        _ => None,
    });
    let names: Vec<&str> = names.collect();
    match &names[..] {
        [] => empty(),
        all => text(format!("<{}>", all.join("; "))),
    }
}

/// Returns whether the source writes a type parameter as `T`, without the keyword `type`.
fn is_bare(param: &StaticParam) -> bool {
    matches!(&param.kind, StaticParamKind::Type(name, _) if name.span == param.span && !param.span.is_none())
}
