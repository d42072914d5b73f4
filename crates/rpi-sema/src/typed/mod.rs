//! Typed program: every name resolved, every expression typed, every operator a primitive.
//!
//! A [`Unit`] is one callable for one choice of static arguments, or a command. Units are checked once and inlined by
//! the elaboration at every call. Expressions are stored in one table per unit and referred to by index, so that passes
//! can keep their results in tables beside it. This form must not know syntax or memory.

mod expr;
mod flow;
pub(crate) mod predeclared;
mod print;
pub(crate) mod task_step;
pub(crate) mod traversal;
mod verify;

pub use crate::typed::task_step::{TakenOverValue, TaskStep};
pub use expr::{Activation, Call, ElementwiseOp, Expr, PrimCall, TypedKind};
pub use flow::{DeclaredClock, Flow, FlowPresence, FlowRole};
pub use print::format_unit;
pub use verify::{InvalidUnitError, verify};

use crate::ty::{DeviceTy, Ty};
use rpi_diag::Span;
use rpi_image::Value;
pub use rpi_net::ClaimKind;
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

/// Index of a block in [`Unit::blocks`]; 0 is the body of the unit.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub struct BlockId(pub u32);

impl BlockId {
    /// Body of the unit.
    pub const ROOT: BlockId = BlockId(0);
}

/// Kind of a callable, which decides how a call is compiled.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum UnitKind {
    /// Function: has no state and is inlined. Absent arguments make its results absent.
    Function,
    /// Node: inlined, with its state in the caller's fragment.
    Node,
    /// Fragment: active or inactive as a whole, with state of its own; one vertex in its caller.
    Fragment,
    /// Command: the root of a net.
    Command,
    /// Test: the root of a net whose claims are observed from outside.
    Test,
    /// Task: a sequence of commands.
    Task,
    /// Constant: an expression at the top level of a module, or in a type.
    Constant,
}

impl UnitKind {
    /// Returns whether units of this kind are run rather than called.
    #[must_use]
    pub fn is_root(self) -> bool {
        matches!(self, UnitKind::Command | UnitKind::Test | UnitKind::Task)
    }
}

/// Callable, such as a node or command, for one choice of static arguments, after type checking.
#[derive(Clone, Debug)]
pub struct Unit {
    /// Name, with the chosen static arguments.
    pub name: Name,
    /// Whether the unit is a function, node, fragment, command, task or test.
    pub kind: UnitKind,
    /// Span of the name in the declaration.
    pub span: Span,
    /// All flows, ports included.
    pub flows: Vec<Flow>,
    /// Values from the caller, in order: those fixed at load time, then inputs, then those taken over.
    pub inputs: Vec<FlowId>,
    /// Flows of the out-ports, in the order of the declaration.
    pub outputs: Vec<FlowId>,
    /// Expressions. Operands precede the expressions that use them.
    pub exprs: Vec<Expr>,
    /// Conditions of `if` that depend on static parameters, in ascending order. Other static arguments may choose the
    /// other branch.
    pub static_conditions: Vec<ExprId>,
    /// Body, fragments in place, and states; parents first.
    pub blocks: Vec<Block>,
    /// Whether the unit samples flows (`when`, `merge`, `current`).
    pub has_clocks: bool,
    /// Whether the unit has state.
    pub has_state: bool,
    /// Whether the source is Lustre, where `current` is never optional.
    pub is_lustre: bool,
    /// Frames that the signature names but no declaration does. Each stands for the frame of an argument.
    pub free_frames: Vec<Name>,
    /// Steps of a task: the commands and tasks that it runs.
    pub steps: Vec<TaskStep>,
    /// Repetition counts of a task, each with the span of the number.
    pub repeat_counts: Vec<(Span, ExprId)>,
}

/// Body, fragment in place, or state of an automaton.
#[derive(Clone, Debug)]
pub struct Block {
    /// Name of the block; empty for the body.
    pub name: Name,
    /// Enclosing block; `None` for the body.
    pub parent: Option<BlockId>,
    /// Condition under which the block is active; `None` if it is active whenever its parent is.
    pub when: Option<ExprId>,
    /// Whether the state of the block restarts on each activation.
    pub restart: bool,
    /// Declared execution time budget in nanoseconds.
    pub budget_ns: Option<u64>,
    /// Whether the block is a contract. Nothing outside reads a contract, and it may be left out.
    pub is_contract: bool,
    /// Equations in text order.
    pub equations: Vec<Equation>,
    /// Claims: conditions stated to hold.
    pub claims: Vec<Claim>,
    /// Results with which the command can end.
    pub ends: Vec<End>,
    /// Exported flows.
    pub exports: Vec<Export>,
    /// Automata in the block.
    pub automata: Vec<Automaton>,
    /// Span of the block.
    pub span: Span,
}

/// Equation such as `x, arm.tcp = e`.
#[derive(Clone, Debug)]
pub struct Equation {
    /// Targets in order. Together they cover all leaves of the value.
    pub targets: Vec<Target>,
    /// Expression on the right side.
    pub value: ExprId,
    /// Span of the whole equation.
    pub span: Span,
}

/// Flow, or part of one, on the left side of an equation.
#[derive(Clone, Debug)]
pub struct Target {
    /// Flow or port that is defined.
    pub place: TargetPlace,
    /// Type of the target.
    pub ty: Ty,
    /// Span of the target.
    pub span: Span,
}

/// What an equation defines: leaves of a flow, or an actuator port.
#[derive(Clone, PartialEq, Debug)]
pub enum TargetPlace {
    /// The equation defines the leaves of a flow from `at` on.
    Flow {
        /// Flow that is defined.
        flow: FlowId,
        /// Index of the first leaf.
        at: u32,
    },
    /// The equation defines a set-point for an actuator port of a device.
    Port {
        /// Flow that holds the device.
        device: FlowId,
        /// Index of the port in the device type.
        port: u32,
    },
    /// The equation defines nothing: after an error, or for `_`.
    Nowhere,
}

