//! Automata. Each state is a block. A flow that several states define belongs to the block around the automaton.
//!
//! If states define a flow that is not declared around the automaton, the automaton declares it. Outside, its value is
//! that of the active state; it is absent if that state does not define it.

use crate::check::bodies::body::Body;
use crate::check::bodies::defaults;
use crate::check::bodies::locals;
use crate::check::bodies::locals::Local;
use crate::check::bodies::statement;
use crate::check::bodies::statement::DeferredCheck;
use crate::check::diagnostics::report;
use crate::check::diagnostics::undefined_names;
use crate::hash::{FastMap, FastSet};
use crate::program::duplicate_name_error;
use crate::typed::{
    Automaton, BlockId, FlowId, FlowPresence, FlowRole, SharedFlow, State, Transition,
};
use rpi_diag::{Code, Diagnostic, Span};
use rpi_syntax::Name;
use rpi_syntax::ast::{self, Ident, StatementKind};

/// An automaton, and a map from the name of each of its states to the index of the state in text order.
type StateTable<'a, 'm> = (&'a ast::Automaton, &'m FastMap<Name, u32>);

/// Maximum number of states listed in a diagnostic as not defining a flow that other states define. A limit is
/// necessary because the product of states and flows could be large.
const MAX_MISSING: usize = 8;

/// Declares the states of an automaton, the statements in them, and the flows that several states define. Appends the
/// checks that need the types of all flows to `later`.
pub(crate) fn declare_automaton<'a>(
    cx: &mut Body<'_, 'a>,
    automaton: &'a ast::Automaton,
    span: Span,
    later: &mut Vec<(BlockId, DeferredCheck<'a>)>,
) {
    cx.record_state(span);
    let mut states = Vec::new();
    report_duplicate_states(cx, automaton);
    for state in &automaton.states {
        let block = locals::add_block(cx, &state.name.name, state.name.span);
        locals::declare_state_name(cx, &state.name, block);
        states.push(State {
            block,
            unless: Vec::new(),
            until: Vec::new(),
        });
    }
    let index = cx.current_block().automata.len();
    let (shared, places) = declare_shared_flows(cx, automaton);
    cx.current_block().automata.push(Automaton {
        states: states.clone(),
        initial: initial_index(automaton),
        shared,
        span,
    });
    for (state, ast) in states.iter().zip(&automaton.states) {
        declare_state_flows(cx, index, state.block, ast, &places);
        cx.in_block(state.block, |body| {
            statement::declare_body(body, &ast.body, later)
        });
    }
    let active = states.iter().zip(&automaton.states);
    let active = active.filter(|(_, ast)| !is_never_active(automaton, ast));
    let active: Vec<BlockId> = active.map(|(state, _)| state.block).collect();
    for place in 0..places.len() {
        let block = &cx.unit.blocks[cx.block.0 as usize];
        let inner = &block.automata[index].shared[place].states;
        let defining = inner.iter().map(|flow| cx.unit.flow(*flow).block);
        let mut defining: Vec<BlockId> = defining.collect();
        defining.sort_unstable();
        let is_missing = |state: &&BlockId| defining.binary_search(state).is_err();
        let missing = active.iter().filter(is_missing).take(MAX_MISSING);
        cx.current_block().automata[index].shared[place].missing = missing.copied().collect();
    }
    later.push((cx.block, DeferredCheck::Automaton(index, automaton)));
}

/// Returns the flow outside of the automaton for each name that states define and do not declare (rule M14.4), in text
/// order, and a map from each name to its index in this list.
fn declare_shared_flows<'a>(
    cx: &mut Body<'_, 'a>,
    automaton: &'a ast::Automaton,
) -> (Vec<SharedFlow>, FastMap<Name, usize>) {
    let (mut flows, mut places) = (Vec::new(), FastMap::default());
    for name in shared_names(automaton) {
        let flow = match locals::find_in_block(cx, cx.block, &name.name) {
            Some(Local::Flow(flow)) if cx.unit.flow(flow).role.has_equation() => flow,
            // A name that no equation may define, such as an in-port, cannot be defined in a state either.
            Some(_) => continue,
            None => {
                statement::report_constant_redefinition(cx, name);
                locals::introduce_flow(cx, name)
            }
        };
        places.insert(name.name.clone(), flows.len());
        flows.push(SharedFlow {
            flow,
            states: Vec::new(),
            missing: Vec::new(),
            default: defaults::shared_flow_default(cx, flow),
        });
    }
    (flows, places)
}

/// Declares a flow local to a state for each flow that the states of an automaton share and that this state defines.
/// `index` is the index of the automaton in the current block, `block` is the state's block, and `places` has the index
/// of each shared flow by name.
fn declare_state_flows<'a>(
    cx: &mut Body<'_, 'a>,
    index: usize,
    block: BlockId,
    state: &'a ast::State,
    places: &FastMap<Name, usize>,
) {
    for name in names_defined_in_state(state) {
        let Some(&place) = places.get(&name.name) else {
            continue;
        };
        if locals::find_in_block(cx, block, &name.name).is_some() {
            continue;
        }
        let outer = cx.current_block().automata[index].shared[place].flow;
        let inner = cx.in_block(block, |body| {
            let inner = add_contribution(body, name, outer);
            locals::declare(body, name, Local::Flow(inner));
            inner
        });
        cx.current_block().automata[index].shared[place]
            .states
            .push(inner);
    }
}

