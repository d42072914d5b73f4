//! Channels of the files that are copied from, and the file that the copies go to.

use std::borrow::Cow;
use std::collections::BTreeMap;

use mcap::records::Record;

use crate::mcap::error::RecordingError;
use crate::mcap::mcap_file::{CopiedChannel, FileChannel, McapFile, Output};

/// Times of a message in nanoseconds since the Unix epoch: when it was recorded, and when it was published.
pub(super) type MessageTimes = (u64, u64);

/// Channel of a file that is copied from.
pub(super) struct SourceChannel {
    pub(super) channel: CopiedChannel,
    /// Number of the channel in the new file, once a message of it was written.
    output: Option<u16>,
}

/// Message of a file that is copied from.
pub(super) struct SourceMessage<'a> {
    /// Number of the channel in the source.
    pub(super) channel: u16,
    pub(super) times: MessageTimes,
    pub(super) data: Cow<'a, [u8]>,
}

/// Schemas and channels of the file that is being read.
#[derive(Default)]
pub(super) struct SourceChannels {
    schemas: BTreeMap<u16, (String, String, Vec<u8>)>,
    channels: BTreeMap<u16, SourceChannel>,
    /// New names of topics, by their names in the source.
    names: BTreeMap<String, String>,
}

impl SourceChannels {
    /// Creates an empty table. `names` has the new names of topics, by their names in the source.
    pub(super) fn renamed(names: BTreeMap<String, String>) -> SourceChannels {
        SourceChannels {
            names,
            ..SourceChannels::default()
        }
    }

    /// Forgets the channels, because another file begins.
    pub(super) fn begin_file(&mut self) {
        self.schemas.clear();
        self.channels.clear();
    }

    /// Stores a schema or a channel, or returns a message.
    pub(super) fn take<'a>(&mut self, record: Record<'a>) -> Option<SourceMessage<'a>> {
        match record {
            Record::Schema { header, data } => {
                let schema = (header.name, header.encoding, data.into_owned());
                self.schemas.insert(header.id, schema);
                None
            }
            Record::Channel(channel) => {
                let name = self.names.get(&channel.topic);
                let copied = CopiedChannel {
                    topic: name.cloned().unwrap_or(channel.topic),
                    message_encoding: channel.message_encoding,
                    metadata: channel.metadata,
                    schema: self.schemas.get(&channel.schema_id).cloned(),
                };
                let known = self.channels.entry(channel.id);
                // The specification allows a channel to be repeated.
                known.or_insert(SourceChannel {
                    channel: copied,
                    output: None,
                });
                None
            }
            Record::Message { header, data } => Some(SourceMessage {
                channel: header.channel_id,
                times: (header.log_time, header.publish_time),
                data,
            }),
            _ => None,
        }
    }

    /// Returns the channel with a number; `None` if the file has none.
    pub(super) fn get(&mut self, number: u16) -> Option<&mut SourceChannel> {
        self.channels.get_mut(&number)
    }
}

/// File that gets copies of messages.
pub(super) struct CopyWriter {
    pub(super) file: McapFile,
    /// Channels of the file, by number.
    channels: BTreeMap<u16, FileChannel>,
}

impl CopyWriter {
    /// Creates the file. `profile` is the MCAP profile: `ros2`, or empty.
    pub(super) fn create(
        out: Box<dyn Output>,
        profile: &str,
    ) -> Result<CopyWriter, RecordingError> {
        let file = McapFile::create(out, profile).map_err(unwritable)?;
        Ok(CopyWriter {
            file,
            channels: BTreeMap::new(),
        })
    }

    /// Writes a message of a channel of a source. The file gets the channel with the first message.
    pub(super) fn write(
        &mut self,
        source: &mut SourceChannel,
        times: MessageTimes,
        data: &[u8],
    ) -> Result<(), RecordingError> {
        let number = match source.output {
            Some(number) => number,
            None => *source.output.insert(self.add_channel(&source.channel)?),
        };
        self.write_numbered(number, times, data)
    }

    /// Writes a message of a channel that is not in the file that is being read any more.
    pub(super) fn write_held(
        &mut self,
        channel: &CopiedChannel,
        times: MessageTimes,
        data: &[u8],
    ) -> Result<(), RecordingError> {
        let number = self.add_channel(channel)?;
        self.write_numbered(number, times, data)
    }

    /// Writes metadata with a name.
    pub(super) fn write_metadata(
        &mut self,
        name: &str,
        keys: &[(&str, String)],
    ) -> Result<(), RecordingError> {
        self.file.write_metadata(name, keys).map_err(unwritable)
    }

    /// Writes an attachment with a name and a media type.
    pub(super) fn attach(
        &mut self,
        (name, media): (&str, &str),
        data: &[u8],
    ) -> Result<(), RecordingError> {
        self.file.attach(name, media, data).map_err(unwritable)
    }

    /// Writes the end of the file.
    pub(super) fn finish(self) -> Result<(), RecordingError> {
        self.file.finish().map(drop).map_err(unwritable)
    }

    /// Returns the number of the channel in the file, which is the same for equal channels of several sources.
    fn add_channel(&mut self, channel: &CopiedChannel) -> Result<u16, RecordingError> {
        let added = self.file.add_copied_channel(channel).map_err(unwritable)?;
        self.channels.entry(added.id()).or_insert(added);
        Ok(added.id())
    }

    fn write_numbered(
        &mut self,
        number: u16,
        times: MessageTimes,
        data: &[u8],
    ) -> Result<(), RecordingError> {
        match self.channels.get_mut(&number) {
            Some(channel) => {
                let written = self.file.write_message_at(channel, times, data);
                written.map_err(unwritable)
            }
            None => Ok(()),
        }
    }
}

fn unwritable(error: std::io::Error) -> RecordingError {
    RecordingError::Unwritable(error.to_string())
}
