//! Puts the messages of several recordings into one file, on one time axis, for viewers.

use std::collections::{BTreeMap, BTreeSet};

use mcap::records::Record;

use super::channels::{CopyWriter, SourceChannels};
use super::message_reader::MessageReader;
use crate::mcap::error::RecordingError;
use crate::mcap::mcap_file::Output;
use crate::mcap::own_topics::{TAPE, is_exact};
use crate::mcap::reader::{MERGED, Recording};
use crate::mcap::recorder::FORM;

/// Common time axis of merged recordings.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub enum TimeAxis {
    /// The wall clock of each recording.
    #[default]
    WallClock,
    /// All recordings begin at the time at which the first one begins.
    Start,
}

/// What a merged recording has.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct MergedRecording {
    /// Number of messages.
    pub messages: u64,
    /// New names of the topics that several recordings have, in ascending order.
    pub renamed: Vec<String>,
}

/// What is known about a recording before its messages are copied.
struct MergeSource<'r> {
    name: &'r str,
    recording: &'r Recording,
    /// Name with which clashing topics, metadata and attachments begin.
    prefix: String,
    /// Topics for viewers.
    topics: BTreeSet<String>,
    /// Time of the first tick in nanoseconds since the Unix epoch.
    start: u64,
}

/// Writes the messages of several recordings, given with the names of their files, side by side by the times of their cycles. The messages of
/// each recording keep their order. Topics that several
/// recordings have get the name of the file as first part of their names.
///
/// # Errors
/// Returns an error if a recording is damaged or has changed since it was opened, and the errors of the output.
pub fn merge(
    recordings: &[(String, Recording)],
    axis: TimeAxis,
    out: impl Output + 'static,
) -> Result<MergedRecording, RecordingError> {
    let mut profiles = recordings.iter().map(|(_, r)| r.mcap_profile.as_str());
    let first = profiles.next().unwrap_or_default();
    let profile = if profiles.all(|other| other == first) {
        first
    } else {
        ""
    };
    let mut writer = CopyWriter::create(Box::new(out), profile)?;
    let names: Vec<&str> = recordings.iter().map(|(name, _)| name.as_str()).collect();
    let keys = [
        ("form", FORM.to_owned()),
        (MERGED, names.join(", ")),
        ("part", "1".to_owned()),
        ("version", env!("CARGO_PKG_VERSION").to_owned()),
    ];
    writer.write_metadata("rpi", &keys)?;
    let sources = sources(recordings)?;
    for source in &sources {
        copy_about(source, &mut writer)?;
    }
    let mut renamed = Vec::new();
    let mut readers = Vec::new();
    for source in &sources {
        let names = new_names(source, &sources);
        renamed.extend(names.values().cloned());
        let reader = MessageReader::new(source.recording, SourceChannels::renamed(names));
        let shift = match axis {
            TimeAxis::WallClock => 0,
            TimeAxis::Start => i128::from(sources[0].start) - i128::from(source.start),
        };
        readers.push((reader, shift));
    }
    renamed.sort();
    let messages = copy_messages(&mut readers, &mut writer)?;
    writer.write_metadata("rpi-end", &[("messages", messages.to_string())])?;
    writer.finish()?;
    Ok(MergedRecording { messages, renamed })
}

/// Copies the messages of all readers, always those of the earliest cycle. Each reader has the shift of its times in nanoseconds. Returns
/// the number of messages.
fn copy_messages(
    readers: &mut [(MessageReader, i128)],
    writer: &mut CopyWriter,
) -> Result<u64, RecordingError> {
    let mut count = 0;
    loop {
        let mut earliest: Option<(i128, usize)> = None;
        for (k, (reader, shift)) in readers.iter_mut().enumerate() {
            let next = reader.peek()?;
            let next = next.map(|message| (i128::from(message.position) + *shift, k));
            earliest = [earliest, next].into_iter().flatten().min();
        }
        let Some((_, k)) = earliest else {
            return Ok(count);
        };
        let (reader, shift) = &mut readers[k];
        let Some(message) = reader.pop() else {
            return Ok(count);
        };
        let shifted = |time: u64| u64::try_from(i128::from(time) + *shift).unwrap_or_default();
        let times = (shifted(message.times.0), shifted(message.times.1));
        let channel = reader.channels.get(message.channel);
        if let Some(channel) = channel.filter(|c| !is_exact(&c.channel.topic)) {
            writer.write(channel, times, &message.data)?;
            count += 1;
        }
    }
}

