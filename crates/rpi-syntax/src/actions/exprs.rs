//! Grammar actions for expressions and literals.
//!
//! In the functions, `l` and `r` are the byte offsets of the beginning and end of the node.

use crate::Dialect;
use crate::ast::*;
use crate::context::ParseContext;
use crate::precedence::Prefix;
use crate::string_literal;
use crate::validation;

pub(crate) fn expr(cx: &ParseContext<'_>, l: u32, kind: ExprKind, r: u32) -> Expr {
    Expr {
        kind,
        span: cx.span(l, r),
    }
}

/// Builds the prefix of a conditional expression written with `when`: `when c then x else`. It begins at byte offset
/// `l`. Only Lustre files accept it.
pub(crate) fn when_as_if(cx: &ParseContext<'_>, l: u32, condition: Expr, yes: Expr) -> Prefix {
    if cx.dialect == Dialect::Rpi {
        cx.report(validation::when_as_if(cx.span(l, l + 4)));
    }
    Prefix::If(Box::new((false, condition, yes)))
}

pub(crate) fn number(cx: &ParseContext<'_>, l: u32, r: u32) -> Number {
    Number {
        text: cx.name(l, r),
    }
}

/// Returns the content of a string literal, without quotes and escapes.
pub(crate) fn string(cx: &ParseContext<'_>, l: u32, r: u32) -> Ident {
    Ident {
        name: cx.intern(&string_literal::unquote(cx.slice(l, r))),
        span: cx.span(l, r),
    }
}

pub(crate) fn quantity(cx: &ParseContext<'_>, l: u32, number: Number, unit: Unit, r: u32) -> Expr {
    let quantity = Box::new(Quantity { number, unit });
    expr(cx, l, ExprKind::Quantity(quantity), r)
}

/// Builds a percentage such as `60%`, a number with the unit `%`. `sign` is the byte offset of the `%`.
pub(crate) fn percent(cx: &ParseContext<'_>, l: u32, number: Number, sign: u32, r: u32) -> Expr {
    let unit = cx.ident(sign, r);
    let span = unit.span;
    let factors = vec![UnitFactor { unit, power: 1 }];
    quantity(cx, l, number, Unit { factors, span }, r)
}

pub(crate) fn field(cx: &ParseContext<'_>, l: u32, base: Expr, field: Ident, r: u32) -> Expr {
    expr(cx, l, ExprKind::Field(Box::new(Field { base, field })), r)
}

pub(crate) fn index(cx: &ParseContext<'_>, l: u32, base: Expr, index: Expr, r: u32) -> Expr {
    expr(cx, l, ExprKind::Index(Box::new(Index { base, index })), r)
}

pub(crate) fn slice_of(
    cx: &ParseContext<'_>,
    l: u32,
    base: Expr,
    slice: SliceBounds,
    r: u32,
) -> Expr {
    expr(
        cx,
        l,
        ExprKind::Slice(Box::new(SliceExpr { base, slice })),
        r,
    )
}

/// Builds a bit range of a machine integer (Kind 2): `base[high:low]`.
pub(crate) fn bits(
    cx: &ParseContext<'_>,
    l: u32,
    base: Expr,
    high: Expr,
    low: Expr,
    r: u32,
) -> Expr {
    let bits = BitRange { base, high, low };
    if cx.dialect != Dialect::Lustre {
        cx.report(validation::unsupported_bit_range(
            bits.high.span,
            bits.low.span,
        ));
    }
    expr(cx, l, ExprKind::BitRange(Box::new(bits)), r)
}

/// Builds an update of elements of an array (Kind 2): `base[0 := x; 1 := y]`.
pub(crate) fn keyed_update(
    cx: &ParseContext<'_>,
    l: u32,
    base: Expr,
    changes: Vec<Change>,
    r: u32,
) -> Expr {
    build_update(cx, l, base, changes, true, r)
}

pub(crate) fn tuple(cx: &ParseContext<'_>, l: u32, first: Expr, rest: Vec<Expr>, r: u32) -> Expr {
    let elements = std::iter::once(first).chain(rest).collect();
    expr(cx, l, ExprKind::Tuple(elements), r)
}

pub(crate) fn update(
    cx: &ParseContext<'_>,
    l: u32,
    base: Expr,
    changes: Vec<Change>,
    r: u32,
) -> Expr {
    build_update(cx, l, base, changes, false, r)
}

fn build_update(
    cx: &ParseContext<'_>,
    l: u32,
    base: Expr,
    changes: Vec<Change>,
    is_keyed: bool,
    r: u32,
) -> Expr {
    let update = Update {
        base,
        changes,
        is_keyed,
    };
    expr(cx, l, ExprKind::Update(Box::new(update)), r)
}

pub(crate) fn merge(
    cx: &ParseContext<'_>,
    l: u32,
    on: Expr,
    cases: Vec<MergeCase>,
    r: u32,
) -> Expr {
    expr(
        cx,
        l,
        ExprKind::Merge(Box::new(Merge {
            selector: on,
            cases,
        })),
        r,
    )
}

/// Builds a `merge` over a Boolean flow without case names: `merge(c; x; y)`, where `x` is used if `c` is true, else
/// `y`.
pub(crate) fn merge_bool(
    cx: &ParseContext<'_>,
    l: u32,
    on: Expr,
    yes: Expr,
    no: Expr,
    r: u32,
) -> Expr {
    let case = |value: &str, then: Expr| MergeCase {
        value: Ident {
            name: cx.intern(value),
            span: then.span,
        },
        then,
    };
    let cases = vec![case("true", yes), case("false", no)];
    merge(cx, l, on, cases, r)
}

pub(crate) fn struct_expr(
    cx: &ParseContext<'_>,
    l: u32,
    ty: Ident,
    statics: Vec<StaticArg>,
    base: Option<Expr>,
    fields: Vec<FieldValue>,
    r: u32,
) -> Expr {
    let value = StructExpr {
        ty,
        statics,
        base,
        fields,
    };
    expr(cx, l, ExprKind::Struct(Box::new(value)), r)
}

/// Builds an expression with an explicit type: `(x: T)`.
pub(crate) fn ascription(cx: &ParseContext<'_>, l: u32, value: Expr, ty: Type, r: u32) -> Expr {
    expr(
        cx,
        l,
        ExprKind::Ascription(Box::new(Ascription { value, ty })),
        r,
    )
}

/// Builds the test of whether a value was made by a constructor: `A?(x)`.
pub(crate) fn constructor_test(
    cx: &ParseContext<'_>,
    l: u32,
    constructor: Ident,
    value: Expr,
    r: u32,
) -> Expr {
    expr(
        cx,
        l,
        ExprKind::ConstructorTest(Box::new(ConstructorTest { constructor, value })),
        r,
    )
}

pub(crate) fn match_expr(
    cx: &ParseContext<'_>,
    l: u32,
    value: Expr,
    arms: Vec<Arm>,
    r: u32,
) -> Expr {
    expr(cx, l, ExprKind::Match(Box::new(Match { value, arms })), r)
}

/// Builds an empty set of a given element type: `{}@<T>`.
pub(crate) fn empty_set(cx: &ParseContext<'_>, l: u32, types: Vec<StaticArg>, r: u32) -> Expr {
    expr(cx, l, ExprKind::EmptySet(types.into()), r)
}
