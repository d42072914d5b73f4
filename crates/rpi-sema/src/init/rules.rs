//! Transfer functions: compute the abstract value of a node from those of its inputs.

use crate::hash::Map;
use crate::init::abstract_value::Known;
use crate::init::latch;
use crate::init::phases::{Active, PHASES};
use crate::init::solve::{Seen, Solution, before};
use rpi_image::{Presence, PrimDesc, Role, Value};
use rpi_net::prim;
use rpi_net::{Input, Net, Node, NodeId, PortRef};
use rpi_prims::{PrimId, fold};
use std::rc::Rc;

/// Transfer function of a primitive.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum Rule {
    /// Delay of a flow that is not optional: uninitialised in the first phase.
    Delay,
    /// Delay that starts absent, or whose missing initial value has been reported.
    OptionalDelay,
    /// True in the first phase.
    First,
    /// `if inCondition then inTrue else inFalse`
    Choice,
    /// Conjunction; `true` is neutral.
    And,
    /// Disjunction; `false` is neutral.
    Or,
    /// Implication.
    Implies,
    /// Negation.
    Not,
    /// First present value of two.
    Coalesce,
    /// A guard, then operands that are ignored where the guard is false.
    Guarded,
    /// All inputs are needed.
    Strict,
}

/// Rules by suffix of the primitive's name.
const NAMED: &[(&str, Rule)] = &[
    ("Conditional", Rule::Choice),
    ("::BooleanAnd", Rule::And),
    ("::BooleanOr", Rule::Or),
    ("::BooleanImplies", Rule::Implies),
    ("::BooleanNot", Rule::Not),
    ("Coalesce", Rule::Coalesce),
];

/// Returns the rules of all nodes. Each primitive is looked up once.
pub(super) fn rules(net: &Net) -> Vec<Rule> {
    let mut known: Map<PrimId, Rule> = Map::default();
    let nodes = net.nodes.iter();
    let rule = |node: &Node| {
        *known
            .entry(node.prim)
            .or_insert_with(|| of_prim(node.desc()))
    };
    nodes.map(rule).collect()
}

/// Returns whether the condition of a conditional is `first` of its own fragment.
pub(super) fn is_by_first(net: &Net, rules: &[Rule], choice: NodeId) -> bool {
    let node = net.node(choice);
    let condition = node.inputs.first().and_then(Input::port);
    condition.is_some_and(|port| {
        rules[port.node.index()] == Rule::First && net.node(port.node).fragment == node.fragment
    })
}

/// Returns the rule of a node's primitive.
pub(super) fn rule(node: &Node) -> Rule {
    of_prim(node.desc())
}

fn of_prim(desc: &PrimDesc) -> Rule {
    match desc.role {
        Role::First => return Rule::First,
        Role::Delay => {
            let mut outputs = desc.outputs.iter();
            let total = outputs.any(|port| port.presence != Presence::Maybe);
            return if total {
                Rule::Delay
            } else {
                Rule::OptionalDelay
            };
        }
        _ => {}
    }
    let named = NAMED.iter().find(|(end, _)| desc.name.ends_with(end));
    let guarded = desc.may_fault
        && desc
            .inputs
            .first()
            .is_some_and(|port| port.name == "inActive");
    match (named, guarded) {
        (Some((_, rule)), _) => *rule,
        (None, true) => Rule::Guarded,
        (None, false) => Rule::Strict,
    }
}

/// Computes the abstract value of a node in a phase of its fragment.
pub(super) fn apply(rule: Rule, all: &Solution<'_>, id: NodeId, phase: usize) -> Known {
    let input = |k: usize| all.input(id, k, phase).known;
    match rule {
        Rule::First => Known::value(Value::bool(phase == 0)),
        Rule::Delay | Rule::OptionalDelay => delay(rule, all, id, phase),
        Rule::Choice => choice(all, id, phase),
        Rule::And | Rule::Or => connective(rule == Rule::Or, all, id, phase, [false, false]),
        Rule::Implies => connective(true, all, id, phase, [true, false]),
        Rule::Coalesce => coalesce(all, id, phase),
        Rule::Guarded if input(0).truth() == Some(false) => Known::Defined,
        Rule::Strict
            if all.net().node(id).prim == prim!("Core::IntEquals")
                && input(0).differs(&input(1)) =>
        {
            Known::value(Value::bool(false))
        }
        Rule::Guarded | Rule::Not | Rule::Strict => strict(all, id, phase),
    }
}

fn delay(rule: Rule, all: &Solution<'_>, id: NodeId, phase: usize) -> Known {
    if phase == 0 {
        return match rule {
            Rule::Delay => Known::Undefined {
                root: id,
                unless: None,
            },
            _ => Known::Defined,
        };
    }
    let earlier = before(phase).iter();
    let earlier = earlier.map(|phase| all.input(id, 0, *phase).known.later());
    earlier.fold(Known::Never, |all, known| all.join(&known))
}

