//! State machines. A state is a block; what several states define is a flow of the surroundings.
//!
//! A flow that states define without its being declared around the automaton is declared by them: outside it is what
//! the active state makes of it, absent where that state does not define it.

use super::body::Body;
use super::locals::Local;
use super::statement::Later;
use super::unknown;
use crate::hash::{Map, Set};
use crate::program::twice;
use crate::typed::{Automaton, BlockId, FlowId, FlowRole, Optional, Shared, State, Transition};
use rpi_diag::{Code, Finding, Span};
use rpi_syntax::Name;
use rpi_syntax::ast::{self, Ident, StatementKind};

/// The states of an automaton, and the place of each by its name.
type States<'a, 'm> = (&'a ast::Automaton, &'m Map<Name, u32>);

/// States that do not define a flow that are kept, for messages: every state may have a flow of its own.
const MISSING: usize = 8;

impl<'a> Body<'_, 'a> {
    /// Declares an automaton's states, what is in them, and the flows that they share.
    pub(super) fn declare_automaton(
        &mut self,
        automaton: &'a ast::Automaton,
        span: Span,
        later: &mut Vec<(BlockId, Later<'a>)>,
    ) {
        self.has_state(span);
        let mut states = Vec::new();
        self.one_of_each_name(automaton);
        for state in &automaton.states {
            let block = self.add_block(&state.name.name, state.name.span);
            self.declare_state_name(&state.name, block);
            states.push(State {
                block,
                unless: Vec::new(),
                until: Vec::new(),
            });
        }
        let index = self.current().automata.len();
        let (shared, places) = self.shared_flows(automaton);
        self.current().automata.push(Automaton {
            states: states.clone(),
            initial: initial(automaton),
            shared,
            span,
        });
        for (state, ast) in states.iter().zip(&automaton.states) {
            self.declare_state(index, state.block, ast, &places);
            self.within(state.block, |body| body.declare_body(&ast.body, later));
        }
        let active = states.iter().zip(&automaton.states);
        let active = active.filter(|(_, ast)| !is_only_passed(automaton, ast));
        let active: Vec<BlockId> = active.map(|(state, _)| state.block).collect();
        for place in 0..places.len() {
            let block = &self.unit.blocks[self.block.0 as usize];
            let inner = &block.automata[index].shared[place].states;
            let defining = inner.iter().map(|flow| self.unit.flow(*flow).block);
            let mut defining: Vec<BlockId> = defining.collect();
            defining.sort_unstable();
            let is_missing = |state: &&BlockId| defining.binary_search(state).is_err();
            let missing = active.iter().filter(is_missing).take(MISSING);
            self.current().automata[index].shared[place].missing = missing.copied().collect();
        }
        later.push((self.block, Later::Automaton(index, automaton)));
    }

    /// The flow of the surroundings for each name that states define and do not declare (M14.4), in text order.
    fn shared_flows(&mut self, automaton: &'a ast::Automaton) -> (Vec<Shared>, Map<Name, usize>) {
        let (mut flows, mut places) = (Vec::new(), Map::default());
        for name in candidates(automaton) {
            let flow = match self.find_in(self.block, &name.name) {
                Some(Local::Flow(flow)) if self.unit.flow(flow).role.has_equation() => flow,
                // What no equation may define, one in a state may not, either.
                Some(_) => continue,
                None => {
                    self.hides_no_constant(name);
                    self.introduce_flow(name)
                }
            };
            places.insert(name.name.clone(), flows.len());
            flows.push(Shared {
                flow,
                states: Vec::new(),
                missing: Vec::new(),
                default: self.default_beside(flow),
            });
        }
        (flows, places)
    }

    /// Declares, in one state, its own version of each flow that it shares.
    fn declare_state(
        &mut self,
        index: usize,
        block: BlockId,
        state: &'a ast::State,
        places: &Map<Name, usize>,
    ) {
        for name in all_defined_names(state) {
            let Some(&place) = places.get(&name.name) else {
                continue;
            };
            if self.find_in(block, &name.name).is_some() {
                continue;
            }
            let outer = self.current().automata[index].shared[place].flow;
            let inner = self.within(block, |body| {
                let inner = body.version_of(name, outer);
                body.declare(name, Local::Flow(inner));
                inner
            });
            self.current().automata[index].shared[place]
                .states
                .push(inner);
        }
    }

    /// A flow of the current block that contributes to `outer`, which states share. Declared `T?`, `outer` may be absent
    /// because of other states: whether this contribution may be absent is for its own equation to say.
    pub(super) fn version_of(&mut self, name: &Ident, outer: FlowId) -> FlowId {
        let shared = self.unit.flow(outer);
        let optional = match shared.optional {
            Optional::Declared(false) if !shared.ty.is_unknown() => shared.optional,
            _ => Optional::Inferred,
        };
        let ty = shared.ty.clone();
        let version = self.add_flow(name, ty, optional, FlowRole::Local);
        self.shares.insert(version, outer);
        self.versions.entry(outer).or_default().push(version);
        version
    }

    /// The flows of the surroundings that a state's flow is a version of, from the inside out.
    pub(super) fn shared_around(&self, flow: FlowId) -> impl Iterator<Item = FlowId> + '_ {
        let outer = |flow: &FlowId| self.shares.get(flow).copied();
        std::iter::successors(outer(&flow), outer)
    }

    /// Checks an automaton's transitions, each in its state.
    pub(super) fn check_automaton(&mut self, index: usize, automaton: &'a ast::Automaton) {
        let states = self.current().automata[index].states.clone();
        let names = automaton.states.iter().map(|state| state.name.name.clone());
        let mut places: Map<Name, u32> = Map::default();
        for (k, name) in (0..).zip(names) {
            places.entry(name).or_insert(k);
        }
        for (k, (state, ast)) in states.iter().zip(&automaton.states).enumerate() {
            let unless = self.transitions((automaton, &places), state.block, &ast.unless, true);
            let until = self.transitions((automaton, &places), state.block, &ast.until, false);
            let state = &mut self.current().automata[index].states[k];
            state.unless = unless;
            state.until = until;
        }
        self.one_initial(automaton);
    }

    fn transitions(
        &mut self,
        states: States<'a, '_>,
        block: BlockId,
        transitions: &'a [ast::Transition],
        strong: bool,
    ) -> Vec<Transition> {
        let mut checked = Vec::new();
        for transition in transitions {
            // A strong condition is decided before the state runs, so it is not one of the state's own flows.
            let place = if strong { self.block } else { block };
            let condition = transition.condition.as_ref();
            let condition =
                condition.map(|c| self.within(place, |body| body.condition(c, "a transition")));
            if let Some(target) = self.target_state(states, &transition.target) {
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

    fn target_state(&mut self, (automaton, places): States<'a, '_>, target: &Ident) -> Option<u32> {
        let index = places.get(&target.name).copied();
        if index.is_none() {
            let names = automaton
                .states
                .iter()
                .map(|state| state.name.name.as_str());
            let finding = match self.state_elsewhere(&target.name) {
                Some(place) => unknown::state_elsewhere(target, place),
                None => {
                    let near = self.c.suggest(&target.name, names);
                    unknown::unknown_state(target, near)
                }
            };
            self.report(finding);
        }
        index
    }

    /// Where a state of another automaton is declared, here or around here.
    fn state_elsewhere(&self, name: &Name) -> Option<Span> {
        match self.find_local(name)? {
            Local::State(block) => Some(self.unit.block(block).span),
            Local::States([first, _], _) => Some(first),
            _ => None,
        }
    }

    /// Whether a block is a state.
    pub(super) fn is_state(&self, block: BlockId) -> bool {
        let around = self.unit.block(block).parent.map(|id| self.unit.block(id));
        let automata = around.into_iter().flat_map(|around| &around.automata);
        let mut states = automata.flat_map(|automaton| &automaton.states);
        states.any(|state| state.block == block)
    }

    fn one_of_each_name(&mut self, automaton: &ast::Automaton) {
        let mut known: Map<&Name, Span> = Map::default();
        for Ident { name, span } in automaton.states.iter().map(|state| &state.name) {
            if let Some(first) = known.get(name) {
                self.report(twice(name, *span, *first));
            }
            known.entry(name).or_insert(*span);
        }
    }

    fn one_initial(&mut self, automaton: &ast::Automaton) {
        let mut initial = automaton.states.iter().filter(|state| state.initial);
        let finding = match (initial.next(), initial.next()) {
            (Some(_), None) => return,
            (Some(first), Some(second)) => {
                Finding::new(Code::RPI3006, "an automaton starts in one state")
                    .at(second.name.span, "a second initial state")
                    .also(first.name.span, "the first one")
            }
            (None, _) => Finding::new(Code::RPI3006, "no state is `initial`")
                .at(automaton.states[0].name.span, "does it start here?")
                .help("write `initial state` where it starts"),
        };
        self.report(finding);
    }
}

/// Whether a state is never active: it is always left before it runs, and nothing enters it in the cycle in which it would run.
fn is_only_passed(automaton: &ast::Automaton, state: &ast::State) -> bool {
    let mut strong = automaton.states.iter().flat_map(|other| &other.unless);
    let is_left = state.unless.iter().any(|one| one.condition.is_none());
    is_left
        && !strong.any(|one| one.target.name == state.name.name)
        && state.body.statements.is_empty()
}

fn initial(automaton: &ast::Automaton) -> u32 {
    let index = automaton.states.iter().position(|state| state.initial);
    index.and_then(|k| u32::try_from(k).ok()).unwrap_or(0)
}

/// The names that states define and do not declare, also by automata in them: each once, in text order.
pub(super) fn candidates(automaton: &ast::Automaton) -> Vec<&Ident> {
    let mut known: Set<&Name> = Set::default();
    let names = automaton.states.iter().flat_map(all_defined_names);
    names.filter(|name| known.insert(&name.name)).collect()
}

/// Plain names that a state or an automaton in it defines, and that it does not declare itself.
fn all_defined_names(state: &ast::State) -> Vec<&Ident> {
    let mut names = defined_names(state);
    names.extend(defined_by_automata(state));
    names
}

/// Plain names that automata in a state define, and that it does not declare itself.
fn defined_by_automata(state: &ast::State) -> Vec<&Ident> {
    let declared = declared_names(state);
    let automata = state.body.statements.iter().filter_map(|s| match &s.kind {
        StatementKind::Automaton(automaton) => Some(automaton),
        _ => None,
    });
    let states = automata.flat_map(|automaton| &automaton.states);
    states
        .flat_map(all_defined_names)
        .filter(|name| !declared.contains_key(&name.name))
        .collect()
}

/// Plain names that equations of a state define, and that it does not declare itself.
fn defined_names(state: &ast::State) -> Vec<&Ident> {
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

fn declared_names(state: &ast::State) -> Map<&Name, ()> {
    let mut declared: Map<&Name, ()> = Map::default();
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
