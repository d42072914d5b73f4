//! Elaborates state machines: an integer register for the state, one fragment per state, and transitions as
//! conditionals.

use crate::elab::arrays;
use crate::elab::block;
use crate::elab::call;
use crate::elab::coverage_points;
use crate::elab::elementwise;
use crate::elab::expr;
use crate::elab::expr::leaf_scalars;
use crate::elab::flows;
use crate::elab::fragment_outputs;
use crate::elab::guards;
use crate::elab::nodes;
use crate::elab::outside_flows;
use crate::elab::primitive_family::PrimitiveFamily;
use crate::elab::scope::Scope;
use crate::elab::signal::{Signal, Wire};
use crate::elab::{ElabMode, Elaborator, Position};
use crate::typed::{Automaton, FlowId, SharedFlow, Transition};
use rpi_diag::Span;
use rpi_image::{Scalar, Value};
use rpi_net::prim;
use rpi_net::{FragmentId, Restart};

/// Number of the state that an automaton takes next, and whether that state is entered with a restart.
#[derive(Clone)]
struct NextState {
    state: Signal,
    restart: Signal,
}

/// Transitions out of one state of an automaton: either its weak transitions or its strong ones.
struct StateTransitions<'u, 's> {
    transitions: &'u [Transition],
    /// Boolean signal: whether the automaton is in this state.
    is_active: &'s Signal,
    automaton: Span,
}

/// Elaborates an automaton to nodes of the net, in the fragment of `at`.
pub(super) fn elab_automaton<'u>(
    elab: &mut Elaborator<'u>,
    scope: &mut Scope<'u>,
    automaton: &'u Automaton,
    at: Position,
) {
    block::set_node_name(elab, &format!("{}state", scope.prefix));
    let span = automaton.span;
    let (memory, next) = state_registers(elab, automaton, at, span);
    let current = strong_transitions(elab, scope, automaton, &memory, at);
    let mut chosen = no_transition(&current.state);
    for (k, state) in automaton.states.iter().enumerate() {
        let here = is_state(elab, &current.state, k, at, span);
        let afresh = restart_condition(elab, (automaton, k), &here, [&memory, &current], at);
        let fragment = state_fragment(elab, scope, automaton, k, &here, &afresh, at);
        scope.fragments[state.block.0 as usize] = Some(fragment);
        if !state.until.is_empty() {
            let inner = Position::in_fragment(fragment);
            let around = std::mem::replace(&mut scope.base, fragment);
            let choice = StateTransitions {
                transitions: &state.until,
                is_active: &here,
                automaton: span,
            };
            let weak = check_transitions(
                elab,
                scope,
                choice,
                no_transition(&number_literal(k)),
                inner,
            );
            scope.base = around;
            chosen = select_next(elab, &here, weak, chosen, at, span);
        }
    }
    call::bind_alias(elab, next[0], &chosen.state);
    call::bind_alias(elab, next[1], &chosen.restart);
    for shared in &automaton.shared {
        shared_flow(elab, scope, shared, (automaton, &current.state), at);
    }
}

/// Adds the registers of an automaton, which store its state and whether the state is entered with a restart. Returns
/// both as of the start of a cycle, and the placeholder ports to which their values for the next cycle must be bound.
fn state_registers(
    elab: &mut Elaborator<'_>,
    automaton: &Automaton,
    at: Position,
    span: Span,
) -> (NextState, [rpi_net::PortRef; 2]) {
    let next = [Scalar::Int, Scalar::Bool].map(|scalar| nodes::new_alias(elab, scalar));
    let first = nodes::first_port(elab, at.fragment, span);
    let state = elementwise::delay(
        elab,
        PrimitiveFamily::Pre,
        Scalar::Int,
        &Signal::Port(next[0]),
        at,
        span,
    );
    let afresh = elementwise::delay(
        elab,
        PrimitiveFamily::Pre,
        Scalar::Bool,
        &Signal::Port(next[1]),
        at,
        span,
    );
    let initial = number_literal(automaton.initial as usize);
    let state = nodes::add_family_member(
        elab,
        PrimitiveFamily::Conditional,
        Scalar::Int,
        &[first.clone(), initial, state],
        at,
        span,
    );
    let no = Signal::Const(Value::bool(false));
    let afresh = nodes::add_family_member(
        elab,
        PrimitiveFamily::Conditional,
        Scalar::Bool,
        &[first, no, afresh],
        at,
        span,
    );
    (
        NextState {
            state,
            restart: afresh,
        },
        next,
    )
}

/// Returns the state of this cycle after the strong transitions, which act before the state runs. `memory` is the state
/// at the start of the cycle.
fn strong_transitions<'u>(
    elab: &mut Elaborator<'u>,
    scope: &mut Scope<'u>,
    automaton: &'u Automaton,
    memory: &NextState,
    at: Position,
) -> NextState {
    let span = automaton.span;
    let mut current = memory.clone();
    for (k, state) in automaton.states.iter().enumerate() {
        if state.unless.is_empty() {
            continue;
        }
        let here = is_state(elab, &memory.state, k, at, span);
        let inside = guard_conditions(elab, scope, &state.unless, &here, at, span);
        let choice = StateTransitions {
            transitions: &state.unless,
            is_active: &here,
            automaton: span,
        };
        let strong = check_transitions(elab, scope, choice, memory.clone(), inside);
        current = select_next(elab, &here, strong, current, at, span);
    }
    current
}

