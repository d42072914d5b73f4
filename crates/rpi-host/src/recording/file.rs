//! A recording as a file: topics, messages, attachments of MCAP (<https://mcap.dev/spec>).

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::io::{self, Seek, Write};

use mcap::records::{MessageHeader, Metadata};
use mcap::{Attachment, McapError, WriteOptions, Writer};
use serde_json::{Value, json};

/// Where a recording goes.
pub trait Output: Write + Seek + Send {}

impl<T: Write + Seek + Send> Output for T {}

/// The file under way.
pub(super) struct File {
    mcap: Writer<Box<dyn Output>>,
    topics: BTreeMap<String, (u16, u32)>,
}

impl File {
    /// Begins a file. It is not compressed: compression would need a C library, and tools for MCAP compress afterwards.
    pub(super) fn create(out: Box<dyn Output>) -> io::Result<File> {
        let options = WriteOptions::new()
            .compression(None)
            .library(concat!("rpi ", env!("CARGO_PKG_VERSION")));
        Ok(File {
            mcap: options.create(out).map_err(error)?,
            topics: BTreeMap::new(),
        })
    }

    /// Makes a topic of JSON objects with these properties, if there is none of this name.
    pub(super) fn json_topic(&mut self, topic: &str, properties: Value) -> io::Result<()> {
        let schema = json!({ "type": "object", "properties": properties });
        let schema = ("jsonschema", schema.to_string().into_bytes());
        self.topic(topic, "json", schema)
    }

    /// Makes a topic of messages in a form of our own, which a text describes.
    pub(super) fn binary_topic(&mut self, topic: &str, form: &str, text: &str) -> io::Result<()> {
        self.topic(topic, form, (form, text.as_bytes().to_vec()))
    }

    fn topic(&mut self, topic: &str, form: &str, schema: (&str, Vec<u8>)) -> io::Result<()> {
        if self.topics.contains_key(topic) {
            return Ok(());
        }
        let name = format!("rpi{}", topic.replace('/', "."));
        let schema = self.mcap.add_schema(&name, schema.0, &schema.1);
        let schema = schema.map_err(error)?;
        let channel = self.mcap.add_channel(schema, topic, form, &BTreeMap::new());
        let channel = channel.map_err(error)?;
        self.topics.insert(topic.to_owned(), (channel, 0));
        Ok(())
    }

    /// Writes a message; nothing to a topic that was not made.
    pub(super) fn message(&mut self, topic: &str, time: u64, data: &[u8]) -> io::Result<()> {
        let Some((channel_id, sequence)) = self.topics.get_mut(topic) else {
            return Ok(());
        };
        *sequence = sequence.wrapping_add(1);
        let header = MessageHeader {
            channel_id: *channel_id,
            sequence: *sequence,
            log_time: time,
            publish_time: time,
        };
        self.mcap
            .write_to_known_channel(&header, data)
            .map_err(error)
    }

    /// Attaches a file.
    pub(super) fn attach(&mut self, name: &str, media: &str, data: &[u8]) -> io::Result<()> {
        let attachment = Attachment {
            log_time: 0,
            create_time: 0,
            name: name.to_owned(),
            media_type: media.to_owned(),
            data: Cow::Borrowed(data),
        };
        self.mcap.attach(&attachment).map_err(error)
    }

    /// Writes keys with values.
    pub(super) fn metadata(&mut self, name: &str, keys: &[(&str, String)]) -> io::Result<()> {
        let keys = keys.iter().map(|(k, v)| ((*k).to_owned(), v.clone()));
        let metadata = Metadata {
            name: name.to_owned(),
            metadata: keys.collect(),
        };
        self.mcap.write_metadata(&metadata).map_err(error)
    }

    /// Ends the file.
    pub(super) fn finish(mut self) -> io::Result<()> {
        self.mcap.finish().map_err(error)?;
        self.mcap.into_inner().flush()
    }
}

fn error(error: McapError) -> io::Error {
    match error {
        McapError::Io(error) => error,
        other => io::Error::other(other.to_string()),
    }
}
