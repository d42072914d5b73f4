//! Requests over HTTP that are invalid, ambiguous or unusual: each file in `tests/http` has the bytes of a request and the
//! expected response.
//!
//! ```text
//! # why
//! expect: STATUS text in the response (`-text`: not in the response)
//!
//! the request; line ends do not count, `\r`, `\n`, `\0` and `\xNN` are bytes
//! @repeat N text
//! @wait MILLISECONDS
//! @close     ends the stream of the client
//! ```

use std::io::{ErrorKind, Read, Write};
use std::net::{Shutdown, SocketAddr, TcpStream};
use std::path::Path;
use std::time::Duration;

use rpi_serve::{Limits, Settings};
use rpi_testkit::files_below;

use crate::client::{PATIENCE, get, server, settings};

/// Returns the bytes of a line of a request.
fn bytes(line: &str) -> Vec<u8> {
    let mut signs = line.chars();
    let mut bytes = Vec::new();
    while let Some(sign) = signs.next() {
        if sign != '\\' {
            bytes.extend(sign.to_string().bytes());
            continue;
        }
        bytes.push(match signs.next() {
            Some('r') => b'\r',
            Some('n') => b'\n',
            Some('0') => 0,
            Some('x') => {
                let digits: String = signs.by_ref().take(2).collect();
                u8::from_str_radix(&digits, 16).unwrap()
            }
            other => panic!("unknown escape {other:?} in {line}"),
        });
    }
    bytes
}

/// Sends a request and returns the whole response.
fn respond(address: SocketAddr, request: &str) -> String {
    let mut stream = TcpStream::connect(address).unwrap();
    stream.set_read_timeout(Some(PATIENCE)).unwrap();
    for line in request.lines() {
        let sent = match line.split_once(' ').unwrap_or((line, "")) {
            ("@repeat", rest) => {
                let (count, text) = rest.split_once(' ').unwrap();
                stream.write_all(&bytes(text).repeat(count.parse().unwrap()))
            }
            ("@wait", time) => {
                std::thread::sleep(Duration::from_millis(time.parse().unwrap()));
                Ok(())
            }
            ("@close", _) => stream.shutdown(Shutdown::Write),
            _ => stream.write_all(&bytes(line)),
        };
        // The server may have answered before it has read everything.
        let closed = [ErrorKind::BrokenPipe, ErrorKind::ConnectionReset];
        assert!(sent.is_ok() || sent.is_err_and(|error| closed.contains(&error.kind())));
    }
    let mut response = Vec::new();
    stream.read_to_end(&mut response).unwrap();
    String::from_utf8(response).unwrap()
}

fn check(address: SocketAddr, path: &Path) {
    let text = std::fs::read_to_string(path).unwrap();
    let (head, request) = text.split_once("\n\n").unwrap();
    let expected = head.lines().find_map(|line| line.strip_prefix("expect: "));
    let expected = expected.unwrap();
    let (status, part) = expected.split_once(' ').unwrap_or((expected, ""));
    let response = respond(address, request);
    let name = path.file_stem().unwrap().to_string_lossy();
    let is_interim = response.starts_with("HTTP/1.1 100");
    assert!(
        response.starts_with(&format!("HTTP/1.1 {status} ")),
        "{name}: {response}"
    );
    let statuses = response
        .split("\r\n")
        .filter(|line| line.starts_with("HTTP/1.1 "));
    assert_eq!(
        statuses.count(),
        1 + usize::from(is_interim),
        "{name}: {response}"
    );
    match part.strip_prefix('-') {
        Some(absent) => assert!(!response.contains(absent), "{name}: {response}"),
        None => assert!(response.contains(part), "{name}: {response}"),
    }
}

#[test]
fn every_request_has_its_response() {
    let limits = Limits {
        request_timeout: Duration::from_secs(1),
        ..Limits::default()
    };
    let settings = Settings {
        limits,
        ..settings()
    };
    let server = server(&settings, ());
    let cases = files_below("crates/rpi-serve/tests/http", &[".txt"]);
    assert!(cases.len() > 60, "{}", cases.len());
    for case in &cases {
        check(server.address(), case);
    }
    assert!(get(server.address(), "/sessions").starts_with("HTTP/1.1 200"));
}

/// Every response has a date, a length, and the end of the connection.
#[test]
fn responses_have_the_headers_that_http_requires() {
    let server = crate::client::open();
    let whole = get(server.address(), "/types");
    let (head, body) = whole.split_once("\r\n\r\n").unwrap();
    let header = |name: &str| {
        let line = head.lines().find_map(|line| line.strip_prefix(name));
        line.unwrap_or_else(|| panic!("{name} is missing: {head}"))
            .to_owned()
    };
    assert_eq!(header("Content-Length: "), body.len().to_string());
    assert_eq!(header("Connection: "), "close");
    let date = header("Date: ");
    assert!(date.ends_with(" GMT") && date.len() == 29, "{date}");
    let request = "HEAD /types HTTP/1.1\r\nHost: localhost\r\n\r\n";
    let only_head = crate::client::http(server.address(), request);
    let same = |text: &str| {
        text.lines()
            .filter(|line| !line.starts_with("Date"))
            .count()
    };
    assert_eq!(same(&only_head), same(head) + 1);
    assert!(only_head.contains(&format!("Content-Length: {}", body.len())));
}
