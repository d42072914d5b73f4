//! Error of reading a value of a sample table.

use std::fmt;

/// Text that is not a value of its column.
#[derive(Clone, PartialEq, Eq, Debug)]
pub enum ColumnError {
    /// The text is not a value of a scalar type.
    UnexpectedText {
        /// Text of the field.
        text: String,
        /// Expected form, such as `an integer of 64 bits`.
        expected: String,
    },
    /// The text is a literal without a value.
    Null,
    /// The text is not a literal of the type.
    InvalidLiteral {
        /// Text of the field.
        text: String,
        /// Name of the type.
        type_name: &'static str,
        /// Error of the literal.
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
