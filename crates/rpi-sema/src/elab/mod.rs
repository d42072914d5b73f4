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
//! | `nodes.rs`, `arrays.rs`, `deferred_arrays.rs` | adding and folding nodes; arrays at ports |
//! | `scope.rs`, `index_map.rs`, `flows.rs` | one inlined unit and its flows |
//! | `expr.rs`, `elementwise.rs`, `guards.rs`, `short_circuit.rs`, `call.rs`, `time.rs` | expressions |
//! | `block.rs`, `claims.rs`, `automaton.rs`, `sampled_flows.rs` | bodies, claims, automata, sampled flows |
//! | `fragment_outputs.rs`, `fragment_inputs.rs` | outputs and inputs of fragments |
//! | `subrange.rs` | run-time checks of subranges |
//! | `device.rs`, `entry_point.rs`, `resolve_aliases.rs` | devices, entry points (commands and nodes), resolving aliases |

pub(crate) mod arrays;
mod automaton;
mod block;
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

pub use crate::elab::entry_point::{
    Argument, ElaboratedUnit, ObservableFlow, PortShape, elaborate, elaborate_dependency_steps,
    elaborate_node, has_hidden_dependency_cycle, parameters,
};
pub use crate::elab::size_budget::{MAX_STEPS, MAX_TASK_DEPTH, SizeBudget, task_too_large};
pub use claims::ClaimPolicy;
pub use constant::evaluate_argument;
pub(crate) use constant::{NotConstantError, evaluate_constant};

pub use crate::elab::short_circuit::LazyOperand;
use crate::facts::Facts;
use crate::hash::{FastMap, FastSet};
use crate::typed::{ExprId, Unit, UnitId};
use rpi_diag::Diagnostic;
use rpi_image::Scalar;
use rpi_net::{DecisionBranch, FragmentId, Net, PortRef};
use rpi_prims::PrimId;
use signal::{Signal, Wire};
use std::rc::Rc;

/// Purpose of an elaboration, which decides what the net contains.
#[derive(Clone, Copy, PartialEq, Debug)]
enum ElabMode {
    /// The net is to be run.
    Net,
    /// The net is for the dependency analysis (M5): it contains the whole source, with branches that a constant never
    /// chooses.
    Dependencies,
    /// Like [`ElabMode::Dependencies`], with a node for every equation, including mere copies. Messages about
    /// dependency cycles are drawn from this net.
    DependencySteps,
    /// No net is made: a constant is evaluated.
    Constant,
}

/// Position in the net at which an expression is evaluated: fragment, guard and branch.
#[derive(Clone, Copy, PartialEq, Debug)]
struct Position {
    /// Fragment of the expression.
    fragment: FragmentId,
    /// Condition under which the enclosing branch of an `if` is chosen. Operations that can fault are guarded by it.
    guard: Option<PortRef>,
    /// Enclosing branch of an `if`, for coverage; `None` unless coverage points are recorded.
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

/// State of the elaboration of one net or constant.
struct Elaborator<'u> {
    units: &'u [Unit],
    facts: &'u [Facts],
    mode: ElabMode,
    net: Net,
    aliases: Aliases,
    cache: Cache,
    inlining: Inlining,
    naming: Naming,
    /// Fragments of blocks that are written in a body, rather than called.
    in_place: FastSet<FragmentId>,
    /// First reason why the constant cannot be evaluated.
    failure: Option<NotConstantError>,
    /// Remaining number of nodes that may be added.
    budget: node_budget::NodeBudget,
    diagnostics: Vec<Diagnostic>,
    /// Whether the unit or a called one contains claims.
    has_claims: bool,
    /// Operands with state that are not always needed.
    lazy_operands: Vec<LazyOperand>,
    /// Whether code was left out because a constant rules it out.
    leaves_out_code: bool,
    /// Treatment of claims.
    claim_policy: ClaimPolicy,
    /// Whether coverage points are recorded.
    records_coverage: bool,
    /// Exported ports that keep flows alive that nothing in the net reads.
    kept_exports: Vec<rpi_net::ExportPort>,
}

/// Placeholder ports for signals that are read before they are known.
#[derive(Default)]
struct Aliases {
    /// Signal of each alias, once it is known.
    signals: Vec<Option<Signal>>,
    types: Vec<Scalar>,
    /// For each alias, whether it is being resolved, to detect aliases that depend on themselves.
    in_progress: Vec<bool>,
    /// For each alias of a signal that leaves a fragment, that fragment. Outside, its constants are present only while
    /// the fragment is active.
    gates: FastMap<usize, FragmentId>,
    /// For each alias of a signal that enters a fragment, that fragment. To its surroundings the fragment is one
    /// vertex.
    entries: FastMap<usize, FragmentId>,
    /// For each flow, the alias by which it was known before its equation was reached. Filled only where clocks are
    /// used.
    names_before: FastMap<PortRef, PortRef>,
    /// Arrays whose leaves are not known yet, in the order of their aliases.
    deferred_arrays: Vec<deferred_arrays::DeferredArray>,
}

/// Ports and fragments that are created once and used again.
#[derive(Default)]
struct Cache {
    /// Out-port with the flow `first` (true in the first cycle) of each fragment that reads it.
    firsts: FastMap<FragmentId, PortRef>,
    /// Inputs of the cycle (`time`, `cancel`) that have been read in each fragment.
    cycle_inputs: FastMap<(FragmentId, PrimId), signal::Wire>,
    /// Fragments that hold the operations of a clock.
    clock_fragments: FastMap<sampled_flows::ClockKey, FragmentId>,
    /// Elements that have been extracted from array ports.
    elements: FastMap<(PortRef, u32), PortRef>,
    /// Sensor ports that have been read.
    sensors: FastMap<(String, String, u32), PortRef>,
    /// State and faults of units that have been analysed.
    unit_properties: FastMap<UnitId, Rc<guards::UnitProperties>>,
}

/// Calls that are being inlined.
#[derive(Default)]
struct Inlining {
    /// Stack of the calls, outermost first.
    call_stack: Vec<UnitId>,
    /// Guard of the innermost call.
    guard: Option<PortRef>,
    /// Signals of the clock conditions of the outputs of the unit that was inlined last.
    exposed_conditions: Vec<Signal>,
    /// Whether the results of the next unit are kept while the unit does not run.
    keeps_results: bool,
}

/// Naming of net nodes: nodes get the names of the flows that they compute.
#[derive(Default)]
struct Naming {
    /// Name of the flow that is being defined, prefixed by the path of calls.
    name: String,
    /// Expression that is the whole value of that flow.
    top_expr: Option<ExprId>,
    /// Number of nodes added for that flow so far, for numbered names.
    serial: u32,
}

/// Greatest depth of nested calls. Each level of inlining costs stack.
pub(crate) const MAX_DEPTH: usize = 400;

impl<'u> Elaborator<'u> {
    fn new(units: &'u [Unit], facts: &'u [Facts], mode: ElabMode) -> Self {
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
        }
    }

    /// Records why a constant cannot be evaluated. Only the first reason is kept.
    fn fail(&mut self, reason: NotConstantError) -> Wire {
        self.failure.get_or_insert(reason);
        signal::empty_wire()
    }
}
