//! Types.

use super::{Dotted, Expr, Ident, StaticArg, Unit, VarDecl};
use rpi_diag::Span;

/// A type.
#[derive(Clone, PartialEq, Debug)]
pub struct Type {
    /// What it is.
    pub kind: TypeKind,
    /// All of it.
    pub span: Span,
}

/// The kinds of types.
#[derive(Clone, PartialEq, Debug)]
pub enum TypeKind {
    /// `bool`
    Bool,
    /// `int`
    Int,
    /// `real`, `real[m/s]`
    Real(Option<Unit>),
    /// `Phase`, `Arm<<7>>`, `Pose(tool in base)`
    Named(Box<NamedType>),
    /// `T^n`
    Array(Box<ArrayType>),
    /// `T?`
    Optional(Box<Type>),
    /// `subrange [lo, hi] of int`
    Subrange(Box<Subrange>),
    /// `[T, U]` (Kind 2)
    Tuple(Vec<Type>),
    /// `subtype { x: T | x > 0 }` (Kind 2)
    Refined(Box<Refined>),
    /// `A | B(x: int)`; only in a declaration of a `datatype` (Kind 2)
    Data(Vec<Constructor>),
    /// `enum { A, B }`; only in a type declaration
    Enum(Vec<EnumValue>),
    /// `struct { x: real; y: real = 0.0 }`; only in a type declaration
    Struct(Vec<VarDecl>),
    /// A type with a fault; whatever has it must not cause further findings
    Broken,
}

/// A type by its name.
#[derive(Clone, PartialEq, Debug)]
pub struct NamedType {
    /// The name; may be qualified.
    pub name: Ident,
    /// Static arguments.
    pub statics: Vec<StaticArg>,
    /// Coordinate frames: `(tool in base)`, `(base)`.
    pub frames: Option<Frames>,
}

/// The coordinate frames of a spatial type.
#[derive(Clone, PartialEq, Debug)]
pub struct Frames {
    /// What is located: `tool` in `(tool in base)`; absent in `(base)`.
    pub of: Option<Dotted>,
    /// The frame of the coordinates: `base`.
    pub in_frame: Dotted,
}

/// `element^size`
#[derive(Clone, PartialEq, Debug)]
pub struct ArrayType {
    /// Type of the elements.
    pub element: Type,
    /// How many, a constant.
    pub size: Expr,
}

/// `subrange [from, to] of int`
#[derive(Clone, PartialEq, Debug)]
pub struct Subrange {
    /// Least value; open if absent (`*`).
    pub from: Option<Expr>,
    /// Greatest value; open if absent (`*`).
    pub to: Option<Expr>,
}

/// `subtype { name: base | condition }`
#[derive(Clone, PartialEq, Debug)]
pub struct Refined {
    /// What a value is called in the condition.
    pub name: Ident,
    /// The type that has more values.
    pub base: Type,
    /// What holds for the values.
    pub condition: Expr,
}

/// One alternative of a `datatype`.
#[derive(Clone, PartialEq, Debug)]
pub struct Constructor {
    /// Its name.
    pub name: Ident,
    /// Its parts.
    pub fields: Vec<VarDecl>,
}

/// One value of an enum.
#[derive(Clone, PartialEq, Debug)]
pub struct EnumValue {
    /// Doc comment before it.
    pub doc: Option<super::Doc>,
    /// Its name.
    pub name: Ident,
}
