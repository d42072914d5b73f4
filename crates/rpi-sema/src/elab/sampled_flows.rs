//! Elaborates sampled flows: an expression on clock c is computed in a fragment that is active when c (M4). This
//! fragment is not in the source, so dependencies are those of the single operations in it (M5).

use crate::clocks::{ClockCondition, ClockId, LeafClocks, Sampling};
use crate::elab::call;
use crate::elab::elementwise;
use crate::elab::expr;
use crate::elab::flows;
use crate::elab::nodes;
use crate::elab::outside_flows;
use crate::elab::primitive_family::PrimitiveFamily;
use crate::elab::scope::Scope;
use crate::elab::signal::{Signal, Wire};
use crate::elab::{ElabMode, Elaborator, Position};
use crate::facts::Facts;
use crate::typed::TypedKind;
use crate::typed::{ExprId, UnitId};
use rpi_diag::Span;
use rpi_image::{Scalar, Value};
use rpi_net::prim;
use rpi_net::{FragmentId, PortRef, Restart};
use std::rc::Rc;

/// Key of the fragment with the operations that run when a clock ticks: the parent fragment, the signal of the clock
/// condition, and its value when the clock ticks.
pub(super) type ClockKey = (FragmentId, ConditionSignal, u32);

/// Signal whose value decides in which cycles a clock ticks.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub(super) enum ConditionSignal {
    Flow(PortRef),
    /// Clock condition that is constant: a Boolean as 0 or 1, or the index of an enum's value.
    Constant(i64),
}

/// Positions in the net at which the leaves (scalar parts) of an expression are computed: one for all leaves, or one
/// for each.
pub(super) enum LeafPositions {
    Uniform(Position),
    PerLeaf(Vec<Position>),
}

impl LeafPositions {
    pub(super) fn at(&self, k: usize) -> Position {
        match self {
            LeafPositions::Uniform(at) => *at,
            LeafPositions::PerLeaf(places) => places[k.min(places.len() - 1)],
        }
    }
}

/// Returns the position at which an expression is evaluated. In a unit with sampled flows, this is in the fragment of
/// the expression's clock.
pub(super) fn position_of<'u>(
    elab: &mut Elaborator<'u>,
    scope: &mut Scope<'u>,
    id: ExprId,
    at: Position,
) -> Position {
    match clocked_facts(elab, scope) {
        Some(facts) => clock_position(elab, scope, facts.clocks.computed_on(id), at),
        None => at,
    }
}

/// Returns the positions at which the leaves (scalar parts) of an elementwise expression are computed. `at` is the
/// position of its first leaf.
pub(super) fn leaf_places<'u>(
    elab: &mut Elaborator<'u>,
    scope: &mut Scope<'u>,
    id: ExprId,
    at: Position,
) -> LeafPositions {
    let row = clocked_facts(elab, scope).map(|facts| facts.clocks.expr_clocks(id));
    match row {
        None | Some(LeafClocks::Uniform(_)) => LeafPositions::Uniform(at),
        Some(LeafClocks::PerLeaf(leaves)) => {
            let place = |clock: &ClockId| clock_position(elab, scope, *clock, at);
            LeafPositions::PerLeaf(leaves.iter().map(place).collect())
        }
    }
}

/// Returns the position for an expression on a clock, in the fragment that runs only when the clock ticks. The guard of
/// `at` still applies if that fragment is inside of the fragment of `at`.
pub(super) fn clock_position<'u>(
    elab: &mut Elaborator<'u>,
    scope: &mut Scope<'u>,
    clock: ClockId,
    at: Position,
) -> Position {
    let fragment = clock_fragment(elab, scope, clock);
    let mut around = elab.net.ancestors(fragment);
    let inside = fragment == at.fragment || around.any(|outer| outer == at.fragment);
    Position {
        fragment,
        guard: at.guard.filter(|_| inside),
        branch: at.branch.filter(|_| inside),
    }
}

pub(super) fn facts_of<'u>(elab: &Elaborator<'u>, scope: &Scope<'u>) -> Option<&'u Facts> {
    let facts = elab.facts;
    let facts = scope.id.and_then(|unit| facts.get(unit.0 as usize));
    facts.map(Rc::as_ref)
}

