//! The typed program: every name resolved, every expression with its type, every operator a primitive.
//!
//! A [`Unit`] is one callable for one choice of static arguments, or a command. Units are checked once and inlined by
//! the elaboration wherever they are called. Expressions lie in one table per unit and are referred to by index, so
//! that passes keep what they find out in tables of their own beside it. This form must not know syntax or memory.

mod flow;
mod parts;
mod print;
mod task;
mod verify;

pub use flow::{ClockOn, Flow, FlowRole, Optional};
pub use print::print;
pub use task::{Handed, TaskStep};
pub use verify::verify;

use crate::ty::{DeviceTy, Ty};
use rpi_diag::Span;
use rpi_image::Value;
pub use rpi_net::ClaimKind;
use rpi_prims::PrimId;
use rpi_syntax::Name;
use std::rc::Rc;

/// Index of a unit in a checked program.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub struct UnitId(pub u32);

/// Index of a flow in [`Unit::flows`].
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub struct FlowId(pub u32);

/// Index of an expression in [`Unit::exprs`].
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub struct ExprId(pub u32);

/// Index of a block in [`Unit::blocks`]; 0 is the body itself.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub struct BlockId(pub u32);

impl BlockId {
    /// The body itself.
    pub const ROOT: BlockId = BlockId(0);
}

/// What a unit is.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum UnitKind {
    /// It has no state and is inlined; absent arguments make its results absent.
    Function,
    /// It is inlined, its state belongs to the caller's fragment.
    Node,
    /// A net of its own: one vertex in its caller.
    Fragment,
    /// The root of a net.
    Command,
    /// The root of a net whose claims are watched from outside.
    Test,
    /// Which command follows which.
    Task,
    /// An expression at the top of a module, or in a type.
    Constant,
}

impl UnitKind {
    /// Whether it is run and never called.
    #[must_use]
    pub fn is_root(self) -> bool {
        matches!(self, UnitKind::Command | UnitKind::Test | UnitKind::Task)
    }
}

/// A callable for one choice of static arguments.
#[derive(Clone, Debug)]
pub struct Unit {
    /// Its name with the static arguments that were chosen.
    pub name: Name,
    /// What it is.
    pub kind: UnitKind,
    /// Where its name stands.
    pub span: Span,
    /// All its flows, ports included.
    pub flows: Vec<Flow>,
    /// What a caller gives, in order: values fixed at load time, then in-ports, then what is taken over.
    pub inputs: Vec<FlowId>,
    /// What a caller gets.
    pub outputs: Vec<FlowId>,
    /// Its expressions.
    pub exprs: Vec<Expr>,
    /// Conditions of its `if`s that static parameters tell: for another choice of these they may be others. In order.
    pub chosen: Vec<ExprId>,
    /// Its body and the fragments and states in it, parents first.
    pub blocks: Vec<Block>,
    /// Whether it samples flows (`when`, `merge`, `current`).
    pub has_clocks: bool,
    /// Whether it remembers earlier cycles.
    pub has_state: bool,
    /// Whether its text is Lustre, where `current` is a plain value.
    pub is_lustre: bool,
    /// Frames that the signature names and no declaration does: each stands for the frame of the argument.
    pub free_frames: Vec<Name>,
    /// What the steps of a task run.
    pub steps: Vec<TaskStep>,
    /// How often a task repeats something, with the place of the number.
    pub counts: Vec<(Span, ExprId)>,
}

/// The body, a fragment in place, or a state of an automaton.
#[derive(Clone, Debug)]
pub struct Block {
    /// Its name; empty for the body.
    pub name: Name,
    /// The block around it; none for the body.
    pub parent: Option<BlockId>,
    /// When it is active; none: whenever its parent is.
    pub when: Option<ExprId>,
    /// Whether it starts afresh when it becomes active again.
    pub restart: bool,
    /// Stated budget in nanoseconds.
    pub budget_ns: Option<u64>,
    /// Whether it is a contract: nothing outside reads it, and it may be left out.
    pub is_contract: bool,
    /// Its equations, in text order.
    pub equations: Vec<Equation>,
    /// Conditions that are claimed to hold.
    pub claims: Vec<Claim>,
    /// How the command can end.
    pub ends: Vec<End>,
    /// What is made visible.
    pub exports: Vec<Export>,
    /// Its state machines.
    pub automata: Vec<Automaton>,
    /// Where it stands.
    pub span: Span,
}

