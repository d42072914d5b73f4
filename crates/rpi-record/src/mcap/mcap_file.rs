//! One file of a recording: channels, messages and attachments in MCAP (<https://mcap.dev/spec>).

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::io::{self, Write};
use std::sync::{Arc, Mutex, PoisonError};

use crc32fast::Hasher;
use mcap::records::{MessageHeader, Metadata};
use mcap::write::NoSeek;
use mcap::{Attachment, Compression, McapError, WriteOptions, Writer};

/// Destination of the bytes of one file of a recording, such as a file or a buffer.
pub trait Output: Write + Send {}

impl<T: Write + Send> Output for T {}

/// Encoding of the messages of an MCAP channel, with the schema that describes them.
#[derive(Clone, Debug)]
pub(super) struct Encoding {
    /// Encoding of the messages: `json`, `cdr` (ROS 2) or the name of a binary format of this project.
    pub(super) message: &'static str,
    /// Name of the schema in the MCAP file.
    pub(super) schema_name: String,
    /// Language of the schema: `jsonschema`, `ros2msg` or the name of a binary format of this project.
    pub(super) schema_encoding: &'static str,
    /// Text of the schema, in its language.
    pub(super) schema: Vec<u8>,
}

/// Channel of another MCAP file, whose messages are copied.
#[derive(Clone, PartialEq, Eq, Debug, Default)]
pub(super) struct CopiedChannel {
    /// Name of the topic.
    pub(super) topic: String,
    /// Encoding of the messages, such as `json` or `cdr`.
    pub(super) message_encoding: String,
    /// Metadata of the channel, such as the ROS 2 quality of service.
    pub(super) metadata: BTreeMap<String, String>,
    /// Name, language and text of the schema; `None` for a channel without one.
    pub(super) schema: Option<(String, String, Vec<u8>)>,
}

/// MCAP channel of a file: its number in the file and the number of its last message.
#[derive(Clone, Copy, Debug)]
pub(super) struct FileChannel {
    id: u16,
    sequence: u32,
}

/// Writer of an MCAP file, one part of a recording.
///
/// The output is never positioned: a chunk is written when it is complete. A file that was cut off is therefore
/// readable up to the last chunk.
pub(super) struct McapFile {
    mcap: Writer<NoSeek<CountingOutput>>,
    progress: Arc<Mutex<Progress>>,
}

/// Number of bytes that have been written to an output, with their checksum and the first error.
#[derive(Default)]
struct Progress {
    bytes: u64,
    checksum: Hasher,
    /// First error of the output. The MCAP writer wraps errors in different ways, so the original is stored here.
    error: Option<io::Error>,
}

/// Output that counts the bytes written to it and stores their checksum and its first error.
struct CountingOutput {
    out: Box<dyn Output>,
    progress: Arc<Mutex<Progress>>,
}

fn lock(progress: &Mutex<Progress>) -> std::sync::MutexGuard<'_, Progress> {
    progress.lock().unwrap_or_else(PoisonError::into_inner)
}

impl FileChannel {
    /// Returns the number of the channel in its file.
    pub(super) fn id(self) -> u16 {
        self.id
    }
}

impl CountingOutput {
    /// Stores the error in `done` if it is the first one of the output, and returns the result with a copy of the
    /// error.
    fn note<T>(&self, done: io::Result<T>) -> io::Result<T> {
        done.map_err(|error| {
            let alike = io::Error::new(error.kind(), error.to_string());
            if error.kind() != io::ErrorKind::Interrupted {
                lock(&self.progress).error.get_or_insert(error);
            }
            alike
        })
    }
}

impl Write for CountingOutput {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let written = self.out.write(bytes);
        let written = self.note(written)?;
        let mut progress = lock(&self.progress);
        progress.bytes += written as u64;
        progress.checksum.update(&bytes[..written]);
        Ok(written)
    }

    fn flush(&mut self) -> io::Result<()> {
        let flushed = self.out.flush();
        self.note(flushed)
    }
}

impl McapFile {
    /// Creates a writer to an output, and writes the header. `profile` is the MCAP profile: `ros2`, or empty.
    pub(super) fn create(out: Box<dyn Output>, profile: &str) -> io::Result<McapFile> {
        let options = WriteOptions::new()
            .compression(Some(Compression::Zstd))
            // The fastest level: higher ones save little, because the numbers of a motion have no structure.
            .compression_level(1)
            // No further threads, which would take processor time from the cycle.
            .compression_threads(0)
            .profile(profile)
            .disable_seeking(true)
            .library(concat!("rpi ", env!("CARGO_PKG_VERSION")));
        let progress = Arc::<Mutex<Progress>>::default();
        let out = CountingOutput {
            out,
            progress: Arc::clone(&progress),
        };
        match options.create(NoSeek::new(out)) {
            Ok(mcap) => Ok(McapFile { mcap, progress }),
            Err(error) => Err(io_error(&progress, error)),
        }
    }

