//! Expressions and calls.

use super::{Clock, Ident, Name, Number, Type, Unit, VarDecl};
use crate::ops::{BinaryOp, UnaryOp};
use rpi_diag::Span;

/// Expression of the language with its place in the source.
#[derive(Clone, PartialEq, Debug)]
pub struct Expr {
    /// Form of the expression, with its operands.
    pub kind: ExprKind,
    /// Source range.
    pub span: Span,
}

/// Kind of an [`Expr`]. The size is kept at 24 bytes: larger contents are boxed.
#[derive(Clone, PartialEq, Debug)]
pub enum ExprKind {
    /// `true`, `false`
    Bool(bool),
    /// `3`, `0x1F`, `2.5`
    Number(Number),
    /// `250[mm/s]`, `60%`
    Quantity(Box<Quantity>),
    /// `"text"`, without quotes and with escapes resolved
    Str(Name),
    /// `x`, `Core::Pi`: a flow, constant, enum value, result, device, ...
    Name(Name),
    /// `way.pose`
    Field(Box<Field>),
    /// `a[i]`
    Index(Box<Index>),
    /// `a[1..6 step 2]`
    Slice(Box<SliceExpr>),
    /// `x[7:0]` (Kind 2)
    BitRange(Box<BitRange>),
    /// `not x`, `pre x`
    Unary(UnaryOp, Box<Expr>),
    /// `x + y`, `x -> y`, `x fby y`, `x ?? y`
    Binary(Box<Binary>),
    /// `x when c`
    When(Box<WhenExpr>),
    /// `if c then x else y`, `with c then x else y`
    If(Box<IfExpr>),
    /// `f<<n: 3>>(x, y: z)`, also with `activate` and `restart`
    Call(Box<Call>),
    /// `#(a, b, c)`, `nor(a, b, c)`
    BoolList(BoolListOp, Box<[Expr]>),
    /// Merge of flows with complementary clocks: `merge c (A -> x) (B -> y)`
    Merge(Box<Merge>),
    /// `(x)`: kept, so that formatting preserves redundant parentheses
    Paren(Box<Expr>),
    /// `()`, `(x, y)`: none or at least two elements
    Tuple(Box<[Expr]>),
    /// `[x, y]`
    Array(Box<[Expr]>),
    /// `T{x = 1; y = 2}`, `T{s with x = 1}`
    Struct(Box<StructExpr>),
    /// `(a with [2] = x; .f[1] = y)`
    Update(Box<Update>),
    /// `forall (x: int) x > y`, `exists (x: int) x > y` (Kind 2)
    Quantified(Box<Quantified>),
    /// `(x: T)` (Kind 2)
    Ascription(Box<Ascription>),
    /// `A?(x)` (Kind 2)
    ConstructorTest(Box<ConstructorTest>),
    /// `match x with A: 1 | B(n): n end` (Kind 2)
    Match(Box<Match>),
    /// `{}@<T>` (Kind 2)
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

    /// Returns the name if the expression is a plain reference to a name.
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
    /// Unit of measure.
    pub unit: Unit,
}

/// Field access: `base.field`.
#[derive(Clone, PartialEq, Debug)]
pub struct Field {
    /// Struct, device or call that has the field.
    pub base: Expr,
    /// Name of the field, port or result.
    pub field: Ident,
}

/// Array access: `base[index]`.
#[derive(Clone, PartialEq, Debug)]
pub struct Index {
    /// Array.
    pub base: Expr,
    /// Index of the element, from 0.
    pub index: Expr,
}

/// Slice of an array: `base[from..to step s]`.
#[derive(Clone, PartialEq, Debug)]
pub struct SliceExpr {
    /// Array.
    pub base: Expr,
    /// Selected elements.
    pub slice: SliceBounds,
}

/// Bit range of a machine integer: `base[high:low]`, both ends included (Kind 2).
#[derive(Clone, PartialEq, Debug)]
pub struct BitRange {
    /// Machine integer.
    pub base: Expr,
    /// Highest selected bit.
    pub high: Expr,
    /// Lowest selected bit.
    pub low: Expr,
}

/// Bounds of a slice: `from..to step s`, both ends included.
#[derive(Clone, PartialEq, Debug)]
pub struct SliceBounds {
    /// Index of the first element.
    pub from: Expr,
    /// Index of the last element.
    pub to: Expr,
    /// Step between indices; 1 if absent.
    pub step: Option<Expr>,
}

/// Binary operation: `lhs op rhs`.
#[derive(Clone, PartialEq, Debug)]
pub struct Binary {
    /// Operator.
    pub op: BinaryOp,
    /// Source range of the operator.
    pub op_span: Span,
    /// Left operand.
    pub lhs: Expr,
    /// Right operand.
    pub rhs: Expr,
}

/// Sampled expression: `value when clock`.
#[derive(Clone, PartialEq, Debug)]
pub struct WhenExpr {
    /// Sampled value.
    pub value: Expr,
    /// Clock of the samples.
    pub clock: Clock,
}

