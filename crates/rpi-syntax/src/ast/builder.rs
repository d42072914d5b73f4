//! Constructors of nodes without source text, for importers and generators.
//!
//! All spans are [`Span::NONE`]. Parenthesis nodes are not needed: the printer adds parentheses by operator precedence.

use super::*;
use crate::ops::{BinaryOp, UnaryOp};

impl Ident {
    /// Creates a name without a source range.
    pub fn synthetic(name: impl Into<Name>) -> Ident {
        Ident {
            name: name.into(),
            span: Span::NONE,
        }
    }
}

impl Dotted {
    /// Creates the path `a.b.c` from its parts.
    pub fn synthetic<N: Into<Name>>(parts: impl IntoIterator<Item = N>) -> Dotted {
        Dotted {
            parts: parts.into_iter().map(Ident::synthetic).collect(),
            span: Span::NONE,
        }
    }
}

impl Unit {
    /// Creates a unit from names of base units and their exponents: `[("m", 1), ("s", -2)]` is m/s^2.
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
    /// Creates the real literal with the fewest digits that parses back to `value`.
    ///
    /// Returns [`None`] for values without a literal: negative (also -0), infinite or NaN.
    pub fn from_real(value: f64) -> Option<Number> {
        let writable = value.is_finite() && value.is_sign_positive();
        writable.then(|| Number {
            text: format!("{value:?}").into(),
        })
    }

    /// Creates a decimal integer literal.
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
    /// Creates the literal `true` or `false`.
    pub fn bool(value: bool) -> Expr {
        ExprKind::Bool(value).into()
    }

    /// Creates an integer literal; a negative value becomes the negation of a literal.
    pub fn int(value: i64) -> Expr {
        let literal = ExprKind::Number(Number::from_int(value.unsigned_abs())).into();
        match value < 0 {
            true => Expr::unary(UnaryOp::Neg, literal),
            false => literal,
        }
    }

    /// Creates a real literal; a negative value (also -0) becomes the negation of a literal. Returns [`None`] for
    /// infinities and NaN, which have no literal.
    pub fn real(value: f64) -> Option<Expr> {
        let literal: Expr = ExprKind::Number(Number::from_real(value.abs())?).into();
        Some(match value.is_sign_negative() {
            true => Expr::unary(UnaryOp::Neg, literal),
            false => literal,
        })
    }

    /// Creates the string literal `"text"`.
    pub fn str(text: impl Into<Name>) -> Expr {
        ExprKind::Str(text.into()).into()
    }

    /// Creates a reference to a plain or qualified name: `x`, `Core::Pi`.
    pub fn name(name: impl Into<Name>) -> Expr {
        ExprKind::Name(name.into()).into()
    }

    /// Creates the field access `self.field`.
    #[must_use]
    pub fn field(self, field: impl Into<Name>) -> Expr {
        let field = Ident::synthetic(field);
        ExprKind::Field(Box::new(Field { base: self, field })).into()
    }

    /// Creates the array access `self[index]`.
    #[must_use]
    pub fn index(self, index: Expr) -> Expr {
        ExprKind::Index(Box::new(Index { base: self, index })).into()
    }

    /// Creates the unary operation `op operand`.
    pub fn unary(op: UnaryOp, operand: Expr) -> Expr {
        ExprKind::Unary(op, Box::new(operand)).into()
    }

    /// Creates the binary operation `lhs op rhs`.
    pub fn binary(op: BinaryOp, lhs: Expr, rhs: Expr) -> Expr {
        ExprKind::Binary(Box::new(Binary {
            op,
            op_span: Span::NONE,
            lhs,
            rhs,
        }))
        .into()
    }

    /// Creates `if condition then yes else no`.
    pub fn if_else(condition: Expr, yes: Expr, no: Expr) -> Expr {
        ExprKind::If(Box::new(IfExpr {
            is_static: false,
            condition,
            then_value: yes,
            else_value: no,
        }))
        .into()
    }

    /// Returns the syntax tree of the call `callee(args)`, for code that the compiler generates.
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
    /// Returns the syntax tree of a callee `name<<statics>>` that does not occur in the source, so that it has no span.
    pub fn synthetic(name: impl Into<Name>, statics: Vec<StaticArg>) -> Callee {
        Callee {
            name: Ident::synthetic(name),
            statics,
            span: Span::NONE,
        }
    }
}

impl Arg {
    /// Creates the positional argument `value`.
    pub fn positional(value: Expr) -> Arg {
        Arg { name: None, value }
    }

    /// Creates the named argument `name: value`.
    pub fn named(name: impl Into<Name>, value: Expr) -> Arg {
        Arg {
            name: Some(Ident::synthetic(name)),
            value,
        }
    }
}

impl StaticArg {
    /// Creates the named static argument `name: value`.
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
    /// Returns the syntax tree of a type that is written by its name, without static arguments or frames.
    pub fn named(name: impl Into<Name>) -> Type {
        TypeKind::Named(Box::new(NamedType {
            name: Ident::synthetic(name),
            statics: Vec::new(),
            frames: None,
        }))
        .into()
    }

    /// Returns the syntax tree of an array type `T^size` whose elements have this type.
    #[must_use]
    pub fn array(self, size: Expr) -> Type {
        TypeKind::Array(Box::new(ArrayType {
            element: self,
            size,
        }))
        .into()
    }

    /// Returns the syntax tree of the type `T?` of flows that may be absent.
    #[must_use]
    pub fn optional(self) -> Type {
        TypeKind::Optional(Box::new(self)).into()
    }
}

impl VarDecl {
    /// Creates the declaration `name: ty`.
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
    /// Returns the left side of an equation for a flow that does not occur in the source, so that it has no span.
    pub fn synthetic(name: impl Into<Name>) -> Target {
        Target {
            name: Ident::synthetic(name),
            path: Vec::new(),
            span: Span::NONE,
        }
    }

    /// Returns the left side of an equation for one field of this target.
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
    /// Returns the syntax tree of the equation `target = value;`, for code that the compiler generates.
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