/// `x, arm.tcp = e`
#[derive(Clone, Debug)]
pub struct Equation {
    /// What is defined, in order; together they take up all leaves of the value.
    pub targets: Vec<Target>,
    /// By what.
    pub value: ExprId,
    /// All of it.
    pub span: Span,
}

/// Something that an equation defines.
#[derive(Clone, Debug)]
pub struct Target {
    /// What.
    pub place: Place,
    /// Its type.
    pub ty: Ty,
    /// Where it stands.
    pub span: Span,
}

/// Where the value of an equation goes.
#[derive(Clone, PartialEq, Debug)]
pub enum Place {
    /// Leaves of a flow, from `at` on.
    Flow {
        /// The flow.
        flow: FlowId,
        /// The first leaf.
        at: u32,
    },
    /// An actuator port of a device.
    Port {
        /// The device.
        device: FlowId,
        /// Index of the port in its type.
        port: u32,
    },
    /// Nowhere, after a fault or for `_`.
    Nowhere,
}

/// A condition that is claimed to hold in every cycle.
#[derive(Clone, Debug)]
pub struct Claim {
    /// By whom it must hold.
    pub kind: ClaimKind,
    /// The condition.
    pub condition: ExprId,
    /// The mode of the contract whose `ensure` it is; the condition then says `require => ensure`.
    pub mode: Option<Name>,
    /// What it is about, in words.
    pub label: Option<Name>,
    /// Where it stands.
    pub span: Span,
}

/// `finish result when condition`
#[derive(Clone, Debug)]
pub struct End {
    /// How.
    pub kind: rpi_syntax::ast::EndKind,
    /// The result's name.
    pub result: Name,
    /// When.
    pub condition: ExprId,
    /// Where it stands.
    pub span: Span,
}

/// A flow that is made visible.
#[derive(Clone, Debug)]
pub struct Export {
    /// Its key.
    pub key: String,
    /// The flow.
    pub value: ExprId,
    /// Where it stands.
    pub span: Span,
}

/// A state machine. Its states are blocks.
#[derive(Clone, Debug)]
pub struct Automaton {
    /// The states; the first named is not always the initial one.
    pub states: Vec<State>,
    /// Index of the initial state.
    pub initial: u32,
    /// Flows that its states define, each with the flow of every state that defines it.
    pub shared: Vec<Shared>,
    /// Where it stands.
    pub span: Span,
}

/// A state.
#[derive(Clone, Debug)]
pub struct State {
    /// What runs in it; its conditions stand there, too.
    pub block: BlockId,
    /// Strong transitions, decided before it runs.
    pub unless: Vec<Transition>,
    /// Weak transitions, which act in the next cycle.
    pub until: Vec<Transition>,
}

/// A transition.
#[derive(Clone, Debug)]
pub struct Transition {
    /// When; none for `otherwise`.
    pub condition: Option<ExprId>,
    /// Whether the target resumes its state.
    pub resumes: bool,
    /// Index of the next state.
    pub target: u32,
    /// All of it.
    pub span: Span,
}

/// A flow that several states define.
#[derive(Clone, Debug)]
pub struct Shared {
    /// The flow as it is seen from outside.
    pub flow: FlowId,
    /// The flow inside each state that defines it, in the order of the states.
    pub states: Vec<FlowId>,
    /// States that may be active and do not define it: some of them if there are many.
    pub missing: Vec<BlockId>,
    /// What the flow is in states that do not define it: the flow of an equation beside the automaton. Without one it is
    /// absent there.
    pub default: Option<FlowId>,
}

impl Shared {
    /// All flows that contribute: those of the states, then the default.
    pub fn contributions(&self) -> impl Iterator<Item = FlowId> + '_ {
        self.states.iter().copied().chain(self.default)
    }

    /// Whether the flow may be absent because an active state does not define it.
    #[must_use]
    pub fn is_left_open(&self) -> bool {
        self.default.is_none() && !self.missing.is_empty()
    }
}