/// Conditional expression: `if condition then yes else no`.
#[derive(Clone, PartialEq, Debug)]
pub struct IfExpr {
    /// Whether the expression is written `with` instead of `if`: the condition is evaluated at compile time, and the
    /// other branch is not elaborated.
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
    /// Called unit.
    pub callee: Callee,
    /// Condition under which the callee runs.
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

/// Condition under which the callee of a [`Call`] runs.
#[derive(Clone, PartialEq, Debug)]
pub enum Activation {
    /// `f(x)`: whenever the call is active.
    Always,
    /// `(activate f every c initial default d)(x)`: if `every` holds. The result is `default` before the first
    /// activation.
    Activate {
        /// Condition.
        every: Expr,
        /// `restart every e`: condition that resets the callee.
        restart: Option<Expr>,
        /// Value before the first activation.
        default: Option<Expr>,
    },
    /// `(restart f every c)(x)`: always. The callee is reset if `every` holds.
    Restart {
        /// Condition.
        every: Expr,
    },
}

/// Argument, positional or named: `x`, `speed: 3`.
#[derive(Clone, PartialEq, Debug)]
pub struct Arg {
    /// Name of the parameter; absent for a positional argument.
    pub name: Option<Ident>,
    /// Value.
    pub value: Expr,
}

/// Static argument, between `<<` and `>>`.
#[derive(Clone, PartialEq, Debug)]
pub struct StaticArg {
    /// Name of the parameter; absent for a positional argument.
    pub name: Option<Ident>,
    /// Value of the argument.
    pub value: StaticValue,
    /// Source range.
    pub span: Span,
}

/// Value of a [`StaticArg`].
#[derive(Clone, PartialEq, Debug)]
pub enum StaticValue {
    /// Expression; a plain name may also denote a type or a node.
    Expr(Expr),
    /// Type that is not a plain name: `int`, `real[m]`, `bool^3`.
    Type(Type),
    /// Operator: `+`, `and`, `if`.
    Op(StaticOp),
    /// Node with static arguments: `f<<3>>`.
    Callee(Callee),
}

/// Operator passed as a node.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum StaticOp {
    /// `not`, `pre`
    Unary(UnaryOp),
    /// `+`, `and`
    Binary(BinaryOp),
    /// `if`
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
    /// Selecting flow: a plain name in Lustre V6, any expression in `merge(c; x; y)`.
    pub selector: Expr,
    /// Cases in text order.
    pub cases: Vec<MergeCase>,
}

/// Case of a merge: `(A -> x)`.
#[derive(Clone, PartialEq, Debug)]
pub struct MergeCase {
    /// Value of the selecting flow: an enum value, `true` or `false`.
    pub value: Ident,
    /// Value of the merge in this case.
    pub then: Expr,
}

/// Quantified condition: `forall (vars) condition` (Kind 2).
#[derive(Clone, PartialEq, Debug)]
pub struct Quantified {
    /// Whether the quantifier is `forall`, not `exists`.
    pub is_forall: bool,
    /// Bound variables.
    pub vars: Vec<VarDecl>,
    /// Quantified condition.
    pub condition: Expr,
}

/// Type ascription: `(value: ty)` (Kind 2).
#[derive(Clone, PartialEq, Debug)]
pub struct Ascription {
    /// Value.
    pub value: Expr,
    /// Ascribed type.
    pub ty: Type,
}

/// Constructor test: `constructor?(value)` (Kind 2).
#[derive(Clone, PartialEq, Debug)]
pub struct ConstructorTest {
    /// Tested constructor.
    pub constructor: Ident,
    /// Value of the datatype.
    pub value: Expr,
}

/// Match expression: `match value with arms end` (Kind 2).
#[derive(Clone, PartialEq, Debug)]
pub struct Match {
    /// Matched value.
    pub value: Expr,
    /// Arms in text order, at least one.
    pub arms: Vec<Arm>,
}

/// Arm of a match expression: `A(x, y): then`.
#[derive(Clone, PartialEq, Debug)]
pub struct Arm {
    /// Pattern of the arm.
    pub pattern: Pattern,
    /// Value if the pattern matches.
    pub then: Expr,
}

/// Pattern of a value of a datatype: `A(x, B(y))`.
#[derive(Clone, PartialEq, Debug)]
pub struct Pattern {
    /// Constructor; `_` or any other name matches every value.
    pub name: Ident,
    /// Patterns of the fields.
    pub parts: Vec<Pattern>,
}

impl Pattern {
    /// Returns all names in the pattern, constructors included.
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
    /// Struct type.
    pub ty: Ident,
    /// Static arguments: `T@<int>{x = 1}`.
    pub statics: Vec<StaticArg>,
    /// Struct that supplies the other fields.
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
    /// Value before the update.
    pub base: Expr,
    /// Changes, at least one, applied in text order.
    pub changes: Vec<Change>,
    /// Whether the update is written `base[0 := x]` (Kind 2): each path is one index. For a struct, the index is the
    /// name of a field.
    pub is_keyed: bool,
}

/// Change of one part: `.f[1] = y`.
#[derive(Clone, PartialEq, Debug)]
pub struct Change {
    /// Path to the part, at least one step.
    pub path: Vec<Access>,
    /// New value of the part.
    pub value: Expr,
}

/// Step of a path into a value.
#[derive(Clone, PartialEq, Debug)]
pub enum Access {
    /// `.f`
    Field(Ident),
    /// `[i]`
    Index(Expr),
    /// `[1..3]`
    Slice(Box<SliceBounds>),
}
