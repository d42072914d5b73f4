//! Coverage points of a net: the parts of a program's text whose execution a coverage report counts.

use crate::input::{FragmentId, Input};
use rpi_diag::Span;

/// Coverage points of a program text. A unit that is called several times has an entry per call.
#[derive(Clone, PartialEq, Default, Debug)]
pub struct CoveragePoints {
    /// Declaration sites of the names of all called units.
    pub called_units: Vec<Span>,
    /// Decisions (`if`); a nested decision comes after the enclosing one.
    pub decisions: Vec<Decision>,
    /// Possible transitions out of the states of automata.
    pub state_transitions: Vec<StateTransitions>,
}

/// Decision in a program text: an `if`, whose branches a test should both take.
#[derive(Clone, PartialEq, Debug)]
pub struct Decision {
    /// Boolean condition of the decision.
    pub condition: Input,
    /// Fragment in which the condition is evaluated.
    pub fragment: FragmentId,
    /// Branch of an enclosing decision that contains this one.
    pub branch: Option<DecisionBranch>,
    /// Location of the whole `if`.
    pub span: Span,
}

/// One side of an `if`: the side for a true or for a false condition.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct DecisionBranch {
    /// Index of the decision in [`CoveragePoints::decisions`].
    pub decision: u32,
    /// Value of the condition for which the branch is taken.
    pub outcome: bool,
}

/// Transitions out of one state of an automaton at the start or at the end of a cycle.
#[derive(Clone, PartialEq, Debug)]
pub struct StateTransitions {
    /// Boolean that is true while the automaton is in the state.
    pub is_active: Input,
    /// Transitions in priority order: the first one with a true condition is taken.
    pub transitions: Vec<Transition>,
}

/// Transition out of a state.
#[derive(Clone, PartialEq, Debug)]
pub struct Transition {
    /// Boolean condition of the transition.
    pub condition: Input,
    /// Location of the transition in the source text.
    pub span: Span,
}
