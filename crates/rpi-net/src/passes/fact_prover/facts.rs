//! Constraint propagation of facts about one cycle: consequences of some flows being true and some fragments being
//! active.
//!
//! Each flow has a set of possible values. Gates narrow the sets of their inputs and outputs until nothing changes, or
//! a set becomes empty, which is a contradiction. Only nodes in fragments that are known to be active are propagated,
//! since other nodes are not evaluated. The method is sound, incomplete and bounded.

use super::contradiction::ContradictionError;
use super::event::Event;
use super::numbers;
use super::truth_tables::{self, ValueSet, by_rule, constant};
use crate::fragment_tree::FragmentTree;
use crate::net::{
    AbsentPolicy, Activation, FragmentId, Input, Net, Node, NodeId, PortRef, Termination,
};
use crate::passes::presence::{FlowPresence, Presences};
use crate::passes::users::Readers;
use rpi_image::{Presence, Role};
use std::cell::Cell;
use std::collections::{BTreeMap, BTreeSet};

/// Net with the results of the analyses that proofs use.
#[derive(Clone, Copy)]
pub(crate) struct ProofContext<'a> {
    pub(crate) net: &'a Net,
    pub(crate) tree: &'a FragmentTree,
    pub(crate) users: &'a Readers,
    pub(crate) presences: &'a Presences,
}

impl ProofContext<'_> {
    /// Returns the conditions on which an event depends: the enclosing fragments that are not always active, and the
    /// flows that may be absent.
    pub(crate) fn obstacles(self, event: &Event) -> (Vec<FragmentId>, Vec<PortRef>) {
        let ProofContext {
            net,
            tree,
            presences,
            ..
        } = self;
        let around = net.ancestors(event.fragment);
        let gates = around.filter(|f| presences.activity(*f) != FlowPresence::Total);
        let seen = |p: &PortRef| presences.presence_at(net, tree, event.fragment, &Input::Port(*p));
        let open = event.present.iter().copied();
        let open = open.filter(|p| seen(p) != FlowPresence::Total);
        (gates.collect(), open.collect())
    }
}

/// Number of node visits that proofs may still make.
pub(crate) type EffortBudget = Cell<u32>;

/// Set of facts about one cycle: the fragments that are active, and the values that flows may have.
#[derive(Clone)]
pub(crate) struct Facts<'a> {
    background: ProofContext<'a>,
    known: BTreeMap<PortRef, ValueSet>,
    /// Fragments that are active because their conditions hold; see `is_active` for the others.
    active: BTreeSet<FragmentId>,
    queue: BTreeSet<NodeId>,
    effort: &'a EffortBudget,
}

type FactResult = Result<(), ContradictionError>;

impl<'a> Facts<'a> {
    pub(crate) fn new(background: ProofContext<'a>, effort: &'a EffortBudget) -> Self {
        Facts {
            background,
            known: BTreeMap::new(),
            active: BTreeSet::from([FragmentId::ROOT]),
            queue: BTreeSet::new(),
            effort,
        }
    }

