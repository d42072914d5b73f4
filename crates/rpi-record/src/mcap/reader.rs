//! Reads a recording: its parts, and the requests, events and images in them.
//!
//! The ticks are not kept: they are read again, one by one, whenever they are needed, so that a recording of any length can be
//! replayed.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;
use std::sync::Arc;

use mcap::records::Record;
use rpi_core::Continuity;
use rpi_image::Image;
use rpi_sim::Cell;
use serde_json::Value;

use super::completion::CUT;
use super::error::RecordingError;
use super::own_topics::{EVENTS, IMAGES, REQUESTS, TAPE};
use super::part_source::{PartEnd, PartSource};
use super::parts::{FIRST_PART, part_path};
use super::recorder::{FORM, policy_from_keyword};
use super::{bytes_encoding, text_encoding};

/// Maximum total size in bytes of the requests, events and images of a recording that are loaded into memory.
const MAX_KEPT: usize = 1 << 30;

/// Key of the metadata `rpi` of a recording that was cut out of another one: the number of its first tick. A recording that begins
/// with the run does not have it.
pub(super) const EXCERPT_FROM: &str = "excerpt_from";
/// Key of the metadata `rpi` of a recording that was cut out of another one and ends before it: the number of the tick after its last
/// one.
pub(super) const EXCERPT_TO: &str = "excerpt_to";
/// Key of the metadata `rpi` of a merged recording: the names of the files it was made of.
pub(super) const MERGED: &str = "merged";

/// Ticks of a recording that was cut out of another one; `None` where it begins or ends as the other one does.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub(super) struct Excerpt {
    /// Number of the first tick.
    pub(super) from: Option<u64>,
    /// Number of the tick after the last one.
    pub(super) to: Option<u64>,
}

/// Content of a recording that was opened for a replay. The ticks stay in the files and are read when they are needed.
#[derive(Clone, Debug)]
pub struct Recording {
    /// Tick length in nanoseconds.
    pub tick_ns: u64,
    /// File name of the program that was run.
    pub program: String,
    pub(super) continuity: Continuity,
    pub(super) cell: Cell,
    /// Text of the cell description.
    pub(super) cell_text: String,
    /// Text of the program; `None` if the recording has none.
    pub(super) source: Option<String>,
    pub(super) images: Vec<Arc<Image>>,
    pub(super) requests: Vec<Value>,
    pub(super) events: Vec<Value>,
    /// Number of ticks that are missing in the recording, as stored at its end; 0 if the recording was cut off.
    pub(super) lost: u64,
    /// Reason why the recording has no end, such as a missing file or a killed process. `None` for a complete
    /// recording.
    pub cut: Option<String>,
    /// Whether the images were replaced by ones that export more flows than were recorded.
    pub(super) is_watched: bool,
    /// Version of the elementary functions (sine, logarithm and others) with which the recording was made, as
    /// [`rpi_math::REVISION`] counts them; 0 for those of the library libm, before recordings contained the version.
    pub(super) functions: u32,
    pub(super) parts: Vec<PartSource>,
    /// Profile in the header of the files: `ros2`, or empty.
    pub(super) mcap_profile: String,
    pub(super) excerpt: Excerpt,
}

/// Records of a recording that are loaded into memory: all but the ticks and the messages for viewers.
#[derive(Default)]
struct RecordCollection {
    /// Number of the part (file) that is being read, from 1.
    part: u32,
    /// CRC-32 of the previous part; `None` in the first part.
    previous: Option<u32>,
    /// Topic and message encoding of each channel of the part that is being read, by channel number.
    channels: BTreeMap<u16, (String, String)>,
    metadata: BTreeMap<String, BTreeMap<String, String>>,
    /// Profile in the header of the first part.
    mcap_profile: Option<String>,
    cell: Option<Vec<u8>>,
    /// Content of the program.
    program: Option<Vec<u8>>,
    images: Vec<Arc<Image>>,
    requests: Vec<Value>,
    events: Vec<Value>,
    /// Total size of the messages that were loaded into memory, in bytes.
    size: usize,
}

