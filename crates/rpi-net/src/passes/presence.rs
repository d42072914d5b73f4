//! Presence analysis: which flows may be absent. It is the least fixed point of the descriptors' presence rules.
//!
//! A flow's [`FlowPresence`] holds in the cycles in which its own fragment is active. A reader elsewhere also sees it
//! absent whenever an intermediate fragment, which encloses the flow but not the reader, is inactive:
//! [`Presences::view`] returns these fragments. A total port has no run-time cost.

use crate::fragment_tree::FragmentTree;
use crate::net::{Activation, FragmentId, Input, Net, Node, NodeId, PortRef};
use crate::passes::schedule::Schedule;
use crate::passes::users::Readers;
use crate::verify_error::VerifyError;
use rpi_image::{Presence, Role};
use smallvec::SmallVec;
use std::ops::BitOr;

/// Fragments that may be inactive while a reader is active, between a flow and that reader. Usually few.
type Gates = SmallVec<[FragmentId; 4]>;

/// Presence of a flow, given that its fragment is active.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub enum FlowPresence {
    /// Present in every cycle.
    Total,
    /// May be present or absent.
    Optional,
    /// Absent in every cycle.
    Never,
}

/// Presence of a flow as seen by one of its readers.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct View {
    /// Presence of the flow within its own fragment.
    pub own: FlowPresence,
    /// Fragments around the flow that may be inactive while the reader is active, innermost first.
    pub through: Vec<FragmentId>,
}

/// Presence of every flow of a net.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Presences {
    /// Index of each node's first port in `states`.
    first: Vec<u32>,
    states: Vec<States>,
    activity: Vec<FlowPresence>,
}

impl Presences {
    /// Infers the presence of every flow. Ports that `forced` selects count as optional regardless of their rule, since
    /// a replay may force an absent value on them. A schedule, if there is one, makes the iteration converge faster.
    #[must_use]
    pub fn infer(
        net: &Net,
        tree: &FragmentTree,
        users: &Readers,
        order: Option<&Schedule>,
        forced: impl Fn(PortRef) -> bool,
    ) -> Self {
        let mut presences = Presences::unknown(net);
        let mut queue: Vec<NodeId> = match order {
            Some(schedule) => schedule.nodes().collect(),
            None => net.node_ids().collect(),
        };
        queue.reverse();
        let mut queued = vec![true; net.nodes.len()];
        while let Some(id) = queue.pop() {
            queued[id.index()] = false;
            if !presences.update(net, tree, id, &forced) {
                continue;
            }
            for reader in users.readers_of(id) {
                if !std::mem::replace(&mut queued[reader.index()], true) {
                    queue.push(*reader);
                }
            }
        }
        presences
    }

    /// Presence of a flow in the cycles in which its own fragment is active.
    #[must_use]
    pub fn own(&self, port: PortRef) -> FlowPresence {
        self.states(port).sureness()
    }

    /// Whether a fragment is active in every (`Total`), some or no cycle in which its parent is.
    #[must_use]
    pub fn activity(&self, fragment: FragmentId) -> FlowPresence {
        self.activity[fragment.index()]
    }

    /// Presence of a flow for readers in the fragment `reader`.
    #[must_use]
    pub fn view(&self, net: &Net, tree: &FragmentTree, reader: FragmentId, port: PortRef) -> View {
        let mut through = self.gates(net, tree, reader, port);
        through.reverse();
        View {
            own: self.own(port),
            through: through.into_vec(),
        }
    }

    /// Presence of an input's source for readers in the fragment `reader`.
    #[must_use]
    pub fn presence_at(
        &self,
        net: &Net,
        tree: &FragmentTree,
        reader: FragmentId,
        input: &Input,
    ) -> FlowPresence {
        self.states_at(net, tree, reader, input).sureness()
    }

