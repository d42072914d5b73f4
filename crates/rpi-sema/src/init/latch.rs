//! Latches: `seen = c or (false -> pre seen)` is true only if `c` is true or has been. Where `seen` is true, `current`
//! of a flow sampled by `c` therefore has a value.
//!
//! Whether a condition implies that another one holds or has held is proved by induction over the cycles: for a delay
//! from the cycle before, for all other nodes from the same cycle. The delays, the held value and the reader must be in
//! one fragment, so that they share the same cycles and restarts.

use crate::init::abstract_value::Condition;
use crate::init::abstract_value::DefinedWhen;
use crate::init::rules::TransferRule;
use crate::init::solve::Solution;
use rpi_image::{Role, StateSize};
use rpi_net::{FragmentId, Input, Net, NodeId, PortRef};

/// Maximum number of steps of the search for one proof.
const MAX_STEPS: usize = 1000;

/// Maximum depth of nested operations to which two conditions are compared.
const MAX_DEPTH: usize = 8;

/// Returns whether the condition `unless`, under which a flow has a value, holds for the node `reader` in all cycles in
/// which the conditions `given` hold.
pub(super) fn holds(
    all: &Solution<'_>,
    reader: NodeId,
    unless: DefinedWhen,
    given: &[Condition],
) -> bool {
    match unless {
        DefinedWhen::Now(condition) => given.contains(&condition),
        DefinedWhen::Since(condition, fragment) => {
            let mut search = LatchProof {
                all,
                condition,
                fragment,
                steps: 0,
                assumed: Vec::new(),
                failed: Vec::new(),
            };
            all.net().node(reader).fragment == fragment
                && given.iter().any(|given| search.proves(*given))
        }
    }
}

/// Returns whether a conditional holds its last value while its condition is false: its second branch is a delay of its
/// own output.
pub(super) fn is_latch(net: &Net, choice: NodeId) -> bool {
    let node = net.node(choice);
    let otherwise = node.inputs.get(2).and_then(Input::port);
    otherwise.is_some_and(|port| {
        let delay = net.node(port.node);
        let of = delay.inputs.first().and_then(Input::port);
        delay.desc().role == Role::Delay
            && delay.fragment == node.fragment
            && of.is_some_and(|of| of.node == choice)
    })
}

/// Search for a proof that, whenever a given condition holds, the condition `condition` holds or has held before.
struct LatchProof<'s, 'n> {
    all: &'s Solution<'n>,
    condition: Condition,
    fragment: FragmentId,
    steps: usize,
    /// Conditions that the induction assumes. Behind a delay, they are taken as proved for all earlier cycles.
    assumed: Vec<Condition>,
    /// Conditions for which no proof was found. Later searches have fewer assumptions, so that they would find none
    /// either.
    failed: Vec<Condition>,
}

impl LatchProof<'_, '_> {
    /// Returns whether the condition of the search holds or has held in all cycles in which the given flow has the
    /// given value.
    fn proves(&mut self, (port, value): Condition) -> bool {
        let (port, value) = self.all.strip_negations(port, value);
        if value == self.condition.1 && is_equal(self.all.net(), port, self.condition.0, MAX_DEPTH)
        {
            return true;
        }
        if self.assumed.contains(&(port, value)) {
            return true;
        }
        let net = self.all.net();
        let node = net.node(port.node);
        self.steps += 1;
        let is_known_to_fail = self.failed.contains(&(port, value));
        if is_known_to_fail || self.steps > MAX_STEPS || node.fragment != self.fragment {
            return false;
        }
        self.assumed.push((port, value));
        let mark = self.assumed.len();
        let [first, second, third] = [0, 1, 2].map(|k| node.inputs.get(k));
        let shown = match (self.all.rule_of(port.node), value) {
            (TransferRule::And, true) | (TransferRule::Or, false) => {
                self.proves_input(first, value) || self.proves_input(second, value)
            }
            (TransferRule::And, false) | (TransferRule::Or, true) => {
                self.proves_input(first, value) && self.proves_input(second, value)
            }
            (TransferRule::Conditional, _) => {
                let decides = |search: &mut Self, holds| search.proves_input(first, holds);
                (self.proves_input(second, value) || decides(self, true))
                    && (self.proves_input(third, value) || decides(self, false))
            }
            (TransferRule::Delay, _) => self.proves_input(first, value),
            _ => false,
        };
        if !shown {
            // Conditions proved since then may depend on this assumption, so they are dropped, too.
            self.assumed.truncate(mark - 1);
            self.failed.push((port, value));
        }
        shown
    }

    fn proves_input(&mut self, input: Option<&Input>, value: bool) -> bool {
        match input {
            Some(Input::Port(port)) => self.proves((*port, value)),
            // A condition that never holds proves everything.
            Some(Input::Const(known)) => known.as_bool() == Some(!value),
            _ => false,
        }
    }
}

/// Returns whether two ports always have the same value, because they are the same port or outputs of the same
/// operation on the same operands. `depth` is the number of nested operations that may still be compared.
fn is_equal(net: &Net, a: PortRef, b: PortRef, depth: usize) -> bool {
    if a == b {
        return true;
    }
    let (one, other) = (net.node(a.node), net.node(b.node));
    let alike = a.port == b.port
        && one.prim == other.prim
        && one.fragment == other.fragment
        && one.desc().role == Role::Compute
        && matches!(one.desc().state, StateSize::None)
        && one.params == other.params
        && one.inputs.len() == other.inputs.len();
    let operand = |(a, b): (&Input, &Input)| match (a, b) {
        (Input::Port(a), Input::Port(b)) => is_equal(net, *a, *b, depth - 1),
        (a, b) => a == b,
    };
    alike && depth > 0 && one.inputs.iter().zip(&other.inputs).all(operand)
}
