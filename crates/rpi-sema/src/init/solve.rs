//! Least solution: the abstract value of every flow in every phase.

use crate::hash::Set;
use crate::init::abstract_value::Condition;
use crate::init::abstract_value::Known;
use crate::init::abstract_value::Unless;
use crate::init::phases::{Active, PHASES, PerPhase, PhaseSet, REST, parents};
use crate::init::rules::{Rule, is_by_first};
use rpi_image::Value;
use rpi_net::{Activation, FragmentId, Input, Net, NodeId, PortRef, Restart};

/// Greatest number of conditions implied by a condition that are visited.
const MAX_IMPLIED: usize = 1000;

/// Abstract values of a net's flows, during and after the iteration.
pub(super) struct Solution<'n> {
    net: &'n Net,
    known: Vec<PerPhase<Known>>,
    rules: Vec<Rule>,
    /// For each fragment, its activity by phase of its parent.
    active: Vec<PerPhase<Active>>,
    /// For each phase of each fragment, the possible phases of its parent.
    parents: Vec<PerPhase<PhaseSet>>,
    /// Values that claims state: node, phase and value, sorted.
    claimed: Vec<(NodeId, usize, bool)>,
}

/// Abstract value of a flow for a reader in another fragment.
pub(super) struct Seen {
    pub(super) known: Known,
    /// Activity of the fragments between the reader and the flow.
    pub(super) there: Active,
}

impl<'n> Solution<'n> {
    /// Solves the equations of all nodes. Conditions in `claims` are taken as true.
    pub(super) fn new(net: &'n Net, rules: Vec<Rule>, claims: &[PortRef]) -> Self {
        let mut solution = Solution {
            net,
            known: vec![std::array::from_fn(|_| Known::Never); net.nodes.len()],
            rules,
            active: vec![[Active::Always; PHASES]; net.fragments.len()],
            parents: vec![std::array::from_fn(PhaseSet::only); net.fragments.len()],
            claimed: Vec::new(),
        };
        for claim in claims {
            solution.claim(*claim);
        }
        for fragment in net.fragment_ids() {
            solution.activate(fragment);
        }
        solution.solve();
        solution
    }

    fn solve(&mut self) {
        let net = self.net;
        let readers = crate::init::worklist::Readers::new(net);
        let mut open = crate::init::worklist::Agenda::all(net);
        while let Some(id) = open.next() {
            let next: PerPhase<Known> = std::array::from_fn(|phase| {
                let known = self.of_node(id, phase);
                // Joined with the old value: a value never descends in the lattice, so the iteration ends.
                self.known[id.index()][phase].join(&self.forced(id, phase, known))
            });
            if next == self.known[id.index()] {
                continue;
            }
            self.known[id.index()] = next;
            open.add(readers.of(id));
            for fragment in readers.activated_by(id) {
                if self.activate(*fragment) {
                    open.add(readers.across(*fragment));
                }
            }
        }
    }

    /// Updates the activity of a fragment and returns whether it has changed.
    fn activate(&mut self, fragment: FragmentId) -> bool {
        let content = self.net.fragment(fragment);
        let Some(parent) = content.parent else {
            return false;
        };
        let active = match content.activation {
            Activation::Always => [Active::Always; PHASES],
            Activation::When { condition, .. } => {
                std::array::from_fn(|phase| Active::of(&self.seen(condition, parent, phase).known))
            }
        };
        let activated = matches!(content.activation, Activation::When { .. });
        let restarts = content.restart != Restart::Never;
        let parents = parents(&active, restarts, activated);
        let at = fragment.index();
        let changed = active != self.active[at] || parents != self.parents[at];
        (self.active[at], self.parents[at]) = (active, parents);
        changed
    }

    fn of_node(&self, id: NodeId, phase: usize) -> Known {
        let rule = self.rules[id.index()];
        crate::init::rules::apply(rule, self, id, phase)
    }

