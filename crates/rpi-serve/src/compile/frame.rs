//! Frames on the pipes between the server and a worker: magic number, version, head, length, content.

use std::io::{self, Read};

use rpi_image::encode_struct;
use rpi_image::encoding::{Encoding, ReadError, Reader};

/// First bytes of a frame.
const MAGIC: [u8; 4] = *b"RPIW";
/// Version of the frames and their content. Server and worker are of the same build, unless the program was replaced.
const VERSION: u16 = 1;

/// Limits that a worker applies to itself before it reads the text.
#[derive(Clone, Copy, PartialEq, Eq, Default, Debug)]
pub(super) struct FrameLimits {
    /// Maximum address space in bytes.
    pub(super) memory_bytes: u64,
    /// Maximum processor time in seconds.
    pub(super) cpu_seconds: u64,
    /// Process of the server, with which the worker ends.
    pub(super) server: u32,
}

encode_struct!(FrameLimits {
    memory_bytes: u64,
    cpu_seconds: u64,
    server: u32
});

/// Length of the part of a frame before its content, in bytes.
pub(super) const HEADER_BYTES: usize =
    MAGIC.len() + u16::MIN_BYTES + FrameLimits::MIN_BYTES + u64::MIN_BYTES;

/// Returns a frame with this content. The answer of a worker has no limits.
pub(super) fn frame(limits: FrameLimits, content: &impl Encoding) -> Vec<u8> {
    let mut body = Vec::new();
    content.encode(&mut body);
    let mut bytes = Vec::with_capacity(HEADER_BYTES + body.len());
    bytes.extend_from_slice(&MAGIC);
    VERSION.encode(&mut bytes);
    limits.encode(&mut bytes);
    (body.len() as u64).encode(&mut bytes);
    bytes.append(&mut body);
    bytes
}

/// Returns the limits and the length of the content in bytes from the head of a frame.
///
/// # Errors
/// If this is no head, or one of another version.
pub(super) fn head(bytes: &[u8]) -> Result<(FrameLimits, u64), ReadError> {
    let rest = bytes.strip_prefix(&MAGIC).ok_or(ReadError::NotAnImage)?;
    let mut reader = Reader::new(rest);
    let version = u16::decode(&mut reader)?;
    if version != VERSION {
        return Err(ReadError::UnsupportedVersion(version));
    }
    Ok((FrameLimits::decode(&mut reader)?, u64::decode(&mut reader)?))
}

/// Decodes the content of a frame.
///
/// # Errors
/// If the bytes are not a value of this type.
pub(super) fn content<T: Encoding>(bytes: &[u8]) -> Result<T, ReadError> {
    let mut reader = Reader::new(bytes);
    let value = T::decode(&mut reader)?;
    reader.expect_end()?;
    Ok(value)
}

/// Reads the head of a frame.
///
/// # Errors
/// If the stream ends or fails, or if this is no head.
pub(super) fn read_head(from: &mut impl Read) -> io::Result<(FrameLimits, u64)> {
    let mut bytes = [0; HEADER_BYTES];
    from.read_exact(&mut bytes)?;
    head(&bytes).map_err(io::Error::other)
}

/// Reads the content of a frame of this length in bytes.
///
/// # Errors
/// If the stream ends or fails, or if the content is invalid.
pub(super) fn read_content<T: Encoding>(from: &mut impl Read, length: u64) -> io::Result<T> {
    let mut bytes = Vec::new();
    // The memory grows with the bytes that arrive, not with the length in the head.
    from.take(length).read_to_end(&mut bytes)?;
    content(&bytes).map_err(io::Error::other)
}
