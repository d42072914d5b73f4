//! What a verifier says when a pass broke its own promise: a fault of the compiler, never of a program.

use std::fmt;

/// A promise that does not hold, in words for who works on the compiler.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Violation(String);

impl Violation {
    /// A violation with this text.
    #[must_use]
    pub fn new(text: impl Into<String>) -> Self {
        Violation(text.into())
    }
}

impl fmt::Display for Violation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl std::error::Error for Violation {}
