//! Data model of a net: plain data, built by elaboration or by the `.rpinet` reader and read by every pass.

use crate::claim::Claim;
use crate::coverage_points::CoveragePoints;
pub use crate::input::{FragmentId, Input, NodeId, PortRef};
use rpi_diag::Span;
use rpi_image::{PrimDesc, Type, Value};
use rpi_prims::PrimId;
use smallvec::SmallVec;
use std::collections::{BTreeMap, BTreeSet};

/// Place in a program from which a node or fragment comes, for messages, traces and the debugger.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Origin {
    /// Location in a source text; [`Span::NONE`] if there is none.
    pub span: Span,
    /// Name of the flow in the program; `None` if it has none. A flow inside an unnamed call has the number of the call
    /// in its name: `y#0.k`.
    pub flow: Option<String>,
}

/// Returns the name of a flow without the parts for unnamed calls: `k` for `y#0.k`, which is the flow `k` in the first
/// call in the equation of `y`.
#[must_use]
pub fn strip_unnamed_calls(flow: &str) -> String {
    let named: Vec<&str> = flow.split('.').filter(|part| !part.contains('#')).collect();
    match named[..] {
        [] => flow.to_owned(),
        _ => named.join("."),
    }
}

/// Types of ports of one node. One element is stored inline, since most primitives have one output.
pub type Types = SmallVec<[Type; 1]>;

/// Sources of the in-ports of a node. Three elements are stored inline, since few primitives have more.
pub type Inputs = SmallVec<[Input; 3]>;

/// Node of a net: an instance of a primitive.
#[derive(Clone, PartialEq, Debug)]
pub struct Node {
    /// Name of the node, unique within its fragment.
    pub name: String,
    /// Primitive of which the node is an instance.
    pub prim: PrimId,
    /// Fragment that directly contains the node.
    pub fragment: FragmentId,
    /// Source of each declared in-port of the primitive, in order.
    pub inputs: Inputs,
    /// Value of each declared parameter of the primitive, in order, with defaults filled in.
    pub params: Vec<Value>,
    /// Type of each declared out-port of the primitive, in order, with array sizes resolved.
    pub outputs: Types,
    /// Place of the node in the program text.
    pub origin: Origin,
}

impl Node {
    /// Returns the descriptor of the node's primitive.
    #[must_use]
    pub fn desc(&self) -> &'static PrimDesc {
        self.prim.desc()
    }
}

/// Part of a net that is active or inactive as a whole.
#[derive(Clone, PartialEq, Debug)]
pub struct Fragment {
    /// Name of the fragment, unique within its parent; empty for the root.
    pub name: String,
    /// Enclosing fragment; `None` for the root.
    pub parent: Option<FragmentId>,
    /// Condition that decides in each cycle whether the fragment is evaluated.
    pub activation: Activation,
    /// Condition that decides in each cycle whether the state of the fragment is reset.
    pub restart: Restart,
    /// Whether the fragment only groups the operations of one clock.
    ///
    /// Such a fragment is not a vertex of the dependency graph: each of its operations waits only for its own inputs,
    /// and the fragment may be entered several times in a cycle.
    pub is_clock: bool,
    /// In-ports declared in the program. The fragment depends on a declared in-port even if no node in the fragment
    /// reads it.
    pub inputs: Vec<FragmentPort>,
    /// Named out-ports. Those of the root fragment are the out-ports of the command.
    pub outputs: Vec<FragmentPort>,
    /// Declared execution time budget per cycle, in nanoseconds; `None` if none is declared.
    pub budget_ns: Option<u64>,
    /// Place of the fragment in the program text.
    pub origin: Origin,
}

/// Named port on the border of a fragment: another name, without delay, for a flow or constant.
#[derive(Clone, PartialEq, Debug)]
pub struct FragmentPort {
    /// Name of the port, unique among the in-ports or out-ports of its fragment.
    pub name: String,
    /// Flow or constant for which the port is another name.
    pub source: Input,
}

/// Condition that decides whether a fragment is evaluated in a cycle in which its parent is.
#[derive(Clone, PartialEq, Debug)]
pub enum Activation {
    /// The fragment is active in every cycle in which its parent is.
    Always,
    /// The fragment is active in cycles in which the condition is true.
    When {
        /// Boolean flow that is computed in an enclosing fragment or in a sibling of the fragment. A flow of a sibling
        /// may be absent.
        condition: PortRef,
        /// Effect of a condition that is absent in a cycle.
        if_absent: AbsentPolicy,
    },
}

