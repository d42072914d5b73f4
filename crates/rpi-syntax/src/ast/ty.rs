//! Type expressions.

use super::{Dotted, Expr, Ident, StaticArg, Unit, VarDecl};
use rpi_diag::Span;

/// Type as it is written in the text, before its names are resolved.
#[derive(Clone, PartialEq, Debug)]
pub struct Type {
    /// Form of the type, with its parts.
    pub kind: TypeKind,
    /// Source range.
    pub span: Span,
}

/// Forms in which a program writes a type.
#[derive(Clone, PartialEq, Debug)]
pub enum TypeKind {
    /// The type `bool` of true and false.
    Bool,
    /// The type `int` of integers with 64 bits.
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
    Refinement(Box<RefinementType>),
    /// `A | B(x: int)`; only in a declaration of a `datatype` (Kind 2)
    Datatype(Vec<Constructor>),
    /// `enum { A, B }`; only in a type declaration
    Enum(Vec<EnumValue>),
    /// `struct { x: real; y: real = 0.0 }`; only in a type declaration
    Struct(Vec<VarDecl>),
    /// Type with an error; it must not cause further diagnostics
    Error,
}

/// Named type with its static arguments and frames.
#[derive(Clone, PartialEq, Debug)]
pub struct NamedType {
    /// Name of the type; may be qualified.
    pub name: Ident,
    /// Arguments of a generic type between `<<` and `>>`.
    pub statics: Vec<StaticArg>,
    /// Coordinate frames: `(tool in base)`, `(base)`.
    pub frames: Option<FramePair>,
}

/// Coordinate frames of a spatial type.
#[derive(Clone, PartialEq, Debug)]
pub struct FramePair {
    /// Located frame: `tool` in `(tool in base)`; absent in `(base)`.
    pub located: Option<Dotted>,
    /// Reference frame of the coordinates: `base`.
    pub reference: Dotted,
}

/// Array type: `element^size`.
#[derive(Clone, PartialEq, Debug)]
pub struct ArrayType {
    /// Type of each element.
    pub element: Type,
    /// Number of elements, a constant.
    pub size: Expr,
}

/// Subrange of the integers: `subrange [from, to] of int`.
#[derive(Clone, PartialEq, Debug)]
pub struct Subrange {
    /// Lower bound, inclusive; absent if unbounded (`*`).
    pub lower: Option<Expr>,
    /// Upper bound, inclusive; absent if unbounded (`*`).
    pub upper: Option<Expr>,
}

/// Refinement type: `subtype { name: base | condition }`.
#[derive(Clone, PartialEq, Debug)]
pub struct RefinementType {
    /// Name of the value in the condition.
    pub name: Ident,
    /// Type whose values the condition or range restricts.
    pub base: Type,
    /// Condition that the values satisfy.
    pub condition: Expr,
}

/// Constructor of a `datatype`.
#[derive(Clone, PartialEq, Debug)]
pub struct Constructor {
    /// Name of the constructor.
    pub name: Ident,
    /// Fields of the constructor.
    pub fields: Vec<VarDecl>,
}

/// Named value in the declaration of an enum.
#[derive(Clone, PartialEq, Debug)]
pub struct EnumValue {
    /// Doc comment before the value.
    pub doc: Option<super::Doc>,
    /// Name of the value, with its place in the source.
    pub name: Ident,
}
