//! Error of a verifier when a pass broke its own postcondition: a bug in the compiler, never an error in a program.

use rpi_diag::Span;
use std::fmt;

/// Error: the net violates an invariant, or the result of a pass is wrong. The text is for compiler developers.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct VerifyError {
    text: String,
    span: Span,
}

impl VerifyError {
    /// Creates an error with this text and without a location.
    #[must_use]
    pub fn new(text: impl Into<String>) -> Self {
        VerifyError {
            text: text.into(),
            span: Span::NONE,
        }
    }

    /// Returns the error with the location in the source text that caused it.
    #[must_use]
    pub fn with_span(self, place: Span) -> Self {
        VerifyError {
            span: place,
            ..self
        }
    }

    /// Returns the location in the source text that caused the error; [`Span::NONE`] if it is unknown.
    #[must_use]
    pub fn span(&self) -> Span {
        self.span
    }
}

impl fmt::Display for VerifyError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.text)
    }
}

impl std::error::Error for VerifyError {}
