//! Index of one file of a recording, built from the records of the file, and written as the summary at its end.
//!
//! The MCAP library keeps this index in the process that writes the file. When that process is killed, the index is lost,
//! and viewers need it to seek in the file.

use std::collections::BTreeMap;

use crc32fast::hash as crc32;
use mcap::records::op;

use super::mcap_bytes::{RecordBytes, take_text, take_u16, take_u32, take_u64};
use super::own_topics::TAPE;

/// Place of a record in a file: offset of its first byte, and number of its bytes.
#[derive(Clone, Copy, Debug)]
pub(super) struct RecordPlace {
    pub(super) offset: u64,
    pub(super) length: u64,
}

/// Index of a file: its schemas, channels, chunks, attachments and metadata.
#[derive(Debug, Default)]
pub(super) struct PartIndex {
    /// Contents of the records of schemas, by number.
    schemas: BTreeMap<u16, Vec<u8>>,
    /// Contents of the records of channels, by number.
    channels: BTreeMap<u16, Vec<u8>>,
    /// Number of messages by channel.
    messages: BTreeMap<u16, u64>,
    chunks: Vec<ChunkEntry>,
    /// Contents of the index records of attachments and of metadata.
    attachments: Vec<RecordBytes>,
    metadata: Vec<RecordBytes>,
    /// Times of the first and the last message, in nanoseconds since the Unix epoch.
    times: Option<(u64, u64)>,
    /// Channel of the tick log.
    tick_channel: Option<u16>,
}

/// Index entry of a chunk.
#[derive(Debug)]
struct ChunkEntry {
    place: RecordPlace,
    /// Times of the first and the last message, in nanoseconds since the Unix epoch.
    times: (u64, u64),
    /// Name of the compression, and the sizes of the records in bytes: compressed and not.
    compression: String,
    sizes: (u64, u64),
    /// Messages of the chunk by channel: time and offset in the chunk.
    messages: BTreeMap<u16, Vec<(u64, u64)>>,
    /// Offset of the message index of each channel in the file.
    index_offsets: BTreeMap<u16, u64>,
    /// Number of bytes of the message indexes.
    index_length: u64,
}

impl PartIndex {
    /// Adds a chunk without its messages. Returns `None` if the content is damaged.
    pub(super) fn begin_chunk(&mut self, place: RecordPlace, mut content: &[u8]) -> Option<()> {
        let times = (take_u64(&mut content)?, take_u64(&mut content)?);
        let uncompressed = take_u64(&mut content)?;
        take_u32(&mut content)?;
        let compression = take_text(&mut content)?.to_owned();
        let sizes = (take_u64(&mut content)?, uncompressed);
        self.chunks.push(ChunkEntry {
            place,
            times,
            compression,
            sizes,
            messages: BTreeMap::new(),
            index_offsets: BTreeMap::new(),
            index_length: 0,
        });
        Some(())
    }

    /// Removes the last chunk, which is damaged.
    pub(super) fn remove_chunk(&mut self) {
        self.chunks.pop();
    }

    /// Adds a record of the last chunk, at the offset `offset` in the chunk. Returns `None` if the content is damaged.
    pub(super) fn add_in_chunk(&mut self, offset: u64, opcode: u8, content: &[u8]) -> Option<()> {
        let mut rest = content;
        let number = take_u16(&mut rest)?;
        match opcode {
            op::SCHEMA => {
                self.schemas.insert(number, content.to_vec());
            }
            op::CHANNEL => {
                take_u16(&mut rest)?;
                if take_text(&mut rest)? == TAPE {
                    self.tick_channel = Some(number);
                }
                self.channels.insert(number, content.to_vec());
            }
            op::MESSAGE => {
                take_u32(&mut rest)?;
                let time = take_u64(&mut rest)?;
                let messages = &mut self.chunks.last_mut()?.messages;
                messages.entry(number).or_default().push((time, offset));
            }
            _ => {}
        }
        Some(())
    }

    /// Counts the messages of the last chunk, which is valid.
    pub(super) fn end_chunk(&mut self) {
        let Some(chunk) = self.chunks.last() else {
            return;
        };
        for (channel, messages) in &chunk.messages {
            *self.messages.entry(*channel).or_default() += messages.len() as u64;
        }
        if !chunk.messages.is_empty() {
            let (first, last) = self.times.unwrap_or(chunk.times);
            self.times = Some((first.min(chunk.times.0), last.max(chunk.times.1)));
        }
    }

    /// Adds a message index of the last chunk. Returns `None` if the content is damaged or belongs to no chunk.
    pub(super) fn add_message_index(&mut self, place: RecordPlace, content: &[u8]) -> Option<()> {
        let mut rest = content;
        let channel = take_u16(&mut rest)?;
        let chunk = self.chunks.last_mut()?;
        chunk.index_offsets.insert(channel, place.offset);
        chunk.index_length += place.length;
        Some(())
    }

