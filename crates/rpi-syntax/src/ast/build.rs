//! Short ways to make nodes that have no text, for importers and generators.
//!
//! All spans are [`Span::NONE`]. Parentheses need not be made: the printer sets what the levels of
//! the operators ask for.

use super::*;
use crate::ops::{BinaryOp, UnaryOp};

impl Ident {
    /// A name without a place.
    pub fn synthetic(name: impl Into<Name>) -> Ident {
        Ident {
            name: name.into(),
            span: Span::NONE,
        }
    }
}

impl Dotted {
    /// `a.b.c` without a place, of its parts.
    pub fn synthetic<N: Into<Name>>(parts: impl IntoIterator<Item = N>) -> Dotted {
        Dotted {
            parts: parts.into_iter().map(Ident::synthetic).collect(),
            span: Span::NONE,
        }
    }
}

impl Unit {
    /// A unit of factors and powers, `[("m", 1), ("s", -2)]`.
    pub fn synthetic<'a>(factors: impl IntoIterator<Item = (&'a str, i32)>) -> Unit {
        let factor = |(unit, power): (&str, i32)| UnitFactor {
            unit: Ident::synthetic(unit),
            power,
        };
        Unit {
            factors: factors.into_iter().map(factor).collect(),
            span: Span::NONE,
        }
    }
}

impl Number {
    /// A real number that is at least 0 and finite, in the shortest form that reads back.
    ///
    /// [`None`] for what the language has no literal for: a sign, infinity, NaN.
    pub fn from_real(value: f64) -> Option<Number> {
        let writable = value.is_finite() && value.is_sign_positive();
        writable.then(|| Number {
            text: format!("{value:?}").into(),
        })
    }

    /// A natural number.
    pub fn from_int(value: u64) -> Number {
        Number {
            text: value.to_string().into(),
        }
    }
}

impl From<ExprKind> for Expr {
    fn from(kind: ExprKind) -> Expr {
        Expr {
            kind,
            span: Span::NONE,
        }
    }
}

impl Expr {
    /// `true`, `false`
    pub fn bool(value: bool) -> Expr {
        ExprKind::Bool(value).into()
    }

    /// An integer; a negative one is the opposite of a literal.
    pub fn int(value: i64) -> Expr {
        let literal = ExprKind::Number(Number::from_int(value.unsigned_abs())).into();
        match value < 0 {
            true => Expr::unary(UnaryOp::Neg, literal),
            false => literal,
        }
    }

    /// A finite real; a negative one, -0 included, is the opposite of a literal. [`None`] for
    /// infinities and NaN, which have no literal.
    pub fn real(value: f64) -> Option<Expr> {
        let literal: Expr = ExprKind::Number(Number::from_real(value.abs())?).into();
        Some(match value.is_sign_negative() {
            true => Expr::unary(UnaryOp::Neg, literal),
            false => literal,
        })
    }

    /// `"text"`
    pub fn str(text: impl Into<Name>) -> Expr {
        ExprKind::Str(text.into()).into()
    }

    /// `x`, `Core::Pi`
    pub fn name(name: impl Into<Name>) -> Expr {
        ExprKind::Name(name.into()).into()
    }

    /// `self.field`
    #[must_use]
    pub fn field(self, field: impl Into<Name>) -> Expr {
        let field = Ident::synthetic(field);
        ExprKind::Field(Box::new(Field { base: self, field })).into()
    }

    /// `self[index]`
    #[must_use]
    pub fn index(self, index: Expr) -> Expr {
        ExprKind::Index(Box::new(Index { base: self, index })).into()
    }

    /// `op operand`
    pub fn unary(op: UnaryOp, operand: Expr) -> Expr {
        ExprKind::Unary(op, Box::new(operand)).into()
    }

    /// `lhs op rhs`
    pub fn binary(op: BinaryOp, lhs: Expr, rhs: Expr) -> Expr {
        ExprKind::Binary(Box::new(Binary {
            op,
            op_span: Span::NONE,
            lhs,
            rhs,
        }))
        .into()
    }

    /// `if condition then yes else no`
    pub fn cond(condition: Expr, yes: Expr, no: Expr) -> Expr {
        ExprKind::If(Box::new(If {
            is_static: false,
            condition,
            yes,
            no,
        }))
        .into()
    }

    /// `callee(args)`
    pub fn call(callee: Callee, args: Vec<Arg>) -> Expr {
        ExprKind::Call(Box::new(Call {
            callee,
            activation: Activation::Always,
            args,
        }))
        .into()
    }
}

impl Callee {
    /// `name<<statics>>`
    pub fn synthetic(name: impl Into<Name>, statics: Vec<StaticArg>) -> Callee {
        Callee {
            name: Ident::synthetic(name),
            statics,
            span: Span::NONE,
        }
    }
}

impl Arg {
    /// `x`
    pub fn positional(value: Expr) -> Arg {
        Arg { name: None, value }
    }

    /// `name: x`
    pub fn named(name: impl Into<Name>, value: Expr) -> Arg {
        Arg {
            name: Some(Ident::synthetic(name)),
            value,
        }
    }
}

impl StaticArg {
    /// `name: x` between `<<` and `>>`
    pub fn named(name: impl Into<Name>, value: Expr) -> StaticArg {
        StaticArg {
            name: Some(Ident::synthetic(name)),
            value: StaticValue::Expr(value),
            span: Span::NONE,
        }
    }
}

impl From<TypeKind> for Type {
    fn from(kind: TypeKind) -> Type {
        Type {
            kind,
            span: Span::NONE,
        }
    }
}

impl Type {
    /// A type by its name.
    pub fn named(name: impl Into<Name>) -> Type {
        TypeKind::Named(Box::new(NamedType {
            name: Ident::synthetic(name),
            statics: Vec::new(),
            frames: None,
        }))
        .into()
    }

    /// `self^size`
    #[must_use]
    pub fn array(self, size: Expr) -> Type {
        TypeKind::Array(Box::new(ArrayType {
            element: self,
            size,
        }))
        .into()
    }

    /// `self?`
    #[must_use]
    pub fn optional(self) -> Type {
        TypeKind::Optional(Box::new(self)).into()
    }
}

impl VarDecl {
    /// `name: ty`
    pub fn synthetic(name: impl Into<Name>, ty: Type) -> VarDecl {
        VarDecl {
            doc: None,
            is_const: false,
            names: vec![Ident::synthetic(name)],
            ty,
            clock: None,
            default: None,
            span: Span::NONE,
        }
    }
}

impl Target {
    /// `name`
    pub fn synthetic(name: impl Into<Name>) -> Target {
        Target {
            name: Ident::synthetic(name),
            path: Vec::new(),
            span: Span::NONE,
        }
    }

    /// `self.field`
    #[must_use]
    pub fn field(mut self, field: impl Into<Name>) -> Target {
        self.path.push(Access::Field(Ident::synthetic(field)));
        self
    }
}

impl From<StatementKind> for Statement {
    fn from(kind: StatementKind) -> Statement {
        Statement {
            doc: None,
            kind,
            span: Span::NONE,
        }
    }
}

impl Statement {
    /// `target = value;`
    pub fn equation(target: Target, value: Expr) -> Statement {
        let targets = vec![target];
        StatementKind::Equation(Box::new(Equation { targets, value })).into()
    }
}

impl From<ItemKind> for Item {
    fn from(kind: ItemKind) -> Item {
        Item {
            doc: None,
            kind,
            span: Span::NONE,
        }
    }
}