/// Adds a flow that is local to a state and gives the value of the shared flow `outer` while the state is active, and
/// returns it. If `outer` is declared `T?`, it may be absent because of other states only, so that the absence of the
/// local flow is inferred from its own equation.
pub(crate) fn add_contribution(cx: &mut Body<'_, '_>, name: &Ident, outer: FlowId) -> FlowId {
    let shared = cx.unit.flow(outer);
    let optional = match shared.optional {
        FlowPresence::Declared(false) if !shared.ty.is_unknown() => shared.optional,
        _ => FlowPresence::Inferred,
    };
    let ty = shared.ty.clone();
    let version = locals::add_flow(cx, name, ty, optional, FlowRole::Local);
    cx.shared.flow_of.insert(version, outer);
    cx.shared
        .contributions
        .entry(outer)
        .or_default()
        .push(version);
    version
}

/// Returns the flows outside of the automaton that a flow local to a state defines while the state is active, innermost
/// automaton first. Several flows are returned for nested automata.
pub(crate) fn enclosing_shared_flows<'s>(
    cx: &'s Body<'_, '_>,
    flow: FlowId,
) -> impl Iterator<Item = FlowId> + 's {
    let outer = |flow: &FlowId| cx.shared.flow_of.get(flow).copied();
    std::iter::successors(outer(&flow), outer)
}

/// Checks the transitions of an automaton, and that exactly one state is initial. `index` is the index of the automaton
/// in the current block.
pub(crate) fn check_automaton<'a>(
    cx: &mut Body<'_, 'a>,
    index: usize,
    automaton: &'a ast::Automaton,
) {
    let states = cx.current_block().automata[index].states.clone();
    let names = automaton.states.iter().map(|state| state.name.name.clone());
    let mut places: FastMap<Name, u32> = FastMap::default();
    for (k, name) in (0..).zip(names) {
        places.entry(name).or_insert(k);
    }
    for (k, (state, ast)) in states.iter().zip(&automaton.states).enumerate() {
        let unless = check_transitions(cx, (automaton, &places), state.block, &ast.unless, true);
        let until = check_transitions(cx, (automaton, &places), state.block, &ast.until, false);
        let state = &mut cx.current_block().automata[index].states[k];
        state.unless = unless;
        state.until = until;
    }
    check_initial_state(cx, automaton);
}

fn check_transitions<'a>(
    cx: &mut Body<'_, 'a>,
    states: StateTable<'a, '_>,
    block: BlockId,
    transitions: &'a [ast::Transition],
    strong: bool,
) -> Vec<Transition> {
    let mut checked = Vec::new();
    for transition in transitions {
        // A strong condition (`unless`) is evaluated before the state runs, so that it cannot read the state's own
        // flows.
        let place = if strong { cx.block } else { block };
        let condition = transition.condition.as_ref();
        let condition = condition.map(|c| {
            cx.in_block(place, |body| {
                statement::check_condition(body, c, "a transition")
            })
        });
        if let Some(target) = resolve_target_state(cx, states, &transition.target) {
            checked.push(Transition {
                condition,
                resumes: transition.resumes,
                target,
                span: transition.span,
            });
        }
    }
    checked
}

/// Returns the index of the target state of a transition in text order; `None` after an error about an undefined state.
fn resolve_target_state<'a>(
    cx: &mut Body<'_, 'a>,
    (automaton, places): StateTable<'a, '_>,
    target: &Ident,
) -> Option<u32> {
    let index = places.get(&target.name).copied();
    if index.is_none() {
        let names = automaton
            .states
            .iter()
            .map(|state| state.name.name.as_str());
        let diagnostic = match state_in_other_automaton(cx, &target.name) {
            Some(place) => undefined_names::state_in_other_automaton(target, place),
            None => {
                let near = cx.checker.suggest(&target.name, names.clone());
                undefined_names::undefined_state(target, near, names)
            }
        };
        report::report_diagnostic(cx, diagnostic);
    }
    index
}

/// Returns the location at which a state of another automaton with this name is declared; `None` if no visible
/// automaton has such a state.
fn state_in_other_automaton(cx: &Body<'_, '_>, name: &Name) -> Option<Span> {
    match locals::find_local(cx, name)? {
        Local::State(block) => Some(cx.unit.block(block).span),
        Local::AmbiguousState([first, _], _) => Some(first),
        _ => None,
    }
}

