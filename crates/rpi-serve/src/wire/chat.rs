//! Message loop of a connection: over a websocket (RFC 6455), or line by line over a Unix socket.

use std::io::{self, Read, Write};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use tungstenite::protocol::frame::coding::CloseCode;
use tungstenite::protocol::{CloseFrame, Role, WebSocketConfig};
use tungstenite::{Error, Message, WebSocket};

use super::head::is_pause;
use super::outbox::Outgoing;

/// Read timeout of a connection, after which outgoing messages are sent.
pub(crate) const TURN: Duration = Duration::from_millis(2);
/// Time to wait for the answer to a received message before the next read.
const ANSWER: Duration = Duration::from_millis(4);

/// Protocol handler of a connection.
pub(crate) trait Front {
    /// Handles a message. Returns false to close the connection.
    fn hear(&mut self, text: &str) -> bool;

    /// Reports why the connection is closed, for transports that have no close frame.
    fn complain(&mut self, _: &str) {}
}

/// A stream whose reads time out after [`TURN`].
pub(crate) trait Stream: Read + Write + Send {}
impl<T: Read + Write + Send> Stream for T {}

/// Maximum message size in bytes, and timeout without any message from the client. A ping is sent after a third of the
/// timeout. `None` disables pings and timeout.
pub(crate) type Bounds = (usize, Option<Duration>);

/// Reason for the end of a connection.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum End {
    /// One side has closed the connection.
    Over,
    /// The client does not read its messages.
    Deaf,
    /// The client has sent a binary message.
    Binary,
    /// The client has sent a message that is too long.
    TooLong,
    /// The client has not sent anything within the timeout.
    Silent,
    /// The server closes.
    Closing,
}

impl End {
    /// Returns the close frame for the reason (RFC 6455, section 7.4.1). `most` is the maximum message size in bytes.
    fn frame(self, most: usize) -> Option<CloseFrame> {
        let (code, reason) = match self {
            End::Over => return None,
            End::Deaf => (CloseCode::Policy, "messages are not read".to_owned()),
            End::Binary => (
                CloseCode::Unsupported,
                "binary messages are not supported".to_owned(),
            ),
            End::TooLong => (CloseCode::Size, too_long(most)),
            End::Silent => (
                CloseCode::Policy,
                "timeout: no message from the client".to_owned(),
            ),
            End::Closing => (CloseCode::Away, "the server closes".to_owned()),
        };
        let reason = reason.into();
        Some(CloseFrame { code, reason })
    }
}

fn too_long(most: usize) -> String {
    format!("a message has at most {most} bytes")
}

/// Runs the message loop over a websocket until one side closes it. `rest` holds bytes already read from the stream.
pub(crate) fn websocket(
    stream: Box<dyn Stream>,
    rest: Vec<u8>,
    (most, silence): Bounds,
    front: &mut dyn Front,
    out: &Outgoing,
    closing: &AtomicBool,
) -> End {
    let config = WebSocketConfig::default()
        .max_message_size(Some(most))
        .max_frame_size(Some(most))
        .max_write_buffer_size(most.saturating_mul(2).max(1 << 20))
        // Clients of the reference system do not mask their frames, against RFC 6455, section 5.3.
        .accept_unmasked_frames(true);
    let mut socket = WebSocket::from_partially_read(stream, rest, Role::Server, Some(config));
    let mut life = Life::new(silence);
    let end = loop {
        let heard = match hear(socket.read(), front, &mut life) {
            Ok(heard) => heard,
            Err(end) => break end,
        };
        if life.is_over() {
            break End::Silent;
        }
        if life.is_due() && socket.write(Message::Ping(Vec::new().into())).is_err() {
            break End::Over;
        }
        if is_closing(closing) {
            break End::Closing;
        }
        if let Some(end) = sent(out, || send(&mut socket, out, heard)) {
            break end;
        }
    };
    let _ = socket.close(end.frame(most));
    let _ = socket.flush();
    end
}

