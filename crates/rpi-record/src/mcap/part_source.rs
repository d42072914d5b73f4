//! Reads the records of one file of a recording, one after another, with bounded memory.

use std::fs::File;
use std::io::{self, Cursor, Read, Seek, SeekFrom};
use std::path::PathBuf;
use std::sync::Arc;

use crc32fast::Hasher;
use mcap::records::{Record, op};
use mcap::sans_io::linear_reader::{LinearReadEvent, LinearReader, LinearReaderOptions};

use super::error::RecordingError;
use super::{chunk, record_parser};

/// Bytes with which every complete MCAP file begins and ends.
pub(super) const MAGIC: &[u8] = b"\x89MCAP0\r\n";
/// Maximum size in bytes of a record, and of a chunk before and after decompression. Larger ones are rejected.
pub(super) const MAX_RECORD: usize = 64 << 20;

/// Source of one file of a recording, which can be read several times: a path, or bytes in memory.
#[derive(Clone, Debug)]
pub(super) enum PartSource {
    File(PathBuf),
    Bytes(Arc<[u8]>),
}

/// How a file of a recording ends: complete, or cut off.
#[derive(Clone, PartialEq, Eq, Debug)]
pub(super) enum PartEnd {
    /// The file is complete. `checksum` is the CRC-32 of all its bytes.
    Complete { checksum: u32 },
    /// The file was cut off, because the process was killed or the disk was full. The text says what is missing.
    Cut(String),
}

/// Result of handling a record: whether to read further records, or an error.
pub(super) type ReadOn = Result<bool, RecordingError>;

/// Bytes of a file of a recording from some position on.
pub(super) trait PartInput: Read + Seek + Send {}

impl<T: Read + Seek + Send> PartInput for T {}

impl PartSource {
    /// Opens the file for reading from any position.
    ///
    /// # Errors
    /// Returns an error if the file cannot be opened.
    pub(super) fn open(&self) -> Result<Box<dyn PartInput>, RecordingError> {
        Ok(match self {
            PartSource::File(path) => Box::new(File::open(path).map_err(read_error)?),
            PartSource::Bytes(bytes) => Box::new(Cursor::new(Arc::clone(bytes))),
        })
    }

    /// Returns whether the file ends with the bytes with which every complete MCAP file ends.
    fn has_end(&self) -> io::Result<bool> {
        match self {
            PartSource::Bytes(bytes) => Ok(bytes.ends_with(MAGIC)),
            PartSource::File(path) => {
                let mut file = File::open(path)?;
                let len = file.seek(SeekFrom::End(0))?;
                file.seek(SeekFrom::Start(len.saturating_sub(MAGIC.len() as u64)))?;
                let mut end = Vec::new();
                file.take(MAGIC.len() as u64).read_to_end(&mut end)?;
                Ok(end == MAGIC)
            }
        }
    }

    /// Passes each record that a recording needs to `take` until it returns false. All checksums are verified. The
    /// records of a chunk are passed one by one after the checksum of the chunk was verified.
    ///
    /// Returns how the file ends; `None` if `take` has ended the reading.
    ///
    /// # Errors
    /// Returns an error if the file is not MCAP or is damaged, and the errors of `take`.
    pub(super) fn read(
        &self,
        mut take: impl FnMut(Record<'_>) -> ReadOn,
    ) -> Result<Option<PartEnd>, RecordingError> {
        let has_end = self.has_end().map_err(read_error)?;
        let mut input = self.open()?;
        let mut reader = LinearReader::new_with_options(options());
        let mut checksum = Hasher::new();
        while let Some(event) = reader.next_event() {
            match event {
                Ok(LinearReadEvent::ReadRequest(need)) => {
                    let buffer = reader.insert(need);
                    let count = input.read(buffer).map_err(read_error)?;
                    checksum.update(&buffer[..count]);
                    reader.notify_read(count);
                }
                Ok(LinearReadEvent::Record { opcode, data }) => {
                    let mut parse = |opcode, data: &[u8]| {
                        let record = record_parser::parse(opcode, data)?;
                        record.map_or(Ok(true), &mut take)
                    };
                    let read_on = match opcode {
                        op::CHUNK => chunk::for_each_record(data, MAX_RECORD, parse)?,
                        _ => parse(opcode, data)?,
                    };
                    if !read_on {
                        return Ok(None);
                    }
                }
                Err(error) if !has_end => return Ok(Some(PartEnd::Cut(error.to_string()))),
                Err(error) => return Err(damaged(error)),
            }
        }
        Ok(Some(PartEnd::Complete {
            checksum: checksum.finalize(),
        }))
    }
}

fn options() -> LinearReaderOptions {
    LinearReaderOptions {
        check_finishes_after_end_magic: true,
        emit_chunks: true,
        validate_data_section_crc: true,
        validate_summary_section_crc: true,
        record_length_limit: Some(MAX_RECORD),
        ..LinearReaderOptions::default()
    }
}

pub(super) fn damaged(error: mcap::McapError) -> RecordingError {
    RecordingError::Damaged(error.to_string())
}

pub(super) fn read_error(error: io::Error) -> RecordingError {
    RecordingError::Unreadable(error.to_string())
}
