//! Elaboration of typed units to a net.
//!
//! Calls are inlined, composite values are split into one link per leaf, and parameters are folded. Reads and writes of
//! blocks in place become links across fragment borders. A flow may be read before its equation is elaborated: the
//! reader is then connected to an alias, which is resolved at the end, so neither order nor length of a chain matters.
//!
//! Constants are evaluated by the same code (`constant.rs`). Only folding is allowed then, and flows are evaluated on demand.
//!
//! | file | idea |
//! |---|---|
//! | `constant.rs` | evaluation of constants; the checker uses it too |
//! | `signal.rs` | signal that a leaf is connected to |
//! | `primitive_family.rs` | primitives that exist once per value type |
//! | `nodes.rs`, `arrays.rs`, `built_arrays.rs`, `deferred_arrays.rs` | adding and folding nodes; arrays at ports |
//! | `scope.rs`, `index_map.rs`, `flows.rs` | one inlined unit and its flows |
//! | `expr.rs`, `elementwise.rs`, `guards.rs`, `short_circuit.rs`, `call.rs`, `time.rs` | expressions |
//! | `block.rs`, `claims.rs`, `automaton.rs`, `sampled_flows.rs` | bodies, claims, automata, sampled flows |
//! | `fragment_outputs.rs`, `fragment_inputs.rs` | outputs and inputs of fragments |
//! | `subrange.rs` | run-time checks of subranges |
//! | `watched_flows.rs` | exports of flows that a user watches |
//! | `device.rs`, `entry_point.rs`, `resolve_aliases.rs` | devices, entry points (commands and nodes), resolving aliases |

pub(crate) mod arrays;
mod automaton;
mod block;
mod built_arrays;
mod call;
mod claims;
pub(crate) mod condact;
pub(crate) mod constant;
pub(crate) mod coverage_points;
pub(crate) mod deferred_arrays;
mod device;
pub(crate) mod elementwise;
pub(crate) mod entry_point;
mod expr;
pub(crate) mod external_ports;
mod flows;
pub(crate) mod fragment_inputs;
pub(crate) mod fragment_outputs;
pub(crate) mod guards;
mod identities;
pub(crate) mod index_map;
pub(crate) mod node_budget;
mod nodes;
pub(crate) mod outside_flows;
pub(crate) mod presence;
pub(crate) mod prim_calls;
pub(crate) mod primitive_family;
pub(crate) mod resolve_aliases;
pub(crate) mod sampled_flows;
mod scope;
pub(crate) mod short_circuit;
mod signal;
pub(crate) mod size_budget;
mod subrange;
mod time;
mod watched_flows;

pub use crate::elab::entry_point::{
    Argument, ElaboratedUnit, ObservableFlow, PortShape, elaborate, elaborate_dependency_steps,
    elaborate_node, elaborate_watched, has_hidden_dependency_cycle, parameters,
};
pub use crate::elab::size_budget::{MAX_STEPS, MAX_TASK_DEPTH, SizeBudget, task_too_large};
pub use claims::ClaimPolicy;
pub use constant::evaluate_argument;
pub(crate) use constant::{NotConstantError, evaluate_constant};

pub use crate::elab::short_circuit::LazyOperand;
pub use crate::elab::watched_flows::{FlowSelection, MAX_WATCHED, contains as name_contains};
use crate::facts::Facts;
use crate::hash::{FastMap, FastSet};
use crate::typed::{ExprId, Unit, UnitId};
use rpi_diag::{Diagnostic, Span};
use rpi_image::Scalar;
use rpi_net::{DecisionBranch, FragmentId, Net, PortRef};
use rpi_prims::PrimId;
use signal::{Signal, Wire};
use std::rc::Rc;

/// Purpose of an elaboration. The purpose decides what the net contains.
#[derive(Clone, Copy, PartialEq, Debug)]
enum ElabMode {
    /// The net is made to be run.
    Net,
    /// The net is for the dependency analysis (M5): it contains the whole source, including branches that a constant
    /// condition never takes.
    Dependencies,
    /// The net is for messages about dependency cycles: it contains the whole source, with a node for every equation,
    /// even if the equation only copies a flow.
    DependencySteps,
    /// No net is needed: a constant expression is evaluated.
    Constant,
}

/// Position in the net at which an expression is evaluated: the fragment, the guard and the branch of an `if`.
#[derive(Clone, Copy, PartialEq, Debug)]
struct Position {
    /// Fragment of the net in which the expression is evaluated.
    fragment: FragmentId,
    /// Condition under which the branches of `if` around the expression are taken; `None` if operations can run in
    /// every cycle. Operations that can fault run only while it is true.
    guard: Option<PortRef>,
    /// Branch of an `if` that contains the expression, for coverage; `None` outside of branches or unless coverage is
    /// recorded.
    branch: Option<DecisionBranch>,
}

impl Position {
    const ROOT: Position = Position::in_fragment(FragmentId::ROOT);

    const fn in_fragment(fragment: FragmentId) -> Position {
        Position {
            fragment,
            guard: None,
            branch: None,
        }
    }

    fn unguarded(self) -> Position {
        Position::in_fragment(self.fragment)
    }
}

