//! Cone of influence: the part of a net that decides whether some events occur, with its registers.

use super::gates::Gate;
use crate::net::{Activation, FragmentId, Input, Net, NodeId, PortRef, Restart};
use crate::passes::Schedule;
use crate::passes::fact_prover::Event;
use rpi_image::{Presence, Role, Scalar, Type, Value};
use rustc_hash::{FxHashMap, FxHashSet};

/// Kind of state that a net stores from cycle to cycle. It is reset with the fragment that owns it.
#[derive(Clone, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub(super) enum RegisterKind {
    /// The input of a delay in the previous cycle, for the delay with this node.
    Delayed(NodeId),
    /// One memory slot of a primitive: its node and the index of the slot, from 0.
    Slot(NodeId, usize),
    /// Whether the fragment has been active in an earlier cycle.
    Started(FragmentId),
    /// Whether the fragment was active in the last active cycle of its parent.
    WasActive(FragmentId),
}

/// State element of a net in the model checker: kind, owner, type and initial value (`None` if it is absent at first).
#[derive(Clone, Debug)]
pub(super) struct Register {
    pub(super) memory: RegisterKind,
    pub(super) owner: FragmentId,
    pub(super) ty: Type,
    pub(super) initial: Option<Value>,
    /// Whether the stored value may be absent. The model then also needs a Boolean for its presence.
    pub(super) may_be_absent: bool,
}

/// Cone of influence of some events: the nodes and registers that decide whether they occur.
pub(super) struct Cone<'a> {
    pub(super) net: &'a Net,
    /// Nodes of the cone in order of evaluation.
    pub(super) nodes: Vec<NodeId>,
    pub(super) registers: Vec<Register>,
    /// Index in `registers` of each state element. Delays of the same flow in the same fragment share one.
    places: FxHashMap<RegisterKind, usize>,
}

impl<'a> Cone<'a> {
    /// Builds the cone of the events `of` and of `flows`. It has at most `limit` nodes, those nearest to the events and
    /// flows. `is_total` returns whether a flow of a delay is present in every cycle.
    pub(super) fn new(
        net: &'a Net,
        schedule: &Schedule,
        of: &[Event],
        flows: &[PortRef],
        limit: usize,
        is_total: impl Fn(PortRef) -> bool,
    ) -> Cone<'a> {
        let mut search = Search::new(net);
        for event in of {
            search.fragment(event.fragment);
            event.present.iter().for_each(|port| search.node(port.node));
        }
        flows.iter().for_each(|port| search.node(port.node));
        search.run(limit);
        let seen = search.seen;
        let nodes: Vec<NodeId> = schedule.nodes().filter(|id| seen.contains(id)).collect();
        let mut cone = Cone {
            net,
            nodes,
            registers: Vec::new(),
            places: FxHashMap::default(),
        };
        cone.find_registers();
        for register in &mut cone.registers {
            if let RegisterKind::Delayed(node) = register.memory {
                register.may_be_absent = !is_total(PortRef { node, port: 0 });
            }
        }
        cone
    }

    /// Returns the index in `registers` of a state element; `None` if it is not in the cone.
    pub(super) fn index_of(&self, memory: &RegisterKind) -> Option<usize> {
        self.places.get(memory).copied()
    }

    fn find_registers(&mut self) {
        let mut delays: FxHashMap<(FragmentId, PortRef, &str), usize> = FxHashMap::default();
        let net = self.net;
        for id in self.nodes.clone() {
            let node = net.node(id);
            match node.desc().role {
                Role::Delay => {
                    let key = node.inputs.first().and_then(Input::port);
                    let key = key.map(|port| (node.fragment, port, node.desc().name));
                    match key.and_then(|key| delays.get(&key)).copied() {
                        Some(shared) => {
                            self.places.insert(RegisterKind::Delayed(id), shared);
                        }
                        None => {
                            let place = self.add(delay(net, id));
                            delays.extend(key.map(|key| (key, place)));
                        }
                    }
                }
                Role::First => {
                    self.flag(RegisterKind::Started(node.fragment), node.fragment);
                }
                _ => {
                    let gate = Gate::from_node(node);
                    let cells = gate
                        .map(|gate| gate.initial_state(node))
                        .unwrap_or_default();
                    for (k, first) in cells.into_iter().enumerate() {
                        self.add(register_with_initial(
                            RegisterKind::Slot(id, k),
                            node.fragment,
                            first,
                        ));
                    }
                }
            }
            self.add_activity_registers(node.fragment);
        }
    }

    fn add_activity_registers(&mut self, fragment: FragmentId) {
        let net = self.net;
        for id in net.ancestors(fragment) {
            let fragment = net.fragment(id);
            if let (Restart::OnActivation, Some(parent)) = (&fragment.restart, fragment.parent) {
                self.flag(RegisterKind::WasActive(id), parent);
            }
        }
    }

    fn flag(&mut self, memory: RegisterKind, owner: FragmentId) {
        if !self.places.contains_key(&memory) {
            self.add(register_with_initial(memory, owner, Value::bool(false)));
        }
    }

    fn add(&mut self, register: Register) -> usize {
        let place = self.registers.len();
        self.places.insert(register.memory.clone(), place);
        self.registers.push(register);
        place
    }
}

fn register_with_initial(memory: RegisterKind, owner: FragmentId, first: Value) -> Register {
    Register {
        memory,
        owner,
        ty: first.ty().unwrap_or(Type::Scalar(Scalar::Bool)),
        initial: Some(first),
        may_be_absent: false,
    }
}

fn delay(net: &Net, id: NodeId) -> Register {
    let node = net.node(id);
    let ty = node
        .outputs
        .first()
        .copied()
        .unwrap_or(Type::Scalar(Scalar::Bool));
    let starts_absent = node
        .desc()
        .outputs
        .first()
        .is_some_and(|o| o.presence == Presence::Maybe);
    Register {
        memory: RegisterKind::Delayed(id),
        owner: node.fragment,
        ty,
        initial: (!starts_absent).then(|| Value::neutral(ty)),
        may_be_absent: true,
    }
}

/// Backward search from events to the nodes that decide whether they occur.
struct Search<'a> {
    net: &'a Net,
    seen: FxHashSet<NodeId>,
    fragments: FxHashSet<FragmentId>,
    open: Vec<NodeId>,
}

impl<'a> Search<'a> {
    fn new(net: &'a Net) -> Search<'a> {
        Search {
            net,
            seen: FxHashSet::default(),
            fragments: FxHashSet::default(),
            open: Vec::new(),
        }
    }
    fn node(&mut self, id: NodeId) {
        if self.seen.insert(id) {
            self.open.push(id);
        }
    }

    fn fragment(&mut self, id: FragmentId) {
        let net = self.net;
        for id in net.ancestors(id) {
            if !self.fragments.insert(id) {
                return;
            }
            let fragment = net.fragment(id);
            if let Activation::When { condition, .. } = fragment.activation {
                self.node(condition.node);
            }
            if let Restart::Every(condition) = fragment.restart {
                self.node(condition.node);
            }
        }
    }

    /// Runs the search breadth first until it has found `limit` nodes, so that those nearest to the events remain.
    fn run(&mut self, limit: usize) {
        let mut at = 0;
        while at < self.open.len() {
            if at >= limit {
                for id in self.open.drain(limit..) {
                    self.seen.remove(&id);
                }
                return;
            }
            let id = self.open[at];
            at += 1;
            let net = self.net;
            let node = net.node(id);
            self.fragment(node.fragment);
            node.inputs
                .iter()
                .filter_map(Input::port)
                .for_each(|port| self.node(port.node));
        }
    }
}
