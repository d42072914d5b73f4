//! Unreachable states of automata.

use crate::hash::FastMap;
use crate::program::DeclKind;
use crate::unused::unreachable_heads;
use crate::unused::walk;
use rpi_diag::{Code, Diagnostic};
use rpi_syntax::ast::{Automaton, State, Visitor};

/// Warnings about unreachable states of the automata of a declaration.
struct UnreachableStates(Vec<Diagnostic>);

impl<'a> Visitor<'a> for UnreachableStates {
    fn visits_expressions(&self) -> bool {
        false
    }

    fn visit_automaton(&mut self, automaton: &'a Automaton) {
        self.0.extend(check_automaton(automaton));
    }
}

/// Returns a warning for each unreachable state of the automata of a declaration. A state that only follows another
/// unreachable state is not reported.
pub(super) fn unreached(kind: DeclKind<'_>) -> Vec<Diagnostic> {
    let mut found = UnreachableStates(Vec::new());
    walk(kind, &mut found);
    found.0
}

fn check_automaton(automaton: &Automaton) -> impl Iterator<Item = Diagnostic> + '_ {
    let states = &automaton.states;
    let mut places: FastMap<&str, usize> = FastMap::default();
    for (at, state) in states.iter().enumerate() {
        places.entry(state.name.name.as_str()).or_insert(at);
    }
    let leads = states.iter().map(|state| targets(state, &places));
    let leads: Vec<Vec<usize>> = leads.collect();
    let leads: Vec<&[usize]> = leads.iter().map(|to| &to[..]).collect();
    let start = states.iter().position(|state| state.is_initial);
    let heads = unreachable_heads(&leads, start, |_| true);
    heads.into_iter().map(|at| diagnostic(&states[at]))
}

fn targets(state: &State, places: &FastMap<&str, usize>) -> Vec<usize> {
    let transitions = state.unless.iter().chain(&state.until);
    let found = transitions.filter_map(|one| places.get(one.target.name.as_str()));
    found.copied().collect()
}

fn diagnostic(state: &State) -> Diagnostic {
    let name = &state.name;
    Diagnostic::new(
        Code::RPI3103,
        format!("state `{}` is unreachable", name.name),
    )
    .primary(name.span, "this state is never active")
    .help(format!(
        "add a transition from a reachable state (`then {}`), or delete the state",
        name.name
    ))
}