impl Recording {
    /// Opens a recording. `path` is the file of its first part. Further parts are the files beside it with their number
    /// before the extension.
    ///
    /// # Errors
    /// Returns an error if the file is not a recording, or is damaged.
    pub fn open(path: &Path) -> Result<Recording, RecordingError> {
        Recording::read_parts(|part| {
            let file = part_path(path, part);
            match part == FIRST_PART || file.exists() {
                true => Ok(PartSource::File(file)),
                false => Err(format!("the part {} is missing", file.display())),
            }
        })
    }

    /// Reads a recording of one part from memory.
    ///
    /// # Errors
    /// Returns an error if the bytes are not a recording, or are damaged.
    pub fn read(bytes: &[u8]) -> Result<Recording, RecordingError> {
        Recording::read_parts(|part| match part {
            FIRST_PART => Ok(PartSource::Bytes(bytes.into())),
            _ => Err(format!("part {part} is missing")),
        })
    }

    fn read_parts(
        open: impl Fn(u32) -> Result<PartSource, String>,
    ) -> Result<Recording, RecordingError> {
        let mut kept = RecordCollection::default();
        let mut parts = Vec::new();
        let mut previous = None;
        let mut number = FIRST_PART;
        let end = loop {
            let source = match open(number) {
                Ok(source) => source,
                Err(missing) => break Err(missing),
            };
            let end = kept.read_part(&source, (number, previous))?;
            parts.push(source);
            match end {
                PartEnd::Complete { checksum } => previous = Some(checksum),
                PartEnd::Cut(why) => break Err(why),
            }
            if let Some(why) = kept.cut_reason() {
                break Err(why);
            }
            match kept.next_part()? {
                Some(next) => number = next,
                None => break Ok(()),
            }
        };
        kept.finish(parts, end)
    }

    /// Returns the periods of the commands of the recording in ns, in ascending order.
    #[must_use]
    pub fn periods(&self) -> BTreeSet<u64> {
        self.images.iter().map(|image| image.period_ns).collect()
    }

    /// Returns the largest number of ticks between two cycles of a command of the recording; 1 without commands.
    #[must_use]
    pub fn longest_period(&self) -> u64 {
        let periods = self
            .images
            .iter()
            .map(|image| image.period_ns / self.tick_ns);
        periods.max().unwrap_or(1).max(1)
    }

    /// Returns an error if the recording does not begin with the run, so that the state of the core at its beginning is unknown.
    ///
    /// # Errors
    /// Returns an error with the time of the first tick.
    pub fn check_replayable(&self) -> Result<(), RecordingError> {
        match self.excerpt.from {
            None => Ok(()),
            Some(tick) => Err(RecordingError::Excerpt(tick.saturating_mul(self.tick_ns))),
        }
    }

    /// Returns whether the recording begins with the run, so that it can be replayed.
    #[must_use]
    pub fn is_replayable(&self) -> bool {
        self.excerpt.from.is_none()
    }

    /// Passes the words of each tick of the tick log to `take`, until it returns false.
    ///
    /// # Errors
    /// Returns an error if a file has changed since it was opened, and the errors of `take`.
    pub(super) fn for_each_tick(
        &self,
        mut take: impl FnMut(&[u64]) -> Result<bool, RecordingError>,
    ) -> Result<(), RecordingError> {
        let mut words = Vec::new();
        for part in &self.parts {
            let mut channels = BTreeMap::new();
            let end = part.read(|record| match record {
                Record::Channel(channel) if channel.topic == TAPE => {
                    channels.insert(channel.id, channel.message_encoding);
                    Ok(true)
                }
                Record::Message { header, data } => match channels.get(&header.channel_id) {
                    Some(encoding) => {
                        let bytes = bytes_encoding::decode(encoding, &data);
                        let chunks = bytes.as_chunks().0.iter();
                        words.clear();
                        words.extend(chunks.map(|bytes| u64::from_le_bytes(*bytes)));
                        take(&words)
                    }
                    None => Ok(true),
                },
                _ => Ok(true),
            })?;
            if end.is_none() {
                break;
            }
        }
        Ok(())
    }
}

