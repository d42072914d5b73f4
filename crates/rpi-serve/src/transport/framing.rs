//! Message loop of a connection: over a websocket (RFC 6455), or line by line over a Unix socket.

use std::io::{self, ErrorKind, Read, Write};
use std::net::{Shutdown, TcpStream};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use tungstenite::protocol::frame::FrameHeader;
use tungstenite::protocol::frame::coding::{CloseCode, Data, OpCode};
use tungstenite::protocol::{CloseFrame, Role, WebSocketConfig};
use tungstenite::{Error, Message, WebSocket};

use super::http::is_timeout;
use super::metered_stream::MeteredStream;
use super::outbox::{OutboxReceiver, QueueSpace};

/// Time for which a connection waits for data from its client before it sends the outgoing messages that are queued.
pub(crate) const READ_TIMEOUT: Duration = Duration::from_millis(2);
/// Length in bytes of the buffer for data from a client. Each connection has one.
const READ_BUFFER: usize = 16 << 10;
/// Length in bytes of an outgoing message from which on it is not copied to a buffer.
const LARGE_MESSAGE: usize = 64 << 10;
/// Time to wait for the answer to a received message before the connection reads again.
const ANSWER_WAIT: Duration = Duration::from_millis(4);

/// Handler of the messages of one connection. Each protocol (DirectIO, JSON-RPC) has an implementation.
pub(crate) trait ConnectionHandler {
    /// Handles a message of the client. Returns false if the connection must be closed.
    fn on_message(&mut self, text: &str) -> bool;

    /// Reports to the client why the connection is closed. Only used for transports that have no close frame.
    fn on_error(&mut self, _: &str) {}
}

/// Queue of the messages to a client.
pub(crate) trait Outgoing {
    /// Returns the next message, for which it waits at most this time; `None` if there is none.
    fn next_message(&self, wait: Duration) -> Option<OutgoingMessage>;

    /// Returns whether the connection must end, because the client does not read its messages.
    fn is_closed(&self) -> bool;
}

/// Message to a client.
pub(crate) enum OutgoingMessage {
    /// Text, with the memory that is reserved for it until it is sent.
    Text(String, Option<QueueSpace>),
    Binary(Vec<u8>),
}

/// Maximum number of messages that are sent before the connection reads again.
const MAX_SENT: usize = 1024;

/// Connection to a client, whose reads time out after [`READ_TIMEOUT`].
pub(crate) trait Stream: Read + Write + Send {
    /// Ends the direction to the client, which then receives the end of the stream. Further writes fail.
    fn end_writing(&mut self);
}

impl Stream for TcpStream {
    fn end_writing(&mut self) {
        // The connection may be broken already.
        let _ = self.shutdown(Shutdown::Write);
    }
}

#[cfg(unix)]
impl Stream for std::os::unix::net::UnixStream {
    fn end_writing(&mut self) {
        let _ = self.shutdown(Shutdown::Write);
    }
}

/// Maximum message size in bytes, and timeout without any message from the client. A ping is sent to the client after a
/// third of the timeout. `None` disables pings and timeout.
pub(crate) type MessageLimits = (usize, Option<Duration>);

/// Reason for the end of a connection.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum CloseReason {
    /// One side has closed the connection, or the connection is broken.
    Closed,
    /// The client does not read the messages that the server sends.
    NotReading,
    /// The client has sent a binary message.
    Binary,
    /// The client has sent a message that exceeds the maximum size.
    TooLong,
    /// The messages of all clients together need too much memory.
    NoMemory,
    /// The client has not sent anything within the timeout.
    Timeout,
    /// The server is closing all connections.
    Closing,
}

impl CloseReason {
    /// Returns the close frame for the reason (RFC 6455, section 7.4.1); `None` if the connection is closed already.
    /// `most` is the maximum message size in bytes.
    fn frame(self, most: usize) -> Option<CloseFrame> {
        let (code, reason) = match self {
            CloseReason::Closed => return None,
            CloseReason::NotReading => (CloseCode::Policy, "messages are not read".to_owned()),
            CloseReason::Binary => (
                CloseCode::Unsupported,
                "binary messages are not supported".to_owned(),
            ),
            CloseReason::TooLong => (CloseCode::Size, too_long(most)),
            CloseReason::NoMemory => (CloseCode::Again, NO_MEMORY.to_owned()),
            CloseReason::Timeout => (
                CloseCode::Policy,
                "timeout: no message from the client".to_owned(),
            ),
            CloseReason::Closing => (CloseCode::Away, "the server closes".to_owned()),
        };
        let reason = reason.into();
        Some(CloseFrame { code, reason })
    }
}

/// Error for a message for which the server has no memory.
const NO_MEMORY: &str = "the server has no memory for this message; try again";

fn too_long(most: usize) -> String {
    format!("a message has at most {most} bytes")
}

