//! Execution of a single node without devices: inputs come from a table, flows are written to a table.
//!
//! | file | idea |
//! |---|---|
//! | `run.rs` | the running node and its cycles |
//! | `table.rs` | CSV rows and their mapping to the node's columns |
//! | `told.rs` | diagnostics for faults in a cycle |

mod run;
mod table;
pub(crate) mod told;

pub use run::{Cycle, NodeRun, Row};
pub use table::{BadTable, Reader, header, line};
