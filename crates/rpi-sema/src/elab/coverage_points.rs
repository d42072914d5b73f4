//! Coverage points: records which places in the source the parts of a test's net come from.

use crate::elab::arrays;
use crate::elab::signal::Signal;
use crate::elab::{Elaborator, Position};
use crate::hash::FastMap;
use crate::typed::Unit;
use rpi_diag::Span;
use rpi_image::Scalar;
use rpi_net::{Decision, DecisionBranch, FragmentId, Net, StateTransitions, Transition};

/// Makes the names of the fragments and nodes in each fragment of a net unique. Repeated calls or several automata in
/// one body have equal names, and tests find fragments and nodes in the image by name.
pub(super) fn make_names_unique(net: &mut Net) {
    let mut known = UsedNames::default();
    for fragment in net.fragments.iter_mut().skip(1) {
        let parent = fragment.parent.unwrap_or(FragmentId::ROOT);
        make_unique(&mut fragment.name, parent, &mut known);
    }
    known.clear();
    for node in &mut net.nodes {
        make_unique(&mut node.name, node.fragment, &mut known);
    }
}

/// Names in use within each fragment of a net, each with the last number that has been appended to it to make it
/// unique.
type UsedNames = FastMap<(FragmentId, String), usize>;

fn make_unique(name: &mut String, inside: FragmentId, known: &mut UsedNames) {
    let plain = (inside, name.clone());
    let mut number = known.get(&plain).copied().unwrap_or(0);
    while known.contains_key(&(inside, name.clone())) {
        number += 1;
        *name = format!("{}#{}", plain.1, number + 1);
    }
    known.insert(plain, number);
    known.entry((inside, name.clone())).or_insert(0);
}

/// Adds a called unit to the coverage points of the net (places whose execution is counted), if coverage is recorded.
pub(super) fn record_call(elab: &mut Elaborator<'_>, unit: &Unit) {
    if elab.records_coverage {
        elab.net.coverage_points.called_units.push(unit.span);
    }
}

/// Adds an `if` with this condition to the coverage points of the net, if coverage is recorded. Returns its branches,
/// the one for a true condition first; without coverage, the branch around the `if`.
pub(super) fn record_choice(
    elab: &mut Elaborator<'_>,
    condition: &Signal,
    at: Position,
    span: Span,
) -> [Option<DecisionBranch>; 2] {
    if !elab.records_coverage {
        return [at.branch; 2];
    }
    let condition = arrays::one_input(elab, condition, Scalar::Bool, at, span);
    let choices = &mut elab.net.coverage_points.decisions;
    let choice = choices.len() as u32;
    choices.push(Decision {
        condition,
        fragment: at.fragment,
        branch: at.branch,
        span,
    });
    [true, false].map(|taken_if| {
        Some(DecisionBranch {
            decision: choice,
            outcome: taken_if,
        })
    })
}

/// Adds the transitions out of a state to the coverage points of the net, if coverage is recorded. `here` is whether
/// the automaton is in the state, and `exits` are the conditions and locations of the transitions, the last one first.
pub(super) fn record_transitions(
    elab: &mut Elaborator<'_>,
    here: &Signal,
    exits: Vec<(Signal, Span)>,
    automaton: Span,
    at: Position,
) {
    if !elab.records_coverage {
        return;
    }
    let here = arrays::one_input(elab, here, Scalar::Bool, at, automaton);
    let exit = |(condition, span): (Signal, Span)| Transition {
        condition: arrays::one_input(elab, &condition, Scalar::Bool, at, span),
        span,
    };
    let transitions = exits.into_iter().rev().map(exit).collect();
    elab.net
        .coverage_points
        .state_transitions
        .push(StateTransitions {
            is_active: here,
            transitions,
        });
}
