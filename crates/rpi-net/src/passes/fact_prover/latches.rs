//! Latches (`Core::Trigger`) that are never on in the same cycle because of earlier cycles.
//!
//! A latch without reset turns on at most once and then off for good. So two latches exclude each other if the cause of
//! one, or a latch that must have been on before it, turns the other off. They also exclude each other if both are
//! turned on by a signal that occurs at most once, but never both in one cycle.

use super::facts::{EffortBudget, Facts, ProofContext};
use super::truth_tables::ValueSet;
use crate::net::{Activation, FragmentId, Input, Node, NodeId, PortRef, Restart};
use rpi_image::{Role, Value};
use std::cell::RefCell;
use std::collections::{BTreeMap, BTreeSet};

/// Maximum number of flows that one search over logic gates visits. Bounds the compile time.
const EFFORT: usize = 400;
/// Maximum nesting depth of logic gates that a search follows. Deeper flows count as unknown.
const DEPTH: usize = 100;

/// Latches (primitives that store a Boolean) of a net that turn on at most once. A latch is identified by an index.
pub(super) struct Latches {
    /// Index of the latch at each node.
    index: BTreeMap<NodeId, usize>,
    /// For each latch, the latches that it turns off permanently when it turns on.
    turned_off: Vec<BTreeSet<usize>>,
    /// For each latch, the latches that must have been on before or turn on in the same cycle.
    prerequisites: Vec<BTreeSet<usize>>,
    /// For each latch, the signals that are true in at most one cycle and must be true when it turns on.
    one_time_signals: Vec<BTreeSet<PortRef>>,
    /// Cache: whether it is proved that a pair of latches does not turn on in the same cycle.
    never_simultaneous: RefCell<BTreeMap<(usize, usize), bool>>,
    nodes: Vec<NodeId>,
}

impl Latches {
    pub(super) fn new(background: ProofContext<'_>) -> Self {
        let net = background.net;
        let nodes: Vec<NodeId> = net
            .node_ids()
            .filter(|id| is_one_shot_latch(background, *id))
            .collect();
        let index: BTreeMap<NodeId, usize> = nodes.iter().copied().zip(0..).collect();
        let mut finder = PrerequisiteSearch {
            background,
            index: &index,
            found: BTreeMap::new(),
        };
        let needs = nodes
            .iter()
            .map(|n| finder.needs_of(&net.node(*n).inputs[0], 0))
            .collect();
        let consequences: Vec<BTreeSet<PortRef>> = nodes
            .iter()
            .map(|n| {
                closure(
                    background,
                    switch_source(background, *n, 0),
                    "Core::BooleanAnd",
                )
            })
            .collect();
        let once = consequences.iter().map(|all| {
            all.iter()
                .copied()
                .filter(|p| occurs_at_most_once(background, *p, &index, DEPTH))
                .collect()
        });
        Latches {
            turned_off: stops(background, &nodes, &consequences),
            prerequisites: needs,
            one_time_signals: once.collect(),
            never_simultaneous: RefCell::default(),
            index,
            nodes,
        }
    }

    /// Returns whether the facts are contradictory, because they imply that two latches are on that are never on
    /// together.
    pub(super) fn exclude(&self, facts: &Facts<'_>, effort: &EffortBudget) -> bool {
        let on = facts.known().filter(|(_, set)| *set == ValueSet::TRUE);
        let on: Vec<usize> = on
            .filter_map(|(p, _)| self.index.get(&p.node).copied())
            .collect();
        on.iter().any(|a| {
            let before = self.on_before(*a);
            let is_stopped = |b: &usize| before.iter().any(|c| self.turned_off[*c].contains(b));
            on.iter()
                .any(|b| is_stopped(b) || (a < b && self.decided_at_once(*a, *b, facts, effort)))
        })
    }

    /// Returns the latch itself and all latches that must have been on before it or turn on in the same cycle.
    fn on_before(&self, latch: usize) -> BTreeSet<usize> {
        let mut all = BTreeSet::from([latch]);
        let mut open = vec![latch];
        while let Some(next) = open.pop() {
            open.extend(self.prerequisites[next].iter().filter(|n| all.insert(**n)));
        }
        all
    }

    fn decided_at_once(
        &self,
        a: usize,
        b: usize,
        facts: &Facts<'_>,
        effort: &EffortBudget,
    ) -> bool {
        let shares = self.one_time_signals[a]
            .intersection(&self.one_time_signals[b])
            .next()
            .is_some();
        shares && self.never_go_on_together(a, b, facts.background(), effort)
    }

