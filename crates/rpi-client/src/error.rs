//! What can go wrong.

use std::fmt;

use serde_json::Value;

/// Why something was not done.
#[derive(Clone, PartialEq, Eq, Debug)]
pub enum Error {
    /// The server refused it.
    Refused {
        /// The server's code; its manual has the table.
        code: i64,
        /// In words.
        message: String,
        /// Every reason, where there are several.
        reasons: Vec<String>,
    },
    /// There is no connection (any more).
    Connection(String),
}

impl Error {
    pub(crate) fn connection(why: impl fmt::Display) -> Error {
        Error::Connection(why.to_string())
    }

    /// A command is no more, and has never run.
    pub(crate) fn unloaded() -> Error {
        Error::Refused {
            code: -32001,
            message: "it was unloaded before it ran".to_owned(),
            reasons: Vec::new(),
        }
    }

    pub(crate) fn of(error: &Value) -> Error {
        let reasons = error["data"]["reasons"].as_array();
        let reasons = reasons.into_iter().flatten().filter_map(Value::as_str);
        Error::Refused {
            code: error["code"].as_i64().unwrap_or_default(),
            message: error["message"].as_str().unwrap_or_default().to_owned(),
            reasons: reasons.map(str::to_owned).collect(),
        }
    }
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Error::Refused { message, .. } => f.write_str(message),
            Error::Connection(why) => write!(f, "no connection to the control core: {why}"),
        }
    }
}

impl std::error::Error for Error {}