    pub(crate) fn background(&self) -> ProofContext<'a> {
        self.background
    }

    /// Adds the fact that a fragment and all enclosing ones are active.
    pub(crate) fn activate(&mut self, fragment: FragmentId) -> FactResult {
        let chain: Vec<FragmentId> = self.background.net.ancestors(fragment).collect();
        for id in chain.into_iter().rev() {
            if self.active.insert(id) {
                self.activated(id)?;
            }
        }
        Ok(())
    }

    fn activated(&mut self, id: FragmentId) -> FactResult {
        let fragment = self.background.net.fragment(id);
        let (
            Activation::When {
                condition,
                if_absent: absent,
            },
            Some(parent),
        ) = (&fragment.activation, fragment.parent)
        else {
            return Ok(());
        };
        let allowed = match absent {
            AbsentPolicy::Inactive => ValueSet::TRUE,
            AbsentPolicy::Active => ValueSet::TRUE.union(ValueSet::ABSENT),
        };
        self.require(parent, *condition, allowed)
    }

    /// Adds the fact that a flow, as seen from the active fragment `reader`, has a value in `allowed`.
    pub(crate) fn require(
        &mut self,
        reader: FragmentId,
        port: PortRef,
        allowed: ValueSet,
    ) -> FactResult {
        let gates = self.gates(reader, port);
        if !allowed.intersects(ValueSet::ABSENT) {
            for gate in gates {
                self.activate(gate)?;
            }
        } else if let [gate] = gates[..]
            && allowed == ValueSet::ABSENT
            && self.is_present_inside(gate, port)
        {
            return self.deactivate(gate);
        } else if !gates.is_empty() {
            // The flow may be absent because its fragment is inactive, so nothing is known about its own value.
            return Ok(());
        }
        self.narrow(port, allowed)
    }

    /// Returns whether it is proved that a flow is present whenever the fragment is active.
    fn is_present_inside(&self, fragment: FragmentId, port: PortRef) -> bool {
        let mut facts = Facts::new(self.background, self.effort);
        let absent = facts
            .activate(fragment)
            .and_then(|()| facts.assume(port, ValueSet::ABSENT));
        absent.is_err()
    }

    /// Adds the fact that a fragment is inactive while its parent is active.
    fn deactivate(&mut self, id: FragmentId) -> FactResult {
        let fragment = self.background.net.fragment(id);
        let (
            Activation::When {
                condition,
                if_absent: absent,
            },
            Some(parent),
        ) = (&fragment.activation, fragment.parent)
        else {
            return Err(ContradictionError);
        };
        // Conditions of a program are total (M4), which the type checker ensures, except those from a sibling clock.
        let is_program = matches!(self.background.net.termination, Termination::Results(_));
        let is_total = is_program && self.gates(parent, *condition).is_empty();
        let allowed = match absent {
            AbsentPolicy::Inactive if !is_total => ValueSet::FALSE.union(ValueSet::ABSENT),
            _ => ValueSet::FALSE,
        };
        self.require(parent, *condition, allowed)
    }

    /// Adds the fact that an event does not occur. Adds nothing if more than one cause is possible.
    pub(crate) fn deny(&mut self, event: &Event) -> FactResult {
        let (gates, open) = self.background.obstacles(event);
        match (&gates[..], &open[..]) {
            ([], []) => Err(ContradictionError),
            ([gate], []) => self.deactivate(*gate),
            ([], [port]) => self.require(event.fragment, *port, ValueSet::ABSENT),
            _ => Ok(()),
        }
    }

    /// Adds the fact that a flow of an active fragment has a value in `allowed`, and derives further facts.
    pub(crate) fn assume(&mut self, port: PortRef, allowed: ValueSet) -> FactResult {
        self.narrow(port, allowed)?;
        self.propagate()
    }

    /// Returns the facts of both sets; an error if they contradict each other.
    pub(crate) fn conjoin(&self, other: &Facts<'a>) -> Result<Facts<'a>, ContradictionError> {
        let mut both = self.clone();
        both.active.extend(&other.active);
        for (port, set) in &other.known {
            both.narrow(*port, *set)?;
        }
        Ok(both)
    }

    /// Derives further facts until nothing changes or the effort is exhausted. Returns an error if the facts contradict
    /// each other.
    pub(crate) fn propagate(&mut self) -> FactResult {
        while let Some(id) = self.queue.pop_first() {
            let left = self.effort.get();
            if left == 0 {
                // Stopping early is sound: fewer facts prove less.
                self.queue.clear();
                return Ok(());
            }
            self.effort.set(left - 1);
            self.revise(id)?;
        }
        self.check_numbers()
    }

    /// Returns an error if the facts about comparisons of numbers contradict each other.
    pub(crate) fn check_numbers(&self) -> FactResult {
        numbers::check(self.background.net, &self.known)
    }

    /// Returns the possible values of a flow while its own fragment is active.
    pub(crate) fn possible_values(&self, port: PortRef) -> ValueSet {
        self.known
            .get(&port)
            .copied()
            .unwrap_or_else(|| self.initial_values(port))
    }

    /// Returns the flows about which facts are known, with their possible values.
    pub(crate) fn known(&self) -> impl Iterator<Item = (PortRef, ValueSet)> + '_ {
        self.known.iter().map(|(port, set)| (*port, *set))
    }

    fn initial_values(&self, port: PortRef) -> ValueSet {
        let node = self.background.net.node(port.node);
        let is_boolean = truth_tables::is_boolean(node.outputs[usize::from(port.port)]);
        if let (Role::Constant, Some(value)) = (node.desc().role, node.params.first()) {
            return constant(value);
        }
        let present = if is_boolean {
            ValueSet::PRESENT
        } else {
            ValueSet::TRUE
        };
        match self.background.presences.own(port) {
            FlowPresence::Total => present,
            FlowPresence::Optional => present.union(ValueSet::ABSENT),
            FlowPresence::Never => ValueSet::ABSENT,
        }
    }

    /// Returns the fragments that must be active so that a reader in the fragment `reader` sees the flow. Fragments
    /// that are known to be active are left out.
    fn gates(&self, reader: FragmentId, port: PortRef) -> Vec<FragmentId> {
        let ProofContext {
            net,
            tree,
            presences,
            ..
        } = self.background;
        let mut gates = presences.view(net, tree, reader, port).through;
        gates.retain(|g| !self.active.contains(g));
        gates
    }

    /// Returns whether a fragment is known to be active. A fragment without a condition, such as that of a call, is active
    /// with the one around it.
    fn is_active(&self, id: FragmentId) -> bool {
        let ProofContext { net, presences, .. } = self.background;
        for fragment in net.ancestors(id) {
            if self.active.contains(&fragment) {
                return true;
            }
            if presences.activity(fragment) != FlowPresence::Total {
                return false;
            }
        }
        true
    }

    fn narrow(&mut self, port: PortRef, allowed: ValueSet) -> FactResult {
        let before = self.possible_values(port);
        let after = before.intersection(allowed);
        if after == ValueSet::EMPTY {
            return Err(ContradictionError);
        }
        let is_open = after.members().count() > 1;
        if after == before && !is_open {
            return Ok(());
        }
        let is_new = self.known.insert(port, after).is_none();
        if after != before || is_new {
            self.queue.insert(port.node);
            self.queue
                .extend(self.background.users.readers_of(port.node));
        }
        Ok(())
    }

    /// Returns the possible values of an input for a reader in the fragment `reader`.
    fn seen_values(&self, reader: FragmentId, input: &Input) -> ValueSet {
        match input {
            Input::Unconnected => ValueSet::ABSENT,
            Input::Const(value) => constant(value),
            Input::Port(port) if self.gates(reader, *port).is_empty() => {
                self.possible_values(*port)
            }
            Input::Port(port) => self.possible_values(*port).union(ValueSet::ABSENT),
        }
    }

    /// Narrows the possible values of the inputs and outputs of a node.
    fn revise(&mut self, id: NodeId) -> FactResult {
        let node = self.background.net.node(id);
        let is_state = matches!(node.desc().role, Role::Delay | Role::Constant);
        if is_state || !self.is_active(node.fragment) || node.outputs.is_empty() {
            return Ok(());
        }
        let seen: Vec<ValueSet> = node
            .inputs
            .iter()
            .map(|i| self.seen_values(node.fragment, i))
            .collect();
        match truth_tables::gate(node) {
            Some(gate) => self.revise_gate(id, &seen, |inputs| gate(node, inputs)),
            None => self.revise_by_rule(id, &seen),
        }
    }

    /// Narrows the inputs and the output of a node to values that occur in some row of its truth table `gate`. `seen`
    /// are the possible values of the inputs.
    fn revise_gate(
        &mut self,
        id: NodeId,
        seen: &[ValueSet],
        gate: impl Fn(&[ValueSet]) -> ValueSet,
    ) -> FactResult {
        let net = self.background.net;
        let port = PortRef { node: id, port: 0 };
        let output = self.possible_values(port);
        let (mut inputs, mut outputs) = (vec![ValueSet::EMPTY; seen.len()], ValueSet::EMPTY);
        for combination in combinations(seen) {
            let possible = gate(&combination).intersection(output);
            if possible != ValueSet::EMPTY {
                outputs = outputs.union(possible);
                for (all, one) in inputs.iter_mut().zip(&combination) {
                    *all = all.union(*one);
                }
            }
        }
        self.narrow_if(port, outputs)?;
        let node = net.node(id);
        for (input, (allowed, before)) in node.inputs.iter().zip(inputs.iter().zip(seen)) {
            match input.port() {
                Some(source) if allowed != before => {
                    self.require(node.fragment, source, *allowed)?
                }
                None if *allowed == ValueSet::EMPTY => return Err(ContradictionError),
                _ => {}
            }
        }
        Ok(())
    }

    fn revise_by_rule(&mut self, id: NodeId, seen: &[ValueSet]) -> FactResult {
        let node = self.background.net.node(id);
        let sets: Vec<ValueSet> = connected(node, seen).map(|(_, s)| *s).collect();
        for (k, output) in (0..).zip(node.desc().outputs) {
            let port = PortRef { node: id, port: k };
            let possible = by_rule(output.presence, &sets, node.outputs[usize::from(k)]);
            self.narrow_if(port, possible)?;
            if self.possible_values(port) == ValueSet::ABSENT {
                self.revise_absent(id, output.presence, seen)?;
            }
            let is_sure = !self.possible_values(port).intersects(ValueSet::ABSENT);
            if is_sure && output.presence == Presence::Strict {
                for source in node.inputs.iter().filter_map(Input::port) {
                    self.require(node.fragment, source, ValueSet::PRESENT)?;
                }
            }
        }
        Ok(())
    }

    /// Narrows the inputs of a node whose output is known to be absent. `rule` is the presence rule of the output,
    /// `seen` the possible values of the inputs.
    fn revise_absent(&mut self, id: NodeId, rule: Presence, seen: &[ValueSet]) -> FactResult {
        let node = self.background.net.node(id);
        let open = connected(node, seen)
            .filter(|(_, set)| rule == Presence::IfAny || set.intersects(ValueSet::ABSENT));
        let open: Vec<&Input> = open.map(|(input, _)| input).collect();
        let follows = rule == Presence::IfAny || (rule == Presence::Strict && open.len() == 1);
        for input in open.into_iter().filter(|_| follows) {
            match input.port() {
                Some(source) => self.require(node.fragment, source, ValueSet::ABSENT)?,
                None => return Err(ContradictionError),
            }
        }
        Ok(())
    }

    /// Restricts the possible values of a flow to `allowed`. Does nothing if all of them are allowed already.
    fn narrow_if(&mut self, port: PortRef, allowed: ValueSet) -> FactResult {
        match self.possible_values(port).is_subset(allowed) {
            true => Ok(()),
            false => self.narrow(port, allowed),
        }
    }
}

/// Returns the connected inputs of a node with their possible values. `seen` has one entry per input.
fn connected<'n>(
    node: &'n Node,
    seen: &'n [ValueSet],
) -> impl Iterator<Item = (&'n Input, &'n ValueSet)> {
    let inputs = node.inputs.iter().zip(seen);
    inputs.filter(|(input, _)| !matches!(input, Input::Unconnected))
}

/// Returns all ways to choose one member of each set (Cartesian product).
fn combinations(sets: &[ValueSet]) -> Vec<Vec<ValueSet>> {
    sets.iter().fold(vec![Vec::new()], |done, set| {
        let with = |chosen: &Vec<ValueSet>, member| {
            let mut longer = chosen.clone();
            longer.push(member);
            longer
        };
        done.iter()
            .flat_map(|chosen| set.members().map(move |m| with(chosen, m)))
            .collect()
    })
}
