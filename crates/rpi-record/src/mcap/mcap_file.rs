//! Recording file: topics, messages and attachments in MCAP (<https://mcap.dev/spec>).

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::io::{self, Seek, SeekFrom, Write};
use std::sync::{Arc, Mutex, PoisonError};

use mcap::records::{MessageHeader, Metadata};
use mcap::{Attachment, McapError, WriteOptions, Writer};
use serde_json::{Value, json};

/// Destination of a recording: a file or buffer that can be written and positioned.
pub trait Output: Write + Seek + Send {}

impl<T: Write + Seek + Send> Output for T {}

/// An MCAP file that is being written.
pub(super) struct McapFile {
    mcap: Writer<ErrorTrackingOutput>,
    /// First write error of the output.
    first_error: FirstError,
    topics: BTreeMap<String, (u16, u32)>,
}

/// First I/O error of the output. The MCAP writer wraps I/O errors in different ways, so the original is kept here.
#[derive(Clone, Default)]
struct FirstError(Arc<Mutex<Option<io::Error>>>);

impl FirstError {
    /// Stores the first error and returns a copy of it.
    fn store<T>(&self, done: io::Result<T>) -> io::Result<T> {
        done.map_err(|error| {
            let mut kept = self.0.lock().unwrap_or_else(PoisonError::into_inner);
            let alike = io::Error::new(error.kind(), error.to_string());
            if error.kind() != io::ErrorKind::Interrupted {
                kept.get_or_insert(error);
            }
            alike
        })
    }

    /// Returns the stored error of the output, if any, and otherwise the error of the MCAP writer.
    fn as_io_error(&self, error: McapError) -> io::Error {
        let kept = self.0.lock().unwrap_or_else(PoisonError::into_inner).take();
        kept.unwrap_or_else(|| match error {
            McapError::Io(error) => error,
            other => io::Error::other(other.to_string()),
        })
    }
}

/// Output that stores the first error of the writer below it.
struct ErrorTrackingOutput {
    out: Box<dyn Output>,
    first_error: FirstError,
}

impl Write for ErrorTrackingOutput {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.first_error.store(self.out.write(bytes))
    }

    fn flush(&mut self) -> io::Result<()> {
        self.first_error.store(self.out.flush())
    }
}

impl Seek for ErrorTrackingOutput {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        self.first_error.store(self.out.seek(to))
    }
}

impl McapFile {
    /// Creates a recording file.
    ///
    /// The file is not compressed: compression would require a C library, and MCAP tools can compress it later.
    pub(super) fn create(out: Box<dyn Output>) -> io::Result<McapFile> {
        let options = WriteOptions::new()
            .compression(None)
            .library(concat!("rpi ", env!("CARGO_PKG_VERSION")));
        let first_error = FirstError::default();
        let out = ErrorTrackingOutput {
            out,
            first_error: first_error.clone(),
        };
        let mcap = options.create(out);
        Ok(McapFile {
            mcap: mcap.map_err(|error| first_error.as_io_error(error))?,
            first_error,
            topics: BTreeMap::new(),
        })
    }

    /// Adds a topic of JSON objects with these properties, unless the topic exists.
    pub(super) fn add_json_topic(&mut self, topic: &str, properties: Value) -> io::Result<()> {
        let schema = json!({ "type": "object", "properties": properties });
        let schema = ("jsonschema", schema.to_string().into_bytes());
        self.add_topic(topic, "json", schema)
    }

    /// Adds a topic of messages in an RPI-specific binary format. `text` documents the format.
    pub(super) fn add_binary_topic(
        &mut self,
        topic: &str,
        form: &str,
        text: &str,
    ) -> io::Result<()> {
        self.add_topic(topic, form, (form, text.as_bytes().to_vec()))
    }

    fn add_topic(&mut self, topic: &str, form: &str, schema: (&str, Vec<u8>)) -> io::Result<()> {
        if self.topics.contains_key(topic) {
            return Ok(());
        }
        let name = format!("rpi{}", topic.replace('/', "."));
        let schema = self.mcap.add_schema(&name, schema.0, &schema.1);
        let schema = schema.map_err(|error| self.first_error.as_io_error(error))?;
        let channel = self.mcap.add_channel(schema, topic, form, &BTreeMap::new());
        let channel = channel.map_err(|error| self.first_error.as_io_error(error))?;
        self.topics.insert(topic.to_owned(), (channel, 0));
        Ok(())
    }

    /// Writes a message. Messages to unknown topics are dropped.
    pub(super) fn write_message(&mut self, topic: &str, time: u64, data: &[u8]) -> io::Result<()> {
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
        let written = self.mcap.write_to_known_channel(&header, data);
        written.map_err(|error| self.first_error.as_io_error(error))
    }

    /// Writes an attachment.
    pub(super) fn attach(&mut self, name: &str, media: &str, data: &[u8]) -> io::Result<()> {
        let attachment = Attachment {
            log_time: 0,
            create_time: 0,
            name: name.to_owned(),
            media_type: media.to_owned(),
            data: Cow::Borrowed(data),
        };
        let written = self.mcap.attach(&attachment);
        written.map_err(|error| self.first_error.as_io_error(error))
    }

    /// Writes a metadata record.
    pub(super) fn write_metadata(&mut self, name: &str, keys: &[(&str, String)]) -> io::Result<()> {
        let keys = keys.iter().map(|(k, v)| ((*k).to_owned(), v.clone()));
        let metadata = Metadata {
            name: name.to_owned(),
            metadata: keys.collect(),
        };
        let written = self.mcap.write_metadata(&metadata);
        written.map_err(|error| self.first_error.as_io_error(error))
    }

    /// Writes the summary and footer and flushes the output.
    pub(super) fn finish(mut self) -> io::Result<()> {
        let finished = self.mcap.finish();
        finished.map_err(|error| self.first_error.as_io_error(error))?;
        self.mcap.into_inner().flush()
    }
}