/// Returns the results of the clock and presence analysis if the unit has sampled flows; `None` for other units and for
/// constants.
pub(super) fn clocked_facts<'u>(elab: &Elaborator<'u>, scope: &Scope<'u>) -> Option<&'u Facts> {
    let facts = facts_of(elab, scope).filter(|facts| facts.clocks.has_samplings());
    facts.filter(|_| elab.mode != ElabMode::Constant)
}

/// Returns the fragment with the operations that run when a clock ticks, in the block that is being elaborated. The
/// fragment is added on first use.
pub(super) fn clock_fragment<'u>(
    elab: &mut Elaborator<'u>,
    scope: &mut Scope<'u>,
    clock: ClockId,
) -> FragmentId {
    let Some(facts) = clocked_facts(elab, scope).filter(|_| clock != ClockId::BASE) else {
        return scope.base;
    };
    let key = (scope.base, clock);
    if let Some(known) = scope.clock_fragments.get(&key) {
        return *known;
    }
    let mut fragment = scope.base;
    for tick in facts.clocks.path(clock) {
        fragment = sampling_fragment(elab, scope, *tick, fragment);
    }
    scope.clock_fragments.insert(key, fragment);
    fragment
}

pub(super) fn sampling_fragment<'u>(
    elab: &mut Elaborator<'u>,
    scope: &mut Scope<'u>,
    tick: Sampling,
    parent: FragmentId,
) -> FragmentId {
    let (span, name) = condition_source(scope, tick.condition);
    let deciding = match condition_signal(elab, scope, tick.condition, span) {
        Signal::Port(port) => Some(ConditionSignal::Flow(first_alias(elab, port))),
        Signal::Const(value) => {
            let value = value.as_bool().map(i64::from).or(value.as_int());
            value.map(ConditionSignal::Constant)
        }
        _ => None,
    };
    let key = deciding.map(|deciding| (parent, deciding, tick.value));
    if let Some(known) = key.and_then(|key| elab.cache.clock_fragments.get(&key)) {
        return *known;
    }
    let at = Position::in_fragment(parent);
    let condition = tick_condition(elab, scope, tick, at, span);
    let activation = call::elab_activation(elab, &condition, at, span);
    let path = format!("{}@{name}#{}", scope.prefix, elab.net.fragments.len());
    let fragment = call::elab_fragment(elab, &path, parent, activation, Restart::Never, span);
    let made = &mut elab.net.fragments[fragment.0 as usize];
    made.is_clock = true;
    // The user knows the flows in this fragment but not the fragment, so it has no flow of its own.
    made.origin.flow = None;
    if let Some(key) = key {
        elab.cache.clock_fragments.insert(key, fragment);
    }
    fragment
}

/// Returns the first port by which a flow was used as a clock condition. It may be a placeholder from before the
/// equation of the flow was elaborated. Without it, one clock would get two fragments.
fn first_alias(elab: &Elaborator<'_>, port: PortRef) -> PortRef {
    use crate::elab::signal::alias_of;
    let mut name = port;
    while let Some(before) = elab.aliases.names_before.get(&name)
        && alias_of(name).is_none_or(|alias| alias_of(*before) < Some(alias))
    {
        name = *before;
    }
    name
}

/// Returns the location and name of a clock condition in the source. A condition inside of a call has the location of
/// the call.
fn condition_source<'u>(scope: &Scope<'u>, by: ClockCondition) -> (Span, String) {
    match by {
        ClockCondition::Flow(flow) => {
            let flow = scope.unit.flow(flow);
            (flow.span, flow.name.to_string())
        }
        ClockCondition::CallInternal(call, number) => {
            (scope.unit.expr(call).span, format!("inside{number}"))
        }
    }
}

/// Returns the signal of a clock condition. For a condition inside of a call, it is a placeholder port, which is
/// connected when the call is inlined.
fn condition_signal<'u>(
    elab: &mut Elaborator<'u>,
    scope: &mut Scope<'u>,
    by: ClockCondition,
    span: Span,
) -> Signal {
    match by {
        ClockCondition::Flow(flow) => {
            let wire = flows::elab_flow(elab, scope, flow, span);
            wire.first().cloned().unwrap_or(Signal::Absent)
        }
        ClockCondition::CallInternal(call, number) => {
            let port = match scope.exposed_aliases.get(&(call, number)) {
                Some(port) => *port,
                None => {
                    let scalar = condition_scalar(elab, scope, by);
                    let port = nodes::new_alias(elab, scalar);
                    scope.exposed_aliases.insert((call, number), port);
                    port
                }
            };
            Signal::Port(port)
        }
    }
}

