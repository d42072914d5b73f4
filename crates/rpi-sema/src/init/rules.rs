//! What each kind of primitive makes of what is known of its in-ports.

use super::known::Known;
use super::latch;
use super::phases::{Active, PHASES};
use super::solve::{Seen, Solution, before};
use crate::hash::Map;
use rpi_image::{Presence, PrimDesc, Role, Value};
use rpi_net::prim;
use rpi_net::{Input, Net, Node, NodeId, PortRef};
use rpi_prims::{PrimId, fold};
use std::rc::Rc;

/// How a primitive passes on what is known.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum Rule {
    /// A delay of a total flow: it has no value in the first phase.
    Delay,
    /// A delay that starts absent, or whose lack of a first value has been told.
    OptionalDelay,
    /// True in the first phase.
    First,
    /// `if inCondition then inTrue else inFalse`
    Choice,
    /// Conjunction; true is neutral.
    And,
    /// Disjunction; false is neutral.
    Or,
    /// Implication.
    Implies,
    /// Negation.
    Not,
    /// The first of two that is present.
    Coalesce,
    /// A guard, then operands that do not matter where it is false.
    Guarded,
    /// All in-ports matter.
    Strict,
}

/// Rules by name, or by the end of the name.
const NAMED: &[(&str, Rule)] = &[
    ("Conditional", Rule::Choice),
    ("::BooleanAnd", Rule::And),
    ("::BooleanOr", Rule::Or),
    ("::BooleanImplies", Rule::Implies),
    ("::BooleanNot", Rule::Not),
    ("Coalesce", Rule::Coalesce),
];

/// The rules of all nodes, looked up once per primitive.
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

/// Whether a choice is one by `first` of its own fragment.
pub(super) fn is_by_first(net: &Net, rules: &[Rule], choice: NodeId) -> bool {
    let node = net.node(choice);
    let condition = node.inputs.first().and_then(Input::port);
    condition.is_some_and(|port| {
        rules[port.node.index()] == Rule::First && net.node(port.node).fragment == node.fragment
    })
}

/// The rule of a node's primitive.
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

/// What is known of a node in a phase of its fragment.
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
    // What it keeps is what it had in all cycles in which it was given a value.
    let keeps = undefined(&known)
        && latch::keeps_itself(all.net(), id)
        && !(0..PHASES).any(|phase| undefined(&branch_in(1, true, phase)));
    match keeps {
        true => known.kept(all.net().node(id).fragment),
        false => known,
    }
}

/// What a choice gives whose condition is not known: where one branch has a value, it has one if that is chosen.
fn either(all: &Solution<'_>, condition: Option<PortRef>, yes: Known, no: Known) -> Known {
    let where_chosen = |value| condition.map(|port| all.plain(port, value));
    match (&yes, &no) {
        (Known::Undefined { .. }, Known::Undefined { .. }) => yes.join(&no),
        (Known::Undefined { .. }, _) => yes.defined_where(where_chosen(false)),
        (_, Known::Undefined { .. }) => no.defined_where(where_chosen(true)),
        _ => yes.join(&no),
    }
}

/// A conjunction, or a disjunction if `absorbing`: an operand with the absorbing value decides by itself, and the other
/// matters only where it does not.
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
        // The other operand has not decided: what that implies.
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

/// Constants matter only where every flow has a value that is known, which is rare.
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
    // The values are of interest only as long as every in-port has one.
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
