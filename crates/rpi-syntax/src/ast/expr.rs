//! Expressions and calls.

use super::{Clock, Ident, Name, Number, Type, Unit, VarDecl};
use crate::ops::{BinaryOp, UnaryOp};
use rpi_diag::Span;

/// An expression.
#[derive(Clone, PartialEq, Debug)]
pub struct Expr {
    /// What it is.
    pub kind: ExprKind,
    /// All of it.
    pub span: Span,
}

/// The kinds of expressions. Kept at 24 bytes: what is larger is boxed.
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
    Slice(Box<SliceOf>),
    /// `x[7:0]` (Kind 2)
    Bits(Box<Bits>),
    /// `not x`, `pre x`
    Unary(UnaryOp, Box<Expr>),
    /// `x + y`, `x -> y`, `x fby y`, `x ?? y`
    Binary(Box<Binary>),
    /// `x when c`
    When(Box<When>),
    /// `if c then x else y`, `with c then x else y`
    If(Box<If>),
    /// `f<<n: 3>>(x, y: z)`, also by `activate` and `restart`
    Call(Box<Call>),
    /// `#(a, b, c)`, `nor(a, b, c)`
    Among(Among, Box<[Expr]>),
    /// `merge c (A -> x) (B -> y)`
    Merge(Box<Merge>),
    /// `(x)`: kept, so that a reader's parentheses survive formatting
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
    Ascribed(Box<Ascribed>),
    /// `A?(x)` (Kind 2)
    IsA(Box<IsA>),
    /// `match x with A: 1 | B(n): n end` (Kind 2)
    Match(Box<Match>),
    /// `{}@<T>` (Kind 2)
    EmptySet(Box<[StaticArg]>),
}

impl Expr {
    /// The expression without the parentheses around it.
    pub fn unparen(&self) -> &Expr {
        let mut expr = self;
        while let ExprKind::Paren(inner) = &expr.kind {
            expr = inner;
        }
        expr
    }

    /// The name, if the expression is nothing but a name.
    pub fn as_name(&self) -> Option<&Name> {
        match &self.kind {
            ExprKind::Name(name) => Some(name),
            _ => None,
        }
    }
}

/// `250[mm/s]`
#[derive(Clone, PartialEq, Debug)]
pub struct Quantity {
    /// The number before the unit.
    pub number: Number,
    /// The unit that it counts.
    pub unit: Unit,
}

/// `base.field`
#[derive(Clone, PartialEq, Debug)]
pub struct Field {
    /// What has the field.
    pub base: Expr,
    /// The field, port or result.
    pub field: Ident,
}

/// `base[index]`
#[derive(Clone, PartialEq, Debug)]
pub struct Index {
    /// The array.
    pub base: Expr,
    /// Which element, from 0.
    pub index: Expr,
}

/// `base[from..to step s]`
#[derive(Clone, PartialEq, Debug)]
pub struct SliceOf {
    /// The array.
    pub base: Expr,
    /// Which elements.
    pub slice: Slice,
}

/// `base[high:low]`, both ends included.
#[derive(Clone, PartialEq, Debug)]
pub struct Bits {
    /// The machine integer.
    pub base: Expr,
    /// The highest bit that is taken.
    pub high: Expr,
    /// The lowest.
    pub low: Expr,
}

/// `from..to step s`, both ends included.
#[derive(Clone, PartialEq, Debug)]
pub struct Slice {
    /// First element.
    pub from: Expr,
    /// Last element.
    pub to: Expr,
    /// Distance, 1 if absent.
    pub step: Option<Expr>,
}

/// `lhs op rhs`
#[derive(Clone, PartialEq, Debug)]
pub struct Binary {
    /// The operator.
    pub op: BinaryOp,
    /// Where the operator stands.
    pub op_span: Span,
    /// Left operand.
    pub lhs: Expr,
    /// Right operand.
    pub rhs: Expr,
}

/// `value when clock`
#[derive(Clone, PartialEq, Debug)]
pub struct When {
    /// What is sampled.
    pub value: Expr,
    /// When.
    pub clock: Clock,
}

/// `if condition then yes else no`
#[derive(Clone, PartialEq, Debug)]
pub struct If {
    /// `with` instead of `if`: decided at compile time, the other branch is not elaborated.
    pub is_static: bool,
    /// The condition.
    pub condition: Expr,
    /// Value if it holds.
    pub yes: Expr,
    /// Value if it does not.
    pub no: Expr,
}

/// A call of a node, function, fragment, primitive or predeclared operator.
#[derive(Clone, PartialEq, Debug)]
pub struct Call {
    /// What is called.
    pub callee: Callee,
    /// When it runs.
    pub activation: Activation,
    /// Its arguments.
    pub args: Vec<Arg>,
}

/// `f`, `Core::Clock<<Increment: 1.0>>`
#[derive(Clone, PartialEq, Debug)]
pub struct Callee {
    /// What is called or passed.
    pub name: Ident,
    /// Its static arguments.
    pub statics: Vec<StaticArg>,
    /// Name and static arguments.
    pub span: Span,
}

