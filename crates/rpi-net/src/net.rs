//! The net itself: plain data, built by the elaboration or the `.rpinet` reader, read by every pass.

use crate::claim::Claim;
use crate::landmark::Landmarks;
use rpi_diag::Span;
use rpi_image::{PrimDesc, Type, Value};
use rpi_prims::PrimId;
use smallvec::SmallVec;
use std::collections::BTreeSet;

/// Index of a node in [`Net::nodes`].
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub struct NodeId(pub u32);

impl NodeId {
    /// Its place in a table with one entry per node.
    #[must_use]
    pub const fn index(self) -> usize {
        self.0 as usize
    }
}

/// Index of a fragment in [`Net::fragments`]; 0 is the root.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub struct FragmentId(pub u32);

impl FragmentId {
    /// The command's own fragment, always active.
    pub const ROOT: FragmentId = FragmentId(0);

    /// Its place in a table with one entry per fragment.
    #[must_use]
    pub const fn index(self) -> usize {
        self.0 as usize
    }
}

/// An out-port of a node.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub struct PortRef {
    /// The node.
    pub node: NodeId,
    /// Index into its descriptor's outputs.
    pub port: u8,
}

/// What an in-port reads.
#[derive(Clone, PartialEq, Debug)]
pub enum Input {
    /// Nothing: allowed where the descriptor says [`rpi_image::Need::Absent`].
    Open,
    /// A constant: a parameter standing in for an open port, or a literal operand.
    Const(Box<Value>),
    /// An out-port of a node in the same fragment, an enclosing one, or (then it may be absent) any other one.
    /// Links cross fragment borders freely; the border's ports are derived, or named in [`Fragment::outputs`].
    Port(PortRef),
}

/// Where a node comes from, for messages, traces and the debugger.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Origin {
    /// Place in a source text ([`Span::NONE`] if there is none).
    pub span: Span,
    /// The flow's name as its author knows it, if it has one; those of flows in calls without a name are numbered.
    pub flow: Option<String>,
}

/// A flow's name without the calls around it that have none: of `y#0.k`, in the first call in the equation of `y`, `k`.
#[must_use]
pub fn without_calls(flow: &str) -> String {
    let named: Vec<&str> = flow.split('.').filter(|part| !part.contains('#')).collect();
    match named[..] {
        [] => flow.to_owned(),
        _ => named.join("."),
    }
}

/// The types of some ports; one, as most primitives have, lies in place.
pub type Types = SmallVec<[Type; 1]>;

/// What the in-ports of a primitive read; three, as few exceed, lie in place.
pub type Inputs = SmallVec<[Input; 3]>;

/// A primitive in a net.
#[derive(Clone, PartialEq, Debug)]
pub struct Node {
    /// Name, unique within its fragment.
    pub name: String,
    /// What it is.
    pub prim: PrimId,
    /// The fragment it stands in.
    pub fragment: FragmentId,
    /// One entry per declared in-port.
    pub inputs: Inputs,
    /// One entry per declared parameter, defaults filled in.
    pub params: Vec<Value>,
    /// Type of each declared out-port, sizes resolved.
    pub outputs: Types,
    /// Where it comes from.
    pub origin: Origin,
}

impl Node {
    /// The primitive's declaration.
    #[must_use]
    pub fn desc(&self) -> &'static PrimDesc {
        self.prim.desc()
    }
}

/// A part of a net that is active or not as a whole.
#[derive(Clone, PartialEq, Debug)]
pub struct Fragment {
    /// Name, unique within its parent; empty for the root.
    pub name: String,
    /// The enclosing fragment; none for the root.
    pub parent: Option<FragmentId>,
    /// When it is evaluated.
    pub activation: Activation,
    /// When its state starts afresh.
    pub restart: Restart,
    /// Whether it only gathers operations of one clock: then it is no vertex for what is around it, each of its operations
    /// waits for what that operation reads, and it may be entered several times in a cycle.
    pub is_clock: bool,
    /// Ports that the source declares; a declared in-port is a dependency of the fragment even if nothing inside reads it.
    pub inputs: Vec<FragmentPort>,
    /// Named out-ports (the root's are the command's own).
    pub outputs: Vec<FragmentPort>,
    /// Stated budget in nanoseconds.
    pub budget_ns: Option<u64>,
    /// Where it comes from.
    pub origin: Origin,
}

/// A named port on a fragment's border: an alias, no delay.
#[derive(Clone, PartialEq, Debug)]
pub struct FragmentPort {
    /// Its name.
    pub name: String,
    /// What runs through it.
    pub source: Input,
}

/// When a fragment is evaluated, given that its parent is.
#[derive(Clone, PartialEq, Debug)]
pub enum Activation {
    /// In every cycle.
    Always,
    /// In cycles in which the Boolean is true.
    When {
        /// The Boolean, computed in an enclosing fragment (or in a sibling, then it may be absent).
        condition: PortRef,
        /// What an absent condition means.
        absent: Absent,
    },
}