/// Whether a block of the body is a state of an automaton.
pub(crate) fn is_state(cx: &Body<'_, '_>, block: BlockId) -> bool {
    let around = cx.unit.block(block).parent.map(|id| cx.unit.block(id));
    let automata = around.into_iter().flat_map(|around| &around.automata);
    let mut states = automata.flat_map(|automaton| &automaton.states);
    states.any(|state| state.block == block)
}

/// Reports states of an automaton with the same name.
fn report_duplicate_states(cx: &mut Body<'_, '_>, automaton: &ast::Automaton) {
    let mut known: FastMap<&Name, Span> = FastMap::default();
    for Ident { name, span } in automaton.states.iter().map(|state| &state.name) {
        if let Some(first) = known.get(name) {
            report::report_diagnostic(cx, duplicate_name_error(name, *span, *first));
        }
        known.entry(name).or_insert(*span);
    }
}

/// Reports an automaton without an initial state or with several.
fn check_initial_state(cx: &mut Body<'_, '_>, automaton: &ast::Automaton) {
    let mut initial = automaton.states.iter().filter(|state| state.is_initial);
    let diagnostic = match (initial.next(), initial.next()) {
        (Some(_), None) => return,
        (Some(first), Some(second)) => Diagnostic::new(
            Code::RPI3006,
            "an automaton must have exactly one initial state",
        )
        .primary(second.name.span, "second initial state")
        .secondary(first.name.span, "first initial state")
        .help("delete `initial` before all states but one"),
        (None, _) => Diagnostic::new(Code::RPI3006, "the automaton has no initial state")
            .primary(automaton.states[0].name.span, "first state")
            .help("mark one state as initial: `initial state`"),
    };
    report::report_diagnostic(cx, diagnostic);
}

/// Whether a state is never active: it has no statements, an unconditional strong transition (`unless`) leaves it
/// before it runs, and no strong transition enters it.
fn is_never_active(automaton: &ast::Automaton, state: &ast::State) -> bool {
    let mut strong = automaton.states.iter().flat_map(|other| &other.unless);
    let is_left = state.unless.iter().any(|one| one.condition.is_none());
    is_left
        && !strong.any(|one| one.target.name == state.name.name)
        && state.body.statements.is_empty()
}

/// Returns the index of the initial state in text order; 0 if no state is declared initial.
fn initial_index(automaton: &ast::Automaton) -> u32 {
    let index = automaton.states.iter().position(|state| state.is_initial);
    index.and_then(|k| u32::try_from(k).ok()).unwrap_or(0)
}

/// Returns the names that the states of an automaton define and do not declare, including the states of nested
/// automata. Each name occurs once, in text order.
pub(crate) fn shared_names(automaton: &ast::Automaton) -> Vec<&Ident> {
    let mut known: FastSet<&Name> = FastSet::default();
    let names = automaton.states.iter().flat_map(names_defined_in_state);
    names.filter(|name| known.insert(&name.name)).collect()
}

/// Returns the names that a state defines without declaring them, by its own equations or by those of automata inside
/// of it.
fn names_defined_in_state(state: &ast::State) -> Vec<&Ident> {
    let mut names = names_defined_by_equations(state);
    names.extend(names_defined_in_nested_automata(state));
    names
}

/// Returns the names that automata inside of a state define and that neither their states nor this state declare.
fn names_defined_in_nested_automata(state: &ast::State) -> Vec<&Ident> {
    let declared = declared_names(state);
    let automata = state.body.statements.iter().filter_map(|s| match &s.kind {
        StatementKind::Automaton(automaton) => Some(automaton),
        _ => None,
    });
    let states = automata.flat_map(|automaton| &automaton.states);
    states
        .flat_map(names_defined_in_state)
        .filter(|name| !declared.contains_key(&name.name))
        .collect()
}

/// Returns the names on the left sides of a state's equations that the state does not declare. Names of which only a
/// part is defined, as in `a[0] = 1`, are left out.
fn names_defined_by_equations(state: &ast::State) -> Vec<&Ident> {
    let declared = declared_names(state);
    let equations = state.body.statements.iter().filter_map(|s| match &s.kind {
        StatementKind::Equation(equation) => Some(equation),
        _ => None,
    });
    let plain = equations
        .flat_map(|equation| &equation.targets)
        .filter(|target| target.path.is_empty());
    plain
        .map(|target| &target.name)
        .filter(|name| !declared.contains_key(&name.name))
        .collect()
}

/// Returns the set of names of the flows and constants that a state declares itself. They hide names around the
/// automaton.
fn declared_names(state: &ast::State) -> FastMap<&Name, ()> {
    let mut declared: FastMap<&Name, ()> = FastMap::default();
    for section in &state.body.locals {
        match section {
            ast::Locals::Var(vars) => {
                declared.extend(
                    vars.iter()
                        .flat_map(|var| &var.names)
                        .map(|n| (&n.name, ())),
                );
            }
            ast::Locals::Const(defs) => {
                declared.extend(
                    defs.iter()
                        .flat_map(|def| &def.names)
                        .map(|n| (&n.name, ())),
                );
            }
        }
    }
    declared
}
