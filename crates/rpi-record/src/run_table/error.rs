//! Errors of tables.

use std::fmt;
use std::io;

/// Error: a table cannot be written.
#[derive(Debug)]
pub enum TableError {
    /// The program was built without Arrow and Parquet.
    NotBuilt,
    /// The recording has no column with this name; the text is a similar name, if there is one.
    UnknownColumn(String, Option<String>),
    /// The table cannot be represented in the format; the text is the reason.
    Format(String),
    /// The file cannot be written.
    Io(io::Error),
}

impl fmt::Display for TableError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            TableError::NotBuilt => f.write_str(
                "this program was built without Arrow and Parquet; build it with `cargo build --release --features rpi/arrow`, or export \
                 CSV (`--format csv`)",
            ),
            TableError::UnknownColumn(name, near) => {
                write!(f, "the recording has no column `{name}`")?;
                let near = near.as_ref();
                near.map_or(Ok(()), |near| write!(f, "; did you mean `{near}`?"))
            }
            TableError::Format(why) => write!(f, "the table cannot be written: {why}"),
            TableError::Io(error) => error.fmt(f),
        }
    }
}

impl std::error::Error for TableError {}

impl From<io::Error> for TableError {
    fn from(error: io::Error) -> TableError {
        TableError::Io(error)
    }
}
