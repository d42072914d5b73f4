//! Keys of the exports that carry the claims of a program (assertions and contracts) and the values that claims read.
//!
//! The compiler adds these exports to an image. The runtime recognises them by their keys and does not publish them.

use alloc::string::String;

/// Prefix of the keys of all exports that belong to a claim. A key that a program declares contains no space.
const PREFIX: &str = "claim ";

/// Returns the key of the export of the claim with this number.
#[must_use]
pub fn claim_key(number: usize) -> String {
    alloc::format!("{PREFIX}{number}")
}

/// Returns the key of the export of a flow that a claim reads.
#[must_use]
pub fn read_key(claim: &str, flow: &str) -> String {
    alloc::format!("{claim}: {flow}")
}

/// Returns true if the export with this key belongs to a claim.
#[must_use]
pub fn is_claim_key(key: &str) -> bool {
    key.starts_with(PREFIX)
}
