//! What stands where in a program's texts: which name means which declaration, and of which type things are.
//!
//! Editors ask this, of programs that are half written. An [`Index`] holds every definition and every reference of a
//! program; it is made of the syntax trees alone, so that it is there however much of the program is wrong. Types and
//! presence come from the checked units ([`types_of_flows`], [`types_of_read`], [`type_around`]), as far as the checker came. This module
//! must not know editors.
//!
//! | file | idea |
//! |---|---|
//! | `def.rs` | definitions and their kinds |
//! | `index.rs` | the table, and what can be asked of it |
//! | `types.rs` | types and presence at places |
//! | `builtin.rs` | what is there without a declaration |
//! | `build/` | from syntax trees to the table |

mod build;
mod builtin;
mod def;
mod index;
mod types;

pub use builtin::{Builtin, builtin, builtins, spatial_parts};
pub use def::{Def, DefId, DefKind};
pub use index::{Index, Reference};
pub use types::{Typed, type_around, types_of_flows, types_of_read};
