//! Error of the lowering.

use std::fmt;

/// Reason why a net cannot be lowered to an image.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum LowerError {
    /// The command needs more memory than an image may have.
    MemoryLimit {
        /// Number of memory slots that the command needs.
        slots: u32,
        /// Maximal number of memory slots of an image.
        limit: u32,
    },
}

impl fmt::Display for LowerError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let LowerError::MemoryLimit { slots, limit } = self;
        write!(
            f,
            "memory limit exceeded: {slots} slots, at most {limit} allowed"
        )
    }
}

impl std::error::Error for LowerError {}
