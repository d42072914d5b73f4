//! Error of a verifier when a pass broke its own postcondition: a bug in the compiler, never an error in a program.

use rpi_diag::Span;
use std::fmt;

/// Violated postcondition of a pass, described for compiler developers.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct VerifyError {
    text: String,
    span: Span,
}

impl VerifyError {
    /// Returns a violation with this text and no location.
    #[must_use]
    pub fn new(text: impl Into<String>) -> Self {
        VerifyError {
            text: text.into(),
            span: Span::NONE,
        }
    }

    /// Returns the violation with the source location that caused it.
    #[must_use]
    pub fn with_span(self, place: Span) -> Self {
        VerifyError {
            span: place,
            ..self
        }
    }

    /// Source location that caused the violation; [`Span::NONE`] if it is unknown.
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