/// Effect of an absent activation condition on a fragment. In programs a condition is always present; in imported nets
/// the fragment is then active.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum AbsentPolicy {
    /// An absent condition leaves the fragment inactive.
    Inactive,
    /// An absent condition makes the fragment active.
    Active,
}

/// Condition that decides whether the state of a fragment is reset in a cycle.
#[derive(Clone, PartialEq, Debug)]
pub enum Restart {
    /// The state is never reset. A fragment that becomes active again continues with its last state.
    Never,
    /// The state is reset in each cycle in which the fragment becomes active after an inactive cycle.
    OnActivation,
    /// The state is reset in each active cycle in which this Boolean is true.
    Every(PortRef),
}

/// Kind of a result with which a command ends.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub enum ResultKind {
    /// `finish`: the command ends with the robot at rest.
    Finish,
    /// `yield`: the command ends, possibly in motion, and only if a successor takes over.
    Yield,
    /// `fail`: the command ends with an error.
    Fail,
}

/// Named result of a command. Results are stored in text order.
#[derive(Clone, PartialEq, Debug)]
pub struct ResultPort {
    /// Name of the result.
    pub name: String,
    /// Whether the result is a `finish`, a `yield` or a `fail`.
    pub kind: ResultKind,
    /// Boolean flow or constant; the command ends with this result when it is true.
    pub condition: Input,
    /// Place of the result in the program text.
    pub origin: Origin,
}

/// Flow that a command publishes after each cycle.
#[derive(Clone, PartialEq, Debug)]
pub struct ExportPort {
    /// Key under which the flow is published.
    pub key: String,
    /// Flow that the command publishes under the key.
    pub source: PortRef,
    /// Unit of the values, such as `m/s`; empty if they have none.
    pub unit: String,
    /// Place of the export in the program text.
    pub origin: Origin,
}

/// Signals by which a net ends.
#[derive(Clone, PartialEq, Debug)]
pub enum Termination {
    /// Named results, for commands compiled from `.rpi` programs.
    Results(Vec<ResultPort>),
    /// Out-ports of the root fragment, as in the reference system: `outTerminate` ends the net, `outFail` is the error
    /// number (0: no error).
    Ports {
        /// Source of the out-port `outTerminate`; `None` if the net does not have the port.
        terminate: Option<Input>,
        /// Source of the out-port `outFail`; `None` if the net does not have the port.
        fail: Option<Input>,
    },
}

/// Ports of a device that drive the same actuator. A command may write at most one of them in a cycle.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Alternatives {
    /// Name of the device in the program, such as `arm`.
    pub device: String,
    /// Names of the ports, of which a command may write at most one in a cycle.
    pub ports: Vec<String>,
}

/// Input of a command. Its value is taken over from the previous command at the start, or set by the host if there is
/// no previous command.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct CommandInput {
    /// Name under which the host sets the value of the input.
    pub key: String,
    /// Whether the input has no default, so that the host must supply a value if there is no previous command.
    pub is_required: bool,
}

/// Dataflow net of one command: nodes, the fragments that contain them, and the ports to the outside.
#[derive(Clone, PartialEq, Debug)]
pub struct Net {
    /// Name of the command, or of the file from which the net was imported.
    pub name: String,
    /// All nodes in declaration order. The order breaks ties in schedules.
    pub nodes: Vec<Node>,
    /// All fragments in declaration order. The first is the root; parents come before their children.
    pub fragments: Vec<Fragment>,
    /// Signals by which the net ends.
    pub termination: Termination,
    /// Inputs whose values the command takes over from its predecessor.
    pub command_inputs: Vec<CommandInput>,
    /// Flows that the command publishes, in addition to the inputs of export primitives among the nodes.
    pub exports: Vec<ExportPort>,
    /// Units of the inputs that the host sets, by their keys. An input that is not listed has none.
    pub input_units: BTreeMap<String, String>,
    /// Groups of device ports that drive the same actuator.
    pub alternatives: Vec<Alternatives>,
    /// Assertions and contract clauses of the program that the net publishes.
    pub claims: Vec<Claim>,
    /// Coverage points of the program text; empty unless they were requested.
    pub coverage_points: CoveragePoints,
    /// Locations of `last x` in fragments where `x` is a flow of an enclosing fragment, whose delay is then read.
    pub outer_delays: BTreeSet<Span>,
    /// Whether the net is a test. A test that does not end with a `finish` counts as failed.
    pub is_test: bool,
}

