//! Beginning and end of connections, common to the server and the port for Foxglove.

use std::io::{self, Write};
use std::net::TcpStream;
use std::thread;
use std::time::{Duration, Instant};

use http::{Method, StatusCode};
use tungstenite::handshake::derive_accept_key;

use super::auth_throttle::{AuthThrottle, RejectReason};
use super::framing::{READ_TIMEOUT, Stream};
use super::http::{Head, is_timeout};
use super::metered_stream::MeteredStream;
use crate::limits::Limits;
use crate::peer::Peer;
use crate::web;

/// First byte of a TLS connection: the content type of a handshake record (RFC 8446, section 5.1).
const HANDSHAKE: u8 = 22;

/// Sets the options of an accepted connection.
pub(crate) fn prepare(stream: &TcpStream, write_timeout: Duration) -> io::Result<()> {
    stream
        // Some systems let an accepted socket inherit the non-blocking mode of the listener. Messages are small,
        // and without `set_nodelay` each would wait for the acknowledgement of the one before.
        .set_nonblocking(false)
        .and_then(|()| stream.set_nodelay(true))
        .and_then(|()| stream.set_read_timeout(Some(READ_TIMEOUT)))
        .and_then(|()| stream.set_write_timeout(Some(write_timeout)))
}

/// Waits for the first byte from a client and returns whether it starts a TLS handshake. The byte remains in the
/// stream. Returns an error after `timeout`.
pub(crate) fn starts_tls(stream: &TcpStream, timeout: Duration) -> io::Result<bool> {
    let begin = Instant::now();
    let mut first = [0];
    loop {
        match stream.peek(&mut first) {
            Ok(0) => return Err(io::ErrorKind::UnexpectedEof.into()),
            Ok(_) => return Ok(first[0] == HANDSHAKE),
            Err(e) if is_timeout(&e) && begin.elapsed() < timeout => {}
            Err(e) => return Err(e),
        }
    }
}

/// Returns whether a request asks for a websocket (RFC 6455, section 4.2.1).
pub(crate) fn is_websocket_upgrade(head: &Head) -> bool {
    let upgrade = head.header("upgrade");
    let is_websocket = upgrade.is_some_and(|value| value.eq_ignore_ascii_case("websocket"));
    is_websocket && head.method == Method::GET
}

/// Accepts a websocket whose request has this key, with the subprotocol that was chosen of those the client has offered.
pub(crate) fn accept_websocket(
    stream: &mut MeteredStream,
    key: &str,
    protocol: Option<&str>,
) -> io::Result<()> {
    let accept = derive_accept_key(key.as_bytes());
    let protocol = protocol.map_or_else(String::new, |name| {
        format!("Sec-WebSocket-Protocol: {name}\r\n")
    });
    write!(
        stream,
        "HTTP/1.1 101 Switching Protocols\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n\
         Sec-WebSocket-Accept: {accept}\r\n{protocol}\r\n"
    )?;
    stream.flush()
}

/// Returns the response to a request without a valid token; `None` if it has none. After a wrong token the response
/// is delayed, to slow down guessing. `on_delay` is called before the delay.
pub(crate) fn rejection(
    why: RejectReason,
    (throttle, peer): (&AuthThrottle, Peer),
    delay: Duration,
    on_delay: impl FnOnce(),
) -> Option<web::Response> {
    if why == RejectReason::NoToken {
        let needed = "a token is needed: `Authorization: Bearer TOKEN`, or `?token=TOKEN`";
        return Some(web::Response::error(StatusCode::UNAUTHORIZED, needed));
    }
    // A delayed answer occupies a thread. Beyond the limit of a peer, the connection is closed without an answer.
    let _wait = throttle.reserve_delay(peer)?;
    on_delay();
    thread::sleep(delay);
    let wrong = "the token is wrong";
    Some(web::Response::error(StatusCode::UNAUTHORIZED, wrong))
}

/// Sends the last response to a client and closes the direction to it. Reads and drops what the client still sends:
/// closing a socket with unread data resets the connection, and the client would lose the response.
pub(crate) fn finish(
    stream: &mut MeteredStream,
    response: &web::Response,
    head_only: bool,
    limits: &Limits,
) {
    if response.send(stream, head_only).is_ok() {
        stream.end_writing();
        stream.drain(limits.message_bytes, limits.request_timeout);
    }
}
