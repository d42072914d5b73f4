//! Expressions and calls.

use super::{Clock, Ident, Name, Number, Type, Unit, VarDecl};
use crate::ops::{BinaryOp, UnaryOp};
use rpi_diag::Span;

/// Expression of the language with its place in the source.
#[derive(Clone, PartialEq, Debug)]
pub struct Expr {
    /// Form of the expression, with its operands.
    pub kind: ExprKind,
    /// Range of the whole construct in the source text.
    pub span: Span,
}

/// Form of an [`Expr`]. The type has 24 bytes: larger contents are boxed.
#[derive(Clone, PartialEq, Debug)]
pub enum ExprKind {
    /// Boolean literal: `true`, `false`
    Bool(bool),
    /// Number literal without a unit: `3`, `0x1F`, `2.5`
    Number(Number),
    /// Number with a unit: `250[mm/s]`, `60%`
    Quantity(Box<Quantity>),
    /// String literal: `"text"`. The content has no quotes, and its escapes are resolved.
    Str(Name),
    /// Reference to a flow, constant, enum value, result or device: `x`, `Core::Pi`
    Name(Name),
    /// Field of a struct, port of a device or result of a call: `way.pose`
    Field(Box<Field>),
    /// Element of an array: `a[i]`
    Index(Box<Index>),
    /// Part of an array: `a[1..6 step 2]`
    Slice(Box<SliceExpr>),
    /// Range of bits of a machine integer: `x[7:0]` (Kind 2)
    BitRange(Box<BitRange>),
    /// Unary operation: `not x`, `pre x`
    Unary(UnaryOp, Box<Expr>),
    /// Binary operation: `x + y`, `x -> y`, `x fby y`, `x ?? y`
    Binary(Box<Binary>),
    /// Flow sampled by a clock: `x when c`
    When(Box<WhenExpr>),
    /// Conditional expression, evaluated at run time (`if c then x else y`) or at compile time (`with c then x else y`)
    If(Box<IfExpr>),
    /// Call: `f<<n: 3>>(x, y: z)`, also with `activate` and `restart`
    Call(Box<Call>),
    /// Operation on any number of Booleans: `#(a, b, c)`, `nor(a, b, c)`
    BoolList(BoolListOp, Box<[Expr]>),
    /// Merge of flows with complementary clocks: `merge c (A -> x) (B -> y)`
    Merge(Box<Merge>),
    /// Expression in parentheses: `(x)`. The node exists so that formatting preserves redundant parentheses.
    Paren(Box<Expr>),
    /// Tuple with no or at least two elements: `()`, `(x, y)`
    Tuple(Box<[Expr]>),
    /// Array of its elements: `[x, y]`
    Array(Box<[Expr]>),
    /// Struct value, or struct with some fields replaced: `T{x = 1; y = 2}`, `T{s with x = 1}`
    Struct(Box<StructExpr>),
    /// Copy of a value with some parts replaced: `(a with [2] = x; .f[1] = y)`
    Update(Box<Update>),
    /// Quantified condition: `forall (x: int) x > y`, `exists (x: int) x > y` (Kind 2)
    Quantified(Box<Quantified>),
    /// Expression with an explicit type: `(x: T)` (Kind 2)
    Ascription(Box<Ascription>),
    /// Test of whether a value was made by a constructor: `A?(x)` (Kind 2)
    ConstructorTest(Box<ConstructorTest>),
    /// Case distinction over constructors: `match x with A: 1 | B(n): n end` (Kind 2)
    Match(Box<Match>),
    /// Empty set with its element type: `{}@<T>` (Kind 2)
    EmptySet(Box<[StaticArg]>),
}

impl Expr {
    /// Returns the expression without enclosing parentheses.
    pub fn unparen(&self) -> &Expr {
        let mut expr = self;
        while let ExprKind::Paren(inner) = &expr.kind {
            expr = inner;
        }
        expr
    }

    /// Returns the name if the expression is a plain or qualified name; `None` otherwise.
    pub fn as_name(&self) -> Option<&Name> {
        match &self.kind {
            ExprKind::Name(name) => Some(name),
            _ => None,
        }
    }
}

/// Number with a unit: `250[mm/s]`.
#[derive(Clone, PartialEq, Debug)]
pub struct Quantity {
    /// Number before the unit.
    pub number: Number,
    /// Unit of measure of the number.
    pub unit: Unit,
}

/// Field access: `base.field`.
#[derive(Clone, PartialEq, Debug)]
pub struct Field {
    /// Struct, device or call that has the field.
    pub base: Expr,
    /// Name of the field of a struct, of the port of a device, or of the result of a call.
    pub field: Ident,
}

/// Array access: `base[index]`.
#[derive(Clone, PartialEq, Debug)]
pub struct Index {
    /// Array whose element is read.
    pub base: Expr,
    /// Index of the element, from 0.
    pub index: Expr,
}

/// Slice of an array: `base[from..to step s]`.
#[derive(Clone, PartialEq, Debug)]
pub struct SliceExpr {
    /// Array of which a part is read.
    pub base: Expr,
    /// Bounds and step of the selected indices.
    pub slice: SliceBounds,
}