/// Returns the machine type of a clock condition, which is Boolean or an integer.
fn condition_scalar<'u>(elab: &Elaborator<'u>, scope: &Scope<'u>, by: ClockCondition) -> Scalar {
    let (mut unit, mut by) = (scope.unit, by);
    loop {
        let (call, number) = match by {
            ClockCondition::Flow(flow) => {
                return unit.flow(flow).ty.scalar().unwrap_or(Scalar::Bool);
            }
            ClockCondition::CallInternal(call, number) => (call, number),
        };
        let TypedKind::Call(call) = &unit.expr(call).kind else {
            return Scalar::Bool;
        };
        let exposed = elab.facts[call.unit.0 as usize].clocks.exposed();
        let Some((inner, _)) = exposed.get(number as usize) else {
            return Scalar::Bool;
        };
        (unit, by) = (&elab.units[call.unit.0 as usize], *inner);
    }
}

/// Returns the signals of the clock conditions of a unit's outputs, in the order in which callers refer to them.
pub(super) fn exposed_conditions<'u>(
    elab: &mut Elaborator<'u>,
    scope: &mut Scope<'u>,
    id: UnitId,
    span: Span,
) -> Vec<Signal> {
    let facts = elab.facts.get(id.0 as usize);
    let exposed = facts.map_or(&[][..], |facts| facts.clocks.exposed());
    let exposed = exposed.iter();
    exposed
        .map(|(by, _)| condition_signal(elab, scope, *by, span))
        .collect()
}

/// Connects the placeholder ports for the clock conditions inside of a call to their signals.
pub(super) fn bind_exposed<'u>(
    elab: &mut Elaborator<'u>,
    scope: &mut Scope<'u>,
    call: ExprId,
    exposed: Vec<Signal>,
) {
    for (number, signal) in (0..).zip(exposed) {
        let by = ClockCondition::CallInternal(call, number);
        if let Signal::Port(alias) = condition_signal(elab, scope, by, Span::NONE) {
            call::bind_alias(elab, alias, &signal);
        }
    }
}

/// Returns the Boolean signal that is true when a sampling ticks, because its clock condition has the required value.
pub(super) fn tick_condition<'u>(
    elab: &mut Elaborator<'u>,
    scope: &mut Scope<'u>,
    tick: Sampling,
    at: Position,
    span: Span,
) -> Signal {
    let deciding = condition_signal(elab, scope, tick.condition, span);
    match (condition_scalar(elab, scope, tick.condition), tick.value) {
        (Scalar::Bool, 0) => {
            nodes::add_simple(elab, prim!("Core::BooleanNot"), &[deciding], at, span)
        }
        (Scalar::Bool, _) => deciding,
        _ => {
            let value = Signal::Const(Value::int(tick.value.into()));
            nodes::add_simple(elab, prim!("Core::IntEquals"), &[deciding, value], at, span)
        }
    }
}

/// Elaborates `merge c (...)` as a selection of one case by the value of `c`. The other cases are absent in that cycle.
pub(super) fn merge_expr<'u>(
    elab: &mut Elaborator<'u>,
    scope: &mut Scope<'u>,
    on: ExprId,
    cases: &'u [(u32, ExprId)],
    id: ExprId,
    at: Position,
) -> Wire {
    let span = scope.unit.expr(id).span;
    let scalars = crate::elab::expr::leaf_scalars(&scope.unit.expr(id).ty);
    let is_truth = scope.unit.expr(on).ty.scalar() == Some(Scalar::Bool);
    let deciding = operand_wire(elab, scope, [id, on], at);
    let deciding = deciding.first().cloned().unwrap_or(Signal::Absent);
    let Some(((_, last), others)) = cases.split_last() else {
        return crate::elab::signal::empty_wire();
    };
    let mut chosen = elementwise::expr_leaves(elab, scope, *last, scalars.len(), at).to_vec();
    for (value, case) in others.iter().rev() {
        let wire = elementwise::expr_leaves(elab, scope, *case, scalars.len(), at);
        let here = match (is_truth, value) {
            (true, 0) => nodes::add_simple(
                elab,
                prim!("Core::BooleanNot"),
                std::slice::from_ref(&deciding),
                at,
                span,
            ),
            (true, _) => deciding.clone(),
            _ => {
                let value = Signal::Const(Value::int((*value).into()));
                nodes::add_simple(
                    elab,
                    prim!("Core::IntEquals"),
                    &[deciding.clone(), value],
                    at,
                    span,
                )
            }
        };
        for ((slot, signal), scalar) in chosen.iter_mut().zip(wire.iter()).zip(&scalars) {
            let inputs = [here.clone(), signal.clone(), slot.clone()];
            *slot = nodes::add_family_member(
                elab,
                PrimitiveFamily::Conditional,
                *scalar,
                &inputs,
                at,
                span,
            );
        }
    }
    chosen.into()
}

