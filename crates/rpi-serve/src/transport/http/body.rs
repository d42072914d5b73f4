//! Bodies of HTTP requests.

use std::time::{Duration, Instant};

use http::StatusCode;
use httparse::{EMPTY_HEADER, Status, parse_chunk_size, parse_headers};

use super::head::Head;
use super::is_timeout;
use super::length::BodyLength;
use super::request_error::RequestError;
use crate::transport::framing::Stream;

/// Maximum length in bytes of the line with the length of a chunk, and of the trailers after the last chunk.
const MAX_LINE_BYTES: usize = 4 << 10;
/// Maximum number of trailers, which are ignored.
const MAX_TRAILERS: usize = 16;

impl Head {
    /// Reads the body of the request. Asks the client to send it if the client waits for that.
    ///
    /// # Errors
    /// If the body is malformed, longer than `most` bytes, or not complete within `timeout`.
    pub(crate) fn body(
        &self,
        stream: &mut dyn Stream,
        most: usize,
        timeout: Duration,
    ) -> Result<Vec<u8>, RequestError> {
        let length = match self.length {
            BodyLength::Known(0) => return Ok(Vec::new()),
            BodyLength::Known(length) => Some(within(length, most)?),
            BodyLength::Chunked => None,
        };
        if self.expects_continue && self.remaining.is_empty() {
            stream.write_all(b"HTTP/1.1 100 Continue\r\n\r\n")?;
            stream.flush()?;
        }
        let mut reader = BodyReader {
            stream,
            buffer: self.remaining.clone(),
            used: 0,
            end: Instant::now() + timeout,
        };
        let mut body = Vec::new();
        match length {
            Some(length) => reader.append(length, &mut body)?,
            None => reader.chunks(most, &mut body)?,
        }
        Ok(body)
    }
}

/// Returns a length that is at most `most`.
fn within(length: u64, most: usize) -> Result<usize, RequestError> {
    let length = usize::try_from(length).ok().filter(|own| *own <= most);
    length.ok_or(RequestError::Rejected(
        StatusCode::PAYLOAD_TOO_LARGE,
        "the body of the request is too long",
    ))
}

/// Reader of a body from a stream.
struct BodyReader<'s> {
    stream: &'s mut dyn Stream,
    /// Bytes that were read from the stream.
    buffer: Vec<u8>,
    /// Number of bytes of the buffer that were used.
    used: usize,
    /// Time at which the body must be complete. With a limit per read, a client could keep the connection by sending
    /// single bytes.
    end: Instant,
}

impl BodyReader<'_> {
    fn rest(&self) -> &[u8] {
        &self.buffer[self.used..]
    }

    /// Reads more bytes from the stream into the buffer. Drops the bytes that were used.
    fn fill(&mut self) -> Result<(), RequestError> {
        self.buffer.drain(..self.used);
        self.used = 0;
        let mut chunk = [0; 16 << 10];
        loop {
            if Instant::now() > self.end {
                let reason = "the body of the request is too slow";
                return Err(RequestError::Rejected(StatusCode::REQUEST_TIMEOUT, reason));
            }
            match self.stream.read(&mut chunk) {
                Ok(0) => return Err(RequestError::malformed("the request ends within its body")),
                Ok(read) => {
                    self.buffer.extend_from_slice(&chunk[..read]);
                    return Ok(());
                }
                Err(error) if is_timeout(&error) => {}
                Err(error) => return Err(error.into()),
            }
        }
    }

    /// Appends the next `length` bytes to the body.
    fn append(&mut self, length: usize, body: &mut Vec<u8>) -> Result<(), RequestError> {
        let mut left = length;
        loop {
            let count = self.rest().len().min(left);
            body.extend_from_slice(&self.rest()[..count]);
            self.used += count;
            left -= count;
            if left == 0 {
                return Ok(());
            }
            self.fill()?;
        }
    }

    /// Appends the chunks of a body, at most `most` bytes (RFC 9112, section 7.1).
    fn chunks(&mut self, most: usize, body: &mut Vec<u8>) -> Result<(), RequestError> {
        loop {
            let size = self.chunk_size()?;
            if size == 0 {
                return self.skip_trailers();
            }
            let length = within(size, most - body.len())?;
            self.append(length, body)?;
            let mut end = Vec::new();
            self.append(2, &mut end)?;
            if end != b"\r\n" {
                return Err(RequestError::malformed("a chunk is longer than its length"));
            }
        }
    }

    fn chunk_size(&mut self) -> Result<u64, RequestError> {
        let malformed = || RequestError::malformed("the length of a chunk is malformed");
        loop {
            let rest = self.rest();
            // `httparse` takes a line without digits for the length 0.
            if rest.first().is_some_and(|byte| !byte.is_ascii_hexdigit()) {
                return Err(malformed());
            }
            match parse_chunk_size(rest).map_err(|_| malformed())? {
                Status::Complete((length, size)) => {
                    self.used += length;
                    return Ok(size);
                }
                Status::Partial if rest.len() > MAX_LINE_BYTES => return Err(malformed()),
                Status::Partial => self.fill()?,
            }
        }
    }

    fn skip_trailers(&mut self) -> Result<(), RequestError> {
        let malformed = || RequestError::malformed("the trailers of the request are malformed");
        loop {
            let rest = self.rest();
            let mut trailers = [EMPTY_HEADER; MAX_TRAILERS];
            match parse_headers(rest, &mut trailers).map_err(|_| malformed())? {
                Status::Complete(_) => return Ok(()),
                Status::Partial if rest.len() > MAX_LINE_BYTES => return Err(malformed()),
                Status::Partial => self.fill()?,
            }
        }
    }
}