/// Runs the message loop over a websocket until one side closes it, and returns the reason. `rest` holds bytes that
/// were already read from the stream.
pub(crate) fn websocket(
    mut stream: MeteredStream,
    rest: Vec<u8>,
    (most, silence): MessageLimits,
    front: &mut dyn ConnectionHandler,
    out: &dyn Outgoing,
    closing: &AtomicBool,
) -> CloseReason {
    let config = WebSocketConfig::default()
        .read_buffer_size(READ_BUFFER)
        .max_message_size(Some(most))
        .max_frame_size(Some(most))
        // Clients of the reference system do not mask their frames, against RFC 6455, section 5.3.
        .accept_unmasked_frames(true);
    stream.start_frames(rest, most);
    let mut socket = WebSocket::from_raw_socket(stream, Role::Server, Some(config));
    let mut life = Liveness::new(silence);
    let end = loop {
        socket.get_mut().begin_turn();
        let read = socket.read();
        let answer_expected = match handle_read(read, front, &mut life, socket.get_mut()) {
            Ok(answer_expected) => answer_expected,
            Err(end) => break end,
        };
        if life.has_timed_out() || socket.get_ref().is_too_slow() {
            break CloseReason::Timeout;
        }
        if life.take_ping_due() && socket.write(Message::Ping(Vec::new().into())).is_err() {
            break CloseReason::Closed;
        }
        if is_closing(closing) {
            break CloseReason::Closing;
        }
        if let Some(end) = send_queued(out, || send(&mut socket, out, answer_expected)) {
            break end;
        }
        // After a large message, its buffer would remain until the end of the connection.
        if answer_expected && socket.get_mut().take_large_frame() {
            socket = WebSocket::from_raw_socket(socket.into_inner(), Role::Server, Some(config));
        }
    };
    let _ = socket.close(end.frame(most));
    let _ = socket.flush();
    end
}

/// Handles the result of a read from a websocket. Returns whether an answer to the client is to be expected, or the
/// reason for which the connection ends.
fn handle_read(
    read: Result<Message, Error>,
    front: &mut dyn ConnectionHandler,
    life: &mut Liveness,
    stream: &mut MeteredStream,
) -> Result<bool, CloseReason> {
    match read {
        Ok(Message::Text(text)) if front.on_message(&text) => {
            life.touch();
            stream.end_message(0).map_err(|_| CloseReason::NoMemory)?;
            Ok(true)
        }
        Ok(Message::Ping(_) | Message::Pong(_)) => {
            life.touch();
            Ok(false)
        }
        Ok(Message::Binary(_)) => Err(CloseReason::Binary),
        Err(Error::Io(e)) if is_timeout(&e) => Ok(false),
        Err(Error::Io(e)) if e.kind() == ErrorKind::QuotaExceeded => Err(CloseReason::NoMemory),
        Err(Error::Capacity(_)) => Err(CloseReason::TooLong),
        _ => Err(CloseReason::Closed),
    }
}

/// Calls `send` to send the queued messages. Returns the reason for the end of the connection; `None` if it continues.
fn send_queued(out: &dyn Outgoing, send: impl FnOnce() -> io::Result<()>) -> Option<CloseReason> {
    if out.is_closed() {
        return Some(CloseReason::NotReading);
    }
    match send() {
        Ok(()) => None,
        Err(why) if is_timeout(&why) => Some(CloseReason::NotReading),
        Err(_) => Some(CloseReason::Closed),
    }
}

/// Monitor of the time since the latest message of a client, for pings and the timeout.
struct Liveness {
    timeout: Option<Duration>,
    latest: Instant,
    pinged: bool,
}

impl Liveness {
    fn new(silence: Option<Duration>) -> Liveness {
        Liveness {
            timeout: silence,
            latest: Instant::now(),
            pinged: false,
        }
    }

    fn touch(&mut self) {
        (self.latest, self.pinged) = (Instant::now(), false);
    }

    fn is_silent_for(&self, share: u32) -> bool {
        let silence = self.timeout.map(|silence| silence / share);
        silence.is_some_and(|silence| self.latest.elapsed() >= silence)
    }

    /// Returns whether a ping must be sent now, and marks it as sent. A ping is due once, after a third of the timeout
    /// without a message.
    fn take_ping_due(&mut self) -> bool {
        let due = !self.pinged && self.is_silent_for(3);
        self.pinged |= due;
        due
    }

    fn has_timed_out(&self) -> bool {
        self.is_silent_for(1)
    }
}

/// Iterates over the queued outgoing messages. If an answer is expected, the iterator waits up to [`ANSWER_WAIT`] for
/// the first one.
fn queued_messages(
    out: &dyn Outgoing,
    answer_expected: bool,
) -> impl Iterator<Item = OutgoingMessage> + '_ {
    let wait = match answer_expected {
        true => ANSWER_WAIT,
        false => Duration::ZERO,
    };
    let waits = std::iter::once(wait).chain(std::iter::repeat(Duration::ZERO));
    waits
        .map_while(|wait| out.next_message(wait))
        .take(MAX_SENT)
}

