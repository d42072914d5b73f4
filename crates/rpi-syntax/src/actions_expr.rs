//! Actions of the grammar: build expressions, types and literals.
//!
//! In the methods, `l` and `r` are the byte offsets of the beginning and end of the node.

use crate::ast::*;
use crate::context::ParseContext;
use crate::precedence::Prefix;
use crate::{Dialect, string_literal, validation};

impl ParseContext<'_> {
    pub(crate) fn expr(&self, l: u32, kind: ExprKind, r: u32) -> Expr {
        Expr {
            kind,
            span: self.span(l, r),
        }
    }

    /// Builds the conditional prefix `when c then x else` that begins at `l`. Only Lustre files accept it.
    pub(crate) fn when_as_if(&self, l: u32, condition: Expr, yes: Expr) -> Prefix {
        if self.dialect == Dialect::Rpi {
            self.report(validation::when_as_if(self.span(l, l + 4)));
        }
        Prefix::If(Box::new((false, condition, yes)))
    }

    pub(crate) fn number(&self, l: u32, r: u32) -> Number {
        Number {
            text: self.name(l, r),
        }
    }

    /// Returns the content of a string literal, without quotes and escapes.
    pub(crate) fn string(&self, l: u32, r: u32) -> Ident {
        Ident {
            name: self.intern(&string_literal::unquote(self.slice(l, r))),
            span: self.span(l, r),
        }
    }

    pub(crate) fn quantity(&self, l: u32, number: Number, unit: Unit, r: u32) -> Expr {
        let quantity = Box::new(Quantity { number, unit });
        self.expr(l, ExprKind::Quantity(quantity), r)
    }

    /// Builds a percentage: `60%`. The `%` begins at `sign`.
    pub(crate) fn percent(&self, l: u32, number: Number, sign: u32, r: u32) -> Expr {
        let unit = self.ident(sign, r);
        let span = unit.span;
        let factors = vec![UnitFactor { unit, power: 1 }];
        self.quantity(l, number, Unit { factors, span }, r)
    }

    /// Checks the number at the beginning of a unit, which must be 1 as in `1/s`.
    pub(crate) fn unit_one(&self, l: u32, r: u32) -> Vec<UnitFactor> {
        if self.slice(l, r) != "1" {
            self.report(validation::number_as_unit(self.span(l, r), self.text));
        }
        Vec::new()
    }

    /// Returns the exponent of a unit, or reports it if it is above 99.
    pub(crate) fn power(&self, l: u32, r: u32) -> i32 {
        let power = self.slice(l, r).parse().ok().filter(|p| *p <= 99);
        power.unwrap_or_else(|| {
            self.report(validation::exponent_too_large(self.span(l, r)));
            1
        })
    }

    /// Builds a real type with a unit: `real[m]`. A number, `real[3]`, has been reported and gives an error type.
    pub(crate) fn real_type(&self, l: u32, unit: Unit, r: u32) -> Type {
        let is_number =
            unit.factors.is_empty() && self.slice(unit.span.start, unit.span.end) != "1";
        let kind = match is_number {
            true => TypeKind::Error,
            false => TypeKind::Real(Some(unit)),
        };
        self.ty(l, kind, r)
    }

    pub(crate) fn ty(&self, l: u32, kind: TypeKind, r: u32) -> Type {
        Type {
            kind,
            span: self.span(l, r),
        }
    }

    pub(crate) fn array_type(&self, l: u32, element: Type, size: Expr, r: u32) -> Type {
        self.ty(l, TypeKind::Array(Box::new(ArrayType { element, size })), r)
    }

    pub(crate) fn named_type(
        &self,
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
        self.ty(l, TypeKind::Named(Box::new(named)), r)
    }

    pub(crate) fn subrange(
        &self,
        l: u32,
        word: Ident,
        from: Option<Expr>,
        to: Option<Expr>,
        r: u32,
    ) -> Type {
        if word.name != "subrange" {
            self.report(validation::bounds_without_subrange(&word));
        }
        self.ty(
            l,
            TypeKind::Subrange(Box::new(Subrange {
                lower: from,
                upper: to,
            })),
            r,
        )
    }

    pub(crate) fn field(&self, l: u32, base: Expr, field: Ident, r: u32) -> Expr {
        self.expr(l, ExprKind::Field(Box::new(Field { base, field })), r)
    }

    pub(crate) fn index(&self, l: u32, base: Expr, index: Expr, r: u32) -> Expr {
        self.expr(l, ExprKind::Index(Box::new(Index { base, index })), r)
    }

    pub(crate) fn slice_of(&self, l: u32, base: Expr, slice: SliceBounds, r: u32) -> Expr {
        self.expr(l, ExprKind::Slice(Box::new(SliceExpr { base, slice })), r)
    }

    /// Builds a bit slice of Kind 2: `base[high:low]`.
    pub(crate) fn bits(&self, l: u32, base: Expr, high: Expr, low: Expr, r: u32) -> Expr {
        let bits = BitRange { base, high, low };
        if self.dialect != Dialect::Lustre {
            self.report(validation::unsupported_bit_range(
                bits.high.span.merge(bits.low.span),
            ));
        }
        self.expr(l, ExprKind::BitRange(Box::new(bits)), r)
    }

    /// Builds an update of Kind 2: `base[0 := x; 1 := y]`.
    pub(crate) fn keyed_update(&self, l: u32, base: Expr, changes: Vec<Change>, r: u32) -> Expr {
        self.build_update(l, base, changes, true, r)
    }

    pub(crate) fn tuple(&self, l: u32, first: Expr, rest: Vec<Expr>, r: u32) -> Expr {
        let elements = std::iter::once(first).chain(rest).collect();
        self.expr(l, ExprKind::Tuple(elements), r)
    }

    pub(crate) fn update(&self, l: u32, base: Expr, changes: Vec<Change>, r: u32) -> Expr {
        self.build_update(l, base, changes, false, r)
    }

    fn build_update(
        &self,
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
        self.expr(l, ExprKind::Update(Box::new(update)), r)
    }

    pub(crate) fn merge(&self, l: u32, on: Expr, cases: Vec<MergeCase>, r: u32) -> Expr {
        self.expr(
            l,
            ExprKind::Merge(Box::new(Merge {
                selector: on,
                cases,
            })),
            r,
        )
    }

    /// Builds a Boolean `merge` without case names: `merge(c; x; y)`.
    pub(crate) fn merge_bool(&self, l: u32, on: Expr, yes: Expr, no: Expr, r: u32) -> Expr {
        let case = |value: &str, then: Expr| MergeCase {
            value: Ident {
                name: self.intern(value),
                span: then.span,
            },
            then,
        };
        let cases = vec![case("true", yes), case("false", no)];
        self.merge(l, on, cases, r)
    }

    pub(crate) fn struct_expr(
        &self,
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
        self.expr(l, ExprKind::Struct(Box::new(value)), r)
    }

    /// Builds an expression with a type ascription: `(x: T)`.
    pub(crate) fn ascription(&self, l: u32, value: Expr, ty: Type, r: u32) -> Expr {
        self.expr(
            l,
            ExprKind::Ascription(Box::new(Ascription { value, ty })),
            r,
        )
    }

    /// Builds a conversion as a call: `int8 x`, `sint@<25> x`. The expression begins at `l`.
    pub(crate) fn conversion(&self, l: u32, to: Ident, bits: Vec<StaticArg>, value: Expr) -> Expr {
        let r = value.span.end;
        let value = match value.kind {
            ExprKind::Paren(inner) => *inner,
            _ => value,
        };
        let callee = self.callee(to.span.start, to.clone(), bits, to.span.end);
        let args = vec![Arg { name: None, value }];
        self.call(
            l,
            crate::actions::call(*callee, Activation::Always, args),
            r,
        )
    }

    /// Builds `any { x: T | c }`. The type begins at `p`.
    pub(crate) fn any_value(
        &self,
        name: Ident,
        p: u32,
        refined: Box<RefinementType>,
        r: u32,
    ) -> Expr {
        let l = name.span.start;
        let ty = self.ty(p, TypeKind::Refinement(refined), r);
        let of = *self.static_arg(p, None, StaticValue::Type(ty), r);
        let callee = self.callee(l, name, vec![of], r);
        let call = crate::actions::call(*callee, Activation::Always, Vec::new());
        self.call(l, call, r)
    }

    /// Builds a test for a constructor: `A?(x)`.
    pub(crate) fn constructor_test(&self, l: u32, constructor: Ident, value: Expr, r: u32) -> Expr {
        self.expr(
            l,
            ExprKind::ConstructorTest(Box::new(ConstructorTest { constructor, value })),
            r,
        )
    }

    pub(crate) fn match_expr(&self, l: u32, value: Expr, arms: Vec<Arm>, r: u32) -> Expr {
        self.expr(l, ExprKind::Match(Box::new(Match { value, arms })), r)
    }

    /// Builds an empty set: `{}@<T>`.
    pub(crate) fn empty_set(&self, l: u32, types: Vec<StaticArg>, r: u32) -> Expr {
        self.expr(l, ExprKind::EmptySet(types.into()), r)
    }

    /// Builds a number among type arguments: `uint<32>`.
    pub(crate) fn static_number(&self, l: u32, r: u32) -> Box<StaticArg> {
        let number = self.number(l, r);
        let value = self.expr(l, ExprKind::Number(number), r);
        self.static_arg(l, None, StaticValue::Expr(value), r)
    }

    pub(crate) fn call(&self, l: u32, call: Box<Call>, r: u32) -> Expr {
        self.expr(l, ExprKind::Call(call), r)
    }

    pub(crate) fn callee(
        &self,
        l: u32,
        name: Ident,
        statics: Vec<StaticArg>,
        r: u32,
    ) -> Box<Callee> {
        let span = self.span(l, r);
        Box::new(Callee {
            name,
            statics,
            span,
        })
    }

    pub(crate) fn static_arg(
        &self,
        l: u32,
        name: Option<Ident>,
        value: StaticValue,
        r: u32,
    ) -> Box<StaticArg> {
        let span = self.span(l, r);
        Box::new(StaticArg { name, value, span })
    }
}