impl Fragment {
    /// Returns true for a fragment that has a name in the program: not the root, and not one that only groups the operations of a clock.
    #[must_use]
    pub fn is_named(&self) -> bool {
        !self.name.is_empty() && !self.is_clock
    }
}

impl Net {
    /// Creates an empty net with the given name and a root fragment.
    #[must_use]
    pub fn new(name: impl Into<String>) -> Self {
        let root = Fragment {
            name: String::new(),
            parent: None,
            activation: Activation::Always,
            restart: Restart::Never,
            is_clock: false,
            inputs: Vec::new(),
            outputs: Vec::new(),
            budget_ns: None,
            origin: Origin {
                span: Span::NONE,
                flow: None,
            },
        };
        Net {
            name: name.into(),
            nodes: Vec::new(),
            fragments: vec![root],
            termination: Termination::Ports {
                terminate: None,
                fail: None,
            },
            command_inputs: Vec::new(),
            exports: Vec::new(),
            input_units: BTreeMap::new(),
            alternatives: Vec::new(),
            claims: Vec::new(),
            coverage_points: CoveragePoints::default(),
            outer_delays: BTreeSet::new(),
            is_test: false,
        }
    }

    /// Returns the node with this index.
    #[must_use]
    pub fn node(&self, id: NodeId) -> &Node {
        &self.nodes[id.index()]
    }

    /// Returns the type of an out-port.
    #[must_use]
    pub fn output_type(&self, port: PortRef) -> Type {
        self.node(port.node).outputs[usize::from(port.port)]
    }

    /// Returns the fragment with this index.
    #[must_use]
    pub fn fragment(&self, id: FragmentId) -> &Fragment {
        &self.fragments[id.index()]
    }

    /// Returns all node indices in declaration order.
    pub fn node_ids(&self) -> impl DoubleEndedIterator<Item = NodeId> + use<> {
        (0..u32::try_from(self.nodes.len()).unwrap_or(u32::MAX)).map(NodeId)
    }

    /// Returns all fragment indices in ascending order; each parent comes before its children.
    pub fn fragment_ids(&self) -> impl DoubleEndedIterator<Item = FragmentId> + use<> {
        (0..u32::try_from(self.fragments.len()).unwrap_or(u32::MAX)).map(FragmentId)
    }

    /// Adds a node at the end of [`Net::nodes`] and returns its index.
    pub fn add_node(&mut self, node: Node) -> NodeId {
        let id = NodeId(u32::try_from(self.nodes.len()).expect("a net has fewer than 2^32 nodes"));
        self.nodes.push(node);
        id
    }

    /// Adds a fragment at the end of [`Net::fragments`] and returns its index.
    pub fn add_fragment(&mut self, fragment: Fragment) -> FragmentId {
        let id = FragmentId(
            u32::try_from(self.fragments.len()).expect("a net has fewer than 2^32 fragments"),
        );
        self.fragments.push(fragment);
        id
    }

    /// Returns the fragment and all fragments that enclose it, innermost first.
    pub fn ancestors(&self, id: FragmentId) -> impl Iterator<Item = FragmentId> + '_ {
        std::iter::successors(Some(id), |f| self.fragment(*f).parent)
    }

    /// Returns the path of a node or fragment `name` that is directly in `fragment`: `outer/inner/name`. The nameless
    /// root is left out.
    #[must_use]
    pub fn path(&self, fragment: FragmentId, name: &str) -> String {
        let mut parts: Vec<&str> = self
            .ancestors(fragment)
            .map(|f| self.fragment(f).name.as_str())
            .collect();
        parts.pop();
        parts.reverse();
        parts.push(name);
        parts.join("/")
    }

    /// Returns the names of the fragments of the program from the root to this one, outermost first. The root, and fragments that only group the
    /// operations of a clock, have none.
    #[must_use]
    pub fn fragment_names(&self, fragment: FragmentId) -> Vec<&str> {
        let around = self.ancestors(fragment).map(|id| self.fragment(id));
        let named = around.filter(|fragment| fragment.is_named());
        let mut names: Vec<&str> = named.map(|fragment| fragment.name.as_str()).collect();
        names.reverse();
        names
    }
}
