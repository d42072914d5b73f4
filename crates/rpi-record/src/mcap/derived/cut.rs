//! Copies a part of a recording to a recording of its own.

use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;

use mcap::records::{Metadata, Record};
use serde_json::Value;

use super::channels::{CopyWriter, MessageTimes, SourceChannel, SourceChannels, SourceMessage};
use super::cut_selection::CutSelection;
use super::cut_window::{CutWindow, Place, logged};
use crate::mcap::completion::CUT;
use crate::mcap::error::RecordingError;
use crate::mcap::live::LATCHED_TOPICS;
use crate::mcap::mcap_file::{CopiedChannel, Output};
use crate::mcap::own_topics::{EVENTS, IMAGES, REQUESTS, TAPE};
use crate::mcap::profile::Profile;
use crate::mcap::reader::{EXCERPT_FROM, EXCERPT_TO, Recording, json};
use crate::mcap::{bytes_encoding, text_encoding};

/// What a recording has that was cut out of another one.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct CutRecording {
    /// Number of the first tick and number of the tick after the last one.
    pub ticks: Range<u64>,
    /// Whether it begins with the run, so that it can be replayed.
    pub is_replayable: bool,
}

/// Writes the ticks whose numbers are in the range `ticks` to a recording of its own, with all messages of these ticks. Messages
/// from before which readers need are moved to its beginning: images and loads of commands that exist there, the starts of those
/// that run, and the last messages of latched topics.
///
/// # Errors
/// Returns an error if the recording has no ticks in this range, if one of its files is damaged or has changed since it was opened,
/// and the errors of the output.
pub fn cut(
    recording: &Recording,
    ticks: &Range<u64>,
    out: impl Output + 'static,
) -> Result<CutRecording, RecordingError> {
    let window = CutWindow::find(recording, ticks)?;
    let mut cutter = Cutter {
        selection: CutSelection::new(recording, &window),
        writer: CopyWriter::create(Box::new(out), &recording.mcap_profile)?,
        latched: Some(BTreeMap::new()),
        copied: BTreeSet::new(),
        position: None,
        window,
    };
    for part in &recording.parts {
        let mut channels = SourceChannels::default();
        part.read(|record| cutter.take(record, &mut channels).map(|()| true))?;
    }
    cutter.finish(recording)
}

/// Last message of a latched topic.
struct LatchedMessage {
    channel: CopiedChannel,
    /// Time at which it was published, in nanoseconds since the Unix epoch.
    published: u64,
    data: Vec<u8>,
}

/// Copying of a part of a recording.
struct Cutter {
    window: CutWindow,
    selection: CutSelection,
    writer: CopyWriter,
    /// Last messages of latched topics before the cut, by topic; `None` once they were written.
    latched: Option<BTreeMap<String, LatchedMessage>>,
    /// Names of the metadata and attachments that were copied. Each part of a recording repeats them.
    copied: BTreeSet<String>,
    /// Number and time of the latest tick in the files.
    position: Option<(u64, u64)>,
}

impl Cutter {
    fn take(
        &mut self,
        record: Record<'_>,
        channels: &mut SourceChannels,
    ) -> Result<(), RecordingError> {
        match record {
            Record::Metadata(metadata) => self.copy_metadata(metadata),
            Record::Attachment { header, data, .. } => {
                match self.copied.insert(format!("attachment {}", header.name)) {
                    true => self
                        .writer
                        .attach((&header.name, &header.media_type), &data),
                    false => Ok(()),
                }
            }
            other => {
                let Some(message) = channels.take(other) else {
                    return Ok(());
                };
                match channels.get(message.channel) {
                    Some(channel) => self.copy_message(channel, message),
                    None => Ok(()),
                }
            }
        }
    }

    /// Copies metadata. Those at the beginning of the recording get the ticks of the cut.
    fn copy_metadata(&mut self, metadata: Metadata) -> Result<(), RecordingError> {
        let is_head = metadata.name == "rpi";
        if metadata.name == "rpi-end" || !self.copied.insert(format!("metadata {}", metadata.name))
        {
            return Ok(());
        }
        let mut keys = metadata.metadata;
        if is_head {
            let ticks = &self.window.ticks;
            if self.window.is_late {
                keys.insert(EXCERPT_FROM.to_owned(), ticks.start.to_string());
            }
            if self.window.is_early {
                keys.insert(EXCERPT_TO.to_owned(), ticks.end.to_string());
            }
        }
        let keys: Vec<(&str, String)> = keys
            .iter()
            .map(|(key, value)| (key.as_str(), value.clone()))
            .collect();
        self.writer.write_metadata(&metadata.name, &keys)
    }

