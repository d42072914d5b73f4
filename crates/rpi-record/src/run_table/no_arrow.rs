//! Stands for the files of Arrow and Parquet in a build without them.

use std::fs::File;

use super::{TableColumn, TableError, TableFormat};
use crate::mcap::RunData;

/// Returns the error that this program was built without Arrow and Parquet.
///
/// # Errors
/// Always.
pub fn write_table(
    _: &RunData,
    _: &[TableColumn<'_>],
    _: TableFormat,
    _: File,
) -> Result<(), TableError> {
    Err(TableError::NotBuilt)
}
