//! States of automata to which nothing leads.

use super::heads;
use crate::hash::Map;
use crate::program::DeclKind;
use rpi_diag::{Code, Finding};
use rpi_syntax::ast::{Automaton, Body, NodeDef, State, Statement, StatementKind};

/// A warning for each state to which nothing leads. What only follows such a state is not told, too.
pub(super) fn unreached(kind: DeclKind<'_>) -> Vec<Finding> {
    let mut findings = Vec::new();
    let body = match kind {
        DeclKind::Node(node) => match &node.definition {
            NodeDef::Body(body) => body,
            _ => return findings,
        },
        DeclKind::Fragment(fragment) => &fragment.body,
        DeclKind::Command(command) => &command.body,
        DeclKind::Test(test) => &test.body,
        _ => return findings,
    };
    within(&body.statements, &mut findings);
    findings
}

fn within(statements: &[Statement], findings: &mut Vec<Finding>) {
    for statement in statements {
        match &statement.kind {
            StatementKind::Fragment(fragment) => within(&fragment.body.statements, findings),
            StatementKind::Automaton(automaton) => {
                findings.extend(of_automaton(automaton));
                let bodies = automaton.states.iter().map(|state| &state.body);
                bodies.for_each(|body: &Body| within(&body.statements, findings));
            }
            _ => {}
        }
    }
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
        format!("nothing leads to the state `{}`", name.name),
    )
    .at(name.span, "this is never active")
    .help(format!(
        "let a transition lead to it (`then {}`), or delete it",
        name.name
    ))
}
