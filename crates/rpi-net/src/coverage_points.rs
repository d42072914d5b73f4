//! Coverage points of a net: the parts of a program's text whose execution a coverage report counts.

use crate::input::{FragmentId, Input};
use rpi_diag::Span;

/// Coverage points of a program text: calls, decisions and transitions that tests should reach. A unit that is called
/// several times has its decisions and transitions once per call.
#[derive(Clone, PartialEq, Default, Debug)]
pub struct CoveragePoints {
    /// Locations of the declared names of all called nodes and fragments.
    pub called_units: Vec<Span>,
    /// Decisions (`if`); a decision comes after the one that contains it.
    pub decisions: Vec<Decision>,
    /// Transitions of automata, grouped by the state that they leave.
    pub state_transitions: Vec<StateTransitions>,
}

/// Decision in a program text: an `if`, whose branches a test should both take.
#[derive(Clone, PartialEq, Debug)]
pub struct Decision {
    /// Boolean condition of the decision.
    pub condition: Input,
    /// Fragment in which the condition of the decision is evaluated.
    pub fragment: FragmentId,
    /// Branch of another decision that contains this decision; `None` if it is not nested.
    pub branch: Option<DecisionBranch>,
    /// Location of the whole `if` in the source text.
    pub span: Span,
}

/// One branch of an `if`.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct DecisionBranch {
    /// Index of the decision in [`CoveragePoints::decisions`].
    pub decision: u32,
    /// Truth value of the condition for which the branch is taken.
    pub outcome: bool,
}

/// Transitions out of one state of an automaton that are decided at the start (`unless`) or at the end (`until`) of a
/// cycle.
#[derive(Clone, PartialEq, Debug)]
pub struct StateTransitions {
    /// Boolean that is true while the automaton is in the state.
    pub is_active: Input,
    /// Transitions in priority order. The first one whose condition is true is taken.
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
