//! Completes a recording whose process was killed: the last file gets an index and an end, so that viewers open it like
//! any other recording.

use std::fs::{File, OpenOptions};
use std::io::{self, BufReader, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use crc32fast::Hasher;
use mcap::records::op;

use super::chunk;
use super::error::RecordingError;
use super::mcap_bytes::RecordBytes;
use super::part_index::{PartIndex, RecordPlace};
use super::part_source::{MAGIC, MAX_RECORD};
use super::parts::{FIRST_PART, part_path};

/// Key of the metadata `rpi-end` of a completed recording: the reason for which the recording was cut off.
pub(super) const CUT: &str = "cut";
/// Length in bytes of the head of an MCAP record: opcode and length field.
const RECORD_HEAD: u64 = 1 + 8;

/// What a recording has that was completed after its process was killed.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct CompletedRecording {
    /// Last file of the recording, which was completed.
    pub file: PathBuf,
    /// Number of ticks in this file.
    pub ticks: u64,
    /// Number of bytes at the end of the file that were removed, because they were part of an incomplete record.
    pub removed_bytes: u64,
}

/// Completes a recording that was cut off. `path` is the file of its first part. `why` is the reason of the cut, which
/// a replay reports. Returns `None` if the recording has an end.
///
/// # Errors
/// Returns an error if the last file has no complete data, or cannot be read or written.
pub fn complete(path: &Path, why: &str) -> Result<Option<CompletedRecording>, RecordingError> {
    let parts = recording_files(path);
    let file = parts.last().ok_or_else(|| {
        let missing = io::Error::from(io::ErrorKind::NotFound);
        unreadable(&missing)
    })?;
    complete_file(file, why)
}

/// Returns the files of a recording that exist, in their order. `path` is the file of the first part.
#[must_use]
pub fn recording_files(path: &Path) -> Vec<PathBuf> {
    let parts = (FIRST_PART..).map(|part| part_path(path, part));
    parts.take_while(|file| file.exists()).collect()
}

fn complete_file(path: &Path, why: &str) -> Result<Option<CompletedRecording>, RecordingError> {
    let length = std::fs::metadata(path).map_err(|e| unreadable(&e))?.len();
    let input = File::open(path).map_err(|e| unreadable(&e))?;
    let mut scan = Scan {
        input: BufReader::new(input),
        length,
        offset: 0,
        checksum: Hasher::new(),
        chunk_checksum: Hasher::new(),
        index: PartIndex::default(),
        state: ScanState::default(),
    };
    scan.run().map_err(|e| unreadable(&e))?;
    if scan.state.is_complete {
        return Ok(None);
    }
    if !(scan.state.has_head && scan.index.has_chunk()) {
        return Err(RecordingError::Missing("complete data".to_owned()));
    }
    let ticks = scan.index.ticks();
    let (from, bytes) = scan.end(why);
    let written = write_end(path, from, &bytes);
    written.map_err(|e| unreadable(&e))?;
    Ok(Some(CompletedRecording {
        file: path.to_owned(),
        ticks,
        removed_bytes: length.saturating_sub(from),
    }))
}

/// Replaces everything from the offset `from` of a file on by `bytes`.
fn write_end(path: &Path, from: u64, bytes: &[u8]) -> io::Result<()> {
    let mut file = OpenOptions::new().write(true).open(path)?;
    file.set_len(from)?;
    file.seek(SeekFrom::Start(from))?;
    file.write_all(bytes)?;
    file.sync_all()
}

/// Reading of the records of a file up to the first one that is incomplete.
struct Scan {
    input: BufReader<File>,
    /// Number of bytes of the file.
    length: u64,
    /// Offset after the last complete record.
    offset: u64,
    /// Checksum of the file up to `offset`, and up to the end of the last chunk.
    checksum: Hasher,
    chunk_checksum: Hasher,
    index: PartIndex,
    state: ScanState,
}

/// What the records of a file show about its completeness.
#[derive(Default)]
struct ScanState {
    /// The metadata at the beginning were read.
    has_head: bool,
    /// The metadata at the end were read: only the index is missing.
    has_end: bool,
    /// The file has an index and a footer.
    is_complete: bool,
}

/// Whether further records of the data are to be read.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Next {
    Record,
    End,
}

impl Scan {
    fn run(&mut self) -> io::Result<()> {
        let mut magic = vec![0; MAGIC.len()];
        if self.length < magic.len() as u64 {
            return Ok(());
        }
        self.input.read_exact(&mut magic)?;
        if magic != MAGIC {
            return Ok(());
        }
        self.accept(&magic, &[]);
        while self.read_record()? == Next::Record {}
        Ok(())
    }