/// When the callee of a [`Call`] runs.
#[derive(Clone, PartialEq, Debug)]
pub enum Activation {
    /// `f(x)`: whenever the call is reached.
    Always,
    /// `(activate f every c initial default d)(x)`: when `every` holds; `default` before the first time.
    Activate {
        /// The condition.
        every: Expr,
        /// `restart every e`: the state starts afresh when this holds.
        restart: Option<Expr>,
        /// The value before the first activation.
        default: Option<Expr>,
    },
    /// `(restart f every c)(x)`: always, afresh when `every` holds.
    Restart {
        /// The condition.
        every: Expr,
    },
}

/// An argument, by place or by name: `x`, `speed: 3`.
#[derive(Clone, PartialEq, Debug)]
pub struct Arg {
    /// The parameter, if named.
    pub name: Option<Ident>,
    /// The value.
    pub value: Expr,
}

/// An argument between `<<` and `>>`.
#[derive(Clone, PartialEq, Debug)]
pub struct StaticArg {
    /// The parameter, if named.
    pub name: Option<Ident>,
    /// The argument.
    pub value: StaticValue,
    /// All of it.
    pub span: Span,
}

/// What a static argument can be.
#[derive(Clone, PartialEq, Debug)]
pub enum StaticValue {
    /// A value; a plain name may also be a type or a node.
    Expr(Expr),
    /// A type that is no plain name: `int`, `real[m]`, `bool^3`.
    Type(Type),
    /// An operator: `+`, `and`, `if`.
    Op(StaticOp),
    /// A node with static arguments of its own: `f<<3>>`.
    Callee(Callee),
}

/// An operator that is passed as a node.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum StaticOp {
    /// `not`, `pre`
    Unary(UnaryOp),
    /// `+`, `and`
    Binary(BinaryOp),
    /// `if`
    If,
}

/// Operators over any number of Booleans.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Among {
    /// `#(...)`: at most one is true.
    AtMostOne,
    /// `nor(...)`: none is true.
    Nor,
}

/// `merge on cases`
#[derive(Clone, PartialEq, Debug)]
pub struct Merge {
    /// The flow that chooses; a plain name in Lustre V6, any expression in `merge(c; x; y)`.
    pub on: Expr,
    /// The cases in text order.
    pub cases: Vec<MergeCase>,
}

/// `(A -> x)`
#[derive(Clone, PartialEq, Debug)]
pub struct MergeCase {
    /// The value of the choosing flow: an enum value, `true`, `false`.
    pub value: Ident,
    /// What the merged flow is then.
    pub then: Expr,
}

/// `forall (vars) condition`
#[derive(Clone, PartialEq, Debug)]
pub struct Quantified {
    /// Whether it must hold for all, not only for some.
    pub for_all: bool,
    /// What is quantified over.
    pub vars: Vec<VarDecl>,
    /// What must hold.
    pub condition: Expr,
}

/// `(value: ty)`
#[derive(Clone, PartialEq, Debug)]
pub struct Ascribed {
    /// The value.
    pub value: Expr,
    /// The type that it is to have.
    pub ty: Type,
}

/// `constructor?(value)`
#[derive(Clone, PartialEq, Debug)]
pub struct IsA {
    /// The alternative that is asked for.
    pub constructor: Ident,
    /// Of this.
    pub value: Expr,
}

/// `match value with arms end`
#[derive(Clone, PartialEq, Debug)]
pub struct Match {
    /// What is taken apart.
    pub value: Expr,
    /// The alternatives in text order, at least one.
    pub arms: Vec<Arm>,
}

/// `A(x, y): then`
#[derive(Clone, PartialEq, Debug)]
pub struct Arm {
    /// What the value looks like.
    pub pattern: Pattern,
    /// The value in this case.
    pub then: Expr,
}

/// `A(x, B(y))`: what a value of a datatype, or a part of one, looks like.
#[derive(Clone, PartialEq, Debug)]
pub struct Pattern {
    /// An alternative; `_` or another name for any.
    pub name: Ident,
    /// What the parts of the alternative look like.
    pub parts: Vec<Pattern>,
}

impl Pattern {
    /// All names in the pattern, alternatives too.
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

/// `T{x = 1; y = 2}`, `T{s with x = 1}`
#[derive(Clone, PartialEq, Debug)]
pub struct StructExpr {
    /// The struct type.
    pub ty: Ident,
    /// Its static arguments: `T@<int>{x = 1}`.
    pub statics: Vec<StaticArg>,
    /// Where the other fields come from.
    pub base: Option<Expr>,
    /// The fields given.
    pub fields: Vec<FieldValue>,
}

/// `x = 1` in a struct expression.
#[derive(Clone, PartialEq, Debug)]
pub struct FieldValue {
    /// The field.
    pub field: Ident,
    /// Its value.
    pub value: Expr,
}

/// `(base with changes)`
#[derive(Clone, PartialEq, Debug)]
pub struct Update {
    /// What is changed.
    pub base: Expr,
    /// The changes, at least one, applied in text order.
    pub changes: Vec<Change>,
    /// Whether it is written `base[0 := x]` (Kind 2): each path is one index; of a struct its name is a field's.
    pub is_keyed: bool,
}

/// `.f[1] = y`
#[derive(Clone, PartialEq, Debug)]
pub struct Change {
    /// Where in the value, at least one step.
    pub path: Vec<Access>,
    /// The new part.
    pub value: Expr,
}

/// One step into a value.
#[derive(Clone, PartialEq, Debug)]
pub enum Access {
    /// `.f`
    Field(Ident),
    /// `[i]`
    Index(Expr),
    /// `[1..3]`
    Slice(Box<Slice>),
}