    fn never_go_on_together(
        &self,
        a: usize,
        b: usize,
        background: ProofContext<'_>,
        effort: &EffortBudget,
    ) -> bool {
        if let Some(known) = self.never_simultaneous.borrow().get(&(a, b)) {
            return *known;
        }
        let mut facts = Facts::new(background, effort);
        let assumed = [a, b].into_iter().try_for_each(|latch| {
            let id = self.nodes[latch];
            let fragment = background.net.node(id).fragment;
            facts.activate(fragment)?;
            match switch_source(background, id, 0) {
                Some(port) => facts.require(fragment, port, ValueSet::TRUE),
                None => Ok(()),
            }
        });
        let apart = assumed.and_then(|()| facts.propagate()).is_err();
        self.never_simultaneous.borrow_mut().insert((a, b), apart);
        apart
    }
}

/// Returns whether a node is a latch that is never reset, so that it turns on at most once.
fn is_one_shot_latch(background: ProofContext<'_>, id: NodeId) -> bool {
    let net = background.net;
    let node = net.node(id);
    let is_latch = node.desc().name == "Core::Trigger";
    let no_reset = node
        .inputs
        .get(2)
        .is_some_and(|i| is_constant(background, i, false));
    is_latch && no_reset && never_restarts(background, node.fragment)
}

fn never_restarts(background: ProofContext<'_>, fragment: FragmentId) -> bool {
    let mut chain = background.net.ancestors(fragment);
    chain.all(|f| background.net.fragment(f).restart == Restart::Never)
}

fn is_constant(background: ProofContext<'_>, input: &Input, expected: bool) -> bool {
    let value = match input {
        Input::Unconnected => return !expected,
        Input::Const(value) => Some(&**value),
        Input::Port(port) => {
            let node = background.net.node(port.node);
            node.params
                .first()
                .filter(|_| node.desc().role == Role::Constant)
        }
    };
    value.and_then(Value::as_bool) == Some(expected)
}

/// Returns the flow at the in-port `inOn` (`input` is 0) or `inOff` (1) of a latch; `None` if a constant or nothing is
/// connected.
fn switch_source(background: ProofContext<'_>, latch: NodeId, input: usize) -> Option<PortRef> {
    background.net.node(latch).inputs.get(input)?.port()
}

/// Returns the flow `start` and all flows that are its operands through gates of the type `gate`, directly or
/// indirectly.
///
/// For conjunctions, all these flows must be true with `start`; for disjunctions, each of them makes `start` true.
fn closure(background: ProofContext<'_>, start: Option<PortRef>, gate: &str) -> BTreeSet<PortRef> {
    let mut all: BTreeSet<PortRef> = start.into_iter().collect();
    let mut open: Vec<PortRef> = all.iter().copied().collect();
    while let Some(port) = open.pop().filter(|_| all.len() < EFFORT) {
        let node = background.net.node(port.node);
        if node.desc().name == gate {
            let operands = node.inputs.iter().filter_map(Input::port);
            open.extend(operands.filter(|p| all.insert(*p)));
        }
    }
    all
}

/// Returns for each latch the latches that it turns off when it turns on. A flow in `consequences`, which is then true,
/// implies their `inOff`.
///
/// These latches are in the same fragment or an enclosing one, so that they are evaluated in that cycle.
fn stops(
    background: ProofContext<'_>,
    nodes: &[NodeId],
    consequences: &[BTreeSet<PortRef>],
) -> Vec<BTreeSet<usize>> {
    let mut stopped_by: BTreeMap<PortRef, Vec<usize>> = BTreeMap::new();
    for (k, latch) in nodes.iter().enumerate() {
        for cause in closure(
            background,
            switch_source(background, *latch, 1),
            "Core::BooleanOr",
        ) {
            stopped_by.entry(cause).or_default().push(k);
        }
    }
    let fragment = |k: usize| background.net.node(nodes[k]).fragment;
    let is_around = |outer, inner| background.tree.common_ancestor(outer, inner) == outer;
    let of = |(k, all): (usize, &BTreeSet<PortRef>)| {
        let stopped = all
            .iter()
            .filter_map(|p| stopped_by.get(p))
            .flatten()
            .copied();
        stopped
            .filter(|other| is_around(fragment(*other), fragment(k)))
            .collect()
    };
    consequences.iter().enumerate().map(of).collect()
}

