//! Constraint propagation of facts about one cycle: consequences of some flows being true and some fragments being
//! active.
//!
//! Each flow has a set of possible values. Gates narrow the sets of their inputs and outputs until nothing changes, or
//! a set becomes empty, which is a contradiction. Only nodes in fragments that are known to be active are propagated,
//! since other nodes are not evaluated. The method is sound, incomplete and bounded.

use super::Happening;
use super::numbers;
use super::truth::{self, Set, by_rule, constant};
use crate::net::{Absent, Activation, Driver, FragmentId, Input, Net, Node, NodeId, PortRef};
use crate::passes::presence::{Presences, Sureness};
use crate::passes::users::Users;
use crate::tree::Tree;
use rpi_image::{Presence, Role};
use std::cell::Cell;
use std::collections::{BTreeMap, BTreeSet};

/// Net with the analyses that proofs use.
#[derive(Clone, Copy)]
pub(crate) struct Background<'a> {
    pub(crate) net: &'a Net,
    pub(crate) tree: &'a Tree,
    pub(crate) users: &'a Users,
    pub(crate) presences: &'a Presences,
}

impl Background<'_> {
    /// Obstacles to an event: enclosing fragments that are not always active, and flows that may be absent.
    pub(crate) fn doubts(self, happening: &Happening) -> (Vec<FragmentId>, Vec<PortRef>) {
        let Background {
            net,
            tree,
            presences,
            ..
        } = self;
        let around = net.enclosing(happening.fragment);
        let gates = around.filter(|f| presences.activity(*f) != Sureness::Total);
        let seen = |p: &PortRef| presences.seen(net, tree, happening.fragment, &Input::Port(*p));
        let open = happening.present.iter().copied();
        let open = open.filter(|p| seen(p) != Sureness::Total);
        (gates.collect(), open.collect())
    }
}

/// Error for facts that contradict each other.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) struct Contradiction;

/// Remaining number of node visits.
pub(crate) type Effort = Cell<u32>;

/// Facts about one cycle.
#[derive(Clone)]
pub(crate) struct Facts<'a> {
    background: Background<'a>,
    known: BTreeMap<PortRef, Set>,
    active: BTreeSet<FragmentId>,
    queue: BTreeSet<NodeId>,
    effort: &'a Effort,
}

type Held = Result<(), Contradiction>;

impl<'a> Facts<'a> {
    pub(crate) fn new(background: Background<'a>, effort: &'a Effort) -> Self {
        Facts {
            background,
            known: BTreeMap::new(),
            active: BTreeSet::from([FragmentId::ROOT]),
            queue: BTreeSet::new(),
            effort,
        }
    }

