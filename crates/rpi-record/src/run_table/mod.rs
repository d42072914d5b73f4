//! Values of a recording as a table: one row per tick, one column per number, for spreadsheets and data frames.
//!
//! The columns that are selected give rows, from which a program writes text, and files of [Arrow] and Parquet.
//!
//! [Arrow]: https://arrow.apache.org/docs/format/Columnar.html

#[cfg(feature = "arrow")]
mod arrow_file;
#[cfg(not(feature = "arrow"))]
#[path = "no_arrow.rs"]
mod arrow_file;
mod error;
#[cfg(feature = "arrow")]
mod fields;
mod rows;
mod selection;

pub use arrow_file::write_table;
pub use error::TableError;
pub use rows::{Row, TableRows, TableValue};
pub use selection::{TableColumn, select};

/// Format of a table that is not text.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum TableFormat {
    /// Arrow IPC file, also called Feather version 2.
    Arrow,
    /// Apache Parquet.
    Parquet,
}
