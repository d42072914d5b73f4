//! HTTP responses.

use std::io::{self, Write};

/// An HTTP response. The server closes the connection after sending it.
#[derive(Debug)]
pub(crate) struct Response {
    status: u16,
    content_type: &'static str,
    body: String,
}

/// Reason phrases of the status codes in use (RFC 9110, section 15).
const REASONS: &[(u16, &str)] = &[
    (200, "OK"),
    (400, "Bad Request"),
    (401, "Unauthorized"),
    (403, "Forbidden"),
    (404, "Not Found"),
    (405, "Method Not Allowed"),
    (413, "Content Too Large"),
    (421, "Misdirected Request"),
    (426, "Upgrade Required"),
    (503, "Service Unavailable"),
];

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
            status: 200,
            content_type,
            body,
        }
    }

    pub(crate) fn error(status: u16, why: &str) -> Response {
        Response {
            status,
            content_type: "text/plain; charset=utf-8",
            body: format!("{why}\n"),
        }
    }

    pub(crate) fn send(&self, stream: &mut dyn Write) -> io::Result<()> {
        let reason = REASONS.iter().find(|(status, _)| *status == self.status);
        let reason = reason.map_or("", |(_, reason)| reason);
        // RFC 9110 requires a challenge in a 401 response (section 15.5.2) and the protocol in a 426 response (section
        // 15.5.22).
        let challenge = match self.status {
            401 => "WWW-Authenticate: Bearer\r\n",
            426 => "Upgrade: websocket\r\n",
            _ => "",
        };
        let text = format!(
            "HTTP/1.1 {} {reason}\r\nContent-Type: {}\r\nContent-Length: {}\r\nConnection: close\r\n\
             {challenge}X-Content-Type-Options: nosniff\r\n\r\n{}",
            self.status,
            self.content_type,
            self.body.len(),
            self.body
        );
        // Head and body in one write: a client may stop reading after the head.
        stream.write_all(text.as_bytes())?;
        stream.flush()
    }
}
