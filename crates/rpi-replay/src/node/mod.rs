//! Execution of a single node without devices: inputs come from a table, flows are written to a table.
//!
//! | file | idea |
//! |---|---|
//! | `run.rs` | the running node and its cycles |
//! | `table.rs` | CSV rows and their mapping to the node's columns |

mod run;
mod table;

pub use run::{Cycle, NodeRun, Row};
pub use table::{BadTable, Reader, header, line};
