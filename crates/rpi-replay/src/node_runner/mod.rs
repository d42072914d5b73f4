//! Execution of a single node without devices: inputs come from a table, flows are written to a table.
//!
//! | file | idea |
//! |---|---|
//! | `run.rs` | the running node and its cycles |
//! | `csv_table.rs` | CSV rows and their mapping to the node's columns |

mod csv_table;
mod run;

pub use csv_table::{TableError, TableReader, header_line, row_line};
pub use run::{ColumnValues, CycleResult, NodeLoadError, NodeRun};
