//! Type expressions.

use super::{Dotted, Expr, Ident, StaticArg, Unit, VarDecl};
use rpi_diag::Span;

/// Type as it is written in the text, before its names are resolved.
#[derive(Clone, PartialEq, Debug)]
pub struct Type {
    /// Form of the type, with its parts.
    pub kind: TypeKind,
    /// Range of the whole construct in the source text.
    pub span: Span,
}

/// Form in which a program writes a type.
#[derive(Clone, PartialEq, Debug)]
pub enum TypeKind {
    /// The type `bool` of true and false.
    Bool,
    /// The type `int` of 64-bit integers.
    Int,
    /// Type of real numbers with an optional unit: `real`, `real[m/s]`
    Real(Option<Unit>),
    /// Type that is referred to by its name: `Phase`, `Arm<<7>>`, `Pose(tool in base)`
    Named(Box<NamedType>),
    /// Array type: `T^n`
    Array(Box<ArrayType>),
    /// Type of flows that may have no value in a cycle: `T?`
    Optional(Box<Type>),
    /// Integers within bounds: `subrange [lo, hi] of int`
    Subrange(Box<Subrange>),
    /// Tuple of types: `[T, U]` (Kind 2)
    Tuple(Vec<Type>),
    /// Values that satisfy a condition: `subtype { x: T | x > 0 }` (Kind 2)
    Refinement(Box<RefinementType>),
    /// Algebraic data type: `A | B(x: int)`. Occurs only in a declaration of a `datatype` (Kind 2).
    Datatype(Vec<Constructor>),
    /// Type with named values: `enum { A, B }`. Occurs only in a type declaration.
    Enum(Vec<EnumValue>),
    /// Type with named fields: `struct { x: real; y: real = 0.0 }`. Occurs only in a type declaration.
    Struct(Vec<VarDecl>),
    /// Placeholder for a type with a reported error. It causes no further diagnostics.
    Error,
}

/// Named type with its static arguments and frames.
#[derive(Clone, PartialEq, Debug)]
pub struct NamedType {
    /// Name of the type; may be qualified.
    pub name: Ident,
    /// Static arguments of a generic type, between `<<` and `>>`.
    pub statics: Vec<StaticArg>,
    /// Coordinate frames of a spatial type: `(tool in base)`, `(base)`; absent for other types.
    pub frames: Option<FramePair>,
}

/// Coordinate frames of a spatial type, such as the type of a pose or velocity.
#[derive(Clone, PartialEq, Debug)]
pub struct FramePair {
    /// Frame whose position or motion is described: `tool` in `(tool in base)`; absent in `(base)`.
    pub located: Option<Dotted>,
    /// Frame in which the coordinates are given: `base`.
    pub reference: Dotted,
}

/// Array type: `element^size`.
#[derive(Clone, PartialEq, Debug)]
pub struct ArrayType {
    /// Type of each element.
    pub element: Type,
    /// Number of elements, an expression that is evaluated at compile time.
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

/// Refinement type, the values of `base` that satisfy a condition: `subtype { name: base | condition }`.
#[derive(Clone, PartialEq, Debug)]
pub struct RefinementType {
    /// Name by which the condition refers to the value.
    pub name: Ident,
    /// Type whose values the condition restricts.
    pub base: Type,
    /// Condition that the values satisfy.
    pub condition: Expr,
}

/// Constructor of an algebraic data type, which is declared with `datatype` (Kind 2).
#[derive(Clone, PartialEq, Debug)]
pub struct Constructor {
    /// Name of the constructor.
    pub name: Ident,
    /// Fields of the constructor; empty for a constructor without arguments.
    pub fields: Vec<VarDecl>,
}

/// Named value in the definition of an enum.
#[derive(Clone, PartialEq, Debug)]
pub struct EnumValue {
    /// Doc comment before the value.
    pub doc: Option<super::Doc>,
    /// Name of the value, with its place in the source.
    pub name: Ident,
}
