//! Unreachable states of automata.

use crate::hash::Map;
use crate::program::DeclKind;
use crate::unused::heads;
use crate::unused::walk;
use rpi_diag::{Code, Finding};
use rpi_syntax::ast::{Automaton, State, Visit};

/// Warnings about the automata of a declaration.
struct Unreached(Vec<Finding>);

impl<'a> Visit<'a> for Unreached {
    fn looks_into_expressions(&self) -> bool {
        false
    }

    fn automaton(&mut self, automaton: &'a Automaton) {
        self.0.extend(of_automaton(automaton));
    }
}

/// Returns a warning for each unreachable state. A state that only follows another unreachable state is not reported.
pub(super) fn unreached(kind: DeclKind<'_>) -> Vec<Finding> {
    let mut found = Unreached(Vec::new());
    walk(kind, &mut found);
    found.0
}

fn of_automaton(automaton: &Automaton) -> impl Iterator<Item = Finding> + '_ {
    let states = &automaton.states;
    let mut places: Map<&str, usize> = Map::default();
    for (at, state) in states.iter().enumerate() {
        places.entry(state.name.name.as_str()).or_insert(at);
    }
    let leads = states.iter().map(|state| targets(state, &places));
    let leads: Vec<Vec<usize>> = leads.collect();
    let leads: Vec<&[usize]> = leads.iter().map(|to| &to[..]).collect();
    let start = states.iter().position(|state| state.initial);
    let told = heads(&leads, start, |_| true);
    told.into_iter().map(|at| finding(&states[at]))
}

fn targets(state: &State, places: &Map<&str, usize>) -> Vec<usize> {
    let transitions = state.unless.iter().chain(&state.until);
    let found = transitions.filter_map(|one| places.get(one.target.name.as_str()));
    found.copied().collect()
}

fn finding(state: &State) -> Finding {
    let name = &state.name;
    Finding::new(
        Code::RPI3103,
        format!("state `{}` is unreachable", name.name),
    )
    .at(name.span, "this state is never active")
    .help(format!(
        "add a transition to it (`then {}`), or delete it",
        name.name
    ))
}
