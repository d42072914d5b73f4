//! State machines. A state is a block; what several states define is a flow of the surroundings.
//!
//! A flow that states define without its being declared around the automaton is declared by them: outside it is what
//! the active state makes of it, absent where that state does not define it.

use super::body::Body;
use super::locals::Local;
use super::statement::Later;
use crate::hash::Map;
use crate::typed::{Automaton, BlockId, FlowId, FlowRole, Optional, Shared, State, Transition};
use rpi_diag::{Code, Finding, Span};
use rpi_syntax::Name;
use rpi_syntax::ast::{self, Ident, StatementKind};

impl<'a> Body<'_, 'a> {
    /// Declares an automaton's states, what is in them, and the flows that they share.
    pub(super) fn declare_automaton(
        &mut self,
        automaton: &'a ast::Automaton,
        span: Span,
        later: &mut Vec<(BlockId, Later<'a>)>,
    ) {
        let shared = self.shared_names(automaton);
        let mut states = Vec::new();
        for state in &automaton.states {
            let block = self.add_block(&state.name.name, state.name.span);
            self.declare(&state.name, Local::Block(block));
            states.push(State {
                block,
                unless: Vec::new(),
                until: Vec::new(),
            });
        }
        let index = self.current().automata.len();
        let flows = self.shared_flows(&shared);
        self.current().automata.push(Automaton {
            states: states.clone(),
            initial: initial(automaton),
            shared: flows,
            span,
        });
        for (k, (state, ast)) in states.iter().zip(&automaton.states).enumerate() {
            self.declare_state(index, k, state.block, &shared);
            self.within(state.block, |body| body.declare_body(&ast.body, later));
        }
        later.push((self.block, Later::Automaton(index, automaton)));
    }

    /// Names that states define and do not declare, in text order, each with the states that do.
    fn shared_names(&self, automaton: &'a ast::Automaton) -> Vec<(&'a Ident, Vec<bool>)> {
        let mut places: Map<Name, usize> = Map::default();
        let mut shared: Vec<(&'a Ident, Vec<bool>)> = Vec::new();
        let count = automaton.states.len();
        for (k, state) in automaton.states.iter().enumerate() {
            for name in defined_names(state) {
                let place = *places.entry(name.name.clone()).or_insert_with(|| {
                    shared.push((name, vec![false; count]));
                    shared.len() - 1
                });
                shared[place].1[k] = true;
            }
        }
        shared
    }

    /// The flow of the surroundings for each shared name.
    fn shared_flows(&mut self, shared: &[(&'a Ident, Vec<bool>)]) -> Vec<Shared> {
        let mut flows = Vec::new();
        for (name, states) in shared {
            let flow = match self.find_in(self.block, &name.name) {
                Some(Local::Flow(flow)) => flow,
                Some(_) => continue,
                None => match self.local_flow(&name.name) {
                    Some(flow) if self.unit.flow(flow).role == FlowRole::Output => flow,
                    _ => self.introduce_flow(name),
                },
            };
            flows.push(Shared {
                flow,
                states: vec![None; states.len()],
            });
        }
        flows
    }

    /// Declares, in one state, its own version of each flow that it shares.
    fn declare_state(
        &mut self,
        index: usize,
        k: usize,
        block: BlockId,
        shared: &[(&'a Ident, Vec<bool>)],
    ) {
        let outer = self.block;
        let flows: Vec<FlowId> = self.current().automata[index]
            .shared
            .iter()
            .map(|s| s.flow)
            .collect();
        for (place, flow) in flows.into_iter().enumerate() {
            let (name, declared) = {
                let flow = self.unit.flow(flow);
                (flow.name.clone(), (flow.ty.clone(), flow.optional))
            };
            let Some((ident, _)) = shared
                .iter()
                .find(|(n, states)| n.name == name && states[k])
            else {
                continue;
            };
            let (ty, optional) = declared;
            let optional = if ty.is_unknown() {
                Optional::Inferred
            } else {
                optional
            };
            let inner = self.within(block, |body| {
                let inner = body.add_flow(ident, ty, optional, FlowRole::Local);
                body.declare(ident, Local::Flow(inner));
                inner
            });
            self.shares.insert(inner, flow);
            self.unit.blocks[outer.0 as usize].automata[index].shared[place].states[k] =
                Some(inner);
        }
    }

    /// The flow of the surroundings that a state's flow is a version of.
    pub(super) fn shared_flow(&self, flow: FlowId) -> Option<FlowId> {
        self.shares.get(&flow).copied()
    }

    /// Checks an automaton's transitions, each in its state.
    pub(super) fn check_automaton(&mut self, index: usize, automaton: &'a ast::Automaton) {
        let states = self.current().automata[index].states.clone();
        for (k, (state, ast)) in states.iter().zip(&automaton.states).enumerate() {
            let unless = self.transitions(automaton, state.block, &ast.unless, true);
            let until = self.transitions(automaton, state.block, &ast.until, false);
            let state = &mut self.current().automata[index].states[k];
            state.unless = unless;
            state.until = until;
        }
        self.one_initial(automaton);
    }

    fn transitions(
        &mut self,
        automaton: &'a ast::Automaton,
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
            if let Some(target) = self.target_state(automaton, &transition.target) {
                checked.push(Transition {
                    condition,
                    resumes: transition.resumes,
                    target,
                });
            }
        }
        checked
    }

    fn target_state(&mut self, automaton: &ast::Automaton, target: &Ident) -> Option<u32> {
        let names = || automaton.states.iter().map(|state| &state.name.name);
        let index = names().position(|name| *name == target.name);
        if index.is_none() {
            let near = rpi_diag::suggest(&target.name, names().map(Name::as_str));
            let finding = super::report::unknown("state", &target.name, target.span, near);
            self.report(finding);
        }
        index.and_then(|k| u32::try_from(k).ok())
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

fn initial(automaton: &ast::Automaton) -> u32 {
    let index = automaton.states.iter().position(|state| state.initial);
    index.and_then(|k| u32::try_from(k).ok()).unwrap_or(0)
}

/// Plain names that a state defines and does not declare itself.
fn defined_names(state: &ast::State) -> Vec<&Ident> {
    let declared = |name: &Name| {
        state.body.locals.iter().any(|section| match section {
            ast::Locals::Var(vars) => vars
                .iter()
                .any(|var| var.names.iter().any(|n| n.name == *name)),
            ast::Locals::Const(defs) => defs
                .iter()
                .any(|def| def.names.iter().any(|n| n.name == *name)),
        })
    };
    let mut names = Vec::new();
    for statement in &state.body.statements {
        let StatementKind::Equation(equation) = &statement.kind else {
            continue;
        };
        let plain = equation
            .targets
            .iter()
            .filter(|target| target.path.is_empty());
        names.extend(
            plain
                .map(|target| &target.name)
                .filter(|name| !declared(&name.name)),
        );
    }
    names
}
