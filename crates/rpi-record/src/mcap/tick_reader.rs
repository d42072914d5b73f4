//! Reads the ticks of a recording one by one, from any position that was reached before.

use std::collections::{BTreeMap, VecDeque};

use mcap::records::Record;

use super::bytes_encoding;
use super::error::RecordingError;
use super::own_topics::TAPE;
use super::part_source::PartSource;
use super::record_reader::RecordReader;

/// Position of a tick in the files of a recording.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub(super) struct TickPosition {
    /// Index of the file.
    part: usize,
    /// Offset in the file, in bytes, of the record that holds the tick: a chunk or a message. 0 for the start of the file.
    offset: u64,
    /// Number of ticks before it in this record.
    within: usize,
}

/// Reader of the ticks of a recording. The files are the same as when the recording was opened, where they were verified.
pub(super) struct TickReader {
    parts: Vec<PartSource>,
    /// For each file, the channels with ticks that have been found, with the encoding of their messages.
    channels: Vec<BTreeMap<u16, String>>,
    /// Ticks of the last record that was read which have not been taken.
    ticks: VecDeque<Vec<u64>>,
    /// Position of the next tick, if `ticks` has one.
    position: TickPosition,
    /// File that is being read; `None` before its first record and at the end.
    file: Option<RecordReader>,
    /// Whether the recording was cut off.
    is_cut: bool,
}

impl TickReader {
    /// Creates a reader at the first tick of a recording with these files, which was cut off if `is_cut`.
    pub(super) fn new(parts: Vec<PartSource>, is_cut: bool) -> TickReader {
        TickReader {
            channels: vec![BTreeMap::new(); parts.len()],
            parts,
            ticks: VecDeque::new(),
            position: TickPosition::default(),
            file: None,
            is_cut,
        }
    }

    /// Returns the position of the next tick.
    pub(super) fn position(&self) -> TickPosition {
        self.position
    }

    /// Returns to a position.
    ///
    /// # Errors
    /// Returns an error if the file cannot be read, or has changed since the position was returned.
    pub(super) fn seek(&mut self, to: TickPosition) -> Result<(), RecordingError> {
        let is_here = self.position.part == to.part && self.position.offset == to.offset;
        if is_here && self.position.within <= to.within && !self.ticks.is_empty() {
            self.ticks.drain(..to.within - self.position.within);
            self.position = to;
            return Ok(());
        }
        self.ticks.clear();
        self.position = TickPosition { within: 0, ..to };
        self.file = match self.parts.get(to.part) {
            Some(part) => Some(RecordReader::open(part, to.offset, self.is_cut)?),
            None => None,
        };
        for _ in 0..to.within {
            self.next()?;
        }
        Ok(())
    }

    /// Returns the words of the next tick; `None` at the end.
    ///
    /// # Errors
    /// Returns an error if a file cannot be read or is damaged.
    pub(super) fn next(&mut self) -> Result<Option<Vec<u64>>, RecordingError> {
        while self.ticks.is_empty() {
            if !self.fill()? {
                return Ok(None);
            }
        }
        self.position.within += 1;
        Ok(self.ticks.pop_front())
    }

    /// Reads the next record. Returns false at the end of the last file.
    fn fill(&mut self) -> Result<bool, RecordingError> {
        let Some(part) = self.parts.get(self.position.part) else {
            return Ok(false);
        };
        let file = match &mut self.file {
            Some(file) => file,
            closed => closed.insert(RecordReader::open(part, 0, self.is_cut)?),
        };
        let (channels, ticks) = (&mut self.channels[self.position.part], &mut self.ticks);
        let offset = file.next(|record| take_record(record, channels, ticks))?;
        self.position = match offset {
            Some(offset) => TickPosition {
                offset,
                within: 0,
                ..self.position
            },
            None => {
                self.file = None;
                TickPosition {
                    part: self.position.part + 1,
                    ..TickPosition::default()
                }
            }
        };
        Ok(true)
    }
}

/// Stores a channel with ticks, or a tick.
fn take_record(
    record: Record<'_>,
    channels: &mut BTreeMap<u16, String>,
    ticks: &mut VecDeque<Vec<u64>>,
) {
    match record {
        Record::Channel(channel) if channel.topic == TAPE => {
            channels.insert(channel.id, channel.message_encoding);
        }
        Record::Message { header, data } => {
            if let Some(encoding) = channels.get(&header.channel_id) {
                let bytes = bytes_encoding::decode(encoding, &data);
                let words = bytes.as_chunks().0.iter();
                ticks.push_back(words.map(|bytes| u64::from_le_bytes(*bytes)).collect());
            }
        }
        _ => {}
    }
}