fn send(
    socket: &mut WebSocket<MeteredStream>,
    out: &dyn Outgoing,
    answer_expected: bool,
) -> io::Result<()> {
    let failed = |why: Error| match why {
        Error::Io(why) => why,
        other => io::Error::other(other),
    };
    for message in queued_messages(out, answer_expected) {
        match message {
            OutgoingMessage::Text(text, _space) if text.len() > LARGE_MESSAGE => {
                socket.flush().map_err(failed)?;
                write_frame(socket.get_mut(), &text)?;
            }
            OutgoingMessage::Text(text, _space) => {
                socket.write(Message::text(text)).map_err(failed)?;
            }
            OutgoingMessage::Binary(data) => {
                socket.write(Message::binary(data)).map_err(failed)?;
            }
        }
    }
    socket.flush().map_err(failed)
}

/// Writes a text frame directly to the stream. The library would copy it to a buffer, which keeps its size until the end
/// of the connection.
fn write_frame(stream: &mut MeteredStream, text: &str) -> io::Result<()> {
    let header = FrameHeader {
        opcode: OpCode::Data(Data::Text),
        ..FrameHeader::default()
    };
    let mut head = Vec::new();
    let formatted = header.format(text.len() as u64, &mut head);
    formatted.map_err(io::Error::other)?;
    stream.write_all(&head)?;
    stream.write_all(text.as_bytes())
}

/// Runs the message loop over a stream with one message per line until one side closes it, and returns the reason.
/// `most` is the maximum message size in bytes.
pub(crate) fn lines(
    mut stream: MeteredStream,
    most: usize,
    front: &mut dyn ConnectionHandler,
    out: &OutboxReceiver,
    closing: &AtomicBool,
) -> CloseReason {
    let mut waiting = Vec::new();
    let mut chunk = vec![0; 64 << 10];
    while !is_closing(closing) {
        stream.begin_turn();
        let received = match stream.read(&mut chunk) {
            Ok(0) => return CloseReason::Closed,
            Ok(read) => &chunk[..read],
            Err(e) if is_timeout(&e) => &[],
            Err(e) if e.kind() == ErrorKind::QuotaExceeded => {
                return reject_line(&mut stream, front, out, CloseReason::NoMemory, NO_MEMORY);
            }
            Err(_) => return CloseReason::Closed,
        };
        let Some(answer_expected) = handle_lines(&mut waiting, received, front) else {
            break;
        };
        if answer_expected && stream.end_message(waiting.len()).is_err() {
            return reject_line(&mut stream, front, out, CloseReason::NoMemory, NO_MEMORY);
        }
        if waiting.len() > most {
            let why = too_long(most);
            return reject_line(&mut stream, front, out, CloseReason::TooLong, &why);
        }
        if stream.is_too_slow() {
            return CloseReason::Timeout;
        }
        if let Some(end) = send_queued(out, || send_lines(&mut stream, out, answer_expected)) {
            return end;
        }
    }
    match out.is_closed() {
        true => CloseReason::NotReading,
        false => CloseReason::Closed,
    }
}

/// Reports to the client that its line is rejected, and returns the reason.
fn reject_line(
    stream: &mut dyn Write,
    front: &mut dyn ConnectionHandler,
    out: &OutboxReceiver,
    reason: CloseReason,
    why: &str,
) -> CloseReason {
    front.on_error(why);
    // The client may have closed the connection.
    let _ = send_lines(stream, out, true);
    reason
}

/// Handles the lines that end within `received`. `waiting` holds the beginning of the first line, and afterwards that
/// of the unfinished last one. Returns whether there was a line; `None` if the connection must be closed. Each byte is
/// read once, so that a long line takes linear time.
fn handle_lines(
    waiting: &mut Vec<u8>,
    received: &[u8],
    front: &mut dyn ConnectionHandler,
) -> Option<bool> {
    let mut rest = received;
    while let Some(end) = rest.iter().position(|b| *b == b'\n') {
        waiting.extend_from_slice(&rest[..end]);
        rest = &rest[end + 1..];
        let line = std::mem::take(waiting);
        match std::str::from_utf8(&line).map(str::trim) {
            Ok("") => {}
            Ok(text) if front.on_message(text) => {}
            Ok(_) => return None,
            Err(_) => front.on_error("a message must be UTF-8"),
        }
    }
    waiting.extend_from_slice(rest);
    Some(rest.len() < received.len())
}

fn send_lines(
    stream: &mut dyn Write,
    out: &OutboxReceiver,
    answer_expected: bool,
) -> io::Result<()> {
    for message in queued_messages(out, answer_expected) {
        // Connections with lines have no binary messages.
        if let OutgoingMessage::Text(text, _space) = message {
            stream.write_all(text.as_bytes())?;
            stream.write_all(b"\n")?;
        }
    }
    stream.flush()
}

fn is_closing(closing: &AtomicBool) -> bool {
    closing.load(Ordering::Relaxed)
}
