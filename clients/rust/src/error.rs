//! Error type of the client.

use std::fmt;

use serde_json::Value;

/// Error of a request to the control core, or of the connection.
#[derive(Clone, PartialEq, Eq, Debug)]
pub enum Error {
    /// The server has rejected the request.
    Refused {
        /// Error code of the server; the manual of the server lists the codes.
        code: i64,
        /// Description of the error by the server.
        message: String,
        /// All reasons, if the server gives several; else empty.
        reasons: Vec<String>,
    },
    /// The connection could not be opened, or it is closed. The text has the reason.
    Connection(String),
}

impl Error {
    pub(crate) fn connection(why: impl fmt::Display) -> Error {
        Error::Connection(why.to_string())
    }

    /// Creates the error for a command or task that was unloaded before it ran, so that it has no end.
    pub(crate) fn unloaded() -> Error {
        Error::Refused {
            code: -32001,
            message: "it was unloaded before it ran".to_owned(),
            reasons: Vec::new(),
        }
    }

    pub(crate) fn from_json(error: &Value) -> Error {
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
