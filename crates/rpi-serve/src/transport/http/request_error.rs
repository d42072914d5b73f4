//! Errors of requests that cannot be answered with a page.

use std::fmt;
use std::io;

use http::StatusCode;

/// Error of an HTTP request before its content is looked at.
#[derive(Debug)]
pub(crate) enum RequestError {
    /// The connection is broken or closed, so that no answer can be sent.
    Connection(io::Error),
    /// The request is rejected with this status, for the reason in the text.
    Rejected(StatusCode, &'static str),
}

impl RequestError {
    /// Creates the error of a request that violates the protocol (status 400).
    pub(super) fn malformed(reason: &'static str) -> RequestError {
        RequestError::Rejected(StatusCode::BAD_REQUEST, reason)
    }
}

impl From<io::Error> for RequestError {
    fn from(error: io::Error) -> RequestError {
        match error.kind() {
            io::ErrorKind::QuotaExceeded => {
                let reason = "the server has no memory for the request; try again";
                RequestError::Rejected(StatusCode::SERVICE_UNAVAILABLE, reason)
            }
            _ => RequestError::Connection(error),
        }
    }
}

impl fmt::Display for RequestError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            RequestError::Connection(error) => error.fmt(f),
            RequestError::Rejected(_, reason) => f.write_str(reason),
        }
    }
}

impl std::error::Error for RequestError {}