/// What an absent activation means: programs need a total condition; imported nets run.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Absent {
    /// The fragment is inactive.
    Inactive,
    /// The fragment is active.
    Active,
}

/// When a fragment's state starts afresh.
#[derive(Clone, PartialEq, Debug)]
pub enum Restart {
    /// Never: it resumes.
    Never,
    /// In each cycle in which it becomes active after it was not.
    OnActivation,
    /// In each active cycle in which the Boolean is true.
    Every(PortRef),
}

/// How a command can end.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub enum ResultKind {
    /// Everything at rest.
    Finish,
    /// Maybe in motion, only into a successor.
    Yield,
    /// With an error.
    Fail,
}

/// A named result of a command, in text order.
#[derive(Clone, PartialEq, Debug)]
pub struct ResultPort {
    /// Its name.
    pub name: String,
    /// Its kind.
    pub kind: ResultKind,
    /// The Boolean that ends the command.
    pub condition: Input,
    /// Where it comes from.
    pub origin: Origin,
}

/// A flow that is published after each cycle.
#[derive(Clone, PartialEq, Debug)]
pub struct ExportPort {
    /// Its key.
    pub key: String,
    /// The flow.
    pub source: PortRef,
    /// Where it comes from.
    pub origin: Origin,
}

/// How a net says that it has ended.
#[derive(Clone, PartialEq, Debug)]
pub enum Driver {
    /// By named results (commands of `.rpi`).
    Results(Vec<ResultPort>),
    /// By the reference's root ports: `outTerminate` ends it, `outFail` is its error number (0: none).
    Ports {
        /// `outTerminate`, if there is one.
        terminate: Option<Input>,
        /// `outFail`, if there is one.
        fail: Option<Input>,
    },
}

/// Ports of one actuator of a device, of which a command drives at most one in a cycle.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Alternatives {
    /// The device.
    pub device: String,
    /// Its ports.
    pub ports: Vec<String>,
}

/// An input that a command takes over from the one before it when it starts, and that is set from outside if there is none.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Given {
    /// The input's key.
    pub key: String,
    /// It has no default: somebody has to give it.
    pub is_needed: bool,
}

/// A net: one command, ready for the passes.
#[derive(Clone, PartialEq, Debug)]
pub struct Net {
    /// The command's name, or the file's.
    pub name: String,
    /// All nodes. Order is declaration order, which breaks ties in schedules.
    pub nodes: Vec<Node>,
    /// All fragments; the first is the root, parents come before children.
    pub fragments: Vec<Fragment>,
    /// How it ends.
    pub driver: Driver,
    /// What it takes over from the command before it.
    pub given: Vec<Given>,
    /// What it publishes besides the primitives with an export role.
    pub exports: Vec<ExportPort>,
    /// Ports of devices that exclude each other.
    pub alternatives: Vec<Alternatives>,
    /// What the program claims of itself, as far as that is published.
    pub claims: Vec<Claim>,
    /// What was made from which place of the text, where that was asked for.
    pub landmarks: Landmarks,
    /// Places in fragments where the delay of a fragment around them is read (`last x`).
    pub outer_delays: BTreeSet<Span>,
    /// Whether it is a test: one that does not finish fails when it runs.
    pub is_test: bool,
}

impl Net {
    /// An empty net of this name with a root fragment.
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
            driver: Driver::Ports {
                terminate: None,
                fail: None,
            },
            given: Vec::new(),
            exports: Vec::new(),
            alternatives: Vec::new(),
            claims: Vec::new(),
            landmarks: Landmarks::default(),
            outer_delays: BTreeSet::new(),
            is_test: false,
        }
    }

    /// The node of this index.
    #[must_use]
    pub fn node(&self, id: NodeId) -> &Node {
        &self.nodes[id.index()]
    }

    /// The fragment of this index.
    #[must_use]
    pub fn fragment(&self, id: FragmentId) -> &Fragment {
        &self.fragments[id.index()]
    }

    /// All node indices in declaration order.
    pub fn node_ids(&self) -> impl DoubleEndedIterator<Item = NodeId> + use<> {
        (0..u32::try_from(self.nodes.len()).unwrap_or(u32::MAX)).map(NodeId)
    }

    /// All fragment indices, parents before children.
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

    /// A fragment and all that enclose it, innermost first.
    pub fn enclosing(&self, id: FragmentId) -> impl Iterator<Item = FragmentId> + '_ {
        std::iter::successors(Some(id), |f| self.fragment(*f).parent)
    }

    /// The path of a fragment or node name, `outer/inner/name`.
    #[must_use]
    pub fn path(&self, fragment: FragmentId, name: &str) -> String {
        let mut parts: Vec<&str> = self
            .enclosing(fragment)
            .map(|f| self.fragment(f).name.as_str())
            .collect();
        parts.pop();
        parts.reverse();
        parts.push(name);
        parts.join("/")
    }
}
