//! The rules that carry the house, as tests.
//!
//! `ARCHITECTURE.md` states them; `tests/house` holds them. This library is what those tests look
//! through: the crates as cargo sees them, the files as git sees them, functions and fenced code
//! blocks by their text; and the files that are generated from the project's tables. Nothing of the
//! product depends on it.

mod fences;
mod generate;
mod manifest;
mod source;

pub use fences::{Fence, fences};
pub use generate::{Generated, generated};
pub use manifest::{Dependency, Package, packages};
pub use source::{Function, SourceFile, functions, source_files, tracked_files};
