//! Data model of a net: plain data, built by elaboration or by the `.rpinet` reader and read by every pass.

use crate::claim::Claim;
use crate::coverage_points::CoveragePoints;
pub use crate::input::{FragmentId, Input, NodeId, PortRef};
use rpi_diag::Span;
use rpi_image::{PrimDesc, Type, Value};
use rpi_prims::PrimId;
use smallvec::SmallVec;
use std::collections::BTreeSet;

/// Place in a program from which a node comes, for messages, traces and the debugger.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Origin {
    /// Location in a source text; [`Span::NONE`] if there is none.
    pub span: Span,
    /// Name of the flow in the source, if it has one; flows in unnamed calls have a numbered call as prefix (`y#0.k`).
    pub flow: Option<String>,
}

/// Returns a flow's name without its unnamed calls: `k` for `y#0.k`, the flow `k` in the first call in `y`'s equation.
#[must_use]
pub fn strip_unnamed_calls(flow: &str) -> String {
    let named: Vec<&str> = flow.split('.').filter(|part| !part.contains('#')).collect();
    match named[..] {
        [] => flow.to_owned(),
        _ => named.join("."),
    }
}

/// Types of some ports. One is stored inline, since most primitives have one output.
pub type Types = SmallVec<[Type; 1]>;

/// Sources of the in-ports of a primitive. Three are stored inline, since few primitives have more.
pub type Inputs = SmallVec<[Input; 3]>;

/// Instance of a primitive in a net.
#[derive(Clone, PartialEq, Debug)]
pub struct Node {
    /// Name of the node, unique within its fragment.
    pub name: String,
    /// Primitive that the node is an instance of.
    pub prim: PrimId,
    /// Fragment that directly contains the node.
    pub fragment: FragmentId,
    /// Source of each declared in-port.
    pub inputs: Inputs,
    /// Value of each declared parameter, with defaults filled in.
    pub params: Vec<Value>,
    /// Type of each declared out-port, with sizes resolved.
    pub outputs: Types,
    /// Source of the node in the program text.
    pub origin: Origin,
}

impl Node {
    /// Descriptor of the node's primitive.
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
    /// Cycles in which the fragment is evaluated.
    pub activation: Activation,
    /// Cycles in which the state of the fragment is reset.
    pub restart: Restart,
    /// Whether the fragment only groups operations of one clock. Such a fragment is not a vertex of the dependency
    /// graph: each of its operations waits only for its own inputs, and the fragment may be entered several times in a
    /// cycle.
    pub is_clock: bool,
    /// In-ports declared in the source. A declared in-port is a dependency of the fragment even if no node in it reads
    /// the port.
    pub inputs: Vec<FragmentPort>,
    /// Named out-ports; those of the root are the out-ports of the command.
    pub outputs: Vec<FragmentPort>,
    /// Declared execution time budget in nanoseconds.
    pub budget_ns: Option<u64>,
    /// Source of the fragment in the program text.
    pub origin: Origin,
}

/// Named port on the border of a fragment: an alias without delay.
#[derive(Clone, PartialEq, Debug)]
pub struct FragmentPort {
    /// Name of the port.
    pub name: String,
    /// Flow or constant that the port carries.
    pub source: Input,
}

/// Cycles in which a fragment is evaluated, given that its parent is evaluated.
#[derive(Clone, PartialEq, Debug)]
pub enum Activation {
    /// Active in every cycle of the parent.
    Always,
    /// Active in cycles in which the condition is true.
    When {
        /// Boolean flow, computed in an enclosing fragment or in a sibling. A flow of a sibling may be absent.
        condition: PortRef,
        /// Meaning of an absent condition.
        if_absent: AbsentPolicy,
    },
}

/// Meaning of an absent activation condition. Programs need a total condition; in imported nets the fragment runs.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum AbsentPolicy {
    /// An absent condition leaves the fragment inactive.
    Inactive,
    /// An absent condition makes the fragment active.
    Active,
}

/// Cycles in which the state of a fragment is reset.
#[derive(Clone, PartialEq, Debug)]
pub enum Restart {
    /// The state is never reset: the fragment resumes with its last state.
    Never,
    /// The state is reset in each cycle in which the fragment becomes active after an inactive cycle.
    OnActivation,
    /// The state is reset in each active cycle in which this Boolean is true.
    Every(PortRef),
}

