//! Reads a recording file.

use std::collections::BTreeMap;
use std::sync::Arc;

use mcap::read::ChunkFlattener;
use mcap::records::Record;
use rpi_core::Continuity;
use rpi_image::Image;
use rpi_sim::Cell;
use serde_json::Value;

use super::checksum;
use super::error::RecordingError;
use super::recorder::policy_from_keyword;
use super::writer::{EVENTS, REQUESTS, TAPE};

/// Content of a recording: cell, images, requests, events and the logged words of each tick.
#[derive(Debug)]
pub struct Recording {
    /// Tick length in nanoseconds.
    pub tick_ns: u64,
    /// File name of the recorded program.
    pub program: String,
    pub(super) continuity: Continuity,
    pub(super) cell: Cell,
    pub(super) images: Vec<Arc<Image>>,
    pub(super) requests: Vec<Value>,
    pub(super) events: Vec<Value>,
    /// Logged words of each tick: the values of the sensors, flows and set-points.
    pub(super) ticks: Vec<Vec<u64>>,
    /// Number of lost ticks, from the `rpi-end` metadata.
    pub(super) lost: u64,
}

/// Records of an MCAP file, sorted by kind.
#[derive(Default)]
struct McapRecords {
    topics: BTreeMap<u16, String>,
    attachments: BTreeMap<String, Vec<u8>>,
    metadata: BTreeMap<String, BTreeMap<String, String>>,
    /// Message data by topic.
    messages: BTreeMap<String, Vec<Vec<u8>>>,
}

impl Recording {
    /// Reads a recording.
    ///
    /// # Errors
    /// Returns an error if the bytes are not a complete recording.
    pub fn read(bytes: &[u8]) -> Result<Recording, RecordingError> {
        let mut parts = McapRecords::read(bytes)?;
        let about = parts.metadata.remove("rpi");
        let about = about.ok_or_else(|| RecordingError::NotRpi("metadata `rpi`".into()))?;
        let key = |name: &str| {
            let value = about.get(name).cloned();
            value.ok_or_else(|| RecordingError::Missing(format!("{name} in its metadata")))
        };
        if key("form")? != "1" {
            return Err(RecordingError::NotRpi(format!("form {}", key("form")?)));
        }
        // A file without its end record may lack the last ticks and events.
        let end = parts.metadata.get("rpi-end").and_then(|m| m.get("lost"));
        let lost = end.and_then(|lost| lost.parse().ok());
        Ok(Recording {
            tick_ns: parse_tick_ns(&key("tick_ns")?)?,
            program: key("program")?,
            continuity: policy_from_keyword(&key("on_jump")?).unwrap_or_default(),
            cell: parts.cell()?,
            images: parts.images()?,
            requests: parts.json(REQUESTS)?,
            events: parts.json(EVENTS)?,
            ticks: parts.ticks(),
            lost: lost
                .ok_or_else(|| RecordingError::Damaged("the end record is missing".into()))?,
        })
    }
}

fn parse_tick_ns(text: &str) -> Result<u64, RecordingError> {
    let number = text.parse().ok().filter(|number| *number > 0);
    number.ok_or_else(|| RecordingError::Damaged(format!("`{text}` is not a valid tick length")))
}

impl McapRecords {
    fn read(bytes: &[u8]) -> Result<McapRecords, RecordingError> {
        let broken = |error: mcap::McapError| RecordingError::Damaged(error.to_string());
        let mut parts = McapRecords::default();
        checksum::verify(bytes).map_err(|why| RecordingError::Damaged(why.to_owned()))?;
        for record in ChunkFlattener::new(bytes).map_err(broken)? {
            parts.add_record(record.map_err(broken)?);
        }
        Ok(parts)
    }

    fn add_record(&mut self, record: Record<'_>) {
        match record {
            Record::Channel(channel) => {
                self.topics.insert(channel.id, channel.topic);
            }
            Record::Attachment { header, data, .. } => {
                self.attachments.insert(header.name, data.into_owned());
            }
            Record::Metadata(metadata) => {
                self.metadata.insert(metadata.name, metadata.metadata);
            }
            Record::Message { header, data } => {
                let topic = self.topics.get(&header.channel_id);
                // Messages for viewers are not needed for a replay.
                if let Some(topic) =
                    topic.filter(|t| [TAPE, REQUESTS, EVENTS].contains(&t.as_str()))
                {
                    let messages = self.messages.entry(topic.clone()).or_default();
                    messages.push(data.into_owned());
                }
            }
            _ => {}
        }
    }

    fn cell(&self) -> Result<Cell, RecordingError> {
        let text = self.attachments.get("cell.toml");
        let text = text.ok_or_else(|| RecordingError::Missing("cell".into()))?;
        let text = String::from_utf8_lossy(text);
        let broken =
            |errors| RecordingError::Damaged(format!("invalid cell description: {errors}"));
        Cell::parse("cell.toml", &text).map_err(broken)
    }

    fn images(&self) -> Result<Vec<Arc<Image>>, RecordingError> {
        let images = self.attachments.range("images/".to_owned()..);
        let images = images.take_while(|(name, _)| name.starts_with("images/"));
        let broken = |error| RecordingError::Damaged(format!("invalid image: {error}"));
        images
            .map(|(_, bytes)| Image::from_bytes(bytes).map(Arc::new).map_err(broken))
            .collect()
    }

    fn json(&self, topic: &str) -> Result<Vec<Value>, RecordingError> {
        let messages = self.messages.get(topic).into_iter().flatten();
        let broken = |error| RecordingError::Damaged(format!("{topic}: {error}"));
        messages
            .map(|data| serde_json::from_slice(data).map_err(broken))
            .collect()
    }

    fn ticks(&mut self) -> Vec<Vec<u64>> {
        let word = |bytes: &[u8]| {
            let bytes = bytes.try_into().unwrap_or_default();
            u64::from_le_bytes(bytes)
        };
        let messages = self.messages.remove(TAPE).unwrap_or_default();
        messages
            .iter()
            .map(|data| data.chunks_exact(8).map(word).collect())
            .collect()
    }
}