/// Bit range of a machine integer: `base[high:low]`, both ends included (Kind 2).
#[derive(Clone, PartialEq, Debug)]
pub struct BitRange {
    /// Machine integer whose bits are selected.
    pub base: Expr,
    /// Index of the highest selected bit, counted from 0.
    pub high: Expr,
    /// Index of the lowest selected bit, counted from 0.
    pub low: Expr,
}

/// Bounds of a slice: `from..to step s`, both ends included.
#[derive(Clone, PartialEq, Debug)]
pub struct SliceBounds {
    /// Index of the first element, from 0.
    pub from: Expr,
    /// Index of the last element, which is part of the slice.
    pub to: Expr,
    /// Step between indices; 1 if absent.
    pub step: Option<Expr>,
}

/// Binary operation: `lhs op rhs`.
#[derive(Clone, PartialEq, Debug)]
pub struct Binary {
    /// Operator of the operation.
    pub op: BinaryOp,
    /// Source range of the operator.
    pub op_span: Span,
    /// Operand on the left of the operator.
    pub lhs: Expr,
    /// Operand on the right of the operator.
    pub rhs: Expr,
}

/// Sampled expression, `value when clock`: the flow has a value only in the cycles in which its clock ticks.
#[derive(Clone, PartialEq, Debug)]
pub struct WhenExpr {
    /// Expression that is sampled.
    pub value: Expr,
    /// Clock of the samples.
    pub clock: Clock,
}

/// Conditional expression: `if condition then yes else no`.
#[derive(Clone, PartialEq, Debug)]
pub struct IfExpr {
    /// Whether the expression is written `with` instead of `if`: the condition is evaluated at compile time, and only
    /// the selected branch is compiled.
    pub is_static: bool,
    /// Boolean expression that chooses between the alternatives.
    pub condition: Expr,
    /// Value if the condition is true.
    pub then_value: Expr,
    /// Value if the condition is false.
    pub else_value: Expr,
}

/// Call of a node, function, fragment, primitive or predeclared operator.
#[derive(Clone, PartialEq, Debug)]
pub struct Call {
    /// Name and static arguments of the called node, function, fragment, primitive or operator.
    pub callee: Callee,
    /// Conditions under which the callee runs or is reset.
    pub activation: Activation,
    /// Arguments in parentheses, in text order.
    pub args: Vec<Arg>,
}

/// Callee of a call, or a node passed as a static argument: `f`, `Core::Clock<<Increment: 1.0>>`.
#[derive(Clone, PartialEq, Debug)]
pub struct Callee {
    /// Name of the called or passed unit.
    pub name: Ident,
    /// Arguments between `<<` and `>>`: types, constants and nodes.
    pub statics: Vec<StaticArg>,
    /// Source range of name and static arguments.
    pub span: Span,
}

/// Conditions under which the callee of a [`Call`] runs or is reset.
#[derive(Clone, PartialEq, Debug)]
pub enum Activation {
    /// The callee runs in every cycle in which the call is evaluated: `f(x)`.
    Always,
    /// The callee runs only if `every` is true: `(activate f every c initial default d)(x)`. The result is `default`
    /// before the first run.
    Activate {
        /// Boolean condition; the callee runs in the cycles in which it is true.
        every: Expr,
        /// Boolean condition that resets the callee to its initial state, `restart every e`; absent if not written.
        restart: Option<Expr>,
        /// Result before the callee runs for the first time; absent if not written.
        default: Option<Expr>,
    },
    /// The callee runs in every cycle, and starts from its initial state if `every` is true: `(restart f every c)(x)`.
    Restart {
        /// Boolean condition; the callee is reset in the cycles in which it is true.
        every: Expr,
    },
}

/// Argument, positional or named: `x`, `speed: 3`.
#[derive(Clone, PartialEq, Debug)]
pub struct Arg {
    /// Name of the parameter; absent for a positional argument.
    pub name: Option<Ident>,
    /// Expression that is passed.
    pub value: Expr,
}

/// Static argument, between `<<` and `>>`.
#[derive(Clone, PartialEq, Debug)]
pub struct StaticArg {
    /// Name of the parameter; absent for a positional argument.
    pub name: Option<Ident>,
    /// Type, value, operator or node that is passed.
    pub value: StaticValue,
    /// Range of the whole construct in the source text.
    pub span: Span,
}

/// Value of a [`StaticArg`]: an expression, type, operator or node.
#[derive(Clone, PartialEq, Debug)]
pub enum StaticValue {
    /// Expression; a plain name may also denote a type or a node.
    Expr(Expr),
    /// Type that is not a plain name: `int`, `real[m]`, `bool^3`.
    Type(Type),
    /// Operator that is passed as a node: `+`, `and`, `if`.
    Op(StaticOp),
    /// Node with static arguments that is passed: `f<<3>>`.
    Callee(Callee),
}

/// Operator that is passed as a static argument in place of a node.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum StaticOp {
    /// Unary operator: `not`, `pre`
    Unary(UnaryOp),
    /// Binary operator: `+`, `and`
    Binary(BinaryOp),
    /// Conditional operator `if`, with a condition and two alternatives as arguments.
    If,
}