/// Returns the position for evaluating the conditions of the strong transitions of one state. If a condition can fault,
/// it is evaluated only while `here`, the automaton is in the state. Registers in the conditions still run in all
/// cycles, because they belong to the fragment around the automaton.
fn guard_conditions<'u>(
    elab: &mut Elaborator<'u>,
    scope: &Scope<'u>,
    transitions: &[Transition],
    here: &Signal,
    at: Position,
    span: Span,
) -> Position {
    let mut conditions = transitions.iter().filter_map(|one| one.condition);
    match conditions.any(|one| guards::elab_can_fault(elab, scope, one)) {
        true => elementwise::with_guard(elab, here.clone(), at, span),
        false => at,
    }
}

/// Returns the target of the first transition whose condition holds; `otherwise` if no condition holds.
fn check_transitions<'u>(
    elab: &mut Elaborator<'u>,
    scope: &mut Scope<'u>,
    choice: StateTransitions<'u, '_>,
    otherwise: NextState,
    at: Position,
) -> NextState {
    let mut next = otherwise;
    let mut exits = Vec::new();
    for transition in choice.transitions.iter().rev() {
        let target = NextState {
            state: number_literal(transition.target as usize),
            restart: Signal::Const(Value::bool(!transition.resumes)),
        };
        let condition = match transition.condition {
            None => Signal::Const(Value::bool(true)),
            Some(condition) => expr::elab_condition(elab, scope, condition, at),
        };
        next = match transition.condition {
            None => target,
            Some(_) => select_next(elab, &condition, target, next, at, choice.automaton),
        };
        if elab.records_coverage {
            exits.push((condition, transition.span));
        }
    }
    coverage_points::record_transitions(elab, choice.is_active, exits, choice.automaton, at);
    next
}

fn select_next(
    elab: &mut Elaborator<'_>,
    condition: &Signal,
    yes: NextState,
    no: NextState,
    at: Position,
    span: Span,
) -> NextState {
    let mut choose = |scalar: Scalar, yes: Signal, no: Signal| {
        let operands = [condition.clone(), yes, no];
        let family = PrimitiveFamily::Conditional;
        nodes::add_family_member(elab, family, scalar, &operands, at, span)
    };
    let state = choose(Scalar::Int, yes.state, no.state);
    let known = [true, false].map(|value| Signal::Const(Value::bool(value)));
    let afresh = match [yes.restart, no.restart] {
        branches if branches == known => condition.clone(),
        [yes, no] => choose(Scalar::Bool, yes, no),
    };
    NextState {
        state,
        restart: afresh,
    }
}

/// Returns the signal that is true if state `k` restarts when it runs in this cycle. It also restarts if it was entered
/// with a restart earlier and left by a strong transition before it ran (M14.6). `memory` and `current` are the states
/// before and after the strong transitions.
fn restart_condition(
    elab: &mut Elaborator<'_>,
    (automaton, k): (&Automaton, usize),
    here: &Signal,
    [memory, current]: [&NextState; 2],
    at: Position,
) -> Signal {
    if !can_have_pending_restart(automaton, k) {
        return current.restart.clone();
    }
    let span = automaton.span;
    let and = prim!("Core::BooleanAnd");
    let later = nodes::new_alias(elab, Scalar::Bool);
    let no = Signal::Const(Value::bool(false));
    let owed = elementwise::delay(
        elab,
        PrimitiveFamily::Pre,
        Scalar::Bool,
        &Signal::Port(later),
        at,
        span,
    );
    let first = nodes::first_port(elab, at.fragment, span);
    let owed = [first, no.clone(), owed];
    let owed = nodes::add_family_member(
        elab,
        PrimitiveFamily::Conditional,
        Scalar::Bool,
        &owed,
        at,
        span,
    );
    let entered = is_state(elab, &memory.state, k, at, span);
    let entered = nodes::add_simple(elab, and, &[entered, memory.restart.clone()], at, span);
    let owed = nodes::add_simple(elab, prim!("Core::BooleanOr"), &[owed, entered], at, span);
    let rest = [here.clone(), no, owed.clone()];
    let rest = nodes::add_family_member(
        elab,
        PrimitiveFamily::Conditional,
        Scalar::Bool,
        &rest,
        at,
        span,
    );
    call::bind_alias(elab, later, &rest);
    let afresh = [owed, current.restart.clone()];
    nodes::add_simple(elab, prim!("Core::BooleanOr"), &afresh, at, span)
}

fn is_state(
    elab: &mut Elaborator<'_>,
    state: &Signal,
    k: usize,
    at: Position,
    span: Span,
) -> Signal {
    nodes::add_simple(
        elab,
        prim!("Core::IntEquals"),
        &[state.clone(), number_literal(k)],
        at,
        span,
    )
}