/// State of the elaboration of one net, or of the evaluation of one constant.
struct Elaborator<'u> {
    units: &'u [Rc<Unit>],
    facts: &'u [Rc<Facts>],
    mode: ElabMode,
    net: Net,
    aliases: Aliases,
    cache: Cache,
    inlining: Inlining,
    naming: Naming,
    /// Fragments of the net for blocks that are written in a body, as opposed to fragments for calls.
    in_place: FastSet<FragmentId>,
    /// First reason why the constant cannot be evaluated or the net cannot be built; `None` if there is none so far.
    failure: Option<NotConstantError>,
    /// Number of nodes that may still be added to the net.
    budget: node_budget::NodeBudget,
    diagnostics: Vec<Diagnostic>,
    /// Whether the unit or a unit that it calls contains claims (assertions or clauses of contracts).
    has_claims: bool,
    /// Operands that are not needed in every cycle and contain state, which runs in all cycles.
    lazy_operands: Vec<LazyOperand>,
    /// Whether code that a constant condition makes unreachable was left out of the net.
    leaves_out_code: bool,
    /// Treatment of claims: left out, exported for the host, or faults.
    claim_policy: ClaimPolicy,
    /// Whether coverage points (places whose execution is counted) are recorded.
    records_coverage: bool,
    /// Exports of claims and observed flows. They belong to flows that nothing else in the net may read.
    kept_exports: Vec<rpi_net::ExportPort>,
    /// Flows that are exported because a user watches them.
    watch: watched_flows::Watch,
}

/// Placeholder ports ("aliases") for signals that are read before they are known.
#[derive(Default)]
struct Aliases {
    /// Signal for which each alias stands; `None` until it is known.
    signals: Vec<Option<Signal>>,
    types: Vec<Scalar>,
    /// For each alias, whether the signal for which it stands is being looked up, to detect aliases that stand for one
    /// another.
    in_progress: Vec<bool>,
    /// For each alias of a signal that leaves a fragment, that fragment. Outside of it, a constant signal is present
    /// only while the fragment is active.
    gates: FastMap<usize, FragmentId>,
    /// For each alias of a signal that enters a fragment, that fragment. For dependencies, a fragment counts as one
    /// vertex: each output depends on all inputs.
    entries: FastMap<usize, FragmentId>,
    /// For each port of a flow, the alias by which the flow was read before its equation was elaborated. Entries exist
    /// only in units with sampled flows.
    names_before: FastMap<PortRef, PortRef>,
    /// Arrays with leaves (scalar parts) that are not known yet, in the order of the aliases that stand for the arrays.
    deferred_arrays: Vec<deferred_arrays::DeferredArray>,
}

/// Ports and fragments of the net that are added once and used again.
#[derive(Default)]
struct Cache {
    /// For each fragment that reads it, the out-port that is true in the first cycle of the fragment.
    firsts: FastMap<FragmentId, PortRef>,
    /// Inputs of the cycle, such as `time` and `cancel`, that have been read in each fragment, by fragment and
    /// primitive.
    cycle_inputs: FastMap<(FragmentId, PrimId), signal::Wire>,
    /// For each clock of a sampled flow, the fragment with the operations that run when the clock ticks.
    clock_fragments: FastMap<sampled_flows::ClockKey, FragmentId>,
    /// Array elements that have been extracted, by the array port and the index of the element.
    elements: FastMap<(PortRef, u32), PortRef>,
    /// Sensor ports that have been read, by device, port and index of the leaf (scalar part).
    sensors: FastMap<(String, String, u32), PortRef>,
    /// For each unit that has been analysed, whether it has state and can fault.
    unit_properties: FastMap<UnitId, Rc<guards::UnitProperties>>,
}

/// State of the inlining of calls.
#[derive(Default)]
struct Inlining {
    /// Units whose calls are being inlined, outermost first.
    call_stack: Vec<UnitId>,
    /// Locations of the calls in the stack.
    call_spans: Vec<Span>,
    /// Guard of the position at which the innermost call is inlined; `None` if the call runs in every cycle.
    guard: Option<PortRef>,
    /// Signals of the clock conditions of the outputs of the unit that was inlined last, for its caller.
    exposed_conditions: Vec<Signal>,
    /// Whether the results of the next inlined unit are held in cycles in which the unit does not run.
    keeps_results: bool,
}

/// Names for the nodes of the net: nodes are named after the flows that they compute.
#[derive(Default)]
struct Naming {
    /// Name of the flow that is being defined, with the path of calls before it.
    name: String,
    /// Expression that is the whole value of the flow that is being defined; `None` if there is none.
    top_expr: Option<ExprId>,
    /// Number of nodes added for the flow that is being defined, for names with numbers.
    serial: u32,
}

/// Maximum depth of nested calls. Each level of inlining needs stack.
pub(crate) const MAX_DEPTH: usize = 400;

impl<'u> Elaborator<'u> {
    fn new(units: &'u [Rc<Unit>], facts: &'u [Rc<Facts>], mode: ElabMode) -> Self {
        Elaborator {
            units,
            facts,
            mode,
            net: Net::new(""),
            aliases: Aliases::default(),
            cache: Cache::default(),
            inlining: Inlining::default(),
            naming: Naming::default(),
            in_place: FastSet::default(),
            failure: None,
            budget: node_budget::NodeBudget::new(),
            diagnostics: Vec::new(),
            has_claims: false,
            lazy_operands: Vec::new(),
            leaves_out_code: false,
            claim_policy: ClaimPolicy::default(),
            records_coverage: false,
            kept_exports: Vec::new(),
            watch: watched_flows::Watch::default(),
        }
    }

    /// Records the reason why a constant cannot be evaluated or a net cannot be built, unless one is recorded. Returns
    /// a value without signals.
    fn fail(&mut self, reason: NotConstantError) -> Wire {
        self.failure.get_or_insert(reason);
        signal::empty_wire()
    }
}