/// Returns whether it is proved that a flow is true in at most one cycle. `depth` limits the recursion.
fn occurs_at_most_once(
    background: ProofContext<'_>,
    port: PortRef,
    latches: &BTreeMap<NodeId, usize>,
    depth: usize,
) -> bool {
    let node = background.net.node(port.node);
    if depth == 0 || !never_restarts(background, node.fragment) {
        return false;
    }
    let input = node.inputs.first();
    let source = input.and_then(Input::port);
    match node.desc().role {
        Role::First => true,
        Role::Delay => {
            source.is_some_and(|s| occurs_at_most_once(background, s, latches, depth - 1))
        }
        _ if node.desc().name == "Core::EdgeDetection" => {
            let rising = node.params.first().and_then(Value::as_bool) == Some(true);
            let latched = source.is_some_and(|s| latches.contains_key(&s.node));
            let constant = input.is_some_and(|i| {
                is_constant(background, i, true) || is_constant(background, i, false)
            });
            constant || (rising && latched)
        }
        _ => false,
    }
}

/// Search for the latches that must have been on whenever a flow is true.
struct PrerequisiteSearch<'a, 'b> {
    background: ProofContext<'a>,
    index: &'b BTreeMap<NodeId, usize>,
    found: BTreeMap<PortRef, BTreeSet<usize>>,
}

impl PrerequisiteSearch<'_, '_> {
    fn needs_of(&mut self, input: &Input, depth: usize) -> BTreeSet<usize> {
        match input.port() {
            Some(port) if depth < DEPTH => self.needs(port, depth),
            _ => BTreeSet::new(),
        }
    }

    fn needs(&mut self, port: PortRef, depth: usize) -> BTreeSet<usize> {
        if let Some(found) = self.found.get(&port) {
            return found.clone();
        }
        // Breaks recursion: an empty set is sound for a flow whose set is being computed.
        self.found.insert(port, BTreeSet::new());
        let node = self.background.net.node(port.node);
        let mut all = self.by_gate(port.node, node, depth + 1);
        for fragment in self.background.net.ancestors(node.fragment) {
            all.extend(self.by_activation(fragment, depth + 1));
        }
        self.found.insert(port, all.clone());
        all
    }

    fn by_gate(&mut self, id: NodeId, node: &Node, depth: usize) -> BTreeSet<usize> {
        if let Some(latch) = self.index.get(&id) {
            return BTreeSet::from([*latch]);
        }
        let rising = || node.params.first().and_then(Value::as_bool) == Some(true);
        match node.desc().name {
            "Core::BooleanAnd" => {
                let inputs = node.inputs.iter();
                inputs.flat_map(|i| self.needs_of(i, depth)).collect()
            }
            "Core::BooleanOr" => {
                let background = self.background;
                let live = node
                    .inputs
                    .iter()
                    .filter(|i| !is_constant(background, i, false));
                let all: Vec<BTreeSet<usize>> = live.map(|i| self.needs_of(i, depth)).collect();
                let common = all
                    .into_iter()
                    .reduce(|a, b| a.intersection(&b).copied().collect());
                common.unwrap_or_default()
            }
            "Core::EdgeDetection" if rising() => self.needs_of(&node.inputs[0], depth),
            "Core::Trigger" => self.needs_of(&node.inputs[0], depth),
            _ if node.desc().role == Role::Delay => self.needs_of(&node.inputs[0], depth),
            _ => BTreeSet::new(),
        }
    }

    fn by_activation(&mut self, fragment: FragmentId, depth: usize) -> BTreeSet<usize> {
        let Activation::When { condition, .. } = self.background.net.fragment(fragment).activation
        else {
            return BTreeSet::new();
        };
        // An absent condition may also activate, but a latch is always present.
        match self.index.get(&condition.node) {
            Some(latch) => BTreeSet::from([*latch]),
            None if depth < DEPTH && self.is_total(fragment, condition) => {
                self.needs(condition, depth)
            }
            None => BTreeSet::new(),
        }
    }

    fn is_total(&self, fragment: FragmentId, condition: PortRef) -> bool {
        let ProofContext {
            net,
            tree,
            presences,
            ..
        } = self.background;
        let parent = tree.parent(fragment).unwrap_or(FragmentId::ROOT);
        let seen = presences.presence_at(net, tree, parent, &Input::Port(condition));
        seen == crate::passes::presence::FlowPresence::Total
    }
}
