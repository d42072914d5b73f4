//! Transfer functions: compute the abstract value of a node from those of its inputs.

use crate::hash::FastMap;
use crate::init::abstract_value::AbstractValue;
use crate::init::latch;
use crate::init::phases::{Activity, PHASES};
use crate::init::solve::{ReadValue, Solution, previous_phases};
use rpi_image::{Presence, PrimDesc, Role, Value};
use rpi_net::prim;
use rpi_net::{Input, Net, Node, NodeId, PortRef};
use rpi_prims::{PrimId, fold};
use std::rc::Rc;

/// Transfer function of a primitive in the analysis of initialisation: how its abstract output follows from its
/// abstract inputs.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum TransferRule {
    /// Delay of a flow that is always present. Its output is uninitialised in the first phase.
    Delay,
    /// Delay whose output counts as defined in the first phase too: it starts absent, or its missing initial value has
    /// already been reported.
    OptionalDelay,
    /// `first`: true in the first phase of the fragment, else false.
    First,
    /// `if inCondition then inTrue else inFalse`, of which the branch that is not chosen is not needed.
    Conditional,
    /// Conjunction. A `false` operand decides the result, so that the other operand is not needed.
    And,
    /// Disjunction. A `true` operand decides the result, so that the other operand is not needed.
    Or,
    /// Implication of the second input by the first input. A false first input or a true second input decides the
    /// result.
    Implies,
    /// Negation of the only input.
    Not,
    /// `x ?? y`: the first input if it is present, else the second input.
    Coalesce,
    /// Operation with a guard as its first input. The other inputs are not needed while the guard is false.
    Guarded,
    /// Any other operation. All its inputs are needed for its output.
    Strict,
}

/// Transfer functions of primitives, by the ends of their names.
const RULES_BY_NAME: &[(&str, TransferRule)] = &[
    ("Conditional", TransferRule::Conditional),
    ("::BooleanAnd", TransferRule::And),
    ("::BooleanOr", TransferRule::Or),
    ("::BooleanImplies", TransferRule::Implies),
    ("::BooleanNot", TransferRule::Not),
    ("Coalesce", TransferRule::Coalesce),
];

/// Returns the transfer function of each node of a net, indexed by node.
pub(super) fn rules(net: &Net) -> Vec<TransferRule> {
    let mut known: FastMap<PrimId, TransferRule> = FastMap::default();
    let nodes = net.nodes.iter();
    let rule = |node: &Node| {
        *known
            .entry(node.prim)
            .or_insert_with(|| rule_of_prim(node.desc()))
    };
    nodes.map(rule).collect()
}

/// Returns whether the condition of a conditional is the flow `first` of its own fragment.
pub(super) fn is_by_first(net: &Net, rules: &[TransferRule], choice: NodeId) -> bool {
    let node = net.node(choice);
    let condition = node.inputs.first().and_then(Input::port);
    condition.is_some_and(|port| {
        rules[port.node.index()] == TransferRule::First
            && net.node(port.node).fragment == node.fragment
    })
}

/// Returns the transfer function of the primitive of a node.
pub(super) fn rule(node: &Node) -> TransferRule {
    rule_of_prim(node.desc())
}

fn rule_of_prim(desc: &PrimDesc) -> TransferRule {
    match desc.role {
        Role::First => return TransferRule::First,
        Role::Delay => {
            let mut outputs = desc.outputs.iter();
            let total = outputs.any(|port| port.presence != Presence::Maybe);
            return if total {
                TransferRule::Delay
            } else {
                TransferRule::OptionalDelay
            };
        }
        _ => {}
    }
    let named = RULES_BY_NAME
        .iter()
        .find(|(end, _)| desc.name.ends_with(end));
    let guarded = desc.may_fault
        && desc
            .inputs
            .first()
            .is_some_and(|port| port.name == "inActive");
    match (named, guarded) {
        (Some((_, rule)), _) => *rule,
        (None, true) => TransferRule::Guarded,
        (None, false) => TransferRule::Strict,
    }
}

