//! Reads the messages of a recording one by one, when they are needed.

use std::collections::VecDeque;

use mcap::records::Record;

use super::channels::{MessageTimes, SourceChannels};
use crate::mcap::error::RecordingError;
use crate::mcap::own_topics::TAPE;
use crate::mcap::part_source::PartSource;
use crate::mcap::reader::Recording;
use crate::mcap::record_reader::RecordReader;

/// Message that was read and not taken yet.
pub(super) struct QueuedMessage {
    /// Number of its channel in the file that is being read.
    pub(super) channel: u16,
    pub(super) times: MessageTimes,
    /// Time of the latest tick before it, by which recordings are put side by side: events are written up to a second before or after
    /// their cycle.
    pub(super) position: u64,
    pub(super) data: Vec<u8>,
}

/// Reader of the messages of a recording, which was verified when it was opened. It holds one chunk.
pub(super) struct MessageReader {
    /// Files that were not read yet.
    parts: VecDeque<PartSource>,
    is_cut: bool,
    file: Option<RecordReader>,
    pub(super) channels: SourceChannels,
    queue: VecDeque<QueuedMessage>,
    /// Time of the latest tick that was read; `None` before the first one.
    position: Option<u64>,
}

impl MessageReader {
    pub(super) fn new(recording: &Recording, channels: SourceChannels) -> MessageReader {
        MessageReader {
            parts: recording.parts.iter().cloned().collect(),
            is_cut: recording.cut.is_some(),
            file: None,
            channels,
            queue: VecDeque::new(),
            position: None,
        }
    }

    /// Returns the next message without taking it; `None` at the end.
    ///
    /// # Errors
    /// Returns an error if a file cannot be read or is damaged.
    pub(super) fn peek(&mut self) -> Result<Option<&QueuedMessage>, RecordingError> {
        while self.queue.is_empty() && self.fill()? {}
        Ok(self.queue.front())
    }

    /// Takes the message that [`MessageReader::peek`] has returned.
    pub(super) fn pop(&mut self) -> Option<QueuedMessage> {
        self.queue.pop_front()
    }

    /// Reads the next record. Returns false at the end of the last file.
    fn fill(&mut self) -> Result<bool, RecordingError> {
        let file = match &mut self.file {
            Some(file) => file,
            closed => match self.parts.pop_front() {
                Some(part) => {
                    self.channels.begin_file();
                    closed.insert(RecordReader::open(&part, 0, self.is_cut)?)
                }
                None => return Ok(false),
            },
        };
        let (channels, queue) = (&mut self.channels, &mut self.queue);
        let position = &mut self.position;
        let offset = file.next(|record| queue_message(record, channels, queue, position))?;
        if offset.is_none() {
            self.file = None;
        }
        Ok(true)
    }
}

fn queue_message(
    record: Record<'_>,
    channels: &mut SourceChannels,
    queue: &mut VecDeque<QueuedMessage>,
    position: &mut Option<u64>,
) {
    if let Some(message) = channels.take(record) {
        let channel = channels.get(message.channel);
        if channel.is_some_and(|channel| channel.channel.topic == TAPE) {
            *position = Some(message.times.0);
        }
        queue.push_back(QueuedMessage {
            channel: message.channel,
            times: message.times,
            position: position.unwrap_or(message.times.0),
            data: message.data.into_owned(),
        });
    }
}