/// Elaborates `current x`: the value of `x` in cycles in which its clock ticks, else its value at the last tick.
pub(super) fn elab_current<'u>(
    elab: &mut Elaborator<'u>,
    scope: &mut Scope<'u>,
    [id, operand]: [ExprId; 2],
    at: Position,
) -> Wire {
    let wire = expr::elab_expr(elab, scope, operand, at.unguarded());
    let Some(facts) = clocked_facts(elab, scope) else {
        return wire;
    };
    let span = scope.unit.expr(id).span;
    let places = leaf_places(elab, scope, id, at);
    let scalars = crate::elab::expr::leaf_scalars(&scope.unit.expr(operand).ty);
    let before = match scope.unit.is_lustre {
        true => PrimitiveFamily::Pre,
        false => PrimitiveFamily::OptionalPre,
    };
    let mut leaves = Vec::with_capacity(scalars.len());
    for (k, (signal, scalar)) in wire.iter().zip(scalars).enumerate() {
        let clock = facts.clocks.leaf(operand, k);
        let Some(tick) = facts.clocks.path(clock).last() else {
            leaves.push(signal.clone());
            continue;
        };
        let at = places.at(k);
        let ticks = tick_condition(elab, scope, *tick, at, span);
        let result = nodes::new_alias(elab, scalar);
        let before = elementwise::delay(elab, before, scalar, &Signal::Port(result), at, span);
        let inputs = [ticks, signal.clone(), before];
        let held = nodes::add_family_member(
            elab,
            PrimitiveFamily::Conditional,
            scalar,
            &inputs,
            at,
            span,
        );
        call::bind_alias(elab, result, &held);
        leaves.push(held);
    }
    leaves.into()
}

/// Returns the signals of an operand of a strict operator or call. The operand is absent in cycles in which the clock
/// of the operator ticks and its own clock does not.
pub(super) fn operand_wire<'u>(
    elab: &mut Elaborator<'u>,
    scope: &mut Scope<'u>,
    [reader, operand]: [ExprId; 2],
    at: Position,
) -> Wire {
    let clock = match clocked_facts(elab, scope) {
        Some(facts) => facts.clocks.computed_on(reader),
        None => ClockId::BASE,
    };
    read_at(elab, scope, operand, clock, at)
}

/// Returns the signals of an operand of an elementwise operator, expanded to `count` leaves (scalar parts), each on the
/// clock of the result.
pub(super) fn read_leaves<'u>(
    elab: &mut Elaborator<'u>,
    scope: &mut Scope<'u>,
    [reader, operand]: [ExprId; 2],
    count: usize,
    at: Position,
) -> Wire {
    let wire = elementwise::expr_leaves(elab, scope, operand, count, at);
    let Some(facts) = clocked_facts(elab, scope) else {
        return wire;
    };
    let clocks = &facts.clocks;
    let pair = |k: usize| (clocks.leaf(operand, k), clocks.leaf(reader, k));
    let expr = scope.unit.expr(operand);
    let scalars = crate::elab::expr::leaf_scalars(&expr.ty);
    outside_flows::on_reader_clock(elab, scope, (&wire, &scalars), pair, expr.span)
}

/// Returns the signals of the expression `id` for another expression on the given clock. They are absent in cycles in
/// which that clock ticks and the clock of `id` does not.
pub(super) fn read_at<'u>(
    elab: &mut Elaborator<'u>,
    scope: &mut Scope<'u>,
    id: ExprId,
    clock: ClockId,
    at: Position,
) -> Wire {
    let wire = expr::elab_expr(elab, scope, id, at);
    let Some(facts) = clocked_facts(elab, scope) else {
        return wire;
    };
    let expr = scope.unit.expr(id);
    let scalars = crate::elab::expr::leaf_scalars(&expr.ty);
    let pair = |k: usize| (facts.clocks.leaf(id, k), clock);
    outside_flows::on_reader_clock(elab, scope, (&wire, &scalars), pair, expr.span)
}
