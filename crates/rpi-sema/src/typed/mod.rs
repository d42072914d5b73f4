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

/// Index of a unit among the units of a checked program.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub struct UnitId(pub u32);

/// Index of a flow in [`Unit::flows`].
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub struct FlowId(pub u32);

/// Index of an expression in [`Unit::exprs`].
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub struct ExprId(pub u32);

/// Index of a block in [`Unit::blocks`]. Block 0 is the body of the unit.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub struct BlockId(pub u32);

impl BlockId {
    /// Block of the body of a unit, which contains all other blocks.
    pub const ROOT: BlockId = BlockId(0);
}

/// Kind of a unit, which decides how a call of it is compiled.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum UnitKind {
    /// Function: has no state and is inlined. Absent arguments make its results absent.
    Function,
    /// Node: its calls are inlined, and its state is part of the fragment that contains the call.
    Node,
    /// Fragment: active or inactive as a whole, with state of its own. For dependencies of its caller, it counts as a
    /// single vertex.
    Fragment,
    /// Command: the unit that the control core runs. It becomes a net of its own.
    Command,
    /// Test: it becomes a net of its own, whose claims are observed from outside.
    Test,
    /// Task: a sequence of commands, without a net of its own.
    Task,
    /// Constant: an expression outside of any other unit, such as the value of a global constant or an array size.
    Constant,
}

impl UnitKind {
    /// Returns whether units of this kind are run on their own, not called.
    #[must_use]
    pub fn is_root(self) -> bool {
        matches!(self, UnitKind::Command | UnitKind::Test | UnitKind::Task)
    }
}

/// Typed form of a callable, such as a node or command, for one choice of static arguments.
#[derive(Clone, PartialEq, Debug)]
pub struct Unit {
    /// Name of the callable with the chosen static arguments.
    pub name: Name,
    /// Kind of the unit, such as function, node, command or task.
    pub kind: UnitKind,
    /// Whether the unit is a declared contract. Contracts are imported, other units are called.
    pub is_contract: bool,
    /// Location of the name in the declaration.
    pub span: Span,
    /// All flows of the unit, including parameters and ports.
    pub flows: Vec<Flow>,
    /// Flows whose values the caller gives, in order: parameters that are fixed when the command is loaded, then
    /// in-ports, then values taken over.
    pub inputs: Vec<FlowId>,
    /// Flows of the out-ports, in the order of the declaration.
    pub outputs: Vec<FlowId>,
    /// All expressions of the unit. Operands precede the expressions that use them.
    pub exprs: Vec<Expr>,
    /// Conditions of `if` that depend on static parameters, in ascending order. In another instance, such a condition
    /// may have another value.
    pub static_conditions: Vec<ExprId>,
    /// Blocks of the unit: the body, inline fragments, states of automata and contracts. Each comes after the block
    /// that contains it.
    pub blocks: Vec<Block>,
    /// Whether the unit uses sampled flows (`when`, `merge`, `current`).
    pub has_clocks: bool,
    /// Whether the unit has state, as in `pre x`, itself or in its calls.
    pub has_state: bool,
    /// Whether the unit is in Lustre, where the results of `current` are never optional.
    pub is_lustre: bool,
    /// Names of frames in the ports that are not declared. Each stands for the frame of an argument.
    pub free_frames: Vec<Name>,
    /// In-ports and parameters whose default is the identity pose.
    pub identity_defaults: Vec<FlowId>,
    /// For a task, its steps: the commands and tasks that it runs. Empty for other units.
    pub steps: Vec<TaskStep>,
    /// For a task, the numbers of repetitions in it, each with its location. Empty for other units.
    pub repeat_counts: Vec<(Span, ExprId)>,
}

/// Part of a unit with its own names and equations: the body, an inline fragment, a state of an automaton, or a
/// contract.
#[derive(Clone, PartialEq, Debug)]
pub struct Block {
    /// Name of the fragment or state; empty for the body of the unit.
    pub name: Name,
    /// Block that contains this one; `None` for the body of the unit.
    pub parent: Option<BlockId>,
    /// Condition under which the block is active; `None` if it is active whenever the block around it is.
    pub when: Option<ExprId>,
    /// Whether the state of the block is reset to its initial values each time the block becomes active.
    pub restart: bool,
    /// Declared budget for the execution time of the block in one cycle, in nanoseconds; `None` if none is declared.
    pub budget_ns: Option<u64>,
    /// Whether the block is a contract. Nothing outside of it reads a contract, so that it may be left out of the net.
    pub is_contract: bool,
    /// Equations in text order.
    pub equations: Vec<Equation>,
    /// Assertions and clauses of contracts: conditions that are stated to hold.
    pub claims: Vec<Claim>,
    /// Statements that end the command when their conditions hold.
    pub ends: Vec<End>,
    /// Flows that the block exports, so that they are visible outside of the command.
    pub exports: Vec<Export>,
    /// Automata (state machines) in the block.
    pub automata: Vec<Automaton>,
    /// Location of the block in the source.
    pub span: Span,
}

/// Equation such as `x, arm.tcp = e`.
#[derive(Clone, PartialEq, Debug)]
pub struct Equation {
    /// Targets in order. Together they take all leaves (scalar parts) of the value.
    pub targets: Vec<Target>,
    /// Expression on the right side of the equation.
    pub value: ExprId,
    /// Location of the whole equation.
    pub span: Span,
}

/// Flow, part of a flow, or actuator port on the left side of an equation.
#[derive(Clone, PartialEq, Debug)]
pub struct Target {
    /// Flow or port that the equation defines.
    pub place: TargetPlace,
    /// Type of the flow, part or port that the equation defines.
    pub ty: Ty,
    /// Location of the target in the source.
    pub span: Span,
}