    pub(crate) fn background(&self) -> Background<'a> {
        self.background
    }

    /// Adds that a fragment and all enclosing ones are active.
    pub(crate) fn activate(&mut self, fragment: FragmentId) -> Held {
        let chain: Vec<FragmentId> = self.background.net.enclosing(fragment).collect();
        for id in chain.into_iter().rev() {
            if self.active.insert(id) {
                self.activated(id)?;
            }
        }
        Ok(())
    }

    fn activated(&mut self, id: FragmentId) -> Held {
        let fragment = self.background.net.fragment(id);
        let (Activation::When { condition, absent }, Some(parent)) =
            (&fragment.activation, fragment.parent)
        else {
            return Ok(());
        };
        let allowed = match absent {
            Absent::Inactive => Set::TRUE,
            Absent::Active => Set::TRUE.or(Set::ABSENT),
        };
        self.require(parent, *condition, allowed)
    }

    /// Adds that a flow, as seen from an active fragment, has a value in `allowed`.
    pub(crate) fn require(&mut self, reader: FragmentId, port: PortRef, allowed: Set) -> Held {
        let gates = self.gates(reader, port);
        if !allowed.has(Set::ABSENT) {
            for gate in gates {
                self.activate(gate)?;
            }
        } else if let [gate] = gates[..]
            && allowed == Set::ABSENT
            && self.is_present_inside(gate, port)
        {
            return self.deactivate(gate);
        } else if !gates.is_empty() {
            // The flow may be absent because its fragment is inactive, so nothing is known about its own value.
            return Ok(());
        }
        self.narrow(port, allowed)
    }

    /// Whether a flow is present whenever its fragment is active.
    fn is_present_inside(&self, fragment: FragmentId, port: PortRef) -> bool {
        let mut facts = Facts::new(self.background, self.effort);
        let absent = facts
            .activate(fragment)
            .and_then(|()| facts.suppose(port, Set::ABSENT));
        absent.is_err()
    }

    /// Adds that a fragment is inactive while its parent is active.
    fn deactivate(&mut self, id: FragmentId) -> Held {
        let fragment = self.background.net.fragment(id);
        let (Activation::When { condition, absent }, Some(parent)) =
            (&fragment.activation, fragment.parent)
        else {
            return Err(Contradiction);
        };
        // Conditions of a program are total (M4), which the type checker ensures, except those from a sibling clock.
        let is_program = matches!(self.background.net.driver, Driver::Results(_));
        let is_total = is_program && self.gates(parent, *condition).is_empty();
        let allowed = match absent {
            Absent::Inactive if !is_total => Set::FALSE.or(Set::ABSENT),
            _ => Set::FALSE,
        };
        self.require(parent, *condition, allowed)
    }

    /// Adds that an event does not occur. Adds nothing if more than one cause is possible.
    pub(crate) fn deny(&mut self, happening: &Happening) -> Held {
        let (gates, open) = self.background.doubts(happening);
        match (&gates[..], &open[..]) {
            ([], []) => Err(Contradiction),
            ([gate], []) => self.deactivate(*gate),
            ([], [port]) => self.require(happening.fragment, *port, Set::ABSENT),
            _ => Ok(()),
        }
    }

    /// Adds that a flow of an active fragment has a value in `allowed`, and propagates.
    pub(crate) fn suppose(&mut self, port: PortRef, allowed: Set) -> Held {
        self.narrow(port, allowed)?;
        self.propagate()
    }

    /// Combines two sets of facts.
    pub(crate) fn joined(&self, other: &Facts<'a>) -> Result<Facts<'a>, Contradiction> {
        let mut both = self.clone();
        both.active.extend(&other.active);
        for (port, set) in &other.known {
            both.narrow(*port, *set)?;
        }
        Ok(both)
    }

    /// Propagates all facts until nothing changes or the effort is exhausted.
    pub(crate) fn propagate(&mut self) -> Held {
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

    /// Checks the comparisons of numbers for contradictions.
    pub(crate) fn check_numbers(&self) -> Held {
        numbers::check(self.background.net, &self.known)
    }

    /// Possible values of a flow within its own fragment.
    pub(crate) fn own(&self, port: PortRef) -> Set {
        self.known
            .get(&port)
            .copied()
            .unwrap_or_else(|| self.at_first(port))
    }

    /// Flows with facts.
    pub(crate) fn known(&self) -> impl Iterator<Item = (PortRef, Set)> + '_ {
        self.known.iter().map(|(port, set)| (*port, *set))
    }

    fn at_first(&self, port: PortRef) -> Set {
        let node = self.background.net.node(port.node);
        let is_boolean = truth::is_boolean(node.outputs[usize::from(port.port)]);
        if let (Role::Constant, Some(value)) = (node.desc().role, node.params.first()) {
            return constant(value);
        }
        let present = if is_boolean { Set::PRESENT } else { Set::TRUE };
        match self.background.presences.own(port) {
            Sureness::Total => present,
            Sureness::Optional => present.or(Set::ABSENT),
            Sureness::Never => Set::ABSENT,
        }
    }

    /// Fragments that must be active for the reader to see the flow as present, except those known to be active.
    fn gates(&self, reader: FragmentId, port: PortRef) -> Vec<FragmentId> {
        let Background {
            net,
            tree,
            presences,
            ..
        } = self.background;
        let mut gates = presences.view(net, tree, reader, port).through;
        gates.retain(|g| !self.active.contains(g));
        gates
    }

    fn narrow(&mut self, port: PortRef, allowed: Set) -> Held {
        let before = self.own(port);
        let after = before.and(allowed);
        if after == Set::NONE {
            return Err(Contradiction);
        }
        let is_open = after.members().count() > 1;
        if after == before && !is_open {
            return Ok(());
        }
        let is_new = self.known.insert(port, after).is_none();
        if after != before || is_new {
            self.queue.insert(port.node);
            self.queue.extend(self.background.users.of(port.node));
        }
        Ok(())
    }

    /// Possible values of an input as its reader sees them.
    fn seen(&self, reader: FragmentId, input: &Input) -> Set {
        match input {
            Input::Open => Set::ABSENT,
            Input::Const(value) => constant(value),
            Input::Port(port) if self.gates(reader, *port).is_empty() => self.own(*port),
            Input::Port(port) => self.own(*port).or(Set::ABSENT),
        }
    }

    /// Narrows the possible values of a node's ports.
    fn revise(&mut self, id: NodeId) -> Held {
        let node = self.background.net.node(id);
        let is_state = matches!(node.desc().role, Role::Delay | Role::Constant);
        if is_state || !self.active.contains(&node.fragment) || node.outputs.is_empty() {
            return Ok(());
        }
        let seen: Vec<Set> = node
            .inputs
            .iter()
            .map(|i| self.seen(node.fragment, i))
            .collect();
        match truth::gate(node) {
            Some(gate) => self.revise_gate(id, &seen, |inputs| gate(node, inputs)),
            None => self.revise_by_rule(id, &seen),
        }
    }

    /// Keeps the values of inputs and output that occur in some combination allowed by the gate.
    fn revise_gate(&mut self, id: NodeId, seen: &[Set], gate: impl Fn(&[Set]) -> Set) -> Held {
        let net = self.background.net;
        let port = PortRef { node: id, port: 0 };
        let output = self.own(port);
        let (mut inputs, mut outputs) = (vec![Set::NONE; seen.len()], Set::NONE);
        for combination in combinations(seen) {
            let given = gate(&combination).and(output);
            if given != Set::NONE {
                outputs = outputs.or(given);
                for (all, one) in inputs.iter_mut().zip(&combination) {
                    *all = all.or(*one);
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
                None if *allowed == Set::NONE => return Err(Contradiction),
                _ => {}
            }
        }
        Ok(())
    }

    fn revise_by_rule(&mut self, id: NodeId, seen: &[Set]) -> Held {
        let node = self.background.net.node(id);
        let sets: Vec<Set> = connected(node, seen).map(|(_, s)| *s).collect();
        for (k, output) in (0..).zip(node.desc().outputs) {
            let port = PortRef { node: id, port: k };
            let given = by_rule(output.presence, &sets, node.outputs[usize::from(k)]);
            self.narrow_if(port, given)?;
            if self.own(port) == Set::ABSENT {
                self.revise_absent(id, output.presence, seen)?;
            }
            let is_sure = !self.own(port).has(Set::ABSENT);
            if is_sure && output.presence == Presence::Strict {
                for source in node.inputs.iter().filter_map(Input::port) {
                    self.require(node.fragment, source, Set::PRESENT)?;
                }
            }
        }
        Ok(())
    }

    /// Narrows the inputs of a node whose output is absent.
    fn revise_absent(&mut self, id: NodeId, rule: Presence, seen: &[Set]) -> Held {
        let node = self.background.net.node(id);
        let open = connected(node, seen)
            .filter(|(_, set)| rule == Presence::IfAny || set.has(Set::ABSENT));
        let open: Vec<&Input> = open.map(|(input, _)| input).collect();
        let follows = rule == Presence::IfAny || (rule == Presence::Strict && open.len() == 1);
        for input in open.into_iter().filter(|_| follows) {
            match input.port() {
                Some(source) => self.require(node.fragment, source, Set::ABSENT)?,
                None => return Err(Contradiction),
            }
        }
        Ok(())
    }

    /// Like [`Facts::narrow`], but does nothing if the set does not change.
    fn narrow_if(&mut self, port: PortRef, allowed: Set) -> Held {
        match self.own(port).within(allowed) {
            true => Ok(()),
            false => self.narrow(port, allowed),
        }
    }
}

/// Connected inputs of a node with their possible values.
fn connected<'n>(node: &'n Node, seen: &'n [Set]) -> impl Iterator<Item = (&'n Input, &'n Set)> {
    let inputs = node.inputs.iter().zip(seen);
    inputs.filter(|(input, _)| !matches!(input, Input::Open))
}

/// Cartesian product: all ways to choose one member of each set.
fn combinations(sets: &[Set]) -> Vec<Vec<Set>> {
    sets.iter().fold(vec![Vec::new()], |done, set| {
        let with = |chosen: &Vec<Set>, member| {
            let mut longer = chosen.clone();
            longer.push(member);
            longer
        };
        done.iter()
            .flat_map(|chosen| set.members().map(move |m| with(chosen, m)))
            .collect()
    })
}