    /// Presence of all flows, node by node.
    pub fn iter(&self) -> impl Iterator<Item = FlowPresence> + '_ {
        self.states.iter().map(|s| s.sureness())
    }

    /// Initial state, in which the presence of every flow is unknown.
    pub(crate) fn unknown(net: &Net) -> Self {
        let mut first = Vec::with_capacity(net.nodes.len());
        let mut count = 0;
        for node in &net.nodes {
            first.push(count);
            count += u32::try_from(node.outputs.len()).unwrap_or(u32::MAX);
        }
        Presences {
            first,
            states: vec![States::UNKNOWN; count as usize],
            activity: net
                .fragments
                .iter()
                .map(|f| activity(net, &f.activation))
                .collect(),
        }
    }

    /// Computes the presence of a node's ports again. Returns whether any of them changed.
    fn update(
        &mut self,
        net: &Net,
        tree: &FragmentTree,
        id: NodeId,
        forced: &impl Fn(PortRef) -> bool,
    ) -> bool {
        let node = net.node(id);
        let desc = node.desc();
        let inputs = self.inputs(net, tree, node);
        let first = self.first[id.index()] as usize;
        let mut changed = false;
        for (port, output) in (0..).zip(desc.outputs) {
            let state = match (forced(PortRef { node: id, port }), desc.role) {
                (true, _) => States::EITHER,
                (_, Role::Delay) => delayed(output.presence, inputs.first),
                _ => inputs.output(output.presence),
            };
            // Joining with the old states keeps the iteration monotonic, so that it terminates.
            let at = first + usize::from(port);
            let joined = self.states[at] | state;
            changed |= joined != self.states[at];
            self.states[at] = joined;
        }
        changed
    }

    fn inputs(&self, net: &Net, tree: &FragmentTree, node: &Node) -> InputStates {
        let mut seen = InputStates::none();
        for input in &node.inputs {
            if !matches!(input, Input::Unconnected) {
                seen.add(self.states_at(net, tree, node.fragment, input));
            }
        }
        seen
    }

    fn states_at(
        &self,
        net: &Net,
        tree: &FragmentTree,
        reader: FragmentId,
        input: &Input,
    ) -> States {
        match input {
            Input::Unconnected => States::ABSENT,
            Input::Const(_) => States::PRESENT,
            Input::Port(port) => {
                let own = self.states(*port);
                let gates = self.gates(net, tree, reader, *port);
                if gates
                    .iter()
                    .any(|f| self.activity(*f) == FlowPresence::Never)
                {
                    States::ABSENT
                } else if gates.is_empty() || own == States::UNKNOWN {
                    own
                } else {
                    own | States::ABSENT
                }
            }
        }
    }

    /// Fragments around a flow that may be inactive while `reader` is active, outermost first.
    fn gates(&self, net: &Net, tree: &FragmentTree, reader: FragmentId, port: PortRef) -> Gates {
        let origin = net.node(port.node).fragment;
        let common = tree.common_ancestor(reader, origin);
        if common == origin {
            return Gates::new();
        }
        let mut gates: Gates = tree.between(origin, common).collect();
        gates.reverse();
        let mut implied = true;
        gates.retain(|gate| {
            let sure = self.activity(*gate) == FlowPresence::Total;
            implied = sure || (implied && same_activation(net, tree, *gate, reader, common));
            !implied
        });
        gates
    }

    /// Checks that the result is a fixed point of the presence rules.
    ///
    /// # Errors
    /// Returns the first flow that is not.
    pub fn verify(&self, net: &Net, tree: &FragmentTree) -> Result<(), VerifyError> {
        let mut again = self.clone();
        for id in net.node_ids() {
            if again.update(net, tree, id, &|_| false) {
                let name = net.path(net.node(id).fragment, &net.node(id).name);
                return Err(VerifyError::new(format!(
                    "presence of `{name}` is not a fixed point"
                )));
            }
        }
        Ok(())
    }

    fn states(&self, port: PortRef) -> States {
        self.states[self.index_of(port)]
    }

    fn index_of(&self, port: PortRef) -> usize {
        self.first[port.node.index()] as usize + usize::from(port.port)
    }
}

