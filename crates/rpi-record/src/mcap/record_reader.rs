//! Reads the records of one file of a recording when they are needed, from any record on.

use std::io::{Read, Seek, SeekFrom};

use mcap::records::{Record, op};
use mcap::sans_io::linear_reader::{LinearReadEvent, LinearReader, LinearReaderOptions};

use super::error::RecordingError;
use super::part_source::{MAGIC, MAX_RECORD, PartInput, PartSource, damaged, read_error};
use super::{chunk, record_parser};

/// Length in bytes of the head of an MCAP record: opcode and length field.
const RECORD_HEAD: u64 = 1 + 8;

/// A file of a recording that is being read.
pub(super) struct RecordReader {
    input: Box<dyn PartInput>,
    reader: LinearReader,
    /// Offset of the next record in bytes.
    offset: u64,
    /// Whether the recording was cut off, so that its last file may end anywhere.
    is_cut: bool,
}

impl RecordReader {
    /// Opens a file at a record; 0 is the start of the file.
    pub(super) fn open(
        part: &PartSource,
        offset: u64,
        is_cut: bool,
    ) -> Result<RecordReader, RecordingError> {
        let mut input = part.open()?;
        input.seek(SeekFrom::Start(offset)).map_err(read_error)?;
        let options = LinearReaderOptions {
            skip_start_magic: offset > 0,
            emit_chunks: true,
            record_length_limit: Some(MAX_RECORD),
            ..LinearReaderOptions::default()
        };
        Ok(RecordReader {
            input,
            reader: LinearReader::new_with_options(options),
            offset: offset.max(MAGIC.len() as u64),
            is_cut,
        })
    }

    /// Passes the next record to `take`, or each record of the next chunk, as far as a recording needs them. Returns the offset of
    /// the record or chunk; `None` at the end of the file, or where it was cut off.
    ///
    /// # Errors
    /// Returns an error if the file cannot be read or is damaged.
    pub(super) fn next(
        &mut self,
        mut take: impl FnMut(Record<'_>),
    ) -> Result<Option<u64>, RecordingError> {
        let mut parse = |opcode, data: &[u8]| {
            record_parser::parse(opcode, data)?.map(&mut take);
            Ok(true)
        };
        self.next_whole(|opcode, data| match opcode {
            op::CHUNK => chunk::for_each_record(data, MAX_RECORD, parse).map(drop),
            _ => parse(opcode, data).map(drop),
        })
    }

    /// Passes the next record, as opcode and content, to `take`, and returns its offset; `None` at the end of the file, or where it
    /// was cut off.
    fn next_whole(
        &mut self,
        take: impl FnOnce(u8, &[u8]) -> Result<(), RecordingError>,
    ) -> Result<Option<u64>, RecordingError> {
        while let Some(event) = self.reader.next_event() {
            match event {
                Ok(LinearReadEvent::ReadRequest(need)) => {
                    let buffer = self.reader.insert(need);
                    let count = self.input.read(buffer).map_err(read_error)?;
                    self.reader.notify_read(count);
                }
                Ok(LinearReadEvent::Record { opcode, data }) => {
                    let offset = self.offset;
                    self.offset += RECORD_HEAD + data.len() as u64;
                    take(opcode, data)?;
                    return Ok(Some(offset));
                }
                Err(_) if self.is_cut => return Ok(None),
                Err(error) => return Err(damaged(error)),
            }
        }
        Ok(None)
    }
}
