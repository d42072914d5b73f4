//! Maintenance tasks of the repository, and its rules as tests.
//!
//! `ARCHITECTURE.md` states the rules; `tests/tidy` checks them; `cargo xtask` runs the tasks. This library provides the data for those tests: the
//! crates from cargo, the files from git, functions and fenced code blocks from source texts, and the files generated
//! from the tables of the project. The product does not depend on it.

mod fences;
mod generate;
mod packages;
mod rust_text;
mod source;
mod types;

pub use fences::{Fence, fences};
pub use generate::{Generated, generated};
pub use packages::{Dependency, Package, packages};
pub use rust_text::{Part, PartKind, is_word, parts};
pub use source::{Function, SourceFile, functions, source_files, tracked_files};
pub use types::{TypePart, type_parts};
