//! Least solution: the abstract value of every flow in every phase.

use crate::hash::FastSet;
use crate::init::abstract_value::AbstractValue;
use crate::init::abstract_value::Condition;
use crate::init::abstract_value::DefinedWhen;
use crate::init::phases::{Activity, LAST_PHASE, PHASES, PerPhase, PhaseSet, parent_phases};
use crate::init::rules::{TransferRule, is_by_first};
use rpi_image::Value;
use rpi_net::{Activation, FragmentId, Input, Net, NodeId, PortRef, Restart};

/// Maximum number of conditions that are visited when the consequences of a condition are collected.
const MAX_IMPLIED: usize = 1000;

/// Abstract values of the outputs of all nodes of a net in each phase, during and after the iteration to a fixed point.
pub(super) struct Solution<'n> {
    net: &'n Net,
    values: Vec<PerPhase<AbstractValue>>,
    rules: Vec<TransferRule>,
    /// For each fragment, whether it is active in each phase of its parent.
    active: Vec<PerPhase<Activity>>,
    /// For each fragment and each of its phases, the phases in which its parent can be at that time.
    parents: Vec<PerPhase<PhaseSet>>,
    /// Values that claims taken as true give to Boolean flows: node, phase of its fragment, and value. The list is
    /// sorted.
    claimed_values: Vec<(NodeId, usize, bool)>,
}

/// Abstract value of a flow as it is read in another fragment.
pub(super) struct ReadValue {
    pub(super) value: AbstractValue,
    /// Whether the fragments between the read and the flow are active.
    pub(super) activity: Activity,
}

impl<'n> Solution<'n> {
    /// Computes the abstract values of all nodes of a net. `rules` has the transfer function of each node. The
    /// conditions in `claims` are taken as true.
    pub(super) fn new(net: &'n Net, rules: Vec<TransferRule>, claims: &[PortRef]) -> Self {
        let mut solution = Solution {
            net,
            values: vec![std::array::from_fn(|_| AbstractValue::Unreachable); net.nodes.len()],
            rules,
            active: vec![[Activity::Always; PHASES]; net.fragments.len()],
            parents: vec![std::array::from_fn(PhaseSet::single); net.fragments.len()],
            claimed_values: Vec::new(),
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
        let readers = crate::init::worklist::Dependents::new(net);
        let mut open = crate::init::worklist::Worklist::new(net);
        while let Some(id) = open.next() {
            let next: PerPhase<AbstractValue> = std::array::from_fn(|phase| {
                let known = self.node_value(id, phase);
                // Joined with the old value: a value never descends in the lattice, so the iteration ends.
                self.values[id.index()][phase].join(&self.apply_claims(id, phase, known))
            });
            if next == self.values[id.index()] {
                continue;
            }
            self.values[id.index()] = next;
            open.add(readers.users(id));
            for fragment in readers.sample_activated_case(id) {
                if self.activate(*fragment) {
                    open.add(readers.across(*fragment));
                }
            }
        }
    }

    /// Updates whether a fragment is active in each phase of its parent, and returns whether this has changed.
    fn activate(&mut self, fragment: FragmentId) -> bool {
        let content = self.net.fragment(fragment);
        let Some(parent) = content.parent else {
            return false;
        };
        let active = match content.activation {
            Activation::Always => [Activity::Always; PHASES],
            Activation::When { condition, .. } => std::array::from_fn(|phase| {
                Activity::from_condition(&self.value_for(condition, parent, phase).value)
            }),
        };
        let activated = matches!(content.activation, Activation::When { .. });
        let restarts = content.restart != Restart::Never;
        let parents = parent_phases(&active, restarts, activated);
        let at = fragment.index();
        let changed = active != self.active[at] || parents != self.parents[at];
        (self.active[at], self.parents[at]) = (active, parents);
        changed
    }

    fn node_value(&self, id: NodeId, phase: usize) -> AbstractValue {
        let rule = self.rules[id.index()];
        crate::init::rules::apply(rule, self, id, phase)
    }

    pub(super) fn net(&self) -> &'n Net {
        self.net
    }

