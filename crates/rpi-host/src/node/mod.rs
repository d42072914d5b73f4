//! A node by itself: fed from a table, its flows written to a table.
//!
//! | file | idea |
//! |---|---|
//! | `run.rs` | a node and its cycles |
//! | `table.rs` | rows of text and the columns that they belong to |
//! | `told.rs` | what went wrong in a cycle, as a finding |

mod run;
mod table;
pub(crate) mod told;

pub use run::{Cycle, NodeRun, Row};
pub use table::{BadTable, Reader, header, line};