impl RecordCollection {
    /// Reads the part with the number `part`, which follows the part with the checksum `previous`. Returns how the part
    /// ends.
    fn read_part(
        &mut self,
        source: &PartSource,
        (part, previous): (u32, Option<u32>),
    ) -> Result<PartEnd, RecordingError> {
        (self.part, self.previous) = (part, previous);
        self.channels.clear();
        let before = std::mem::take(&mut self.metadata);
        let end = source.read(|record| self.take(record).map(|()| true))?;
        let end = end.unwrap_or_else(|| PartEnd::Cut("the reading has ended".to_owned()));
        if part > FIRST_PART && self.metadata.is_empty() && matches!(end, PartEnd::Cut(_)) {
            // A later part that was cut off before its head has nothing to replay.
            self.metadata = before;
        }
        self.key("form")?;
        Ok(end)
    }

    fn take(&mut self, record: Record<'_>) -> Result<(), RecordingError> {
        match record {
            Record::Header(header) => {
                self.mcap_profile.get_or_insert(header.profile);
            }
            Record::Channel(channel) => {
                let about = (channel.topic, channel.message_encoding);
                self.channels.insert(channel.id, about);
            }
            Record::Attachment { header, data, .. } if header.name == "cell.toml" => {
                self.cell.get_or_insert(data.into_owned());
            }
            Record::Attachment { header, data, .. } if header.name.starts_with("program/") => {
                self.program.get_or_insert(data.into_owned());
            }
            Record::Metadata(metadata) => {
                let is_head = metadata.name == "rpi";
                self.metadata.insert(metadata.name, metadata.metadata);
                if is_head {
                    self.check_head()?;
                }
            }
            Record::Message { header, data } => {
                if let Some((topic, encoding)) = self.channels.get(&header.channel_id).cloned() {
                    self.take_message(&topic, &encoding, &data)?;
                }
            }
            _ => {}
        }
        Ok(())
    }

    fn take_message(
        &mut self,
        topic: &str,
        encoding: &str,
        data: &[u8],
    ) -> Result<(), RecordingError> {
        match topic {
            REQUESTS => self.requests.push(json(topic, encoding, data)?),
            EVENTS => self.events.push(json(topic, encoding, data)?),
            IMAGES => self.take_image(bytes_encoding::decode(encoding, data))?,
            // Ticks are read when they are replayed. Messages for viewers are not needed for a replay.
            _ => return Ok(()),
        }
        self.size = self.size.saturating_add(data.len());
        match self.size > MAX_KEPT {
            true => Err(RecordingError::TooLarge(MAX_KEPT)),
            false => Ok(()),
        }
    }

    /// Decodes and stores an image. Images must have the number of their message, counted from 0.
    fn take_image(&mut self, data: &[u8]) -> Result<(), RecordingError> {
        let broken = |why: String| RecordingError::Damaged(format!("invalid image: {why}"));
        let (number, bytes) = data
            .split_first_chunk()
            .ok_or_else(|| broken("it has no number".to_owned()))?;
        if u64::from_le_bytes(*number) != self.images.len() as u64 {
            return Err(broken("its number is not the next one".to_owned()));
        }
        let image = Image::from_bytes(bytes).map_err(|error| broken(error.to_string()))?;
        self.images.push(Arc::new(image));
        Ok(())
    }

    /// Returns the value of a key in the metadata of the part that is being read, or an error if the key is missing.
    fn key(&self, name: &str) -> Result<&str, RecordingError> {
        let about = self.metadata.get("rpi");
        let about = about.ok_or_else(|| RecordingError::NotRpi("metadata `rpi`".into()))?;
        let value = about.get(name).map(String::as_str);
        value.ok_or_else(|| RecordingError::Missing(format!("{name} in its metadata")))
    }

    /// Returns an error unless the metadata say that the file is the part that is being read, of a known version, and
    /// follows the previous part.
    fn check_head(&self) -> Result<(), RecordingError> {
        let number = self.part;
        if let Ok(files) = self.key(MERGED) {
            return Err(RecordingError::Merged(files.to_owned()));
        }
        let form = self.key("form")?;
        if form != FORM {
            let version = self.key("version").unwrap_or("?");
            return Err(RecordingError::NotRpi(format!(
                "form {form} of version {version}, this version reads form {FORM}"
            )));
        }
        let own = self.key("part")?;
        if own != number.to_string() {
            return Err(RecordingError::NotRpi(match number {
                FIRST_PART => format!("part {own} of a recording, name the file of its first part"),
                _ => format!("part {own} in place of part {number}"),
            }));
        }
        let sum = self.previous.map(|sum| format!("{sum:08x}"));
        match sum.is_none_or(|sum| self.key("previous") == Ok(&sum)) {
            true => Ok(()),
            false => Err(RecordingError::NotRpi(format!(
                "part {number} belongs to another recording"
            ))),
        }
    }