/// Operator over any number of Booleans.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum BoolListOp {
    /// `#(...)`: at most one is true.
    AtMostOne,
    /// `nor(...)`: none is true.
    Nor,
}

/// Merge of flows with complementary clocks: `merge on cases`.
#[derive(Clone, PartialEq, Debug)]
pub struct Merge {
    /// Flow whose value selects the case: a plain name in Lustre V6, any expression in `merge(c; x; y)`.
    pub selector: Expr,
    /// Cases in text order, one for each value of the selecting flow.
    pub cases: Vec<MergeCase>,
}

/// Case of a merge: `(A -> x)`.
#[derive(Clone, PartialEq, Debug)]
pub struct MergeCase {
    /// Value of the selecting flow for which the case applies: an enum value, `true` or `false`.
    pub value: Ident,
    /// Value of the merge if the case applies.
    pub then: Expr,
}

/// Quantified condition: `forall (vars) condition` (Kind 2).
#[derive(Clone, PartialEq, Debug)]
pub struct Quantified {
    /// Whether the quantifier is `forall`, not `exists`.
    pub is_forall: bool,
    /// Variables that the quantifier binds, with their types.
    pub vars: Vec<VarDecl>,
    /// Condition that must hold for all values of the bound variables (`forall`) or for some (`exists`).
    pub condition: Expr,
}

/// Type ascription: `(value: ty)` (Kind 2).
#[derive(Clone, PartialEq, Debug)]
pub struct Ascription {
    /// Expression whose type is stated.
    pub value: Expr,
    /// Type that the expression must have.
    pub ty: Type,
}

/// Constructor test: `constructor?(value)` (Kind 2).
#[derive(Clone, PartialEq, Debug)]
pub struct ConstructorTest {
    /// Constructor with which the value must have been made.
    pub constructor: Ident,
    /// Value of a datatype that is tested.
    pub value: Expr,
}

/// Match expression: `match value with arms end` (Kind 2).
#[derive(Clone, PartialEq, Debug)]
pub struct Match {
    /// Value of an algebraic data type that the patterns are compared with.
    pub value: Expr,
    /// Arms in text order, at least one. The first arm whose pattern matches gives the value.
    pub arms: Vec<Arm>,
}

/// Arm of a match expression: `A(x, y): then`.
#[derive(Clone, PartialEq, Debug)]
pub struct Arm {
    /// Pattern that a value must match so that the arm applies.
    pub pattern: Pattern,
    /// Value of the match expression if the arm applies.
    pub then: Expr,
}

/// Pattern of a value of a datatype: `A(x, B(y))`.
#[derive(Clone, PartialEq, Debug)]
pub struct Pattern {
    /// Constructor that the value must have; `_` or any other name matches every value.
    pub name: Ident,
    /// Patterns of the fields of the constructor, in order.
    pub parts: Vec<Pattern>,
}

impl Pattern {
    /// Returns all names in the pattern and its nested patterns, including the names of constructors.
    pub fn names(&self) -> Vec<&Ident> {
        let mut all = vec![self];
        let mut at = 0;
        while let Some(pattern) = all.get(at).copied() {
            all.extend(&pattern.parts);
            at += 1;
        }
        all.into_iter().map(|pattern| &pattern.name).collect()
    }
}

/// Struct expression: `T{x = 1; y = 2}`, `T{s with x = 1}`.
#[derive(Clone, PartialEq, Debug)]
pub struct StructExpr {
    /// Name of the struct type.
    pub ty: Ident,
    /// Static arguments: `T@<int>{x = 1}`.
    pub statics: Vec<StaticArg>,
    /// Struct from which all fields without explicit values are copied; absent in `T{x = 1}`.
    pub base: Option<Expr>,
    /// Fields with explicit values.
    pub fields: Vec<FieldValue>,
}

/// Field of a struct expression: `x = 1`.
#[derive(Clone, PartialEq, Debug)]
pub struct FieldValue {
    /// Name of the field.
    pub field: Ident,
    /// Value of the field.
    pub value: Expr,
}

/// Update of parts of a value: `(base with changes)`.
#[derive(Clone, PartialEq, Debug)]
pub struct Update {
    /// Value whose parts are replaced.
    pub base: Expr,
    /// Changes, at least one, applied in text order.
    pub changes: Vec<Change>,
    /// Whether the update is written `base[0 := x]` (Kind 2). Then each path is one index; for a struct, the index is
    /// the name of a field.
    pub is_keyed: bool,
}

/// Replacement of one part in an [`Update`]: `.f[1] = y`.
#[derive(Clone, PartialEq, Debug)]
pub struct Change {
    /// Path to the replaced part, at least one step.
    pub path: Vec<Access>,
    /// New value of the part.
    pub value: Expr,
}

/// Step of a path into a value: a field, an index or a slice.
#[derive(Clone, PartialEq, Debug)]
pub enum Access {
    /// Field of a struct: `.f`
    Field(Ident),
    /// Element of an array: `[i]`
    Index(Expr),
    /// Part of an array: `[1..3]`
    Slice(Box<SliceBounds>),
}
