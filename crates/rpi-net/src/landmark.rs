//! Where a net came from: for those who watch what of a program's text a run reaches.

use crate::net::{FragmentId, Input};
use rpi_diag::Span;

/// What was made from which place of the text; of what is called several times there are as many entries.
#[derive(Clone, PartialEq, Default, Debug)]
pub struct Landmarks {
    /// The names of all that was called, where it is declared.
    pub called: Vec<Span>,
    /// The choices, those inside another one after it.
    pub choices: Vec<Choice>,
    /// What may leave the states of its automata.
    pub exits: Vec<Exits>,
}

/// An `if`.
#[derive(Clone, PartialEq, Debug)]
pub struct Choice {
    /// What decides: a Boolean.
    pub condition: Input,
    /// Where it is made.
    pub fragment: FragmentId,
    /// The branch of another choice that it belongs to.
    pub side: Option<Side>,
    /// All of it.
    pub span: Span,
}

/// A branch of a choice.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Side {
    /// Which choice, by its place in [`Landmarks::choices`].
    pub choice: u32,
    /// The condition for which the branch is taken.
    pub taken_if: bool,
}

/// What may leave a state of an automaton at one end of a cycle: for those who watch a run.
#[derive(Clone, PartialEq, Debug)]
pub struct Exits {
    /// Whether the automaton is in that state: a Boolean.
    pub here: Input,
    /// The transitions in the order in which they are tried: the first one whose condition holds is taken.
    pub transitions: Vec<Exit>,
}

/// A transition out of a state.
#[derive(Clone, PartialEq, Debug)]
pub struct Exit {
    /// When: a Boolean.
    pub condition: Input,
    /// The transition.
    pub span: Span,
}