    pub(super) fn net(&self) -> &'n Net {
        self.net
    }

    /// Returns the abstract value of a node's input in a phase of the node's fragment.
    pub(super) fn input(&self, id: NodeId, input: usize, phase: usize) -> Seen {
        let node = self.net.node(id);
        match &node.inputs[input] {
            Input::Port(port) => self.seen(*port, node.fragment, phase),
            Input::Const(value) => Seen::there(Known::value((**value).clone())),
            Input::Open => Seen {
                known: Known::Defined,
                there: Active::Never,
            },
        }
    }

    /// Returns the abstract value of a flow for a reader in a phase of fragment `from`.
    pub(super) fn seen(&self, port: PortRef, from: FragmentId, phase: usize) -> Seen {
        let source = self.net.node(port.node).fragment;
        let known = &self.known[port.node.index()];
        if source == from {
            return Seen::there(known[phase].clone());
        }
        let (common, phases) = self.outwards(from, phase, source);
        let (phases, there) = self.inwards(common, phases, source);
        match phases.is_empty() {
            true => Seen {
                known: Known::Defined,
                there: Active::Never,
            },
            false => {
                let all = phases.phases().map(|phase| &known[phase]);
                let known = all.fold(Known::Never, |all, known| all.join(known));
                // The reader is active, so the conditions of its activation hold.
                let holds = |unless| match unless {
                    Unless::Now(one) => self.activations(from, common).contains(&one),
                    Unless::Since(..) => false,
                };
                Seen {
                    known: known.given(holds),
                    there,
                }
            }
        }
    }

    /// Returns the conditions that hold while fragment `from` is active, up to the enclosing fragment `around`.
    fn activations(&self, from: FragmentId, around: FragmentId) -> Vec<Condition> {
        let way = self.net.enclosing(from).take_while(|at| *at != around);
        let conditions = way.filter_map(|at| match self.net.fragment(at).activation {
            Activation::When { condition, .. } => Some(self.implied(condition, true)),
            Activation::Always => None,
        });
        conditions.flatten().collect()
    }

    /// Returns the innermost fragment that encloses both, and its possible phases.
    fn outwards(&self, from: FragmentId, phase: usize, to: FragmentId) -> (FragmentId, PhaseSet) {
        let mut at = from;
        let mut phases = PhaseSet::only(phase);
        while !self.net.enclosing(to).any(|fragment| fragment == at) {
            let sets = &self.parents[at.index()];
            let all = phases.phases().map(|phase| sets[phase]);
            phases = all.fold(PhaseSet::default(), PhaseSet::with);
            match self.net.fragment(at).parent {
                Some(parent) => at = parent,
                None => break,
            }
        }
        (at, phases)
    }

    /// Returns the possible phases of an inner fragment while an outer one is in one of `phases`, and the activity on
    /// the way.
    fn inwards(&self, from: FragmentId, phases: PhaseSet, to: FragmentId) -> (PhaseSet, Active) {
        let way: Vec<FragmentId> = self.net.enclosing(to).take_while(|f| *f != from).collect();
        let (mut phases, mut there) = (phases, Active::Always);
        for fragment in way.into_iter().rev() {
            let active = &self.active[fragment.index()];
            if phases.phases().any(|phase| active[phase] != Active::Always) {
                there = Active::Maybe;
            }
            let sets = &self.parents[fragment.index()];
            let mut inner = PhaseSet::default();
            for phase in (0..PHASES).filter(|phase| sets[*phase].meets(phases)) {
                inner = inner.with(PhaseSet::only(phase));
            }
            phases = inner;
        }
        (phases, there)
    }

    /// Returns the condition under which the fragment of a flow is active, if it is a child of the reader's fragment.
    pub(super) fn condition_of(&self, port: PortRef, reader: FragmentId) -> Option<Condition> {
        let fragment = self.net.fragment(self.net.node(port.node).fragment);
        match fragment.activation {
            Activation::When { condition, .. } if fragment.parent == Some(reader) => {
                Some(self.plain(condition, true))
            }
            _ => None,
        }
    }

    /// Returns the rule of a node.
    pub(super) fn rule_of(&self, id: NodeId) -> Rule {
        self.rules[id.index()]
    }

    /// Strips the negations from a condition.
    pub(super) fn plain(&self, port: PortRef, value: bool) -> Condition {
        let (mut port, mut value) = (port, value);
        while self.rules[port.node.index()] == Rule::Not {
            let Some(inner) = self.net.node(port.node).inputs[0].port() else {
                break;
            };
            (port, value) = (inner, !value);
        }
        (port, value)
    }

    /// Returns the conditions that hold if a condition has this value, including itself.
    pub(super) fn implied(&self, port: PortRef, value: bool) -> Vec<Condition> {
        let (mut all, mut open) = (Vec::new(), vec![self.plain(port, value)]);
        let mut seen = Set::default();
        while let Some((port, value)) = open.pop() {
            if seen.len() >= MAX_IMPLIED || !seen.insert((port, value)) {
                continue;
            }
            let parts = match (self.rules[port.node.index()], value) {
                (Rule::And, true) | (Rule::Or, false) => &self.net.node(port.node).inputs[..],
                _ => &[],
            };
            let parts = parts.iter().filter_map(Input::port);
            open.extend(parts.map(|part| self.plain(part, value)));
            all.push((port, value));
        }
        all
    }

    /// Records the values that a claim states for flows of its own fragment.
    fn claim(&mut self, claim: PortRef) {
        for phase in 0..PHASES {
            let mut open = vec![(claim, true)];
            let mut seen = Set::default();
            while let Some((port, value)) = open.pop() {
                let (port, value) = self.plain(port, value);
                if !seen.insert((port, value)) {
                    continue;
                }
                let node = self.net.node(port.node);
                self.claimed.push((port.node, phase, value));
                let inputs = match (self.rules[port.node.index()], value) {
                    (Rule::And, true) | (Rule::Or, false) => &node.inputs[..],
                    (Rule::Choice, _) if is_by_first(self.net, &self.rules, port.node) => {
                        match phase {
                            0 => &node.inputs[1..2],
                            _ => &node.inputs[2..3],
                        }
                    }
                    _ => &[],
                };
                let inner = inputs.iter().filter_map(Input::port);
                open.extend(
                    inner
                        .filter(|p| self.net.node(p.node).fragment == node.fragment)
                        .map(|p| (p, value)),
                );
            }
        }
        self.claimed.sort_unstable();
        self.claimed.dedup();
    }

    fn forced(&self, id: NodeId, phase: usize, known: Known) -> Known {
        let claimed = |value| self.claimed.binary_search(&(id, phase, value)).is_ok();
        match known {
            Known::Defined if claimed(true) => Known::value(Value::bool(true)),
            Known::Defined if claimed(false) => Known::value(Value::bool(false)),
            known => known,
        }
    }
}

impl Seen {
    fn there(known: Known) -> Seen {
        Seen {
            known,
            there: Active::Always,
        }
    }
}

/// Returns the phases whose last value a delay outputs in a phase.
pub(super) fn before(phase: usize) -> &'static [usize] {
    const BEFORE: PerPhase<&[usize]> = [&[], &[0], &[1], &[2], &[REST - 1, REST]];
    BEFORE[phase]
}