    /// Returns the abstract value of the input with index `input` of a node, in a phase of the node's fragment.
    pub(super) fn input(&self, id: NodeId, input: usize, phase: usize) -> ReadValue {
        let node = self.net.node(id);
        match &node.inputs[input] {
            Input::Port(port) => self.value_for(*port, node.fragment, phase),
            Input::Const(value) => {
                ReadValue::always_active(AbstractValue::from_value((**value).clone()))
            }
            Input::Unconnected => ReadValue {
                value: AbstractValue::Defined,
                activity: Activity::Never,
            },
        }
    }

    /// Returns the abstract value of a port for a read in the given phase of the fragment `from`.
    pub(super) fn value_for(&self, port: PortRef, from: FragmentId, phase: usize) -> ReadValue {
        let source = self.net.node(port.node).fragment;
        let known = &self.values[port.node.index()];
        if source == from {
            return ReadValue::always_active(known[phase].clone());
        }
        let (common, phases) = self.common_ancestor(from, phase, source);
        let (phases, there) = self.inner_phases(common, phases, source);
        match phases.is_empty() {
            true => ReadValue {
                value: AbstractValue::Defined,
                activity: Activity::Never,
            },
            false => {
                let all = phases.phases().map(|phase| &known[phase]);
                let known = all.fold(AbstractValue::Unreachable, |all, known| all.join(known));
                // The reader is active, so the conditions of its activation hold.
                let holds = |unless| match unless {
                    DefinedWhen::Now(one) => self.activations(from, common).contains(&one),
                    DefinedWhen::Since(..) => false,
                };
                ReadValue {
                    value: known.assuming(holds),
                    activity: there,
                }
            }
        }
    }

    /// Returns the conditions that hold while the fragment `from` is active: the activation conditions of the fragments
    /// from `from` outwards, up to but not including `around`, with their consequences.
    fn activations(&self, from: FragmentId, around: FragmentId) -> Vec<Condition> {
        let way = self.net.ancestors(from).take_while(|at| *at != around);
        let conditions = way.filter_map(|at| match self.net.fragment(at).activation {
            Activation::When { condition, .. } => Some(self.implied_conditions(condition, true)),
            Activation::Always => None,
        });
        conditions.flatten().collect()
    }

    /// Returns the innermost fragment that encloses both `from` and `to`, and its possible phases while `from` is in
    /// the given phase.
    fn common_ancestor(
        &self,
        from: FragmentId,
        phase: usize,
        to: FragmentId,
    ) -> (FragmentId, PhaseSet) {
        let mut at = from;
        let mut phases = PhaseSet::single(phase);
        while !self.net.ancestors(to).any(|fragment| fragment == at) {
            let sets = &self.parents[at.index()];
            let all = phases.phases().map(|phase| sets[phase]);
            phases = all.fold(PhaseSet::default(), PhaseSet::union);
            match self.net.fragment(at).parent {
                Some(parent) => at = parent,
                None => break,
            }
        }
        (at, phases)
    }

    /// Returns the possible phases of the fragment `to` while the fragment `from`, which encloses it, is in one of the
    /// phases `phases`. Also returns whether the fragments in between are active.
    fn inner_phases(
        &self,
        from: FragmentId,
        phases: PhaseSet,
        to: FragmentId,
    ) -> (PhaseSet, Activity) {
        let way: Vec<FragmentId> = self.net.ancestors(to).take_while(|f| *f != from).collect();
        let (mut phases, mut there) = (phases, Activity::Always);
        for fragment in way.into_iter().rev() {
            let active = &self.active[fragment.index()];
            if phases
                .phases()
                .any(|phase| active[phase] != Activity::Always)
            {
                there = Activity::Maybe;
            }
            let sets = &self.parents[fragment.index()];
            let mut inner = PhaseSet::default();
            for phase in (0..PHASES).filter(|phase| sets[*phase].intersects(phases)) {
                inner = inner.union(PhaseSet::single(phase));
            }
            phases = inner;
        }
        (phases, there)
    }

