//! Grammar actions for types and units.
//!
//! In the functions, `l` and `r` are the byte offsets of the beginning and end of the node.

use super::with_element;
use crate::ast::*;
use crate::context::ParseContext;
use crate::validation;

/// Returns the inverse of a unit factor, as after `/`.
pub(crate) fn inverse(factor: UnitFactor) -> UnitFactor {
    UnitFactor {
        power: -factor.power,
        ..factor
    }
}

pub(crate) fn dotted(dotted: Dotted, name: Ident) -> Dotted {
    Dotted {
        span: dotted.span.merge(name.span),
        parts: with_element(dotted.parts, name),
    }
}

/// Checks the number at the beginning of a unit, which must be 1 as in `1/s`.
pub(crate) fn unit_one(cx: &ParseContext<'_>, l: u32, r: u32) -> Vec<UnitFactor> {
    if cx.slice(l, r) != "1" {
        cx.report(validation::number_as_unit(cx.span(l, r), cx.text));
    }
    Vec::new()
}

/// Returns the exponent of a unit, or reports it if it is above 99.
pub(crate) fn power(cx: &ParseContext<'_>, l: u32, r: u32) -> i32 {
    let power = cx.slice(l, r).parse().ok().filter(|p| *p <= 99);
    power.unwrap_or_else(|| {
        cx.report(validation::exponent_too_large(cx.span(l, r)));
        1
    })
}

/// Builds a real type with a unit: `real[m]`. A number, `real[3]`, has been reported and gives an error type.
pub(crate) fn real_type(cx: &ParseContext<'_>, l: u32, unit: Unit, r: u32) -> Type {
    let is_number = unit.factors.is_empty() && cx.slice(unit.span.start, unit.span.end) != "1";
    let kind = match is_number {
        true => TypeKind::Error,
        false => TypeKind::Real(Some(unit)),
    };
    ty(cx, l, kind, r)
}

pub(crate) fn ty(cx: &ParseContext<'_>, l: u32, kind: TypeKind, r: u32) -> Type {
    Type {
        kind,
        span: cx.span(l, r),
    }
}

pub(crate) fn array_type(cx: &ParseContext<'_>, l: u32, element: Type, size: Expr, r: u32) -> Type {
    ty(
        cx,
        l,
        TypeKind::Array(Box::new(ArrayType { element, size })),
        r,
    )
}

pub(crate) fn named_type(
    cx: &ParseContext<'_>,
    l: u32,
    name: Ident,
    statics: Vec<StaticArg>,
    frames: Option<Box<FramePair>>,
    r: u32,
) -> Type {
    let named = NamedType {
        name,
        statics,
        frames: frames.map(|frames| *frames),
    };
    ty(cx, l, TypeKind::Named(Box::new(named)), r)
}

pub(crate) fn subrange(
    cx: &ParseContext<'_>,
    l: u32,
    word: Ident,
    from: Option<Expr>,
    to: Option<Expr>,
    r: u32,
) -> Type {
    if word.name != "subrange" {
        cx.report(validation::bounds_without_subrange(&word));
    }
    ty(
        cx,
        l,
        TypeKind::Subrange(Box::new(Subrange {
            lower: from,
            upper: to,
        })),
        r,
    )
}
