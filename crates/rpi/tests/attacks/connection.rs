//! Connections of clients to the server, byte by byte.

use std::io::{BufRead, BufReader, Read, Write};
use std::net::{SocketAddr, TcpStream};
use std::os::unix::net::UnixStream;
use std::path::PathBuf;
use std::time::{Duration, Instant};

/// Addresses of the server.
pub(crate) struct Target {
    pub(crate) address: SocketAddr,
    pub(crate) socket: PathBuf,
}

/// Returns a request of JSON-RPC without parameters.
pub(crate) fn request(method: &str) -> String {
    format!("{{\"jsonrpc\":\"2.0\",\"id\":1,\"method\":\"{method}\",\"params\":{{}}}}")
}

/// Calls a method as a new client at the Unix socket.
pub(crate) fn line_answer(target: &Target, method: &str, timeout: Duration) -> String {
    let mut stream = UnixStream::connect(&target.socket).unwrap();
    stream.set_read_timeout(Some(timeout)).unwrap();
    writeln!(stream, "{}", request(method)).unwrap();
    let mut answer = String::new();
    BufReader::new(stream).read_line(&mut answer).unwrap();
    answer
}

/// Calls a method as a new client over the network. If the server gives the place of the connection to a later one before the
/// handshake ends, the client connects again, as clients do; the caller measures the time from the first attempt.
pub(crate) fn websocket_answer(target: &Target, method: &str, timeout: Duration) -> String {
    let end = Instant::now() + timeout;
    let mut attempts = std::iter::repeat_with(|| websocket(target, "/rpc"));
    let mut stream = attempts
        .find(|stream| stream.is_some() || Instant::now() > end)
        .flatten()
        .unwrap();
    stream.set_read_timeout(Some(timeout)).unwrap();
    stream
        .write_all(&frame(request(method).as_bytes()))
        .unwrap();
    let mut head = [0; 2];
    stream.read_exact(&mut head).unwrap();
    let length = match head[1] {
        126 => {
            let mut long = [0; 2];
            stream.read_exact(&mut long).unwrap();
            usize::from(u16::from_be_bytes(long))
        }
        short => usize::from(short),
    };
    let mut answer = vec![0; length];
    stream.read_exact(&mut answer).unwrap();
    String::from_utf8(answer).unwrap()
}

/// Connects a websocket; `None` if the server closes the connection before.
pub(crate) fn websocket(target: &Target, path: &str) -> Option<TcpStream> {
    let mut stream = TcpStream::connect(target.address).ok()?;
    let head = format!(
        "GET {path} HTTP/1.1\r\nHost: localhost\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n\
         Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n\r\n"
    );
    stream.write_all(head.as_bytes()).ok()?;
    let mut answer = Vec::new();
    let mut byte = [0];
    while !answer.ends_with(b"\r\n\r\n") {
        stream.read_exact(&mut byte).ok()?;
        answer.push(byte[0]);
    }
    answer.starts_with(b"HTTP/1.1 101").then_some(stream)
}

/// Returns a text frame with a message (RFC 6455, section 5.2).
pub(crate) fn frame(message: &[u8]) -> Vec<u8> {
    let length = message.len() as u64;
    let mut bytes = match length {
        0..126 => vec![0x81, length as u8],
        126..0x1_0000 => [&[0x81, 126], &(length as u16).to_be_bytes()[..]].concat(),
        _ => [&[0x81, 127], &length.to_be_bytes()[..]].concat(),
    };
    bytes.extend_from_slice(message);
    bytes
}

/// Connects at the Unix socket.
pub(crate) fn line(target: &Target) -> Option<UnixStream> {
    let stream = UnixStream::connect(&target.socket).ok()?;
    let timeout = Some(Duration::from_secs(2));
    stream.set_read_timeout(timeout).ok()?;
    stream.set_write_timeout(timeout).ok()?;
    Some(stream)
}

/// Connects over the network and sends bytes, as far as the server reads them.
pub(crate) fn sent(target: &Target, bytes: &[u8]) -> Option<TcpStream> {
    let mut stream = TcpStream::connect(target.address).ok()?;
    let timeout = Some(Duration::from_secs(2));
    stream.set_read_timeout(timeout).ok()?;
    stream.set_write_timeout(timeout).ok()?;
    let _ = stream.write_all(bytes);
    Some(stream)
}