/// Returns the abstract value of the output of the node `id` in a phase of its fragment.
pub(super) fn apply(
    rule: TransferRule,
    all: &Solution<'_>,
    id: NodeId,
    phase: usize,
) -> AbstractValue {
    let input = |k: usize| all.input(id, k, phase).value;
    match rule {
        TransferRule::First => AbstractValue::from_value(Value::bool(phase == 0)),
        TransferRule::Delay | TransferRule::OptionalDelay => delay(rule, all, id, phase),
        TransferRule::Conditional => conditional(all, id, phase),
        TransferRule::And | TransferRule::Or => {
            connective(rule == TransferRule::Or, all, id, phase, [false, false])
        }
        TransferRule::Implies => connective(true, all, id, phase, [true, false]),
        TransferRule::Coalesce => coalesce_leaf(all, id, phase),
        TransferRule::Guarded if input(0).truth() == Some(false) => AbstractValue::Defined,
        TransferRule::Strict
            if all.net().node(id).prim == prim!("Core::IntEquals")
                && input(0).differs(&input(1)) =>
        {
            AbstractValue::from_value(Value::bool(false))
        }
        TransferRule::Guarded | TransferRule::Not | TransferRule::Strict => strict(all, id, phase),
    }
}

fn delay(rule: TransferRule, all: &Solution<'_>, id: NodeId, phase: usize) -> AbstractValue {
    if phase == 0 {
        return match rule {
            TransferRule::Delay => AbstractValue::Undefined {
                root: id,
                defined_when: None,
            },
            _ => AbstractValue::Defined,
        };
    }
    let earlier = previous_phases(phase).iter();
    let earlier = earlier.map(|phase| all.input(id, 0, *phase).value.later());
    earlier.fold(AbstractValue::Unreachable, |all, known| all.join(&known))
}

fn conditional(all: &Solution<'_>, id: NodeId, phase: usize) -> AbstractValue {
    let condition = all.input(id, 0, phase).value;
    let port = all.net().node(id).inputs[0].port();
    let implied =
        |value: bool| port.map_or_else(Vec::new, |port| all.implied_conditions(port, value));
    let branch_in = |k: usize, value: bool, phase: usize| {
        let holds = |unless| latch::holds(all, id, unless, &implied(value));
        all.input(id, k, phase).value.assuming(holds)
    };
    let branch = |k: usize, value: bool| branch_in(k, value, phase);
    let undefined = |known: &AbstractValue| matches!(known, AbstractValue::Undefined { .. });
    let known = match (&condition, condition.truth()) {
        (AbstractValue::Unreachable, _) => AbstractValue::Unreachable,
        (_, Some(true)) => branch(1, true),
        (_, Some(false)) => branch(2, false),
        (AbstractValue::Undefined { .. }, _) => condition,
        _ => select_if_equal(all, port, branch(1, true), branch(2, false)),
    };
    // A held value is initialised if every value that it took over was initialised.
    let keeps = undefined(&known)
        && latch::is_latch(all.net(), id)
        && !(0..PHASES).any(|phase| undefined(&branch_in(1, true, phase)));
    match keeps {
        true => known.held(all.net().node(id).fragment),
        false => known,
    }
}

/// Returns the abstract value of a conditional whose condition is unknown. `yes` and `no` are the abstract values of
/// its branches. If only one branch is initialised, the result is initialised where that branch is chosen.
fn select_if_equal(
    all: &Solution<'_>,
    condition: Option<PortRef>,
    yes: AbstractValue,
    no: AbstractValue,
) -> AbstractValue {
    let where_chosen = |value| condition.map(|port| all.strip_negations(port, value));
    match (&yes, &no) {
        (AbstractValue::Undefined { .. }, AbstractValue::Undefined { .. }) => yes.join(&no),
        (AbstractValue::Undefined { .. }, _) => yes.defined_where(where_chosen(false)),
        (_, AbstractValue::Undefined { .. }) => no.defined_where(where_chosen(true)),
        _ => yes.join(&no),
    }
}