/// Kind of a result with which a command ends.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub enum ResultKind {
    /// `finish`: the robot is at rest.
    Finish,
    /// `yield`: the robot may be in motion; taken only if a successor takes over.
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
    /// Boolean that ends the command with this result.
    pub condition: Input,
    /// Source of the result in the program text.
    pub origin: Origin,
}

/// Flow that is published after each cycle.
#[derive(Clone, PartialEq, Debug)]
pub struct ExportPort {
    /// Key under which the flow is published.
    pub key: String,
    /// Published flow.
    pub source: PortRef,
    /// Source of the export in the program text.
    pub origin: Origin,
}

/// Signals by which a net ends.
#[derive(Clone, PartialEq, Debug)]
pub enum Termination {
    /// Named results (commands of `.rpi`).
    Results(Vec<ResultPort>),
    /// Root ports of the reference system: `outTerminate` ends the net, `outFail` is its error number (0: no error).
    Ports {
        /// Source of `outTerminate`, if the net has this port.
        terminate: Option<Input>,
        /// Source of `outFail`, if the net has this port.
        fail: Option<Input>,
    },
}

/// Ports of a device that drive the same actuator: a command may write at most one of them in a cycle.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Alternatives {
    /// Name of the device.
    pub device: String,
    /// Names of the mutually exclusive ports.
    pub ports: Vec<String>,
}

/// Input of a command: taken over from the previous command at the start, set from outside if there is none.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct CommandInput {
    /// Name under which the host sets the input.
    pub key: String,
    /// Whether the input has no default, so that a value must be supplied.
    pub is_required: bool,
}

/// Dataflow net of one command, ready for the passes.
#[derive(Clone, PartialEq, Debug)]
pub struct Net {
    /// Name of the command, or of the file.
    pub name: String,
    /// All nodes in declaration order, which breaks ties in schedules.
    pub nodes: Vec<Node>,
    /// All fragments. The first is the root; parents come before children.
    pub fragments: Vec<Fragment>,
    /// Signals by which the net ends.
    pub termination: Termination,
    /// Inputs that the net takes over from the previous command.
    pub command_inputs: Vec<CommandInput>,
    /// Flows that the net publishes besides the primitives with an export role.
    pub exports: Vec<ExportPort>,
    /// Groups of mutually exclusive device ports.
    pub alternatives: Vec<Alternatives>,
    /// Assertions and contracts of the program, as far as the net publishes them.
    pub claims: Vec<Claim>,
    /// Coverage points of the program text; empty unless they were requested.
    pub coverage_points: CoveragePoints,
    /// Locations in a fragment at which the delay of an enclosing fragment is read (`last x`).
    pub outer_delays: BTreeSet<Span>,
    /// Whether the net is a test. A test that does not finish counts as failed.
    pub is_test: bool,
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

    /// Returns all fragment indices; each parent comes before its children.
    pub fn fragment_ids(&self) -> impl DoubleEndedIterator<Item = FragmentId> + use<> {
        (0..u32::try_from(self.fragments.len()).unwrap_or(u32::MAX)).map(FragmentId)
    }

    /// Adds a node and returns its index.
    pub fn add_node(&mut self, node: Node) -> NodeId {
        let id = NodeId(u32::try_from(self.nodes.len()).expect("a net has fewer than 2^32 nodes"));
        self.nodes.push(node);
        id
    }

    /// Adds a fragment and returns its index.
    pub fn add_fragment(&mut self, fragment: Fragment) -> FragmentId {
        let id = FragmentId(
            u32::try_from(self.fragments.len()).expect("a net has fewer than 2^32 fragments"),
        );
        self.fragments.push(fragment);
        id
    }

    /// Returns a fragment and all fragments that enclose it, innermost first.
    pub fn ancestors(&self, id: FragmentId) -> impl Iterator<Item = FragmentId> + '_ {
        std::iter::successors(Some(id), |f| self.fragment(*f).parent)
    }

    /// Returns the path of a fragment or node name, `outer/inner/name`. The nameless root is left out.
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
}