    /// Returns the message indexes of the last chunk if some of them are missing in the file; otherwise `None`. The
    /// indexes are to be written at `offset`, the end of the chunk.
    pub(super) fn rebuild_message_indexes(&mut self) -> Option<(u64, Vec<u8>)> {
        let chunk = self.chunks.last_mut()?;
        if chunk.index_offsets.len() == chunk.messages.len() {
            return None;
        }
        let offset = chunk.place.offset + chunk.place.length;
        let mut bytes = Vec::new();
        chunk.index_offsets.clear();
        for (channel, messages) in &chunk.messages {
            let entry = |entries: RecordBytes, (time, at): &(u64, u64)| {
                entries.number64(*time).number64(*at)
            };
            let entries = messages.iter().fold(RecordBytes::default(), entry);
            let index = RecordBytes::default().number16(*channel);
            let index = index.counted(&entries.0).record(op::MESSAGE_INDEX);
            let place = offset + bytes.len() as u64;
            chunk.index_offsets.insert(*channel, place);
            bytes.extend(index);
        }
        chunk.index_length = bytes.len() as u64;
        Some((offset, bytes))
    }

    /// Frees the places of the messages of the last chunk, which are in the message indexes of the file.
    pub(super) fn forget_messages(&mut self) {
        if let Some(chunk) = self.chunks.last_mut()
            && chunk.index_offsets.len() == chunk.messages.len()
        {
            chunk
                .messages
                .values_mut()
                .for_each(|messages| *messages = Vec::new());
        }
    }

    /// Adds an attachment. Returns `None` if the content is damaged.
    pub(super) fn add_attachment(&mut self, place: RecordPlace, content: &[u8]) -> Option<()> {
        let mut rest = content;
        let times = (take_u64(&mut rest)?, take_u64(&mut rest)?);
        let (name, media) = (take_text(&mut rest)?, take_text(&mut rest)?);
        let size = take_u64(&mut rest)?;
        let index = RecordBytes::default()
            .number64(place.offset)
            .number64(place.length)
            .number64(times.0)
            .number64(times.1)
            .number64(size)
            .text(name)
            .text(media);
        self.attachments.push(index);
        Some(())
    }

    /// Adds metadata. Returns their name, or `None` if the content is damaged.
    pub(super) fn add_metadata<'a>(
        &mut self,
        place: RecordPlace,
        mut content: &'a [u8],
    ) -> Option<&'a str> {
        let name = take_text(&mut content)?;
        let index = RecordBytes::default()
            .number64(place.offset)
            .number64(place.length)
            .text(name);
        self.metadata.push(index);
        Some(name)
    }

    /// Returns the number of ticks in the file.
    pub(super) fn ticks(&self) -> u64 {
        let ticks = self
            .tick_channel
            .and_then(|channel| self.messages.get(&channel));
        ticks.copied().unwrap_or_default()
    }

    /// Returns whether the file has a chunk.
    pub(super) fn has_chunk(&self) -> bool {
        !self.chunks.is_empty()
    }

    /// Returns the summary and the footer of the file. The summary begins at the offset `offset`.
    pub(super) fn summary(&self, offset: u64) -> Vec<u8> {
        let mut summary = Vec::new();
        let mut offsets = Vec::new();
        for (opcode, records) in self.groups() {
            let begin = summary.len() as u64;
            let records = records.into_iter();
            records.for_each(|content| summary.extend(content.record(opcode)));
            let length = summary.len() as u64 - begin;
            if length > 0 {
                let group = RecordBytes::default().number8(opcode);
                let group = group.number64(offset + begin).number64(length);
                offsets.extend(group.record(op::SUMMARY_OFFSET));
            }
        }
        let offsets_begin = offset + summary.len() as u64;
        summary.extend(offsets);
        // The checksum of the summary includes the footer up to the checksum itself.
        let footer = RecordBytes::default()
            .number64(offset)
            .number64(offsets_begin);
        let mut footer = footer.number32(0).record(op::FOOTER);
        footer.truncate(footer.len() - size_of::<u32>());
        summary.extend(footer);
        let checksum = crc32(&summary);
        summary.extend(checksum.to_le_bytes());
        summary
    }

    /// Returns the contents of the records of the summary, by opcode.
    fn groups(&self) -> [(u8, Vec<RecordBytes>); 6] {
        let copies = |records: &BTreeMap<u16, Vec<u8>>| {
            let records = records.values().cloned();
            records.map(RecordBytes).collect::<Vec<RecordBytes>>()
        };
        [
            (op::SCHEMA, copies(&self.schemas)),
            (op::CHANNEL, copies(&self.channels)),
            (op::STATISTICS, vec![self.statistics()]),
            (
                op::CHUNK_INDEX,
                self.chunks.iter().map(ChunkEntry::index).collect(),
            ),
            (op::ATTACHMENT_INDEX, self.attachments.clone()),
            (op::METADATA_INDEX, self.metadata.clone()),
        ]
    }

    fn statistics(&self) -> RecordBytes {
        let count32 = |count: usize| u32::try_from(count).unwrap_or(u32::MAX);
        let (first, last) = self.times.unwrap_or_default();
        RecordBytes::default()
            .number64(self.messages.values().sum())
            .number16(u16::try_from(self.schemas.len()).unwrap_or(u16::MAX))
            .number32(count32(self.channels.len()))
            .number32(count32(self.attachments.len()))
            .number32(count32(self.metadata.len()))
            .number32(count32(self.chunks.len()))
            .number64(first)
            .number64(last)
            .channel_map(&self.messages)
    }
}

impl ChunkEntry {
    fn index(&self) -> RecordBytes {
        RecordBytes::default()
            .number64(self.times.0)
            .number64(self.times.1)
            .number64(self.place.offset)
            .number64(self.place.length)
            .channel_map(&self.index_offsets)
            .number64(self.index_length)
            .text(&self.compression)
            .number64(self.sizes.0)
            .number64(self.sizes.1)
    }
}
