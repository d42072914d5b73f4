//! Keys of the exports that carry the claims of a program (assertions and contracts) and the values that claims read.
//!
//! The compiler adds these exports to an image. The runtime recognises them by their keys and does not publish them.

use alloc::string::String;

/// Prefix of the export keys that belong to a claim (an `assert`, a `check` or a clause of a contract). The space
/// prevents a clash with an export of a program, whose key contains no space.
const PREFIX: &str = "claim ";

/// Returns the key of the export that carries the condition of a claim, such as `claim 1`. `number` counts the claims
/// of the command from 1.
#[must_use]
pub fn claim_key(number: usize) -> String {
    alloc::format!("{PREFIX}{number}")
}

/// Returns the key of the export of a flow that the condition of a claim reads. `claim` is the key of the claim
/// ([`claim_key`]), `flow` the name of the flow: `claim 1: speed`.
#[must_use]
pub fn read_key(claim: &str, flow: &str) -> String {
    alloc::format!("{claim}: {flow}")
}

/// Returns true if the export with this key carries the condition of a claim (`assert`, `check`, clause of a contract)
/// or a flow that such a condition reads.
#[must_use]
pub fn is_claim_key(key: &str) -> bool {
    key.starts_with(PREFIX)
}
