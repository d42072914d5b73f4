//! Requests of HTTP/1.1 (RFC 9110, RFC 9112).
//!
//! The crate `httparse` parses heads, chunk sizes and trailers, the crate `http` names, values and targets. This module
//! reads the bytes within limits and decides how long the body of a request is. An ambiguous length is an error
//! (RFC 9112, section 6.3), although no request follows another one on the same connection.

mod body;
mod head;
mod length;
mod request_error;

pub(crate) use head::Head;
pub(crate) use request_error::RequestError;

use std::io;

/// Returns whether a read or write failed only because it timed out or was interrupted, so that it can be repeated.
pub(crate) fn is_timeout(error: &io::Error) -> bool {
    matches!(
        error.kind(),
        io::ErrorKind::WouldBlock | io::ErrorKind::TimedOut | io::ErrorKind::Interrupted
    )
}