/// An expression.
#[derive(Clone, Debug)]
pub struct Expr {
    /// What it is.
    pub kind: Kind,
    /// Its type.
    pub ty: Ty,
    /// Where it stands.
    pub span: Span,
}

/// A leaf of a constant: a value or a text.
pub type Leaf = Value;

/// The kinds of expressions.
#[derive(Clone, Debug)]
pub enum Kind {
    /// A fault that has been reported.
    Fault,
    /// A constant, leaf by leaf.
    Const(Rc<[Leaf]>),
    /// A literal of one leaf.
    Literal(Leaf),
    /// `none`
    None,
    /// A value that the program leaves open.
    Outside,
    /// A flow.
    Flow(FlowId),
    /// A sensor or status port of a device.
    Sensor {
        /// The device.
        device: ExprId,
        /// Index of the port in its type.
        port: u32,
    },
    /// A part of a composite value that lies at a fixed place: the leaves from `at` on.
    Part {
        /// The composite.
        base: ExprId,
        /// First leaf.
        at: u32,
    },
    /// Elements of an array at fixed distances.
    Slice {
        /// The array.
        base: ExprId,
        /// First element.
        from: u32,
        /// Distance.
        step: i32,
    },
    /// An element of an array whose place is computed.
    Select {
        /// The array.
        base: ExprId,
        /// Which element, from 0.
        index: ExprId,
    },
    /// A composite value of its parts: tuple, struct, array; an array's parts may be one part for all elements.
    Build(Box<[ExprId]>),
    /// An array of equal elements.
    Repeat(ExprId),
    /// A composite value with the leaves from `at` on replaced.
    Replace {
        /// The composite.
        base: ExprId,
        /// First leaf.
        at: u32,
        /// The new part.
        value: ExprId,
    },
    /// An operator that works leaf by leaf.
    Each(Each, Box<[ExprId]>),
    /// `x = y`, `x <> y` on values of any type.
    Equal {
        /// The operands.
        operands: [ExprId; 2],
        /// Whether it asks for difference.
        negated: bool,
    },
    /// `present(x)`
    Present(ExprId),
    /// A registered primitive.
    Prim(Box<PrimCall>),
    /// A call of a unit.
    Call(Box<Call>),
    /// `x when c`
    When {
        /// What is sampled.
        value: ExprId,
        /// When.
        clock: ClockOn,
    },
    /// `merge c (...)`: exactly one case is on at a time.
    Merge {
        /// The flow that chooses.
        on: ExprId,
        /// The cases, by the chooser's value.
        cases: Box<[(u32, ExprId)]>,
    },
    /// `current x`
    Current(ExprId),
}

/// Operators that work leaf by leaf, by one primitive per value type.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Each {
    /// `if c then x else y`
    If,
    /// `pre x`
    Pre,
    /// `last x`: the delay stands where x is defined, not in the state that reads it
    Last,
    /// `x -> y`
    Arrow,
    /// `x ?? y`
    Coalesce,
    /// `hold(x, init)`
    Hold,
}

/// A registered primitive, called.
#[derive(Clone, Debug)]
pub struct PrimCall {
    /// Which.
    pub prim: PrimId,
    /// What each in-port reads; none: open.
    pub inputs: Box<[Option<ExprId>]>,
    /// What each parameter is; none: its default. Constants once the command's parameters are known.
    pub params: Box<[Option<ExprId>]>,
}

/// A call of a unit.
#[derive(Clone, Debug)]
pub struct Call {
    /// Which.
    pub unit: UnitId,
    /// One per entry of [`Unit::inputs`]; none: the default.
    pub args: Box<[Option<ExprId>]>,
    /// When it runs.
    pub activation: Activation,
}

/// When a called unit runs.
#[derive(Clone, Debug)]
pub enum Activation {
    /// Whenever the call is reached.
    Always,
    /// When the condition holds; before the first time the default, then the value of the last time.
    Condact {
        /// The condition.
        every: ExprId,
        /// The value before the first time.
        default: Option<ExprId>,
        /// When its state starts afresh.
        restart: Option<ExprId>,
    },
    /// Always, its state afresh when the condition holds.
    Restart {
        /// The condition.
        every: ExprId,
    },
}