/// Returns what is known about each recording.
fn sources(recordings: &[(String, Recording)]) -> Result<Vec<MergeSource<'_>>, RecordingError> {
    let mut sources = Vec::new();
    for (name, recording) in recordings {
        let (topics, start) = scan(recording)?;
        sources.push(MergeSource {
            name,
            recording,
            prefix: String::new(),
            topics,
            start,
        });
    }
    let all: BTreeSet<String> = sources.iter().flat_map(|s| s.topics.clone()).collect();
    let mut taken = BTreeSet::new();
    for source in &mut sources {
        source.prefix = prefix(source.name, |prefix| {
            let begins = format!("/{prefix}/");
            taken.contains(prefix) || all.iter().any(|topic| topic.starts_with(&begins))
        });
        taken.insert(source.prefix.clone());
    }
    Ok(sources)
}

/// Returns the topics of a recording for viewers, and the time of its first tick.
fn scan(recording: &Recording) -> Result<(BTreeSet<String>, u64), RecordingError> {
    let mut topics = BTreeSet::new();
    let mut start = None;
    for part in &recording.parts {
        let mut ticks = BTreeSet::new();
        part.read(|record| {
            match record {
                Record::Channel(channel) if channel.topic == TAPE => {
                    ticks.insert(channel.id);
                }
                Record::Channel(channel) if !is_exact(&channel.topic) => {
                    topics.insert(channel.topic);
                }
                Record::Message { header, .. } if ticks.contains(&header.channel_id) => {
                    start.get_or_insert(header.log_time);
                }
                _ => {}
            }
            Ok(true)
        })?;
    }
    Ok((topics, start.unwrap_or_default()))
}

/// Copies the metadata and attachments of the first part of a recording, with the name of its file before theirs.
fn copy_about(source: &MergeSource<'_>, writer: &mut CopyWriter) -> Result<(), RecordingError> {
    let prefix = &source.prefix;
    let first = source.recording.parts.iter().take(1);
    for part in first {
        part.read(|record| {
            match record {
                Record::Metadata(metadata) => {
                    let keys = metadata.metadata.iter();
                    let keys: Vec<(&str, String)> = keys
                        .map(|(key, value)| (key.as_str(), value.clone()))
                        .collect();
                    writer.write_metadata(&format!("{prefix}/{}", metadata.name), &keys)?;
                }
                Record::Attachment { header, data, .. } => {
                    let name = format!("{prefix}/{}", header.name);
                    writer.attach((&name, &header.media_type), &data)?;
                }
                _ => {}
            }
            Ok(true)
        })?;
    }
    Ok(())
}

/// Returns the new names of the topics of a recording that another one has, too.
fn new_names(source: &MergeSource<'_>, sources: &[MergeSource<'_>]) -> BTreeMap<String, String> {
    let others = || sources.iter().filter(|other| other.prefix != source.prefix);
    let clashes = source
        .topics
        .iter()
        .filter(|topic| others().any(|other| other.topics.contains(*topic)));
    clashes
        .map(|topic| (topic.clone(), format!("/{}{topic}", source.prefix)))
        .collect()
}

/// Returns the name of a file as a part of the name of a topic, as ROS 2 allows it: letters, digits and `_`, not beginning with a
/// digit. It ends in a number if `is_taken` returns true for it without one.
fn prefix(name: &str, is_taken: impl Fn(&str) -> bool) -> String {
    let allowed = |c: char| if c.is_ascii_alphanumeric() { c } else { '_' };
    let mut own: String = name.chars().map(allowed).collect();
    if own.starts_with(|c: char| !c.is_ascii_alphabetic()) {
        own.insert_str(0, "run_");
    }
    let numbered = (2_u64..).map(|k| format!("{own}_{k}"));
    let mut names = std::iter::once(own.clone()).chain(numbered);
    names.find(|name| !is_taken(name)).unwrap_or(own)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_prefix_is_part_of_a_name_in_ros_2() {
        assert_eq!(prefix("left-arm", |_| false), "left_arm");
        assert_eq!(prefix("2026 run", |_| false), "run_2026_run");
        assert_eq!(prefix("", |_| false), "");
        assert_eq!(prefix("out", |name| name == "out"), "out_2");
        assert_eq!(
            prefix("out", |name| ["out", "out_2"].contains(&name)),
            "out_3"
        );
    }
}
