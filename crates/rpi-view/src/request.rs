//! Requests of a browser for the page and the document.

use std::io::{self, Read};
use std::net::SocketAddr;

/// Maximum size of the head of a request in bytes.
const MAX_HEAD: usize = 16 << 10;
/// Maximum number of headers of a request.
const MAX_HEADERS: usize = 64;

/// Maximum length of the name of a flow in a path, in bytes.
const MAX_NAME: usize = 1 << 10;

/// Resource that a browser may get.
#[derive(Clone, PartialEq, Eq, Debug)]
pub(crate) enum Resource {
    /// The page.
    Page,
    /// The document of the recording.
    Document,
    /// Document of the values of a run from this tick on.
    Since(u64),
    /// Values of all flows in this tick.
    Cycle(u64),
    /// Document of one flow.
    Flow(String),
    /// Causes of the value of a flow in a tick.
    Why(u64, String),
}

/// Request that is answered with an error: the status of the response.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum RequestError {
    /// The head is not HTTP, incomplete or too long.
    BadRequest,
    /// The header `Host` does not name the loopback interface and this port. A page of another site could otherwise
    /// read the recording through a name that resolves to the loopback interface (DNS rebinding).
    Forbidden,
    /// There is no such path.
    NotFound,
    /// The method is not GET.
    MethodNotAllowed,
}

impl RequestError {
    /// Returns the status line of the response without the version.
    pub(crate) fn status(self) -> &'static str {
        match self {
            RequestError::BadRequest => "400 Bad Request",
            RequestError::Forbidden => "403 Forbidden",
            RequestError::NotFound => "404 Not Found",
            RequestError::MethodNotAllowed => "405 Method Not Allowed",
        }
    }
}

/// Reads the head of a request: everything up to the first empty line.
///
/// # Errors
/// Returns the errors of the connection, and an error if the head is too long or the connection ends before it.
pub(crate) fn read_head(connection: &mut impl Read) -> io::Result<Vec<u8>> {
    let mut head = Vec::new();
    let mut buffer = [0; 1024];
    loop {
        let count = connection.read(&mut buffer)?;
        let new = buffer.get(..count).unwrap_or_default();
        head.extend(new);
        if head.windows(4).any(|end| end == b"\r\n\r\n") {
            return Ok(head);
        }
        if count == 0 || head.len() > MAX_HEAD {
            return Err(io::ErrorKind::InvalidData.into());
        }
    }
}

/// Returns the resource that a request is for. `own` is the address of the server.
pub(crate) fn resource(head: &[u8], own: SocketAddr) -> Result<Resource, RequestError> {
    let mut headers = [httparse::EMPTY_HEADER; MAX_HEADERS];
    let mut request = httparse::Request::new(&mut headers);
    match request.parse(head) {
        Ok(httparse::Status::Complete(_)) => {}
        _ => return Err(RequestError::BadRequest),
    }
    if request.method != Some("GET") {
        return Err(RequestError::MethodNotAllowed);
    }
    let mut hosts = request
        .headers
        .iter()
        .filter(|h| h.name.eq_ignore_ascii_case("host"));
    let host = hosts.next().map_or(&b""[..], |h| h.value);
    let port = own.port();
    let names = [format!("{}:{port}", own.ip()), format!("localhost:{port}")];
    if hosts.next().is_some() || !names.iter().any(|name| name.as_bytes() == host) {
        return Err(RequestError::Forbidden);
    }
    let path = request.path.and_then(|path| path.strip_prefix('/'));
    let parts: Vec<&str> = path.ok_or(RequestError::NotFound)?.split('/').collect();
    let tick = |text: &str| text.parse().map_err(|_| RequestError::NotFound);
    match parts[..] {
        [""] => Ok(Resource::Page),
        ["document"] => Ok(Resource::Document),
        ["since", from] => Ok(Resource::Since(tick(from)?)),
        ["cycle", at] => Ok(Resource::Cycle(tick(at)?)),
        ["flow", name] => Ok(Resource::Flow(decode(name)?)),
        ["why", at, name] => Ok(Resource::Why(tick(at)?, decode(name)?)),
        _ => Err(RequestError::NotFound),
    }
}

