//! Wording that messages of the compiler and the runtime share: counts with nouns, and the nearest known name.
//!
//! This crate depends on no other crate, so that the runtime can word its messages without the diagnostics of the
//! compiler.

mod pluralise;
mod suggest;

pub use pluralise::{times, with_noun};
pub use suggest::suggest;
