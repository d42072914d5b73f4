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

/// Expression of a unit after type checking, with its operands as indices of other expressions.
#[derive(Clone, PartialEq, Debug)]
pub struct Expr {
    /// Kind of the expression, with its operands.
    pub kind: TypedKind,
    /// Type of the expression's value.
    pub ty: Ty,
    /// Location of the expression in the source.
    pub span: Span,
}

/// Kind of a typed expression, with its operands.
#[derive(Clone, PartialEq, Debug)]
pub enum TypedKind {
    /// Expression with an error that has been reported.
    Error,
    /// Constant value, given by the values of its leaves (scalar parts).
    Const(Rc<[Leaf]>),
    /// Literal with a single leaf (scalar part).
    Literal(Leaf),
    /// The value `none`, which is always absent.
    None,
    /// Value that the program leaves open, such as `any` of Kind 2. At run time it is an input of the net.
    Arbitrary,
    /// Value of a flow of the unit in the current cycle.
    Flow(FlowId),
    /// Read of a sensor or status port of a device.
    Sensor {
        /// Expression that reads the device.
        device: ExprId,
        /// Index of the port among the ports of the device type.
        port: u32,
    },
    /// Part of an array, struct or tuple at a constant position: as many leaves (scalar parts) as the type has, from
    /// leaf `at` on.
    Part {
        /// Array, struct or tuple that contains the part.
        base: ExprId,
        /// Index of the first leaf (scalar part) of the part.
        at: u32,
    },
    /// Slice of an array: elements at a constant distance from one another.
    Slice {
        /// Array from which the elements are taken.
        base: ExprId,
        /// Index of the first element, from 0.
        from: u32,
        /// Difference of the indices of successive elements; may be negative.
        step: i32,
    },
    /// Element of an array at an index that is computed at run time.
    Select {
        /// Array from which the element is taken.
        base: ExprId,
        /// Index of the selected element, counted from 0.
        index: ExprId,
    },
    /// Tuple, struct or array, built from its parts.
    Build(Box<[ExprId]>),
    /// Array of equal elements, as many as its type states.
    Repeat(ExprId),
    /// Array, struct or tuple of which a part is replaced: the leaves (scalar parts) from `at` on.
    Replace {
        /// Array, struct or tuple before the replacement.
        base: ExprId,
        /// Index of the first leaf (scalar part) that is replaced.
        at: u32,
        /// New value of the replaced part.
        value: ExprId,
    },
    /// Operator that is applied separately to each leaf (scalar part) of its operands.
    Each(ElementwiseOp, Box<[ExprId]>),
    /// Comparison `x = y` or `x <> y` of values of any type.
    Equal {
        /// Left and right operand.
        operands: [ExprId; 2],
        /// Whether the operator is `<>` (not equal).
        negated: bool,
    },
    /// `present(x)`: whether the operand has a value in this cycle.
    Present(ExprId),
    /// Call of a primitive (basic operation) of the registry.
    Prim(Box<PrimCall>),
    /// Call of a function, node or fragment.
    Call(Box<Call>),
    /// `x when c`: the operand sampled at a clock.
    When {
        /// Expression that is sampled.
        value: ExprId,
        /// Clock of the result: a flow, and its value in the cycles in which the result has a value.
        clock: DeclaredClock,
    },
    /// `merge c (...)`: the value of the case for the current value of `c`. In each cycle, exactly one case is present.
    Merge {
        /// Expression, usually a flow, whose value selects the case.
        on: ExprId,
        /// Cases, each with the number of the value that selects it: 0 or 1 for a Boolean, an index for an enum.
        cases: Box<[(u32, ExprId)]>,
    },
    /// `current x`: the latest value of a sampled operand.
    Current(ExprId),
}

/// Operator that works separately on each leaf (scalar part) of its operands. It is implemented by one primitive for
/// each machine type.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum ElementwiseOp {
    /// `if c then x else y`, with the condition as the first operand.
    If,
    /// `pre x`: the value of the previous cycle.
    Pre,
    /// `last x`: the value of the previous cycle, delayed in the block that defines `x`, not in the state of an
    /// automaton that reads it.
    Last,
    /// `x -> y`: `x` in the first cycle, `y` afterwards.
    Arrow,
    /// `x ?? y`: `x` where it is present, else `y`.
    Coalesce,
    /// `hold(x, init)`: the latest present value of `x`; `init` before the first one.
    Hold,
}

/// Call of a primitive (basic operation) of the registry, with its arguments.
#[derive(Clone, PartialEq, Debug)]
pub struct PrimCall {
    /// Primitive that is called.
    pub prim: PrimId,
    /// Arguments for the in-ports of the primitive; `None` for an in-port that is not connected.
    pub inputs: Box<[Option<ExprId>]>,
    /// Values of the parameters of the primitive; `None` for a default. They are constant once the parameters of the
    /// command are known.
    pub params: Box<[Option<ExprId>]>,
}

/// Call of a function, node or fragment, with arguments that have been checked.
#[derive(Clone, PartialEq, Debug)]
pub struct Call {
    /// Called unit, for the static arguments of the call.
    pub unit: UnitId,
    /// One argument for each entry of the unit's [`inputs`](crate::typed::Unit::inputs); `None` for an input that uses
    /// its default.
    pub args: Box<[Option<ExprId>]>,
    /// Cycles in which the called unit runs.
    pub activation: Activation,
}

/// Cycles in which a called unit runs, and cycles in which its state restarts.
#[derive(Clone, PartialEq, Debug)]
pub enum Activation {
    /// The unit runs in every cycle of the code that contains the call.
    Always,
    /// The unit runs while a condition holds. In other cycles, the result is that of its last run, or the default
    /// before the first run.
    Condact {
        /// Boolean expression; the unit runs in the cycles in which it is true.
        every: ExprId,
        /// Result before the first run; `None` if no default is given.
        default: Option<ExprId>,
        /// Condition under which the state of the unit restarts; `None` if it never restarts.
        restart: Option<ExprId>,
    },
    /// The unit runs in every cycle. Its state restarts in cycles in which a condition holds.
    Restart {
        /// Condition under which the state of the unit restarts.
        every: ExprId,
    },
}

impl TypedKind {
    /// Calls `visit` with every direct operand of the expression.
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
    /// Returns the result before the first run of the unit; `None` if no default is given.
    #[must_use]
    pub fn default(&self) -> Option<ExprId> {
        match self {
            Activation::Condact { default, .. } => *default,
            Activation::Always | Activation::Restart { .. } => None,
        }
    }

    /// Calls `visit` with every operand of the activation: its conditions and default.
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