/// Handles the result of a read. Returns whether an answer is to be expected, or the reason for the end.
fn hear(read: Result<Message, Error>, front: &mut dyn Front, life: &mut Life) -> Result<bool, End> {
    match read {
        Ok(Message::Text(text)) if front.hear(&text) => {
            life.sign();
            Ok(true)
        }
        Ok(Message::Ping(_) | Message::Pong(_)) => {
            life.sign();
            Ok(false)
        }
        Ok(Message::Binary(_)) => Err(End::Binary),
        Err(Error::Io(e)) if is_pause(&e) => Ok(false),
        Err(Error::Capacity(_)) => Err(End::TooLong),
        _ => Err(End::Over),
    }
}

/// Sends the queued messages. Returns the reason for the end if the connection has ended.
fn sent(out: &Outgoing, send: impl FnOnce() -> io::Result<()>) -> Option<End> {
    if out.is_over() {
        return Some(End::Deaf);
    }
    match send() {
        Ok(()) => None,
        Err(why) if is_pause(&why) => Some(End::Deaf),
        Err(_) => Some(End::Over),
    }
}

/// Liveness of a client: the time of its latest message.
struct Life {
    silence: Option<Duration>,
    latest: Instant,
    asked: bool,
}

impl Life {
    fn new(silence: Option<Duration>) -> Life {
        Life {
            silence,
            latest: Instant::now(),
            asked: false,
        }
    }

    fn sign(&mut self) {
        (self.latest, self.asked) = (Instant::now(), false);
    }

    fn is_silent_for(&self, share: u32) -> bool {
        let silence = self.silence.map(|silence| silence / share);
        silence.is_some_and(|silence| self.latest.elapsed() >= silence)
    }

    /// Returns whether a ping must be sent now: once, after a third of the timeout.
    fn is_due(&mut self) -> bool {
        let due = !self.asked && self.is_silent_for(3);
        self.asked |= due;
        due
    }

    fn is_over(&self) -> bool {
        self.is_silent_for(1)
    }
}

fn send(socket: &mut WebSocket<Box<dyn Stream>>, out: &Outgoing, heard: bool) -> io::Result<()> {
    let failed = |why: Error| match why {
        Error::Io(why) => why,
        other => io::Error::other(other),
    };
    let wait = if heard { ANSWER } else { Duration::ZERO };
    let mut next = out.messages.recv_timeout(wait).ok();
    while let Some(message) = next {
        socket.write(Message::text(message)).map_err(failed)?;
        next = out.messages.try_recv().ok();
    }
    socket.flush().map_err(failed)
}

/// Runs the message loop over a stream of lines until one side closes it.
pub(crate) fn lines(
    mut stream: Box<dyn Stream>,
    most: usize,
    front: &mut dyn Front,
    out: &Outgoing,
    closing: &AtomicBool,
) -> End {
    let mut waiting = Vec::new();
    let mut chunk = vec![0; 16 << 10];
    while !is_closing(closing) {
        let heard = match stream.read(&mut chunk) {
            Ok(0) => return End::Over,
            Ok(read) => {
                waiting.extend_from_slice(&chunk[..read]);
                true
            }
            Err(e) if is_pause(&e) => false,
            Err(_) => return End::Over,
        };
        if !hear_lines(&mut waiting, front) {
            break;
        }
        if waiting.len() > most {
            front.complain(&too_long(most));
            let _ = send_lines(&mut stream, out, true);
            return End::TooLong;
        }
        if let Some(end) = sent(out, || send_lines(&mut stream, out, heard)) {
            return end;
        }
    }
    match out.is_over() {
        true => End::Deaf,
        false => End::Over,
    }
}

fn hear_lines(waiting: &mut Vec<u8>, front: &mut dyn Front) -> bool {
    while let Some(end) = waiting.iter().position(|b| *b == b'\n') {
        let line: Vec<u8> = waiting.drain(..=end).collect();
        let text = String::from_utf8_lossy(&line);
        if !text.trim().is_empty() && !front.hear(text.trim()) {
            return false;
        }
    }
    true
}

fn send_lines(stream: &mut dyn Write, out: &Outgoing, heard: bool) -> io::Result<()> {
    let wait = if heard { ANSWER } else { Duration::ZERO };
    let mut next = out.messages.recv_timeout(wait).ok();
    while let Some(message) = next {
        stream.write_all(message.as_bytes())?;
        stream.write_all(b"\n")?;
        next = out.messages.try_recv().ok();
    }
    stream.flush()
}

fn is_closing(closing: &AtomicBool) -> bool {
    closing.load(Ordering::Relaxed)
}