    /// Returns the reason for which the recording was cut off, if it was [completed](super::complete) afterwards.
    fn cut_reason(&self) -> Option<String> {
        self.metadata.get("rpi-end")?.get(CUT).cloned()
    }

    /// Returns the number of the part that follows the present one; `None` at the end of the recording.
    fn next_part(&self) -> Result<Option<u32>, RecordingError> {
        let end = self.metadata.get("rpi-end");
        let end = end.ok_or_else(|| RecordingError::Missing("end record".into()))?;
        let Some(next) = end.get("continues") else {
            return Ok(None);
        };
        let wrong = || RecordingError::Damaged(format!("`{next}` is not the next part"));
        let next = next.parse().map_err(|_| wrong())?;
        match next == self.part.saturating_add(1) {
            true => Ok(Some(next)),
            false => Err(wrong()),
        }
    }

    fn finish(
        self,
        parts: Vec<PartSource>,
        end: Result<(), String>,
    ) -> Result<Recording, RecordingError> {
        let lost = self.metadata.get("rpi-end").and_then(|end| end.get("lost"));
        let lost = lost.and_then(|lost| lost.parse().ok());
        let lost = match &end {
            Ok(()) => lost.ok_or_else(|| RecordingError::Missing("number of lost ticks".into()))?,
            Err(_) => 0,
        };
        let cell_text = String::from_utf8_lossy(self.cell.as_deref().unwrap_or_default());
        Ok(Recording {
            cell_text: cell_text.into_owned(),
            source: self.program.clone().and_then(|p| String::from_utf8(p).ok()),
            tick_ns: parse_tick_ns(self.key("tick_ns")?)?,
            program: self.key("program")?.to_owned(),
            continuity: policy_from_keyword(self.key("on_jump")?).unwrap_or_default(),
            cell: self.cell()?,
            functions: self.functions_version(),
            excerpt: Excerpt {
                from: self.tick(EXCERPT_FROM)?,
                to: self.tick(EXCERPT_TO)?,
            },
            mcap_profile: self.mcap_profile.unwrap_or_default(),
            images: self.images,
            requests: self.requests,
            events: self.events,
            lost,
            cut: end.err(),
            is_watched: false,
            parts,
        })
    }

    /// Returns the number of a tick in the metadata; `None` without this key.
    fn tick(&self, key: &str) -> Result<Option<u64>, RecordingError> {
        let tick = self.key(key).ok().map(str::parse);
        let wrong = |_| RecordingError::Damaged(format!("`{key}` is no number of a tick"));
        tick.transpose().map_err(wrong)
    }

    fn functions_version(&self) -> u32 {
        let version = self.key("functions").unwrap_or_default();
        version.parse().unwrap_or(0)
    }

    fn cell(&self) -> Result<Cell, RecordingError> {
        let text = self.cell.as_ref();
        let text = text.ok_or_else(|| RecordingError::Missing("cell".into()))?;
        let text = String::from_utf8_lossy(text);
        let broken =
            |errors| RecordingError::Damaged(format!("invalid cell description: {errors}"));
        Cell::parse("cell.toml", &text).map_err(broken)
    }
}

/// Decodes the JSON text in a message of a topic.
pub(super) fn json(topic: &str, encoding: &str, data: &[u8]) -> Result<Value, RecordingError> {
    let text = text_encoding::decode(encoding, data);
    serde_json::from_slice(text).map_err(|e| RecordingError::Damaged(format!("{topic}: {e}")))
}

fn parse_tick_ns(text: &str) -> Result<u64, RecordingError> {
    let number = text.parse().ok().filter(|number| *number > 0);
    number.ok_or_else(|| RecordingError::Damaged(format!("`{text}` is not a valid tick length")))
}
