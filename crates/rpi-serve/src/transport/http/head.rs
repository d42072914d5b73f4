//! Heads of HTTP requests.

use std::io::{ErrorKind, Read};
use std::time::{Duration, Instant};

use http::header::HOST;
use http::uri::Authority;
use http::{HeaderMap, HeaderName, HeaderValue, Method, StatusCode, Uri, Version};
use httparse::{EMPTY_HEADER, Status};

use super::is_timeout;
use super::length::{BodyLength, expects_continue};
use super::request_error::RequestError;

/// Head of an HTTP request, with the bytes of the body that were already read.
#[derive(Debug)]
pub(crate) struct Head {
    pub(crate) method: Method,
    /// Path without query, with single slashes.
    pub(crate) path: String,
    pub(crate) query: String,
    /// Host with port to which the request is addressed; `None` for a request of HTTP/1.0 without a host.
    pub(crate) host: Option<String>,
    headers: HeaderMap,
    pub(super) length: BodyLength,
    /// Whether the client waits for the status 100 before it sends the body.
    pub(super) expects_continue: bool,
    /// Bytes that were read after the head: the beginning of the body.
    pub(crate) remaining: Vec<u8>,
}

/// Maximum length of a request head in bytes.
const MAX_HEAD_BYTES: usize = 16 << 10;
/// Maximum number of headers of a request.
const MAX_HEADERS: usize = 64;

impl Head {
    /// Reads the head of an HTTP request from a stream, for at most `timeout`.
    ///
    /// # Errors
    /// If the connection ends, or the head is too long, too slow or malformed.
    pub(crate) fn read(stream: &mut dyn Read, timeout: Duration) -> Result<Head, RequestError> {
        let begin = Instant::now();
        let mut bytes = Vec::new();
        let mut chunk = [0; 1024];
        loop {
            if let Some(head) = Head::parse(&bytes)? {
                return Ok(head);
            }
            if bytes.len() > MAX_HEAD_BYTES {
                return Err(too_long());
            }
            if begin.elapsed() > timeout {
                let reason = "the head of the request is too slow";
                return Err(RequestError::Rejected(StatusCode::REQUEST_TIMEOUT, reason));
            }
            match stream.read(&mut chunk) {
                Ok(0) if bytes.is_empty() => {
                    return Err(RequestError::Connection(ErrorKind::UnexpectedEof.into()));
                }
                Ok(0) => return Err(RequestError::malformed("the request ends within its head")),
                Ok(read) => bytes.extend_from_slice(&chunk[..read]),
                Err(error) if is_timeout(&error) => {}
                Err(error) => return Err(error.into()),
            }
        }
    }

    /// Parses a head at the beginning of `bytes`. Returns `None` if it is incomplete.
    fn parse(bytes: &[u8]) -> Result<Option<Head>, RequestError> {
        let mut headers = [EMPTY_HEADER; MAX_HEADERS];
        let mut request = httparse::Request::new(&mut headers);
        let Status::Complete(end) = request.parse(bytes).map_err(parse_error)? else {
            return Ok(None);
        };
        let version = match request.version {
            Some(0) => Version::HTTP_10,
            _ => Version::HTTP_11,
        };
        let method = Method::from_bytes(request.method.unwrap_or_default().as_bytes())
            .map_err(|_| RequestError::malformed("the method is invalid"))?;
        let target: Uri = request
            .path
            .unwrap_or_default()
            .parse()
            .map_err(|_| RequestError::malformed("the target of the request is invalid"))?;
        let headers = header_map(request.headers)?;
        let parts = target.path().split('/').filter(|part| !part.is_empty());
        let path = format!("/{}", parts.collect::<Vec<_>>().join("/"));
        Ok(Some(Head {
            method,
            path,
            query: target.query().unwrap_or_default().to_owned(),
            host: host(&headers, &target, version)?,
            length: BodyLength::new(&headers, version)?,
            expects_continue: expects_continue(&headers, version)?,
            headers,
            remaining: bytes[end..].to_vec(),
        }))
    }

    /// Returns the value of the first header with this name, which must be in lower case; `None` if there is none, or
    /// if it is not text.
    pub(crate) fn header(&self, name: &'static str) -> Option<&str> {
        self.headers.get(name)?.to_str().ok()
    }
}