fn state_fragment<'u>(
    elab: &mut Elaborator<'u>,
    scope: &Scope<'u>,
    automaton: &Automaton,
    k: usize,
    here: &Signal,
    afresh: &Signal,
    at: Position,
) -> FragmentId {
    let block = scope.unit.block(automaton.states[k].block);
    let path = format!("{}{}", scope.prefix, block.name);
    let activation = call::elab_activation(elab, here, at, block.span);
    let restart = arrays::port_of(elab, afresh, Scalar::Bool, at, block.span);
    let restart = restart.map_or(Restart::Never, Restart::Every);
    call::elab_fragment(elab, &path, at.fragment, activation, restart, block.span)
}

/// Defines a flow that several states of an automaton define: by the value from the active state, or by the default.
fn shared_flow<'u>(
    elab: &mut Elaborator<'u>,
    scope: &mut Scope<'u>,
    shared: &'u SharedFlow,
    (automaton, state): (&'u Automaton, &Signal),
    at: Position,
) {
    let flow = scope.unit.flow(shared.flow);
    block::set_node_name(elab, &format!("{}{}", scope.prefix, flow.name));
    let before = elab.net.nodes.len();
    let merged = match shared.default {
        Some(default) => with_default(elab, scope, shared, default, (automaton, state), at),
        None => first_present(elab, scope, shared, at, automaton.span),
    };
    if elab.mode == ElabMode::DependencySteps {
        let path = format!("{}{}", scope.prefix, flow.name);
        block::name_leaves(elab, &path, &flow.ty, &merged, before);
    }
    flows::define(elab, scope, shared.flow, 0, &merged);
}

/// Returns the value that the active state gives to a flow defined by several states. Values from inactive states are
/// absent, so that the first present value is taken.
fn first_present<'u>(
    elab: &mut Elaborator<'u>,
    scope: &mut Scope<'u>,
    shared: &'u SharedFlow,
    at: Position,
    span: Span,
) -> Wire {
    let scalars = leaf_scalars(&scope.unit.flow(shared.flow).ty);
    let mut merged: Option<Wire> = None;
    for inner in &shared.states {
        let place = scope.unit.flow(*inner).span;
        let wire = fragment_outputs::read_flow(elab, scope, (*inner, true), at, place);
        let Some(so_far) = merged else {
            merged = Some(wire);
            continue;
        };
        let pairs = so_far.iter().zip(&*wire).zip(&scalars);
        let both = pairs.map(|((a, b), scalar)| {
            let inputs = [a.clone(), b.clone()];
            nodes::add_family_member(elab, PrimitiveFamily::Coalesce, *scalar, &inputs, at, span)
        });
        merged = Some(both.collect());
    }
    merged.unwrap_or_else(crate::elab::signal::empty_wire)
}

/// Returns the value that the active state gives to a flow defined by several states, which may be absent; in states
/// that do not define the flow, the value of its default.
fn with_default<'u>(
    elab: &mut Elaborator<'u>,
    scope: &mut Scope<'u>,
    shared: &'u SharedFlow,
    default: FlowId,
    (automaton, state): (&'u Automaton, &Signal),
    at: Position,
) -> Wire {
    let span = scope.unit.flow(default).span;
    let scalars = leaf_scalars(&scope.unit.flow(shared.flow).ty);
    let chosen = fragment_outputs::read_flow(elab, scope, (default, false), at, span);
    let mut chosen = outside_flows::off_clock_absent(elab, scope, default, &chosen, span);
    for inner in &shared.states {
        let (block, place) = (scope.unit.flow(*inner).block, scope.unit.flow(*inner).span);
        let Some(k) = automaton.states.iter().position(|s| s.block == block) else {
            continue;
        };
        let here = is_state(elab, state, k, at, automaton.span);
        let wire = fragment_outputs::read_flow(elab, scope, (*inner, true), at, place);
        let pairs = wire.iter().zip(&*chosen).zip(&scalars);
        let either = pairs.map(|((own, other), scalar)| {
            let inputs = [here.clone(), own.clone(), other.clone()];
            nodes::add_family_member(
                elab,
                PrimitiveFamily::Conditional,
                *scalar,
                &inputs,
                at,
                automaton.span,
            )
        });
        chosen = either.collect();
    }
    chosen
}

fn number_literal(k: usize) -> Signal {
    Signal::Const(Value::int(k as i64))
}

/// Returns whether state `k` can be entered with a restart, left before it runs, and entered again by `continue`. Only
/// such a state needs a register for a pending restart.
fn can_have_pending_restart(automaton: &Automaton, k: usize) -> bool {
    let weak = automaton.states.iter().flat_map(|state| &state.until);
    let strong = automaton.states.iter().flat_map(|state| &state.unless);
    let enters = |one: &&Transition| one.target as usize == k;
    !automaton.states[k].unless.is_empty()
        && weak.clone().filter(enters).any(|one| !one.resumes)
        && weak.chain(strong).filter(enters).any(|one| one.resumes)
}

/// Returns the next state of an automaton in a cycle without a transition: the same state, without a restart.
fn no_transition(state: &Signal) -> NextState {
    NextState {
        state: state.clone(),
        restart: Signal::Const(Value::bool(false)),
    }
}