    fn copy_message(
        &mut self,
        channel: &mut SourceChannel,
        message: SourceMessage<'_>,
    ) -> Result<(), RecordingError> {
        let encoding = channel.channel.message_encoding.clone();
        let profile = match encoding.as_str() {
            "cdr" => Profile::Ros2,
            _ => Profile::Json,
        };
        let SourceMessage { times, data, .. } = message;
        match channel.channel.topic.as_str() {
            IMAGES => match self.renumbered(bytes_encoding::decode(&encoding, &data)) {
                Some(image) => self.write(channel, times, &bytes_encoding::encode(profile, image)),
                None => Ok(()),
            },
            REQUESTS => match self.selection.request(json(REQUESTS, &encoding, &data)?) {
                Some(request) => {
                    let text = text_encoding::encode(profile, &request.to_string());
                    self.write(channel, times, &text)
                }
                None => Ok(()),
            },
            EVENTS => match self.keeps_event(&json(EVENTS, &encoding, &data)?) {
                true => self.write(channel, times, &data),
                false => Ok(()),
            },
            TAPE => {
                let bytes = bytes_encoding::decode(&encoding, &data);
                let words = bytes.as_chunks().0.iter();
                let words: Vec<u64> = words.map(|bytes| u64::from_le_bytes(*bytes)).collect();
                let number = logged(&words)?.number;
                self.position = Some((number, times.0));
                let place = self.window.place_of_tick(number);
                self.copy_placed(place, channel, times, &data)
            }
            _ => self.copy_placed(self.place(times.0), channel, times, &data),
        }
    }

    /// Returns the place of a message by its time. The clock may have been set between two ticks: a message with the time of the
    /// latest tick belongs to it.
    fn place(&self, time: u64) -> Place {
        match self.position.filter(|(_, latest)| *latest == time) {
            Some((tick, _)) => self.window.place_of_tick(tick),
            None => self.window.place_of_time(time),
        }
    }

    fn copy_placed(
        &mut self,
        place: Place,
        channel: &mut SourceChannel,
        times: MessageTimes,
        data: &[u8],
    ) -> Result<(), RecordingError> {
        match (place, &mut self.latched) {
            (Place::Within, _) => {
                self.write_latched()?;
                self.write(channel, times, data)
            }
            (Place::Before, Some(latched)) if is_latched(&channel.channel) => {
                let message = LatchedMessage {
                    channel: channel.channel.clone(),
                    published: times.1,
                    data: data.to_vec(),
                };
                latched.insert(message.channel.topic.clone(), message);
                Ok(())
            }
            _ => Ok(()),
        }
    }

    /// Writes a message. One from before the cut gets the time of its beginning, so that the time of the file begins there.
    fn write(
        &mut self,
        channel: &mut SourceChannel,
        times: MessageTimes,
        data: &[u8],
    ) -> Result<(), RecordingError> {
        let log_time = times.0.max(self.window.times.start);
        self.writer.write(channel, (log_time, times.1), data)
    }

    /// Writes the last messages of latched topics before the cut.
    fn write_latched(&mut self) -> Result<(), RecordingError> {
        let start = self.window.times.start;
        for message in self
            .latched
            .take()
            .into_iter()
            .flat_map(BTreeMap::into_values)
        {
            let times = (start, message.published);
            self.writer
                .write_held(&message.channel, times, &message.data)?;
        }
        Ok(())
    }

    /// Returns an image with its new number; `None` if it is left out.
    fn renumbered(&self, image: &[u8]) -> Option<Vec<u8>> {
        let (number, content) = image.split_first_chunk()?;
        let number = self.selection.image(u64::from_le_bytes(*number))?;
        Some([&number.to_le_bytes(), content].concat())
    }

    fn keeps_event(&self, event: &Value) -> bool {
        let tick = event["tick"].as_u64().unwrap_or_default();
        match self.window.place_of_tick(tick) {
            Place::Within => true,
            Place::Before => self.selection.is_start_of_running(event),
            // The end of the core has events after the last tick.
            Place::After => !self.window.is_early,
        }
    }

    fn finish(mut self, recording: &Recording) -> Result<CutRecording, RecordingError> {
        let window = self.window;
        let mut end = vec![
            ("ticks", window.count.to_string()),
            ("lost", window.lost.to_string()),
        ];
        if let Some(why) = recording.cut.as_ref().filter(|_| !window.is_early) {
            end.push((CUT, why.clone()));
        }
        self.writer.write_metadata("rpi-end", &end)?;
        self.writer.finish()?;
        Ok(CutRecording {
            is_replayable: !window.is_late,
            ticks: window.ticks,
        })
    }
}

/// Returns whether a viewer needs the last message of a channel whenever it comes to a recording: by the name of the topic, or by its
/// quality of service in ROS 2.
fn is_latched(channel: &CopiedChannel) -> bool {
    let quality = channel.metadata.get("offered_qos_profiles");
    LATCHED_TOPICS.contains(&channel.topic.as_str())
        || quality.is_some_and(|quality| {
            // As a number in older versions of ROS 2, by name in newer ones.
            ["durability: 1", "durability: transient_local"]
                .iter()
                .any(|latched| quality.contains(latched))
        })
}
