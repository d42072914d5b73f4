//! Queries about positions in the source: the definition of a name, and types.
//!
//! Editors use these queries on unfinished programs. An [`Index`] holds every definition and reference of a program. It
//! is built from the syntax trees alone, so that it exists even for programs with errors. Types and presence come from
//! the checked units ([`flow_types`], [`read_types`], [`type_at`]), as far as the checker got. This module
//! must not know editors.
//!
//! | file | idea |
//! |---|---|
//! | `def.rs` | definitions and their kinds |
//! | `index.rs` | table of definitions and references, with its queries |
//! | `types.rs` | types and presence at positions |
//! | `builtin.rs` | predeclared names |
//! | `build/` | builds the table from syntax trees |

mod build;
mod builtin;
mod def;
mod index;
mod types;

pub use builtin::{Builtin, builtin, builtins, spatial_parts};
pub use def::{Def, DefId, DefKind};
pub use index::{Index, Reference};
pub use types::{FlowType, flow_types, read_types, type_at};
