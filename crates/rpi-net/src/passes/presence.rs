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

/// Fragments, between a flow and its reader, that may be inactive while the reader is active. There are usually few.
type Gates = SmallVec<[FragmentId; 4]>;

/// Presence of a flow in the cycles in which its fragment is active.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub enum FlowPresence {
    /// The flow has a value in every cycle in which its fragment is active.
    Total,
    /// The flow may have a value in some of the cycles in which its fragment is active, and none in others.
    Optional,
    /// The flow never has a value.
    Never,
}

/// Presence of a flow for one of its readers.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct View {
    /// Presence of the flow in the cycles in which its own fragment is active.
    pub own: FlowPresence,
    /// Fragments around the flow that may be inactive while the reader is active, innermost first.
    pub through: Vec<FragmentId>,
}

/// Presence of every flow of a net: whether it has a value in every, some or no cycle in which its fragment is active.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Presences {
    /// Index of each node's first port in `states`.
    first: Vec<u32>,
    states: Vec<States>,
    activity: Vec<FlowPresence>,
}

impl Presences {
    /// Infers the presence of every flow.
    ///
    /// Out-ports that `forced` selects count as optional, whatever their presence rule, since a replay may force an
    /// absent value on them. A schedule, if there is one, makes the iteration converge faster.
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

    /// Returns the presence of a flow in the cycles in which its own fragment is active.
    #[must_use]
    pub fn own(&self, port: PortRef) -> FlowPresence {
        self.states(port).sureness()
    }

    /// Returns whether a fragment is active in every (`Total`), some (`Optional`) or no (`Never`) cycle in which its
    /// parent is.
    #[must_use]
    pub fn activity(&self, fragment: FragmentId) -> FlowPresence {
        self.activity[fragment.index()]
    }

    /// Returns the presence of a flow for readers in the fragment `reader`.
    #[must_use]
    pub fn view(&self, net: &Net, tree: &FragmentTree, reader: FragmentId, port: PortRef) -> View {
        let mut through = self.gates(net, tree, reader, port);
        through.reverse();
        View {
            own: self.own(port),
            through: through.into_vec(),
        }
    }

    /// Returns the presence of the source of an input for readers in the fragment `reader`.
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

    /// Returns the presence of each out-port in its own fragment, in the order of the nodes.
    pub fn iter(&self) -> impl Iterator<Item = FlowPresence> + '_ {
        self.states.iter().map(|s| s.sureness())
    }

    /// Creates the initial state of the inference, in which the presence of every flow is unknown.
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

    /// Computes the presence of the out-ports of a node from that of its inputs. Returns whether any of them changed.
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

    /// Returns the fragments around a flow that may be inactive while the fragment `reader` is active, outermost first.
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

    /// Checks that the presence of every flow follows from that of its sources by the presence rules.
    ///
    /// # Errors
    /// Returns the first node for which it does not.
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

/// Set of presence states, "present" and "absent", that a flow may have in a cycle.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
struct States(u8);

impl States {
    /// Empty set: the presence has not been inferred yet.
    const UNKNOWN: States = States(0);
    /// Set with the state "present" only.
    const PRESENT: States = States(1);
    /// Set with the state "absent" only.
    const ABSENT: States = States(2);
    /// Set with both states: present in some cycles and absent in others.
    const EITHER: States = States(3);

    fn has(self, other: States) -> bool {
        self.0 & other.0 != 0
    }

    fn when(self, holds: bool) -> States {
        if holds { self } else { States::UNKNOWN }
    }

    /// Returns the presence that the set stands for at the end of the inference. An empty set, of a flow that depends
    /// on itself, counts as optional.
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

/// Presence states of all connected inputs of a node together, as far as the presence rules need them.
struct InputStates {
    /// Possible presence of the first connected input.
    first: States,
    /// Union of the state sets of all connected inputs.
    union: States,
    /// Intersection of the state sets of all connected inputs.
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

    /// Returns the presence states of an out-port with the presence rule `rule`. The result grows with the states of
    /// the inputs, so that a least fixed point exists.
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

/// Returns the presence states of a delay's output, which is absent or present like its initial value, then like its
/// input.
fn delayed(rule: Presence, input: States) -> States {
    match rule {
        Presence::Maybe => States::ABSENT | input,
        _ => States::PRESENT | input,
    }
}

/// Returns whether `reader`, or a fragment around it below `common`, has the same activation as `gate`.
///
/// If so, `gate` is active in every cycle in which both `reader` and the parent of `gate` are.
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

/// Returns whether a fragment with this activation is always, sometimes or never active in the cycles in which its
/// parent is. Only a constant condition gives always or never.
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