/// Returns the abstract value of a disjunction if `absorbing`, else of a conjunction. An operand with the value
/// `absorbing` decides the result, and the other operand is then not needed. `negated` is whether each operand is
/// negated.
fn connective(
    absorbing: bool,
    all: &Solution<'_>,
    id: NodeId,
    phase: usize,
    negated: [bool; 2],
) -> AbstractValue {
    let inputs = &all.net().node(id).inputs;
    let operand = |k: usize| {
        let other = inputs[1 - k].port();
        // Conditions implied by the other operand not deciding the result.
        let holds = |unless| {
            let implied = other.map_or_else(Vec::new, |port| {
                all.implied_conditions(port, !absorbing ^ negated[1 - k])
            });
            latch::holds(all, id, unless, &implied)
        };
        all.input(id, k, phase).value.assuming(holds)
    };
    let (a, b) = (operand(0), operand(1));
    let decides = |known: &AbstractValue, negated: bool| known.truth() == Some(absorbing ^ negated);
    match decides(&a, negated[0]) || decides(&b, negated[1]) {
        true => AbstractValue::from_value(Value::bool(absorbing)),
        false => strict_of(all, id, [a, b].into_iter()),
    }
}

fn coalesce_leaf(all: &Solution<'_>, id: NodeId, phase: usize) -> AbstractValue {
    let node = all.net().node(id);
    let [first, second] = [0, 1].map(|k| all.input(id, k, phase));
    let Some(source) = node.inputs[0].port() else {
        return strict(all, id, phase);
    };
    let ReadValue {
        value: known,
        activity: there,
    } = first;
    let own = all.net().node(source.node).fragment == node.fragment;
    match there {
        Activity::Never => second.value,
        Activity::Always if !own => known,
        _ => {
            let condition = all.condition_of(source, node.fragment);
            known.join(&second.value.defined_where(condition))
        }
    }
}

/// Returns the abstract value of an operation that needs all its inputs. Constant inputs are read only if the values of
/// all other inputs are known, which is rare.
fn strict(all: &Solution<'_>, id: NodeId, phase: usize) -> AbstractValue {
    let inputs = &all.net().node(id).inputs;
    let input = |k: usize| all.input(id, k, phase).value;
    let flows = (0..inputs.len()).filter(|k| inputs[*k].port().is_some());
    let (mut worst, mut is_known) = (AbstractValue::Defined, true);
    for flow in flows.map(input) {
        match flow {
            AbstractValue::Unreachable => return AbstractValue::Unreachable,
            AbstractValue::Value(_) => continue,
            AbstractValue::OneOf(_) | AbstractValue::Defined => {}
            undefined @ AbstractValue::Undefined { .. } => worst = worst.join(&undefined),
        }
        is_known = false;
    }
    match is_known {
        true => strict_of(all, id, (0..inputs.len()).map(input)),
        false => worst,
    }
}

fn strict_of(
    all: &Solution<'_>,
    id: NodeId,
    inputs: impl Iterator<Item = AbstractValue>,
) -> AbstractValue {
    let node = all.net().node(id);
    let mut worst = AbstractValue::Defined;
    // The values are needed only if every input has one.
    let (mut values, mut count) = (Vec::new(), 0);
    for known in inputs {
        match known {
            AbstractValue::Unreachable => return AbstractValue::Unreachable,
            AbstractValue::Value(value) if values.len() == count => values.push(value),
            AbstractValue::Value(_) | AbstractValue::OneOf(_) | AbstractValue::Defined => {}
            undefined @ AbstractValue::Undefined { .. } => worst = worst.join(&undefined),
        }
        count += 1;
    }
    if values.len() < count || count == 0 {
        return worst;
    }
    let values: Vec<&Value> = values.iter().map(Rc::as_ref).collect();
    match fold(node.prim, &values, &node.params, &node.outputs) {
        Some(Ok(results)) if results.len() == 1 => AbstractValue::from_value(results[0].clone()),
        _ => AbstractValue::Defined,
    }
}
