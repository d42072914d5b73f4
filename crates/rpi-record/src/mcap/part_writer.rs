//! Writes messages to the parts of a recording, and begins the next part when one is full.

use std::collections::BTreeMap;
use std::io;
use std::sync::Arc;

use super::mcap_file::{Encoding, FileChannel, McapFile};
use super::parts::{FIRST_PART, OpenPart, PartLimits};
use super::recorder::RunSources;

/// Maximum number of MCAP channels in one file of a recording. The index of a file stays small, and MCAP has 16-bit
/// channel numbers.
const MAX_CHANNELS: usize = 4096;
/// Interval in nanoseconds after which a chunk is ended even if it is small: the time of which data can be lost if the
/// process is killed.
const CHUNK_INTERVAL: u64 = 1_000_000_000;

/// Topic of a recording with the encoding of its messages. Topics are compared by address, so that they are looked up
/// quickly.
#[derive(Debug)]
pub(super) struct EncodedTopic {
    /// Name of the topic in the MCAP file, such as `/events`.
    pub(super) name: String,
    /// Encoding of the topic's messages, with their schema.
    pub(super) encoding: Encoding,
    /// Metadata of the topic's MCAP channel, such as the ROS 2 quality of service.
    pub(super) metadata: BTreeMap<String, String>,
}

/// Data written at the beginning of every file of a recording: the metadata, the cell and the program.
pub(super) struct PartHead {
    /// Keys and values of the metadata of the recording, such as its version and tick length.
    pub(super) keys: Vec<(&'static str, String)>,
    /// Program and cell description of the recorded run.
    pub(super) origin: RunSources,
    /// MCAP profile of the files: `ros2`, or empty.
    pub(super) profile: &'static str,
}

/// Writer of the files (parts) of a recording. It begins the next file when one is full.
pub(super) struct PartWriter {
    open: OpenPart,
    limits: PartLimits,
    head: PartHead,
    part: u32,
    file: McapFile,
    /// MCAP channels of the current file, by the address of their topic. A channel is added with the first message of
    /// its topic.
    channels: BTreeMap<usize, (Arc<EncodedTopic>, FileChannel)>,
    /// Time of the first tick in the current file, in nanoseconds since the Unix epoch; `None` before it.
    began: Option<u64>,
    flushed: u64,
}

impl PartWriter {
    /// Opens and begins the first file of a recording.
    pub(super) fn begin(
        mut open: OpenPart,
        limits: PartLimits,
        head: PartHead,
    ) -> io::Result<PartWriter> {
        let file = McapFile::create(open(FIRST_PART)?, head.profile)?;
        let mut writer = PartWriter {
            open,
            limits,
            head,
            part: FIRST_PART,
            file,
            channels: BTreeMap::new(),
            began: None,
            flushed: 0,
        };
        writer.write_head(None)?;
        Ok(writer)
    }

    /// Writes metadata and attachments at the beginning of a file. `previous` is the checksum of the previous file;
    /// `None` for the first one.
    fn write_head(&mut self, previous: Option<u32>) -> io::Result<()> {
        let mut keys = self.head.keys.clone();
        keys.push(("part", self.part.to_string()));
        keys.extend(previous.map(|sum| ("previous", format!("{sum:08x}"))));
        self.file.write_metadata("rpi", &keys)?;
        let origin = &self.head.origin;
        self.file
            .attach("cell.toml", "application/toml", origin.cell.as_bytes())?;
        let program = format!("program/{}", origin.program);
        self.file
            .attach(&program, "text/plain", &origin.program_bytes)
    }

    /// Writes a message of a topic. `time` is in nanoseconds since the Unix epoch.
    pub(super) fn write(
        &mut self,
        topic: &Arc<EncodedTopic>,
        time: u64,
        data: &[u8],
    ) -> io::Result<()> {
        let key = Arc::as_ptr(topic).addr();
        if !self.channels.contains_key(&key) {
            let (name, metadata) = (&topic.name, &topic.metadata);
            let channel = self.file.add_channel(name, &topic.encoding, metadata)?;
            // The reference keeps the address from being used for another topic.
            self.channels.insert(key, (Arc::clone(topic), channel));
        }
        match self.channels.get_mut(&key) {
            Some((_, channel)) => self.file.write_message(channel, time, data),
            None => Ok(()),
        }
    }

    /// Ends the current chunk if it is old enough, and begins the next file if this one is full. Called between ticks;
    /// `time` is that of the tick in nanoseconds since the Unix epoch. Returns whether a file begins here, the first
    /// one or another one.
    pub(super) fn end_tick(&mut self, time: u64) -> io::Result<bool> {
        let is_first = self.began.is_none();
        if self.began.is_none() {
            (self.began, self.flushed) = (Some(time), time);
        }
        if time.saturating_sub(self.flushed) >= CHUNK_INTERVAL {
            self.file.flush()?;
            self.flushed = time;
        }
        if self.is_full(time) {
            self.next_part(time)?;
            return Ok(true);
        }
        Ok(is_first)
    }

    fn is_full(&self, time: u64) -> bool {
        let PartLimits { bytes, time: most } = self.limits;
        let age = u128::from(time.saturating_sub(self.began.unwrap_or(time)));
        bytes.is_some_and(|limit| self.file.bytes() >= limit)
            || most.is_some_and(|limit| age >= limit.as_nanos())
            || self.channels.len() >= MAX_CHANNELS
    }

    fn next_part(&mut self, time: u64) -> io::Result<()> {
        self.part += 1;
        let out = (self.open)(self.part)?;
        let next = McapFile::create(out, self.head.profile)?;
        let mut last = std::mem::replace(&mut self.file, next);
        last.write_metadata("rpi-end", &[("continues", self.part.to_string())])?;
        let checksum = last.finish()?;
        self.channels.clear();
        (self.began, self.flushed) = (Some(time), time);
        self.write_head(Some(checksum))
    }

    /// Ends the recording and its last file. `end` has the keys and values of the metadata at the end of the recording.
    pub(super) fn finish(mut self, end: &[(&str, String)]) -> io::Result<()> {
        self.file.write_metadata("rpi-end", end)?;
        self.file.finish().map(drop)
    }
}