    /// Advances by a complete record, of which `head` are the first bytes and `content` the others.
    fn accept(&mut self, head: &[u8], content: &[u8]) {
        self.checksum.update(head);
        self.checksum.update(content);
        self.offset += (head.len() + content.len()) as u64;
    }

    fn read_record(&mut self) -> io::Result<Next> {
        let rest = self.length - self.offset;
        if rest < RECORD_HEAD {
            return Ok(Next::End);
        }
        let mut head = [0; RECORD_HEAD as usize];
        self.input.read_exact(&mut head)?;
        let [opcode, length @ ..] = head;
        let length = u64::from_le_bytes(length);
        if opcode == op::DATA_END {
            self.state.is_complete = self.has_footer()?;
            return Ok(Next::End);
        }
        let size = usize::try_from(length).unwrap_or(usize::MAX);
        if length > rest - RECORD_HEAD || size > MAX_RECORD {
            return Ok(Next::End);
        }
        let mut content = vec![0; size];
        self.input.read_exact(&mut content)?;
        let place = RecordPlace {
            offset: self.offset,
            length: RECORD_HEAD + length,
        };
        if self.take(place, opcode, &content).is_none() {
            return Ok(Next::End);
        }
        self.accept(&head, &content);
        if opcode == op::CHUNK {
            self.chunk_checksum = self.checksum.clone();
        }
        Ok(Next::Record)
    }

    /// Adds a record to the index. Returns `None` if the record is damaged, as after a loss of power.
    fn take(&mut self, place: RecordPlace, opcode: u8, content: &[u8]) -> Option<()> {
        if opcode != op::MESSAGE_INDEX {
            self.index.forget_messages();
        }
        match opcode {
            op::HEADER => Some(()),
            op::CHUNK => self.take_chunk(place, content),
            op::MESSAGE_INDEX => self.index.add_message_index(place, content),
            op::ATTACHMENT => self.index.add_attachment(place, content),
            op::METADATA => {
                let name = self.index.add_metadata(place, content)?;
                self.state.has_head |= name == "rpi";
                self.state.has_end |= name == "rpi-end";
                Some(())
            }
            // A recording has no other records outside of chunks.
            _ => None,
        }
    }

    fn take_chunk(&mut self, place: RecordPlace, content: &[u8]) -> Option<()> {
        self.index.begin_chunk(place, content)?;
        let mut offset = 0;
        let index = &mut self.index;
        let read = chunk::for_each_record(content, MAX_RECORD, |opcode, content| {
            let taken = index.add_in_chunk(offset, opcode, content);
            offset += RECORD_HEAD + content.len() as u64;
            Ok(taken.is_some())
        });
        match read {
            Ok(true) => {
                self.index.end_chunk();
                Some(())
            }
            _ => {
                self.index.remove_chunk();
                None
            }
        }
    }

    /// Returns whether the file ends as a complete one does.
    fn has_footer(&mut self) -> io::Result<bool> {
        let end = -i64::try_from(MAGIC.len()).unwrap_or(0);
        self.input.seek(SeekFrom::End(end))?;
        let mut bytes = Vec::new();
        self.input.read_to_end(&mut bytes)?;
        Ok(bytes == MAGIC)
    }

    /// Returns the bytes that complete the file, and the offset at which they are to be written.
    fn end(mut self, why: &str) -> (u64, Vec<u8>) {
        let mut bytes = Vec::new();
        let rebuilt = match self.state.has_end {
            true => None,
            false => self.index.rebuild_message_indexes(),
        };
        let from = rebuilt.as_ref().map_or(self.offset, |(offset, _)| *offset);
        if let Some((_, indexes)) = rebuilt {
            self.checksum = self.chunk_checksum.clone();
            bytes.extend(indexes);
        }
        if !self.state.has_end {
            let keys = RecordBytes::default().text(CUT).text(why);
            let content = RecordBytes::default().text("rpi-end").counted(&keys.0);
            let place = RecordPlace {
                offset: from + bytes.len() as u64,
                length: RECORD_HEAD + content.0.len() as u64,
            };
            self.index.add_metadata(place, &content.0);
            bytes.extend(content.record(op::METADATA));
        }
        self.checksum.update(&bytes);
        let data_end = RecordBytes::default().number32(self.checksum.finalize());
        bytes.extend(data_end.record(op::DATA_END));
        bytes.extend(self.index.summary(from + bytes.len() as u64));
        bytes.extend(MAGIC);
        (from, bytes)
    }
}

fn unreadable(error: &io::Error) -> RecordingError {
    RecordingError::Unreadable(error.to_string())
}