impl Unit {
    /// For each leaf of the out-ports, in order, whether it may be absent in a cycle in which the unit runs.
    pub fn optional_leaves(&self) -> impl Iterator<Item = bool> + '_ {
        let outputs = self.outputs.iter().map(|flow| self.flow(*flow));
        outputs.flat_map(|flow| {
            let is_optional = flow.optional == Optional::Declared(true);
            std::iter::repeat_n(is_optional, flow.ty.leaf_count())
        })
    }

    /// The flow of this index.
    #[must_use]
    pub fn flow(&self, id: FlowId) -> &Flow {
        &self.flows[id.0 as usize]
    }

    /// The expression of this index.
    #[must_use]
    pub fn expr(&self, id: ExprId) -> &Expr {
        &self.exprs[id.0 as usize]
    }

    /// The block of this index.
    #[must_use]
    pub fn block(&self, id: BlockId) -> &Block {
        &self.blocks[id.0 as usize]
    }

    /// A flow's name from outside of all blocks: behind those of the fragments in place and states around it.
    #[must_use]
    pub fn path_of(&self, flow: FlowId) -> String {
        let flow = self.flow(flow);
        let mut path = flow.name.to_string();
        let mut block = Some(flow.block);
        while let Some(around) = block.map(|id| self.block(id)) {
            if !around.name.is_empty() {
                path = format!("{}.{path}", around.name);
            }
            block = around.parent;
        }
        path
    }

    /// What a call of it gives: the out-port's type, or all of them by name.
    #[must_use]
    pub fn result(&self) -> Ty {
        if let [one] = self.outputs[..] {
            return self.flow(one).ty.clone();
        }
        let member = |id: &FlowId| crate::ty::Member {
            name: Some(self.flow(*id).name.clone()),
            ty: self.flow(*id).ty.clone(),
        };
        Ty::Tuple(self.outputs.iter().map(member).collect())
    }

    /// The device type of a flow, if it is a device.
    #[must_use]
    pub fn device(&self, id: FlowId) -> Option<&Rc<DeviceTy>> {
        match &self.flow(id).ty {
            Ty::Device(device) => Some(device),
            _ => None,
        }
    }
}

impl Block {
    /// A block without content.
    #[must_use]
    pub fn new(name: Name, parent: Option<BlockId>, span: Span) -> Block {
        Block {
            name,
            parent,
            when: None,
            restart: false,
            budget_ns: None,
            is_contract: false,
            equations: Vec::new(),
            claims: Vec::new(),
            ends: Vec::new(),
            exports: Vec::new(),
            automata: Vec::new(),
            span,
        }
    }
}

impl Kind {
    /// Calls `visit` with every operand.
    pub fn operands(&self, visit: &mut impl FnMut(ExprId)) {
        match self {
            Kind::Fault
            | Kind::Const(_)
            | Kind::Literal(_)
            | Kind::None
            | Kind::Outside
            | Kind::Flow(_) => {}
            Kind::Sensor { device: one, .. }
            | Kind::Part { base: one, .. }
            | Kind::Slice { base: one, .. }
            | Kind::Repeat(one)
            | Kind::Present(one)
            | Kind::When { value: one, .. }
            | Kind::Current(one) => visit(*one),
            Kind::Select { base, index } => [base, index].into_iter().for_each(|id| visit(*id)),
            Kind::Replace { base, value, .. } => {
                [base, value].into_iter().for_each(|id| visit(*id));
            }
            Kind::Build(parts) | Kind::Each(_, parts) => parts.iter().for_each(|id| visit(*id)),
            Kind::Equal { operands, .. } => operands.iter().for_each(|id| visit(*id)),
            Kind::Prim(call) => {
                let operands = call.inputs.iter().chain(&call.params);
                operands.flatten().for_each(|id| visit(*id));
            }
            Kind::Call(call) => {
                call.args.iter().flatten().for_each(|id| visit(*id));
                call.activation.operands(visit);
            }
            Kind::Merge { on, cases } => {
                visit(*on);
                cases.iter().for_each(|(_, id)| visit(*id));
            }
        }
    }
}

impl Activation {
    /// The value before the first run, if one is given.
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