    /// Returns the condition under which the fragment of a port is active, if that fragment is a child of the fragment
    /// `reader`; `None` otherwise.
    pub(super) fn condition_of(&self, port: PortRef, reader: FragmentId) -> Option<Condition> {
        let fragment = self.net.fragment(self.net.node(port.node).fragment);
        match fragment.activation {
            Activation::When { condition, .. } if fragment.parent == Some(reader) => {
                Some(self.strip_negations(condition, true))
            }
            _ => None,
        }
    }

    /// Returns the transfer function of a node in the analysis of initialisation.
    pub(super) fn rule_of(&self, id: NodeId) -> TransferRule {
        self.rules[id.index()]
    }

    /// Returns a condition without negations that is equivalent to the given one: the port behind all `not` operations,
    /// and the value that it must have.
    pub(super) fn strip_negations(&self, port: PortRef, value: bool) -> Condition {
        let (mut port, mut value) = (port, value);
        while self.rules[port.node.index()] == TransferRule::Not {
            let Some(inner) = self.net.node(port.node).inputs[0].port() else {
                break;
            };
            (port, value) = (inner, !value);
        }
        (port, value)
    }

    /// Returns the conditions that hold if the given port has the given value. The given condition is one of them.
    pub(super) fn implied_conditions(&self, port: PortRef, value: bool) -> Vec<Condition> {
        let (mut all, mut open) = (Vec::new(), vec![self.strip_negations(port, value)]);
        let mut seen = FastSet::default();
        while let Some((port, value)) = open.pop() {
            if seen.len() >= MAX_IMPLIED || !seen.insert((port, value)) {
                continue;
            }
            let parts = match (self.rules[port.node.index()], value) {
                (TransferRule::And, true) | (TransferRule::Or, false) => {
                    &self.net.node(port.node).inputs[..]
                }
                _ => &[],
            };
            let parts = parts.iter().filter_map(Input::port);
            open.extend(parts.map(|part| self.strip_negations(part, value)));
            all.push((port, value));
        }
        all
    }

    /// Records the values that a claim taken as true gives to flows of its own fragment.
    fn claim(&mut self, claim: PortRef) {
        for phase in 0..PHASES {
            let mut open = vec![(claim, true)];
            let mut seen = FastSet::default();
            while let Some((port, value)) = open.pop() {
                let (port, value) = self.strip_negations(port, value);
                if !seen.insert((port, value)) {
                    continue;
                }
                let node = self.net.node(port.node);
                self.claimed_values.push((port.node, phase, value));
                let inputs = match (self.rules[port.node.index()], value) {
                    (TransferRule::And, true) | (TransferRule::Or, false) => &node.inputs[..],
                    (TransferRule::Conditional, _)
                        if is_by_first(self.net, &self.rules, port.node) =>
                    {
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
        self.claimed_values.sort_unstable();
        self.claimed_values.dedup();
    }

    fn apply_claims(&self, id: NodeId, phase: usize, known: AbstractValue) -> AbstractValue {
        let claimed = |value| {
            self.claimed_values
                .binary_search(&(id, phase, value))
                .is_ok()
        };
        match known {
            AbstractValue::Defined if claimed(true) => AbstractValue::from_value(Value::bool(true)),
            AbstractValue::Defined if claimed(false) => {
                AbstractValue::from_value(Value::bool(false))
            }
            known => known,
        }
    }
}

impl ReadValue {
    fn always_active(known: AbstractValue) -> ReadValue {
        ReadValue {
            value: known,
            activity: Activity::Always,
        }
    }
}

/// Returns the phases in which a delay can have read the value that it outputs in the given phase.
pub(super) fn previous_phases(phase: usize) -> &'static [usize] {
    const BEFORE: PerPhase<&[usize]> = [&[], &[0], &[1], &[2], &[LAST_PHASE - 1, LAST_PHASE]];
    BEFORE[phase]
}