/// Set of presence states that a flow may have.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
struct States(u8);

impl States {
    /// Empty set: not inferred yet.
    const UNKNOWN: States = States(0);
    const PRESENT: States = States(1);
    const ABSENT: States = States(2);
    const EITHER: States = States(3);

    fn has(self, other: States) -> bool {
        self.0 & other.0 != 0
    }

    fn when(self, holds: bool) -> States {
        if holds { self } else { States::UNKNOWN }
    }

    /// Presence at the end of the inference. An empty set means that the flow depends on itself.
    fn sureness(self) -> FlowPresence {
        match self {
            States::PRESENT => FlowPresence::Total,
            States::ABSENT => FlowPresence::Never,
            _ => FlowPresence::Optional,
        }
    }
}

impl BitOr for States {
    type Output = States;
    fn bitor(self, other: States) -> States {
        States(self.0 | other.0)
    }
}

/// Presence of all inputs of a node together, as far as the presence rules need it.
struct InputStates {
    /// States of the first connected input.
    first: States,
    /// Union of the states of all connected inputs.
    union: States,
    /// Intersection of the states of all connected inputs.
    intersection: States,
    /// Whether some connected input is certainly present.
    any_present: bool,
    /// Whether the state of some connected input is still unknown.
    any_unknown: bool,
}

impl InputStates {
    fn none() -> Self {
        InputStates {
            first: States::UNKNOWN,
            union: States::UNKNOWN,
            intersection: States::EITHER,
            any_present: false,
            any_unknown: false,
        }
    }

    fn add(&mut self, states: States) {
        if self.union == States::UNKNOWN && !self.any_unknown {
            self.first = states;
        }
        self.union = self.union | states;
        self.intersection = States(self.intersection.0 & states.0);
        self.any_present |= states == States::PRESENT;
        self.any_unknown |= states == States::UNKNOWN;
    }

    /// Presence states of an out-port under its rule. Monotonic in the states of the inputs, so that a least fixed
    /// point exists.
    fn output(&self, rule: Presence) -> States {
        match rule {
            Presence::Always => States::PRESENT,
            Presence::Maybe => States::EITHER,
            Presence::IfAny if self.any_present => States::PRESENT,
            _ if self.any_unknown => States::UNKNOWN,
            Presence::IfAny => States::EITHER,
            Presence::IfAll if self.union.has(States::ABSENT) => States::EITHER,
            Presence::IfAll => States::PRESENT,
            Presence::Strict => {
                States::PRESENT.when(self.intersection.has(States::PRESENT))
                    | States::ABSENT.when(self.union.has(States::ABSENT))
            }
        }
    }
}

/// Presence states of a delay's output: absent or present like its initial value, then like its input.
fn delayed(rule: Presence, input: States) -> States {
    match rule {
        Presence::Maybe => States::ABSENT | input,
        _ => States::PRESENT | input,
    }
}

/// Whether `reader`, or a fragment around it below `common`, has the same activation as `gate`. Then `gate` is active
/// whenever `reader` and `gate`'s parent are.
fn same_activation(
    net: &Net,
    tree: &FragmentTree,
    gate: FragmentId,
    reader: FragmentId,
    common: FragmentId,
) -> bool {
    let activation = &net.fragment(gate).activation;
    tree.between(reader, common)
        .any(|f| net.fragment(f).activation == *activation)
}

/// Whether a fragment is active always, sometimes or never when its parent is, as far as its condition is constant.
fn activity(net: &Net, activation: &Activation) -> FlowPresence {
    let Activation::When { condition, .. } = activation else {
        return FlowPresence::Total;
    };
    match constant(net.node(condition.node)) {
        Some(true) => FlowPresence::Total,
        Some(false) => FlowPresence::Never,
        None => FlowPresence::Optional,
    }
}

fn constant(node: &Node) -> Option<bool> {
    let is_constant = node.desc().role == Role::Constant;
    node.params.first().filter(|_| is_constant)?.as_bool()
}
