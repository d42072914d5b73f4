//! Typed expressions.

use crate::ty::Ty;
use crate::typed::DeclaredClock;
use crate::typed::ExprId;
use crate::typed::FlowId;
use crate::typed::Leaf;
use crate::typed::UnitId;
use rpi_diag::Span;
use rpi_prims::PrimId;
use std::rc::Rc;

/// Expression of a unit after type checking.
#[derive(Clone, Debug)]
pub struct Expr {
    /// Kind of the expression, with its operands.
    pub kind: TypedKind,
    /// Type of the expression's value.
    pub ty: Ty,
    /// Span of the expression.
    pub span: Span,
}

/// Kind of an expression, with its operands.
#[derive(Clone, Debug)]
pub enum TypedKind {
    /// Expression with an error that has been reported.
    Error,
    /// Constant value, leaf by leaf.
    Const(Rc<[Leaf]>),
    /// Literal with a single leaf.
    Literal(Leaf),
    /// The value `none`, which is always absent.
    None,
    /// Value that the program leaves open, such as `any` of Kind 2.
    Arbitrary,
    /// Read of a flow.
    Flow(FlowId),
    /// Read of a sensor or status port of a device.
    Sensor {
        /// Expression of the device.
        device: ExprId,
        /// Index of the port in the device type.
        port: u32,
    },
    /// Part of a composite value at a constant position: the leaves from `at` on.
    Part {
        /// Composite value.
        base: ExprId,
        /// Index of the first leaf.
        at: u32,
    },
    /// Elements of an array with a constant step.
    Slice {
        /// Array.
        base: ExprId,
        /// Index of the first element.
        from: u32,
        /// Distance between elements; may be negative.
        step: i32,
    },
    /// Element of an array at a computed index.
    Select {
        /// Array.
        base: ExprId,
        /// Index of the element, from 0.
        index: ExprId,
    },
    /// Tuple, struct or array, built from its parts.
    Build(Box<[ExprId]>),
    /// Array of equal elements.
    Repeat(ExprId),
    /// Composite value in which the leaves from `at` on are replaced.
    Replace {
        /// Composite value.
        base: ExprId,
        /// Index of the first replaced leaf.
        at: u32,
        /// New value of these leaves.
        value: ExprId,
    },
    /// Operator that is applied to each leaf of its operands separately.
    Each(ElementwiseOp, Box<[ExprId]>),
    /// `x = y` or `x <> y` on values of any type.
    Equal {
        /// Left and right operand.
        operands: [ExprId; 2],
        /// Whether the operator is `<>`.
        negated: bool,
    },
    /// `present(x)`
    Present(ExprId),
    /// Call of a registered primitive.
    Prim(Box<PrimCall>),
    /// Call of a unit.
    Call(Box<Call>),
    /// `x when c`
    When {
        /// Expression that is sampled.
        value: ExprId,
        /// Clock of the result: the condition and its value.
        clock: DeclaredClock,
    },
    /// `merge c (...)`: exactly one case is present in each cycle.
    Merge {
        /// Flow whose value selects the case.
        on: ExprId,
        /// Cases, each with the value of the selecting flow.
        cases: Box<[(u32, ExprId)]>,
    },
    /// `current x`
    Current(ExprId),
}

/// Operator that works on each leaf of its operands separately, and is implemented by one primitive per value type.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum ElementwiseOp {
    /// `if c then x else y`
    If,
    /// `pre x`
    Pre,
    /// `last x`, a delay in the block that defines x, not in the state that reads it.
    Last,
    /// `x -> y`
    Arrow,
    /// `x ?? y`
    Coalesce,
    /// `hold(x, init)`
    Hold,
}

/// Call of a registered primitive.
#[derive(Clone, Debug)]
pub struct PrimCall {
    /// The primitive that is called.
    pub prim: PrimId,
    /// Arguments of the inputs; `None` for an input that is not connected.
    pub inputs: Box<[Option<ExprId>]>,
    /// Values of the parameters; `None` for a default. Constant once the command's parameters are known.
    pub params: Box<[Option<ExprId>]>,
}

/// Call of a function, node or fragment, with checked arguments.
#[derive(Clone, Debug)]
pub struct Call {
    /// Called unit.
    pub unit: UnitId,
    /// One argument for each entry of [`inputs`](crate::typed::Unit::inputs); none for a default.
    pub args: Box<[Option<ExprId>]>,
    /// Activation of the call.
    pub activation: Activation,
}

/// Cycles in which a called unit runs.
#[derive(Clone, Debug)]
pub enum Activation {
    /// The unit runs in every cycle in which the call is reached.
    Always,
    /// The unit runs while a condition holds. Otherwise the result is that of its last run, or the default before the
    /// first run.
    Condact {
        /// Condition under which the unit runs.
        every: ExprId,
        /// Result before the first run.
        default: Option<ExprId>,
        /// Condition under which the state restarts.
        restart: Option<ExprId>,
    },
    /// The unit runs in every cycle. Its state restarts when a condition holds.
    Restart {
        /// Condition under which the state restarts.
        every: ExprId,
    },
}

impl TypedKind {
    /// Calls `visit` with every operand.
    pub fn operands(&self, visit: &mut impl FnMut(ExprId)) {
        match self {
            TypedKind::Error
            | TypedKind::Const(_)
            | TypedKind::Literal(_)
            | TypedKind::None
            | TypedKind::Arbitrary
            | TypedKind::Flow(_) => {}
            TypedKind::Sensor { device: one, .. }
            | TypedKind::Part { base: one, .. }
            | TypedKind::Slice { base: one, .. }
            | TypedKind::Repeat(one)
            | TypedKind::Present(one)
            | TypedKind::When { value: one, .. }
            | TypedKind::Current(one) => visit(*one),
            TypedKind::Select { base, index } => {
                [base, index].into_iter().for_each(|id| visit(*id))
            }
            TypedKind::Replace { base, value, .. } => {
                [base, value].into_iter().for_each(|id| visit(*id));
            }
            TypedKind::Build(parts) | TypedKind::Each(_, parts) => {
                parts.iter().for_each(|id| visit(*id))
            }
            TypedKind::Equal { operands, .. } => operands.iter().for_each(|id| visit(*id)),
            TypedKind::Prim(call) => {
                let operands = call.inputs.iter().chain(&call.params);
                operands.flatten().for_each(|id| visit(*id));
            }
            TypedKind::Call(call) => {
                call.args.iter().flatten().for_each(|id| visit(*id));
                call.activation.operands(visit);
            }
            TypedKind::Merge { on, cases } => {
                visit(*on);
                cases.iter().for_each(|(_, id)| visit(*id));
            }
        }
    }
}

impl Activation {
    /// Returns the result before the first run, if one is given.
    #[must_use]
    pub fn default(&self) -> Option<ExprId> {
        match self {
            Activation::Condact { default, .. } => *default,
            Activation::Always | Activation::Restart { .. } => None,
        }
    }

    /// Calls `visit` with every operand.
    pub fn operands(&self, visit: &mut impl FnMut(ExprId)) {
        match self {
            Activation::Always => {}
            Activation::Condact {
                every,
                default,
                restart,
            } => {
                visit(*every);
                default.iter().chain(restart).for_each(|id| visit(*id));
            }
            Activation::Restart { every } => visit(*every),
        }
    }
}