/// Assertion or clause of a contract: a condition that is stated to hold in every cycle.
#[derive(Clone, Debug)]
pub struct Claim {
    /// Kind of the claim, which says who must ensure it.
    pub kind: ClaimKind,
    /// Condition that is stated to hold.
    pub condition: ExprId,
    /// Mode of the contract, for an `ensure`. The condition is then `require => ensure`.
    pub mode: Option<Name>,
    /// Label in the source.
    pub label: Option<Name>,
    /// Span of the claim.
    pub span: Span,
}

/// Statement that ends a command, such as `finish result when condition`.
#[derive(Clone, Debug)]
pub struct End {
    /// Whether the statement is a `finish`, a `yield` or a `fail`.
    pub kind: rpi_syntax::ast::CommandEndKind,
    /// Name of the result with which the command ends.
    pub result: Name,
    /// Condition under which the command ends.
    pub condition: ExprId,
    /// Span of the statement.
    pub span: Span,
}

/// Flow that a command exports, under a key.
#[derive(Clone, Debug)]
pub struct Export {
    /// Name under which the host reads the exported flow.
    pub key: String,
    /// Exported expression.
    pub value: ExprId,
    /// Span of the export.
    pub span: Span,
}

/// State machine of a body. In each cycle exactly one state is active; each state is a block.
#[derive(Clone, Debug)]
pub struct Automaton {
    /// States in text order. The first one need not be the initial one.
    pub states: Vec<State>,
    /// Index of the initial state.
    pub initial: u32,
    /// Flows that the states define together.
    pub shared: Vec<SharedFlow>,
    /// Span of the automaton.
    pub span: Span,
}

/// State of an automaton.
#[derive(Clone, Debug)]
pub struct State {
    /// Block of the state. The conditions of its weak transitions are evaluated in it.
    pub block: BlockId,
    /// Strong transitions, taken before the state runs.
    pub unless: Vec<Transition>,
    /// Weak transitions, which take effect in the next cycle.
    pub until: Vec<Transition>,
}

/// Transition between states.
#[derive(Clone, Debug)]
pub struct Transition {
    /// Condition of the transition; `None` for `otherwise`.
    pub condition: Option<ExprId>,
    /// Whether the target state resumes instead of restarting.
    pub resumes: bool,
    /// Index of the target state.
    pub target: u32,
    /// Span of the transition.
    pub span: Span,
}

/// Flow that several states define.
#[derive(Clone, Debug)]
pub struct SharedFlow {
    /// Flow as read outside the automaton.
    pub flow: FlowId,
    /// For each state that defines the flow, the flow inside that state, in the order of the states.
    pub states: Vec<FlowId>,
    /// States that may be active and do not define the flow. Truncated if there are many.
    pub missing: Vec<BlockId>,
    /// Flow of an equation beside the automaton, which applies in states that do not define the flow. Without a default
    /// the flow is absent there.
    pub default: Option<FlowId>,
}

impl SharedFlow {
    /// Returns the flows that contribute to this one: those of the states, then the default.
    pub fn contributions(&self) -> impl Iterator<Item = FlowId> + '_ {
        self.states.iter().copied().chain(self.default)
    }

    /// Returns whether the flow may be absent because an active state does not define it.
    #[must_use]
    pub fn is_partially_defined(&self) -> bool {
        self.default.is_none() && !self.missing.is_empty()
    }
}

/// Leaf of a constant: a value or a text.
pub type Leaf = Value;

impl Unit {
    /// Returns for each leaf of the outputs, in order, whether it may be absent in a cycle in which the unit runs.
    pub fn optional_leaves(&self) -> impl Iterator<Item = bool> + '_ {
        let outputs = self.outputs.iter().map(|flow| self.flow(*flow));
        outputs.flat_map(|flow| {
            let is_optional = flow.optional == FlowPresence::Declared(true);
            std::iter::repeat_n(is_optional, flow.ty.leaf_count())
        })
    }

    /// Returns the flow with this index.
    #[must_use]
    pub fn flow(&self, id: FlowId) -> &Flow {
        &self.flows[id.0 as usize]
    }

    /// Returns the expression with this index.
    #[must_use]
    pub fn expr(&self, id: ExprId) -> &Expr {
        &self.exprs[id.0 as usize]
    }

    /// Returns the block with this index.
    #[must_use]
    pub fn block(&self, id: BlockId) -> &Block {
        &self.blocks[id.0 as usize]
    }

    /// Returns a flow's name qualified by the names of its enclosing blocks.
    #[must_use]
    pub fn flow_path(&self, flow: FlowId) -> String {
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

    /// Returns the type of a call's result: the type of the only output, or a tuple of all outputs by name.
    #[must_use]
    pub fn result_type(&self) -> Ty {
        if let [one] = self.outputs[..] {
            return self.flow(one).ty.clone();
        }
        let member = |id: &FlowId| crate::ty::Member {
            name: Some(self.flow(*id).name.clone()),
            ty: self.flow(*id).ty.clone(),
        };
        Ty::Tuple(self.outputs.iter().map(member).collect())
    }

    /// Returns the device type of a flow; none if the flow is not a device.
    #[must_use]
    pub fn device_type_instance(&self, id: FlowId) -> Option<&Rc<DeviceTy>> {
        match &self.flow(id).ty {
            Ty::Device(device) => Some(device),
            _ => None,
        }
    }
}

impl Block {
    /// Creates an empty block.
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
