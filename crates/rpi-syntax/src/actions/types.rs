//! Grammar actions for types and units.
//!
//! In the functions, `l` and `r` are the byte offsets of the beginning and end of the node.

use super::with_element;
use crate::ast::*;
use crate::context::ParseContext;
use crate::validation;

/// Returns a factor of a unit with the negated exponent, as needed after `/` in `m/s`.
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

/// Reports an error unless the number at `l..r`, which begins a unit, is 1, as in `1/s`. Returns the factors of the
/// unit `1`, which are none.
pub(crate) fn unit_one(cx: &ParseContext<'_>, l: u32, r: u32) -> Vec<UnitFactor> {
    if cx.slice(l, r) != "1" {
        cx.report(validation::number_as_unit(cx.span(l, r), cx.text));
    }
    Vec::new()
}

/// Returns the exponent of a unit at the byte range `l..r`. An exponent above 99 is reported and replaced by 1.
pub(crate) fn power(cx: &ParseContext<'_>, l: u32, r: u32) -> i32 {
    let power = cx.slice(l, r).parse().ok().filter(|p| *p <= 99);
    power.unwrap_or_else(|| {
        cx.report(validation::exponent_too_large(cx.span(l, r)));
        1
    })
}

/// Builds a real type with a unit: `real[m]`. A number in place of the unit, `real[3]`, gives an error type; its error
/// has been reported.
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