/// Decodes a name in a path: `%5B` is a bracket (RFC 3986, section 2.1).
fn decode(text: &str) -> Result<String, RequestError> {
    if text.is_empty() || text.len() > MAX_NAME {
        return Err(RequestError::NotFound);
    }
    let mut parts = text.split('%');
    let mut bytes = parts.next().unwrap_or_default().as_bytes().to_vec();
    for part in parts {
        let code = part
            .get(..2)
            .filter(|code| code.bytes().all(|b| b.is_ascii_hexdigit()));
        let byte = code.and_then(|code| u8::from_str_radix(code, 16).ok());
        bytes.push(byte.ok_or(RequestError::BadRequest)?);
        bytes.extend(part.get(2..).unwrap_or_default().as_bytes());
    }
    String::from_utf8(bytes).map_err(|_| RequestError::BadRequest)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn requested(text: &str) -> Result<Resource, RequestError> {
        resource(text.as_bytes(), ([127, 0, 0, 1], 4000).into())
    }

    #[test]
    fn the_parts_of_a_recording_have_paths() {
        let get = |path: &str| {
            requested(&format!(
                "GET {path} HTTP/1.1\r\nHost: localhost:4000\r\n\r\n"
            ))
        };
        assert_eq!(get("/since/17"), Ok(Resource::Since(17)));
        assert_eq!(get("/cycle/0"), Ok(Resource::Cycle(0)));
        let name = "Main.a[2].x".to_owned();
        assert_eq!(
            get("/flow/Main.a%5B2%5d.x"),
            Ok(Resource::Flow(name.clone()))
        );
        assert_eq!(get("/why/5/Main.a[2].x"), Ok(Resource::Why(5, name)));
        for path in [
            "/cycle/-1",
            "/cycle/99999999999999999999",
            "/flow/",
            "/why/5",
            "/cycle/1/2",
        ] {
            assert_eq!(get(path), Err(RequestError::NotFound), "{path}");
        }
        for path in ["/flow/%", "/flow/%4", "/flow/%+1", "/flow/a%ff"] {
            assert_eq!(get(path), Err(RequestError::BadRequest), "{path}");
        }
        let long = format!("/flow/{}", "a".repeat(MAX_NAME + 1));
        assert_eq!(get(&long), Err(RequestError::NotFound));
    }

    #[test]
    fn only_the_page_and_the_document_are_served() {
        let get = |path: &str| {
            requested(&format!(
                "GET {path} HTTP/1.1\r\nHost: 127.0.0.1:4000\r\n\r\n"
            ))
        };
        assert_eq!(get("/"), Ok(Resource::Page));
        assert_eq!(get("/document"), Ok(Resource::Document));
        assert_eq!(get("/../etc/passwd"), Err(RequestError::NotFound));
        let post = "POST / HTTP/1.1\r\nHost: localhost:4000\r\n\r\n";
        assert_eq!(requested(post), Err(RequestError::MethodNotAllowed));
        assert_eq!(requested("hello\r\n\r\n"), Err(RequestError::BadRequest));
    }

    #[test]
    fn another_host_is_rejected() {
        for host in [
            "evil.example:4000",
            "127.0.0.1:4001",
            "",
            "127.0.0.1:4000\r\nHost: a",
        ] {
            let request = format!("GET / HTTP/1.1\r\nHost: {host}\r\n\r\n");
            assert_eq!(requested(&request), Err(RequestError::Forbidden), "{host}");
        }
        let none = requested("GET / HTTP/1.1\r\n\r\n");
        assert_eq!(none, Err(RequestError::Forbidden));
    }

    #[test]
    fn a_head_is_read_up_to_its_limit() {
        let long = vec![b'a'; 2 * MAX_HEAD];
        assert!(read_head(&mut &long[..]).is_err());
        assert!(read_head(&mut &b"GET / HTTP/1.1\r\n"[..]).is_err());
        let head = b"GET / HTTP/1.1\r\n\r\n";
        assert_eq!(read_head(&mut &head[..]).ok().as_deref(), Some(&head[..]));
    }
}
