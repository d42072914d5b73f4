//! Stream that limits the memory and the time of incomplete messages.

use std::io::{self, ErrorKind, Read, Write};
use std::time::{Duration, Instant};

use super::framing::Stream;
use super::http::is_timeout;
use super::memory_pool::ConnectionMemory;

/// Memory of a received byte: buffers grow by doubling.
const MEMORY_FACTOR: usize = 2;
/// Minimum time between two control frames that are subtracted. Within a large message a client could otherwise send many
/// of them, to hide a part of the message.
const CONTROL_INTERVAL: Duration = Duration::from_millis(20);
/// Maximum length of the head of a control frame in bytes (RFC 6455, section 5.2).
const CONTROL_HEAD: usize = 6;
/// Time for which a client that sends without a pause is read, before the queued messages are sent to it.
const TURN: Duration = Duration::from_millis(20);

/// Stream from a client whose incomplete messages take memory of a pool, for a limited time.
pub(crate) struct MeteredStream {
    stream: Box<dyn Stream>,
    memory: ConnectionMemory,
    /// Maximum time for which an incomplete message may use memory of the pool.
    timeout: Duration,
    /// Time since which an incomplete message uses memory of the pool; `None` if none does.
    since: Option<Instant>,
    latest_control: Option<Instant>,
    /// Beginning of the turn of the reader; `None` if its turn has no end.
    turn: Option<Instant>,
}

impl MeteredStream {
    /// Creates the stream. An incomplete message that uses memory of the pool must be complete within `timeout`.
    pub(crate) fn new(
        stream: Box<dyn Stream>,
        memory: ConnectionMemory,
        timeout: Duration,
    ) -> MeteredStream {
        MeteredStream {
            stream,
            memory,
            timeout,
            since: None,
            latest_control: None,
            turn: None,
        }
    }

    /// Begins a turn of the reader: after a short time, reads time out, however much the client sends.
    pub(super) fn begin_turn(&mut self) {
        self.turn = Some(Instant::now());
    }

    /// Releases the memory of a message that was handled, except for `kept` received bytes of the next message.
    pub(super) fn end_message(&mut self, kept: usize) -> io::Result<()> {
        self.memory.release(usize::MAX);
        self.since = None;
        self.receive(kept)
    }

    /// Subtracts a control frame with a payload of this length, which is no part of a message.
    pub(super) fn end_control(&mut self, length: usize) {
        let is_due = |latest: Instant| latest.elapsed() >= CONTROL_INTERVAL;
        if self.latest_control.is_none_or(is_due) {
            self.latest_control = Some(Instant::now());
            self.memory.release(MEMORY_FACTOR * (CONTROL_HEAD + length));
        }
    }

    /// Returns whether a message has used memory of the pool for too long.
    pub(super) fn is_too_slow(&self) -> bool {
        self.since
            .is_some_and(|since| since.elapsed() > self.timeout)
    }

    /// Reads and drops at most `most` bytes, until the client ends its stream, for at most `timeout`.
    pub(super) fn drain(&mut self, most: usize, timeout: Duration) {
        let (begin, mut left) = (Instant::now(), most);
        let mut chunk = [0; 16 << 10];
        while begin.elapsed() < timeout && left > 0 {
            match self.stream.read(&mut chunk) {
                Ok(0) => return,
                Ok(count) => left = left.saturating_sub(count),
                Err(error) if is_timeout(&error) => {}
                Err(_) => return,
            }
        }
    }

    fn receive(&mut self, bytes: usize) -> io::Result<()> {
        if !self.memory.reserve(bytes.saturating_mul(MEMORY_FACTOR)) {
            return Err(ErrorKind::QuotaExceeded.into());
        }
        if self.since.is_none() && self.memory.uses_pool() {
            self.since = Some(Instant::now());
        }
        Ok(())
    }
}

impl Read for MeteredStream {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        if self.is_too_slow() || self.turn.is_some_and(|begin| begin.elapsed() > TURN) {
            return Err(ErrorKind::WouldBlock.into());
        }
        let count = self.stream.read(buffer)?;
        self.receive(count)?;
        Ok(count)
    }
}

impl Write for MeteredStream {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.stream.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.stream.flush()
    }
}

impl Stream for MeteredStream {
    fn end_writing(&mut self) {
        self.stream.end_writing();
    }
}