/// What an equation defines: leaves (scalar parts) of a flow, an actuator port, or nothing.
#[derive(Clone, PartialEq, Debug)]
pub enum TargetPlace {
    /// The equation defines a flow or a part of one: as many leaves (scalar parts) as the target's type has, from leaf
    /// `at` on.
    Flow {
        /// Flow that is defined, completely or in part.
        flow: FlowId,
        /// Index of the first leaf (scalar part) that is defined.
        at: u32,
    },
    /// The equation gives a set-point to an actuator port of a device.
    Port {
        /// Flow (a parameter) that holds the device.
        device: FlowId,
        /// Index of the port among the ports of the device type.
        port: u32,
    },
    /// The equation defines nothing, because its target has an error or is `_`.
    Nowhere,
}

/// Assertion or clause of a contract: a condition that is stated to hold in every cycle.
#[derive(Clone, PartialEq, Debug)]
pub struct Claim {
    /// Kind of the claim. The kind decides who must ensure the condition: the caller or the body.
    pub kind: ClaimKind,
    /// Condition that is stated to hold.
    pub condition: ExprId,
    /// For an `ensure` in a mode of a contract, the name of the mode. The condition is then `require => ensure`.
    pub mode: Option<Name>,
    /// Label that the source gives to the claim, if there is one.
    pub label: Option<Name>,
    /// Location of the claim in the source.
    pub span: Span,
}

/// Statement that ends a command, such as `finish result when condition`.
#[derive(Clone, PartialEq, Debug)]
pub struct End {
    /// Kind of the statement: `finish`, `yield` or `fail`.
    pub kind: rpi_syntax::ast::CommandEndKind,
    /// Name of the result with which the command ends.
    pub result: Name,
    /// Condition under which the command ends with this result.
    pub condition: ExprId,
    /// Location of the statement in the source.
    pub span: Span,
}

/// Flow that a command exports, with the key under which it is read.
#[derive(Clone, PartialEq, Debug)]
pub struct Export {
    /// Name under which the host reads the exported flow.
    pub key: String,
    /// Expression with the exported value.
    pub value: ExprId,
    /// Location of the export in the source.
    pub span: Span,
}

/// Automaton (state machine) of a block. In each cycle, exactly one state is active. Each state is a block.
#[derive(Clone, PartialEq, Debug)]
pub struct Automaton {
    /// States in text order. The first one need not be the initial one.
    pub states: Vec<State>,
    /// Index of the initial state.
    pub initial: u32,
    /// Flows that the states define for the block around the automaton.
    pub shared: Vec<SharedFlow>,
    /// Location of the automaton in the source.
    pub span: Span,
}

/// State of an automaton, with the transitions out of it.
#[derive(Clone, PartialEq, Debug)]
pub struct State {
    /// Block with the equations of the state. The conditions of its weak transitions are evaluated in it.
    pub block: BlockId,
    /// Strong transitions, which are taken before the state runs in a cycle, in order of priority.
    pub unless: Vec<Transition>,
    /// Weak transitions, which take effect in the next cycle, in order of priority.
    pub until: Vec<Transition>,
}

/// Transition from one state of an automaton to another.
#[derive(Clone, PartialEq, Debug)]
pub struct Transition {
    /// Condition of the transition; `None` if it is always taken when no earlier transition is.
    pub condition: Option<ExprId>,
    /// Whether the target state continues with its previous state values instead of restarting.
    pub resumes: bool,
    /// Index of the target state in the automaton.
    pub target: u32,
    /// Location of the transition in the source.
    pub span: Span,
}

/// Flow outside of an automaton that several of its states define. Each such state has a local version of the flow.
#[derive(Clone, PartialEq, Debug)]
pub struct SharedFlow {
    /// Flow as it is read outside of the automaton.
    pub flow: FlowId,
    /// For each state that defines the flow, the local version of the flow, in the order of the states.
    pub states: Vec<FlowId>,
    /// States that may be active and do not define the flow. If there are many, only the first ones are listed.
    pub missing: Vec<BlockId>,
    /// Flow with the value of an equation beside the automaton, which applies in states that do not define the flow;
    /// `None` if there is no such equation. The flow is then absent in those states.
    pub default: Option<FlowId>,
}

impl SharedFlow {
    /// Returns the flows that give this flow its value: the local versions in the states, then the default.
    pub fn contributions(&self) -> impl Iterator<Item = FlowId> + '_ {
        self.states.iter().copied().chain(self.default)
    }

    /// Returns whether the flow may be absent because an active state does not define it and there is no default.
    #[must_use]
    pub fn is_partially_defined(&self) -> bool {
        self.default.is_none() && !self.missing.is_empty()
    }
}

/// Value of a leaf (scalar part) of a constant: a machine value or a text.
pub type Leaf = Value;

impl Unit {
    /// Returns for each leaf (scalar part) of the outputs, in order, whether it may be absent in a cycle in which the
    /// unit runs.
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

    /// Returns the name of a flow with the names of the blocks that contain it before it, such as `Filter.smooth`.
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

    /// Returns the type of a call's result: the type of the only output, or a tuple with the names and types of all
    /// outputs.
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

    /// Returns the device type of a flow; `None` if the flow does not hold a device.
    #[must_use]
    pub fn device_type_instance(&self, id: FlowId) -> Option<&Rc<DeviceTy>> {
        match &self.flow(id).ty {
            Ty::Device(device) => Some(device),
            _ => None,
        }
    }
}

impl Block {
    /// Creates a block without equations or other content.
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
