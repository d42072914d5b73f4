//! Reads the records in a chunk.
//!
//! The MCAP library trusts the lengths of the records in a chunk (it subtracts them without a check), so that chunks are taken from it as
//! a whole.

use crc32fast::hash as crc32;

use super::error::RecordingError;

/// Length in bytes of the head of an MCAP record: opcode and length field.
const RECORD_HEAD: usize = 1 + 8;

/// Content of an MCAP chunk: a compressed sequence of records.
struct Chunk<'a> {
    uncompressed_size: u64,
    /// CRC-32 of the uncompressed records; 0 if the chunk has no checksum.
    checksum: u32,
    compression: &'a [u8],
    records: &'a [u8],
}

/// Passes opcode and content of each record of an MCAP chunk to `take`, until it returns false. The checksum is
/// verified first, and a chunk is decompressed to at most `most` bytes. Returns false if `take` has returned false.
///
/// # Errors
/// Returns an error if the chunk is damaged or too large, and the errors of `take`.
pub(super) fn for_each_record(
    data: &[u8],
    most: usize,
    mut take: impl FnMut(u8, &[u8]) -> Result<bool, RecordingError>,
) -> Result<bool, RecordingError> {
    let chunk = parse(data).ok_or_else(|| damaged("a chunk has no valid head"))?;
    let decompressed;
    let records = match chunk.compression {
        b"" => chunk.records,
        b"zstd" => {
            decompressed = decompress(&chunk, most)?;
            &decompressed
        }
        _ => return Err(damaged("a chunk has an unknown compression")),
    };
    if chunk.checksum != 0 && crc32(records) != chunk.checksum {
        return Err(damaged("the checksum of a chunk is wrong"));
    }
    let mut rest = records;
    while !rest.is_empty() {
        let split = split_record(rest);
        let (opcode, content, after) =
            split.ok_or_else(|| damaged("a record is longer than its chunk"))?;
        if !take(opcode, content)? {
            return Ok(false);
        }
        rest = after;
    }
    Ok(true)
}

fn damaged(why: &str) -> RecordingError {
    RecordingError::Damaged(why.to_owned())
}

fn decompress(chunk: &Chunk<'_>, most: usize) -> Result<Vec<u8>, RecordingError> {
    let size = usize::try_from(chunk.uncompressed_size).ok();
    let size = size.filter(|size| *size <= most);
    let size = size.ok_or_else(|| damaged("a chunk is too large"))?;
    let records = zstd::bulk::decompress(chunk.records, size);
    records.map_err(|error| RecordingError::Damaged(error.to_string()))
}

/// Parses the content of a chunk record (MCAP specification, record Chunk); `None` if it is damaged.
fn parse(data: &[u8]) -> Option<Chunk<'_>> {
    // Times of the first and last message come first.
    let (uncompressed_size, rest) = data.get(16..)?.split_first_chunk()?;
    let (checksum, rest) = rest.split_first_chunk()?;
    let (len, rest) = rest.split_first_chunk()?;
    let len = usize::try_from(u32::from_le_bytes(*len)).ok()?;
    let (compression, rest) = rest.split_at_checked(len)?;
    let (len, rest) = rest.split_first_chunk()?;
    let len = usize::try_from(u64::from_le_bytes(*len)).ok()?;
    Some(Chunk {
        uncompressed_size: u64::from_le_bytes(*uncompressed_size),
        checksum: u32::from_le_bytes(*checksum),
        compression,
        records: rest.get(..len)?,
    })
}

/// Returns opcode and content of the first record, and the records after it; `None` if the first one is incomplete.
fn split_record(records: &[u8]) -> Option<(u8, &[u8], &[u8])> {
    let (head, rest) = records.split_first_chunk::<RECORD_HEAD>()?;
    let [opcode, len @ ..] = head;
    let len = usize::try_from(u64::from_le_bytes(*len)).ok()?;
    let (content, rest) = rest.split_at_checked(len)?;
    Some((*opcode, content, rest))
}
