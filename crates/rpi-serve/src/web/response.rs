//! HTTP responses.

use std::io::{self, Write};

use http::StatusCode;
use time::OffsetDateTime;
use time::format_description::well_known::Rfc2822;

use crate::transport::ConnectionMemory;

/// Error for a page for which the server has no memory.
const NO_MEMORY: &str = "the server has no memory for this page; try again";

/// Maximum length in bytes of the part of a body that is sent in one write with the head. A client may stop reading after
/// the head.
const FIRST_WRITE: usize = 64 << 10;

/// An HTTP response. The server closes the connection after sending it.
pub(crate) struct Response {
    status: StatusCode,
    content_type: &'static str,
    body: String,
    /// Memory that is reserved for the body; `None` for a short body.
    _memory: Option<ConnectionMemory>,
}

impl Response {
    pub(crate) fn xml(body: String) -> Response {
        Response::with_type("application/xml", body)
    }

    pub(crate) fn text(body: String) -> Response {
        Response::with_type("text/plain; charset=utf-8", body)
    }

    /// Creates a successful response of this media type.
    pub(crate) fn with_type(content_type: &'static str, body: String) -> Response {
        Response {
            status: StatusCode::OK,
            content_type,
            body,
            _memory: None,
        }
    }

    /// Creates an error response with this status and reason.
    pub(crate) fn error(status: StatusCode, why: &str) -> Response {
        Response {
            status,
            content_type: "text/plain; charset=utf-8",
            body: format!("{why}\n"),
            _memory: None,
        }
    }

    /// Reserves the memory of the body until the response is sent. Returns an error response if there is too little.
    pub(crate) fn reserve(self, memory: ConnectionMemory) -> Response {
        if !memory.reserve(self.body.len()) {
            return Response::error(StatusCode::SERVICE_UNAVAILABLE, NO_MEMORY);
        }
        Response {
            _memory: Some(memory),
            ..self
        }
    }

    /// Sends the response to a client. A request for the head of a page only gets no body (RFC 9110, section 9.3.2).
    ///
    /// # Errors
    /// If the connection is broken, or the client does not read.
    pub(crate) fn send(&self, stream: &mut dyn Write, head_only: bool) -> io::Result<()> {
        let body = if head_only { "" } else { self.body.as_str() };
        let (beginning, rest) = body.as_bytes().split_at(body.len().min(FIRST_WRITE));
        let first = [self.head().as_bytes(), beginning].concat();
        stream.write_all(&first)?;
        stream.write_all(rest)?;
        stream.flush()
    }

    fn head(&self) -> String {
        let reason = self.status.canonical_reason().unwrap_or_default();
        // Headers that these statuses need (RFC 9110, sections 15.5.2, 15.5.6 and 15.5.22).
        let needed = match self.status {
            StatusCode::UNAUTHORIZED => "WWW-Authenticate: Bearer\r\n",
            StatusCode::METHOD_NOT_ALLOWED => "Allow: GET, HEAD, POST\r\n",
            StatusCode::UPGRADE_REQUIRED => "Upgrade: websocket\r\n",
            _ => "",
        };
        format!(
            "HTTP/1.1 {} {reason}\r\n{}Content-Type: {}\r\nContent-Length: {}\r\nConnection: close\r\n\
             {needed}X-Content-Type-Options: nosniff\r\n\r\n",
            self.status.as_str(),
            date(),
            self.content_type,
            self.body.len(),
        )
    }
}

/// Returns the header with the time of the response (RFC 9110, section 6.6.1). HTTP names the time zone where mail has an
/// offset.
fn date() -> String {
    let now = OffsetDateTime::now_utc().format(&Rfc2822);
    now.map_or_else(
        |_| String::new(),
        |now| format!("Date: {}\r\n", now.replace("+0000", "GMT")),
    )
}
