//! What a verifier says when a pass broke its own promise: a fault of the compiler, never of a program.

use rpi_diag::Span;
use std::fmt;

/// A promise that does not hold, in words for who works on the compiler.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Violation {
    text: String,
    place: Span,
}

impl Violation {
    /// A violation with this text.
    #[must_use]
    pub fn new(text: impl Into<String>) -> Self {
        Violation {
            text: text.into(),
            place: Span::NONE,
        }
    }

    /// The same, brought about by what stands at a place of the text.
    #[must_use]
    pub fn at(self, place: Span) -> Self {
        Violation { place, ..self }
    }

    /// The place that brought it about; [`Span::NONE`] if it is not known.
    #[must_use]
    pub fn place(&self) -> Span {
        self.place
    }
}

impl fmt::Display for Violation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.text)
    }
}

impl std::error::Error for Violation {}