fn too_long() -> RequestError {
    RequestError::Rejected(
        StatusCode::REQUEST_HEADER_FIELDS_TOO_LARGE,
        "the head of a request has at most 16384 bytes and 64 headers",
    )
}

fn parse_error(error: httparse::Error) -> RequestError {
    match error {
        httparse::Error::TooManyHeaders => too_long(),
        httparse::Error::Version => RequestError::Rejected(
            StatusCode::HTTP_VERSION_NOT_SUPPORTED,
            "not a request of HTTP/1.0 or HTTP/1.1; check the scheme and the port",
        ),
        httparse::Error::HeaderName | httparse::Error::HeaderValue | httparse::Error::NewLine => {
            RequestError::malformed("a header of the request is malformed")
        }
        _ => RequestError::malformed("not an HTTP/1.1 request; check the scheme and the port"),
    }
}

fn header_map(parsed: &[httparse::Header<'_>]) -> Result<HeaderMap, RequestError> {
    let malformed = || RequestError::malformed("a header of the request is malformed");
    let mut headers = HeaderMap::with_capacity(parsed.len());
    for header in parsed {
        let name = HeaderName::from_bytes(header.name.as_bytes()).map_err(|_| malformed())?;
        let value = HeaderValue::from_bytes(header.value).map_err(|_| malformed())?;
        headers.append(name, value);
    }
    Ok(headers)
}

/// Returns the host, with port, to which a request is addressed (RFC 9112, section 3.2). The host in the target replaces
/// that of the header.
fn host(
    headers: &HeaderMap,
    target: &Uri,
    version: Version,
) -> Result<Option<String>, RequestError> {
    let mut hosts = headers.get_all(HOST).iter();
    let header = match (hosts.next(), hosts.next()) {
        (Some(host), None) => Some(host),
        (None, _) if version == Version::HTTP_10 => None,
        _ => {
            return Err(RequestError::malformed(
                "a request of HTTP/1.1 has one header `Host` (RFC 9112, section 3.2)",
            ));
        }
    };
    let is_valid = |host: &HeaderValue| {
        let authority = Authority::try_from(host.as_bytes());
        host.is_empty() || authority.is_ok_and(|authority| !authority.as_str().contains('@'))
    };
    if header.is_some_and(|host| !is_valid(host)) {
        return Err(RequestError::malformed("the header `Host` is invalid"));
    }
    let header = header.map(|host| String::from_utf8_lossy(host.as_bytes()).into_owned());
    Ok(target.authority().map(Authority::to_string).or(header))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<Head, RequestError> {
        Head::read(&mut text.as_bytes(), Duration::from_secs(1))
    }

    #[test]
    fn a_head_is_split_into_its_parts() {
        let mut text: &[u8] =
            b"POST //eval/?a=b HTTP/1.1\r\nContent-Length: 3\r\nHost: x\r\nX-Y: \xff\r\n\r\nabcd";
        let head = Head::read(&mut text, Duration::from_secs(1)).unwrap();
        assert_eq!((&head.method, head.path.as_str()), (&Method::POST, "/eval"));
        assert_eq!(
            (head.query.as_str(), head.host.as_deref()),
            ("a=b", Some("x"))
        );
        assert_eq!(head.length, BodyLength::Known(3));
        assert_eq!(head.header("x-y"), None, "it is no text");
        assert_eq!(head.remaining, b"abcd");
    }

    #[test]
    fn the_host_of_the_target_replaces_that_of_the_header() {
        let head = read("GET http://cell:80/nets HTTP/1.1\r\nHost: other\r\n\r\n").unwrap();
        assert_eq!(
            (head.host.as_deref(), head.path.as_str()),
            (Some("cell:80"), "/nets")
        );
        let old = read("GET / HTTP/1.0\r\n\r\n").unwrap();
        assert_eq!(old.host, None);
    }

    #[test]
    fn a_connection_without_a_request_has_no_answer() {
        let error = read("").unwrap_err();
        assert!(matches!(error, RequestError::Connection(_)), "{error}");
    }
}