    fn check<T>(&self, done: Result<T, McapError>) -> io::Result<T> {
        done.map_err(|error| io_error(&self.progress, error))
    }

    /// Adds a channel for the messages of a topic, with its schema and metadata.
    pub(super) fn add_channel(
        &mut self,
        topic: &str,
        encoding: &Encoding,
        metadata: &BTreeMap<String, String>,
    ) -> io::Result<FileChannel> {
        let (name, language) = (&encoding.schema_name, encoding.schema_encoding);
        let schema = self.mcap.add_schema(name, language, &encoding.schema);
        let schema = self.check(schema)?;
        let channel = self
            .mcap
            .add_channel(schema, topic, encoding.message, metadata);
        let id = self.check(channel)?;
        Ok(FileChannel { id, sequence: 0 })
    }

    /// Adds a channel like that of another file, with its schema and metadata.
    pub(super) fn add_copied_channel(
        &mut self,
        channel: &CopiedChannel,
    ) -> io::Result<FileChannel> {
        let schema = match &channel.schema {
            Some((name, language, text)) => {
                let schema = self.mcap.add_schema(name, language, text);
                self.check(schema)?
            }
            // The number that MCAP reserves for channels without a schema.
            None => 0,
        };
        let CopiedChannel {
            topic,
            message_encoding,
            metadata,
            ..
        } = channel;
        let id = self
            .mcap
            .add_channel(schema, topic, message_encoding, metadata);
        let id = self.check(id)?;
        Ok(FileChannel { id, sequence: 0 })
    }

    /// Writes a message to a channel. `time` is in nanoseconds since the Unix epoch.
    pub(super) fn write_message(
        &mut self,
        channel: &mut FileChannel,
        time: u64,
        data: &[u8],
    ) -> io::Result<()> {
        self.write_message_at(channel, (time, time), data)
    }

    /// Writes a message to a channel. The times at which it was recorded and published are in nanoseconds since the Unix
    /// epoch.
    pub(super) fn write_message_at(
        &mut self,
        channel: &mut FileChannel,
        (log_time, publish_time): (u64, u64),
        data: &[u8],
    ) -> io::Result<()> {
        channel.sequence = channel.sequence.wrapping_add(1);
        let header = MessageHeader {
            channel_id: channel.id,
            sequence: channel.sequence,
            log_time,
            publish_time,
        };
        let written = self.mcap.write_to_known_channel(&header, data);
        self.check(written)
    }

    /// Writes an attachment: data with a name and a media type.
    pub(super) fn attach(&mut self, name: &str, media: &str, data: &[u8]) -> io::Result<()> {
        let attachment = Attachment {
            log_time: 0,
            create_time: 0,
            name: name.to_owned(),
            media_type: media.to_owned(),
            data: Cow::Borrowed(data),
        };
        let written = self.mcap.attach(&attachment);
        self.check(written)
    }

    /// Writes a metadata record with this name, which has pairs of keys and values.
    pub(super) fn write_metadata(&mut self, name: &str, keys: &[(&str, String)]) -> io::Result<()> {
        let keys = keys.iter().map(|(k, v)| ((*k).to_owned(), v.clone()));
        let metadata = Metadata {
            name: name.to_owned(),
            metadata: keys.collect(),
        };
        let written = self.mcap.write_metadata(&metadata);
        self.check(written)
    }

    /// Ends the current chunk. Everything up to here can be read even if the process is killed.
    pub(super) fn flush(&mut self) -> io::Result<()> {
        let flushed = self.mcap.flush();
        self.check(flushed)
    }

    /// Returns the number of bytes written to the output. Messages of the unfinished chunk do not count.
    pub(super) fn bytes(&self) -> u64 {
        lock(&self.progress).bytes
    }

    /// Writes the summary and the footer of the file and flushes the output. Returns the CRC-32 of the whole file.
    pub(super) fn finish(mut self) -> io::Result<u32> {
        let finished = self.mcap.finish();
        self.check(finished)?;
        self.mcap.into_inner().into_inner().flush()?;
        let progress = lock(&self.progress);
        Ok(progress.checksum.clone().finalize())
    }
}

/// Returns the original error of the output if there was one, otherwise the error of the MCAP writer as an I/O error.
fn io_error(progress: &Mutex<Progress>, error: McapError) -> io::Error {
    let kept = lock(progress).error.take();
    kept.unwrap_or_else(|| match error {
        McapError::Io(error) => error,
        other => io::Error::other(other.to_string()),
    })
}
