//! Error of reading a value of a sample table.

use std::fmt;

/// Error: the text of a field is not a value of its column in a table of samples.
#[derive(Clone, PartialEq, Eq, Debug)]
pub enum ColumnError {
    /// The text is not a Boolean, number or enum value, as the column requires.
    UnexpectedText {
        /// Text that was read from the table.
        text: String,
        /// Expected form, such as `an integer of 64 bits`.
        expected: String,
    },
    /// The text is the literal `null`, which stands for an absent value. A field must hold a value.
    Null,
    /// The text is not a literal of the column's type, such as a pose or an array.
    InvalidLiteral {
        /// Text that was read from the table.
        text: String,
        /// Name of the type of the column, as in programs.
        type_name: &'static str,
        /// Error message of the parser of literals.
        reason: String,
    },
}

impl fmt::Display for ColumnError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            ColumnError::UnexpectedText { text, expected } => {
                write!(f, "`{text}` is not {expected}")
            }
            ColumnError::Null => f.write_str("expected a value, found `null`"),
            ColumnError::InvalidLiteral {
                text,
                type_name,
                reason,
            } => write!(f, "`{text}` is not a valid {type_name}: {reason}"),
        }
    }
}

impl std::error::Error for ColumnError {}
