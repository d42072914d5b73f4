//! Stream that limits the memory and the time of incomplete messages.

use std::io::{self, BufReader, Cursor, ErrorKind, Read, Write};
use std::time::{Duration, Instant};

use super::frame_position::FramePosition;
use super::framing::Stream;
use super::http::is_timeout;
use super::memory_pool::ConnectionMemory;

/// Memory of a received byte: buffers grow by doubling.
const MEMORY_FACTOR: usize = 2;
/// Length in bytes of the buffer for short reads.
const BUFFER: usize = 4 << 10;
/// Length in bytes of a frame from which on the buffers of its reader are large.
const LARGE_FRAME: u64 = 64 << 10;
/// Time for which a client that sends without a pause is read, before the queued messages are sent to it.
const TURN: Duration = Duration::from_millis(20);

/// Stream from a client whose incomplete messages take memory of a pool, for a limited time.
pub(crate) struct MeteredStream {
    stream: BufReader<Box<dyn Stream>>,
    /// Bytes to read before those of the stream.
    rest: Cursor<Vec<u8>>,
    /// Position in the frames of a websocket, and the maximum length of a frame; `None` if the stream has no frames.
    frames: Option<(FramePosition, u64)>,
    /// Whether a large frame was read.
    had_large_frame: bool,
    memory: ConnectionMemory,
    /// Maximum time for which an incomplete message may use memory of the pool.
    timeout: Duration,
    /// Time since which an incomplete message uses memory of the pool; `None` if none does.
    since: Option<Instant>,
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
            stream: BufReader::with_capacity(BUFFER, stream),
            rest: Cursor::default(),
            frames: None,
            had_large_frame: false,
            memory,
            timeout,
            since: None,
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

    /// Reads frames of a websocket from now on, which begin with the bytes `rest`. A frame has at most `most` bytes; the
    /// reader rejects a longer one by its head. Each read ends at the end of a frame at the latest, so that a reader
    /// between two frames has no bytes in its buffers.
    pub(super) fn start_frames(&mut self, rest: Vec<u8>, most: usize) {
        self.memory.release(usize::MAX);
        self.since = None;
        self.rest = Cursor::new(rest);
        self.frames = Some((FramePosition::default(), most as u64));
    }

    /// Returns whether a large frame was read since the last call.
    pub(super) fn take_large_frame(&mut self) -> bool {
        std::mem::take(&mut self.had_large_frame)
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

    fn read_some(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        match self.rest.read(buffer)? {
            0 => self.stream.read(buffer),
            count => Ok(count),
        }
    }

    /// Reads within a frame. The memory of a frame is reserved before its reader knows its length, because the reader
    /// then makes all of it.
    fn read_frame(
        &mut self,
        (mut position, most): (FramePosition, u64),
        buffer: &mut [u8],
    ) -> io::Result<usize> {
        let end = position.most().min(buffer.len());
        let read = self.read_some(&mut buffer[..end]);
        let length = match read {
            Ok(count) => position.advance(&buffer[..count]),
            Err(_) => None,
        };
        self.frames = Some((position, most));
        if let Some(length) = length.filter(|length| *length <= most) {
            self.had_large_frame |= length > LARGE_FRAME;
            self.receive(usize::try_from(length).unwrap_or(usize::MAX))?;
        }
        read
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
        if let Some(frames) = self.frames.take() {
            return self.read_frame(frames, buffer);
        }
        let count = self.read_some(buffer)?;
        self.receive(count)?;
        Ok(count)
    }
}

impl Write for MeteredStream {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.stream.get_mut().write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.stream.get_mut().flush()
    }
}

impl Stream for MeteredStream {
    fn end_writing(&mut self) {
        self.stream.get_mut().end_writing();
    }
}