fn choice(all: &Solution<'_>, id: NodeId, phase: usize) -> Known {
    let condition = all.input(id, 0, phase).known;
    let port = all.net().node(id).inputs[0].port();
    let implied = |value: bool| port.map_or_else(Vec::new, |port| all.implied(port, value));
    let branch_in = |k: usize, value: bool, phase: usize| {
        let holds = |unless| latch::holds(all, id, unless, &implied(value));
        all.input(id, k, phase).known.given(holds)
    };
    let branch = |k: usize, value: bool| branch_in(k, value, phase);
    let undefined = |known: &Known| matches!(known, Known::Undefined { .. });
    let known = match (&condition, condition.truth()) {
        (Known::Never, _) => Known::Never,
        (_, Some(true)) => branch(1, true),
        (_, Some(false)) => branch(2, false),
        (Known::Undefined { .. }, _) => condition,
        _ => either(all, port, branch(1, true), branch(2, false)),
    };
    // A held value is initialised if every value that it took over was initialised.
    let keeps = undefined(&known)
        && latch::keeps_itself(all.net(), id)
        && !(0..PHASES).any(|phase| undefined(&branch_in(1, true, phase)));
    match keeps {
        true => known.kept(all.net().node(id).fragment),
        false => known,
    }
}

/// Returns the abstract value of a conditional with an unknown condition. If only one branch is initialised, the result
/// is initialised where that branch is chosen.
fn either(all: &Solution<'_>, condition: Option<PortRef>, yes: Known, no: Known) -> Known {
    let where_chosen = |value| condition.map(|port| all.plain(port, value));
    match (&yes, &no) {
        (Known::Undefined { .. }, Known::Undefined { .. }) => yes.join(&no),
        (Known::Undefined { .. }, _) => yes.defined_where(where_chosen(false)),
        (_, Known::Undefined { .. }) => no.defined_where(where_chosen(true)),
        _ => yes.join(&no),
    }
}

/// Computes a conjunction, or a disjunction if `absorbing`. An operand with the absorbing value decides the result, and
/// the other operand is needed only where it does not decide.
fn connective(
    absorbing: bool,
    all: &Solution<'_>,
    id: NodeId,
    phase: usize,
    negated: [bool; 2],
) -> Known {
    let inputs = &all.net().node(id).inputs;
    let operand = |k: usize| {
        let other = inputs[1 - k].port();
        // Conditions implied by the other operand not deciding the result.
        let holds = |unless| {
            let implied = other.map_or_else(Vec::new, |port| {
                all.implied(port, !absorbing ^ negated[1 - k])
            });
            latch::holds(all, id, unless, &implied)
        };
        all.input(id, k, phase).known.given(holds)
    };
    let (a, b) = (operand(0), operand(1));
    let decides = |known: &Known, negated: bool| known.truth() == Some(absorbing ^ negated);
    match decides(&a, negated[0]) || decides(&b, negated[1]) {
        true => Known::value(Value::bool(absorbing)),
        false => strict_of(all, id, [a, b].into_iter()),
    }
}

fn coalesce(all: &Solution<'_>, id: NodeId, phase: usize) -> Known {
    let node = all.net().node(id);
    let [first, second] = [0, 1].map(|k| all.input(id, k, phase));
    let Some(source) = node.inputs[0].port() else {
        return strict(all, id, phase);
    };
    let Seen { known, there } = first;
    let own = all.net().node(source.node).fragment == node.fragment;
    match there {
        Active::Never => second.known,
        Active::Always if !own => known,
        _ => {
            let condition = all.condition_of(source, node.fragment);
            known.join(&second.known.defined_where(condition))
        }
    }
}

/// Computes a strict operator. Constant inputs are read only if the values of all flows are known, which is rare.
fn strict(all: &Solution<'_>, id: NodeId, phase: usize) -> Known {
    let inputs = &all.net().node(id).inputs;
    let input = |k: usize| all.input(id, k, phase).known;
    let flows = (0..inputs.len()).filter(|k| inputs[*k].port().is_some());
    let (mut worst, mut is_known) = (Known::Defined, true);
    for flow in flows.map(input) {
        match flow {
            Known::Never => return Known::Never,
            Known::Value(_) => continue,
            Known::OneOf(_) | Known::Defined => {}
            undefined @ Known::Undefined { .. } => worst = worst.join(&undefined),
        }
        is_known = false;
    }
    match is_known {
        true => strict_of(all, id, (0..inputs.len()).map(input)),
        false => worst,
    }
}

fn strict_of(all: &Solution<'_>, id: NodeId, inputs: impl Iterator<Item = Known>) -> Known {
    let node = all.net().node(id);
    let mut worst = Known::Defined;
    // The values are needed only if every input has one.
    let (mut values, mut count) = (Vec::new(), 0);
    for known in inputs {
        match known {
            Known::Never => return Known::Never,
            Known::Value(value) if values.len() == count => values.push(value),
            Known::Value(_) | Known::OneOf(_) | Known::Defined => {}
            undefined @ Known::Undefined { .. } => worst = worst.join(&undefined),
        }
        count += 1;
    }
    if values.len() < count || count == 0 {
        return worst;
    }
    let values: Vec<&Value> = values.iter().map(Rc::as_ref).collect();
    match fold(node.prim, &values, &node.params, &node.outputs) {
        Some(Ok(results)) if results.len() == 1 => Known::value(results[0].clone()),
        _ => Known::Defined,
    }
}
