//! Parser of HTTP request heads (RFC 9112), as far as the server needs them.

use std::io::{self, Read};
use std::time::{Duration, Instant};

/// Head of an HTTP request, with the bytes of the body that were already read.
#[derive(Debug)]
pub(crate) struct Head {
    pub(crate) method: String,
    /// Path without query, with single slashes.
    pub(crate) path: String,
    pub(crate) query: String,
    headers: Vec<(String, String)>,
    /// Bytes that were read after the head: the beginning of the body.
    pub(crate) remaining: Vec<u8>,
}

/// Maximum length of a request head in bytes.
const MAX_HEAD_BYTES: usize = 16 << 10;

impl Head {
    /// Reads the head of an HTTP request from a stream, for at most `timeout`.
    ///
    /// # Errors
    ///
    /// If the head is incomplete, too long, too slow or malformed.
    pub(crate) fn read(stream: &mut dyn Read, timeout: Duration) -> io::Result<Head> {
        let begin = Instant::now();
        let mut bytes = Vec::new();
        let mut chunk = [0; 1024];
        loop {
            if let Some(end) = bytes.windows(4).position(|w| w == b"\r\n\r\n") {
                let rest = bytes.split_off(end + 4);
                return Head::parse(&bytes[..end], rest).ok_or_else(|| {
                    invalid_data("not an HTTP/1.1 request; check the scheme and the port")
                });
            }
            if bytes.len() > MAX_HEAD_BYTES || begin.elapsed() > timeout {
                return Err(invalid_data("the request is too long or too slow"));
            }
            match stream.read(&mut chunk) {
                Ok(0) => return Err(io::ErrorKind::UnexpectedEof.into()),
                Ok(read) => bytes.extend_from_slice(&chunk[..read]),
                Err(e) if is_timeout(&e) => {}
                Err(e) => return Err(e),
            }
        }
    }

    fn parse(head: &[u8], rest: Vec<u8>) -> Option<Head> {
        let head = std::str::from_utf8(head).ok()?;
        let mut lines = head.split("\r\n");
        let mut request = lines.next()?.split(' ');
        let (method, target) = (request.next()?, request.next()?);
        request.next().filter(|v| v.starts_with("HTTP/1."))?;
        let header = |line: &str| {
            let (name, value) = line.split_once(':')?;
            Some((name.trim().to_ascii_lowercase(), value.trim().to_owned()))
        };
        let (path, query) = target.split_once('?').unwrap_or((target, ""));
        let parts: Vec<&str> = path.split('/').filter(|part| !part.is_empty()).collect();
        Some(Head {
            method: method.to_owned(),
            path: format!("/{}", parts.join("/")),
            query: query.to_owned(),
            headers: lines.map(header).collect::<Option<_>>()?,
            remaining: rest,
        })
    }

    /// Returns the value of the first header with this name, which must be in lower case; `None` if there is none.
    pub(crate) fn header(&self, name: &str) -> Option<&str> {
        let found = self.headers.iter().find(|(known, _)| known == name);
        found.map(|(_, value)| value.as_str())
    }

    /// Returns the values of all headers with this name, which must be in lower case.
    pub(crate) fn values(&self, name: &'static str) -> impl Iterator<Item = &str> {
        let found = self.headers.iter().filter(move |(known, _)| known == name);
        found.map(|(_, value)| value.as_str())
    }

    /// Reads the body of the request, of the length announced in the head.
    ///
    /// # Errors
    ///
    /// If the body is longer than `most` bytes, or not complete within `timeout`.
    pub(crate) fn body(
        &self,
        stream: &mut dyn Read,
        most: usize,
        timeout: Duration,
    ) -> io::Result<Vec<u8>> {
        let length = self.header("content-length").map_or(Ok(0), str::parse);
        let length: usize =
            length.map_err(|_| invalid_data("the content length is not a number"))?;
        if length > most {
            return Err(invalid_data("the body is too long"));
        }
        let begin = Instant::now();
        let mut body = self.remaining.clone();
        let mut chunk = [0; 16 << 10];
        while body.len() < length {
            // The limit is for the whole body. With a limit per read, a client could keep the connection by sending
            // single bytes.
            if begin.elapsed() > timeout {
                return Err(invalid_data("the body is too slow"));
            }
            match stream.read(&mut chunk) {
                Ok(0) => return Err(io::ErrorKind::UnexpectedEof.into()),
                Ok(read) => body.extend_from_slice(&chunk[..read]),
                Err(e) if is_timeout(&e) => {}
                Err(e) => return Err(e),
            }
        }
        body.truncate(length);
        Ok(body)
    }
}

fn invalid_data(what: &str) -> io::Error {
    io::Error::new(io::ErrorKind::InvalidData, what)
}

/// Returns whether a read or write failed only because it timed out or was interrupted, so that it can be repeated.
pub(crate) fn is_timeout(error: &io::Error) -> bool {
    matches!(
        error.kind(),
        io::ErrorKind::WouldBlock | io::ErrorKind::TimedOut | io::ErrorKind::Interrupted
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> io::Result<Head> {
        Head::read(&mut text.as_bytes(), Duration::from_secs(1))
    }

    #[test]
    fn a_head_is_taken_apart() {
        let mut text: &[u8] =
            b"POST //eval/?a=b HTTP/1.1\r\nContent-Length: 3\r\nHost: x\r\n\r\nabcd";
        let head = Head::read(&mut text, Duration::from_secs(1)).unwrap();
        assert_eq!(
            (head.method.as_str(), head.path.as_str()),
            ("POST", "/eval")
        );
        assert_eq!(
            (head.query.as_str(), head.header("host")),
            ("a=b", Some("x"))
        );
        let body = head.body(&mut text, 10, Duration::from_secs(1)).unwrap();
        assert_eq!(body, b"abc");
        assert!(head.body(&mut text, 2, Duration::from_secs(1)).is_err());
    }

    #[test]
    fn what_is_no_head_is_refused() {
        assert!(read("hello\r\n\r\n").is_err());
        assert!(read("GET / SMTP/1\r\n\r\n").is_err());
        assert!(read("GET / HTTP/1.1\r\nno colon\r\n\r\n").is_err());
        assert!(read("GET / HTTP/1.1\r\n").is_err());
        assert!(read(&"x".repeat(100_000)).is_err());
    }
}
