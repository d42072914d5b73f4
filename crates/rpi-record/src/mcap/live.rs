//! Messages of a run for viewers that are connected while it goes on.

use std::collections::BTreeMap;
use std::sync::Arc;

use super::own_topics::is_exact;
use super::part_writer::EncodedTopic;

/// Topics whose last message a viewer needs whenever it comes to a recording or a run.
pub(super) const LATCHED_TOPICS: [&str; 2] = ["/robot_description", "/tf_static"];

/// Topic of a run for live viewers.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct LiveTopic<'a> {
    /// Name, such as `/joint_states`. No two topics have the same name at the same time.
    pub name: &'a str,
    /// Encoding of the messages: `json`.
    pub encoding: &'a str,
    /// Name of the schema of the messages, its language and its text.
    pub schema_name: &'a str,
    /// Language of the schema: `jsonschema`.
    pub schema_encoding: &'a str,
    /// Text of the schema.
    pub schema: &'a str,
    /// Whether a viewer that comes later gets the last message.
    pub is_latched: bool,
}

/// Receiver of the messages of a run for live viewers. No method blocks: the thread that calls them also writes the recording.
pub trait LiveViewers: Send {
    /// Adds a topic under a number that no other topic has had.
    fn add_topic(&mut self, number: u64, topic: LiveTopic<'_>);

    /// Removes a topic.
    fn remove_topic(&mut self, number: u64);

    /// Returns whether messages of a topic are needed. Others are not encoded.
    fn needs(&self, number: u64) -> bool;

    /// Passes a message of a topic on. `time` is in nanoseconds since the Unix epoch.
    fn message(&mut self, number: u64, time: u64, data: &[u8]);
}

/// The topics of a run and the viewers that get their messages.
pub(super) struct LiveOutput {
    viewers: Box<dyn LiveViewers>,
    /// Topics of the viewers with their numbers, by the address of the topic.
    topics: BTreeMap<usize, (Arc<EncodedTopic>, u64)>,
    next_number: u64,
    /// Whether the messages at the beginning of the run were passed on.
    pub(super) has_begun: bool,
}

impl LiveOutput {
    pub(super) fn new(viewers: Box<dyn LiveViewers>) -> LiveOutput {
        LiveOutput {
            viewers,
            topics: BTreeMap::new(),
            next_number: 1,
            has_begun: false,
        }
    }

    /// Makes the topics of the viewers those of `all`, except the ones for replays. Of several with the same name, the viewers have
    /// the last one, which belongs to the command that was loaded last.
    pub(super) fn set_topics<'t>(&mut self, all: impl Iterator<Item = &'t Arc<EncodedTopic>>) {
        let named: BTreeMap<&str, &Arc<EncodedTopic>> = all
            .filter(|topic| !is_exact(&topic.name))
            .map(|topic| (topic.name.as_str(), topic))
            .collect();
        let wanted: BTreeMap<usize, &Arc<EncodedTopic>> = named
            .into_values()
            .map(|topic| (address(topic), topic))
            .collect();
        let viewers = &mut self.viewers;
        self.topics.retain(|key, (_, number)| {
            let is_wanted = wanted.contains_key(key);
            if !is_wanted {
                viewers.remove_topic(*number);
            }
            is_wanted
        });
        for (key, topic) in wanted {
            if !self.topics.contains_key(&key) {
                viewers.add_topic(self.next_number, live_topic(topic));
                self.topics
                    .insert(key, (Arc::clone(topic), self.next_number));
                self.next_number += 1;
            }
        }
    }

    /// Returns whether a viewer needs the messages of a topic.
    pub(super) fn needs(&self, topic: &Arc<EncodedTopic>) -> bool {
        let known = self.topics.get(&address(topic));
        known.is_some_and(|(_, number)| self.viewers.needs(*number))
    }

    /// Passes a message on. `time` is in nanoseconds since the Unix epoch.
    pub(super) fn write(&mut self, topic: &Arc<EncodedTopic>, time: u64, data: &[u8]) {
        if let Some((_, number)) = self.topics.get(&address(topic)) {
            self.viewers.message(*number, time, data);
        }
    }
}

fn address(topic: &Arc<EncodedTopic>) -> usize {
    Arc::as_ptr(topic).addr()
}

fn live_topic(topic: &EncodedTopic) -> LiveTopic<'_> {
    let encoding = &topic.encoding;
    LiveTopic {
        name: &topic.name,
        encoding: encoding.message,
        schema_name: &encoding.schema_name,
        schema_encoding: encoding.schema_encoding,
        schema: std::str::from_utf8(&encoding.schema).unwrap_or_default(),
        is_latched: LATCHED_TOPICS.contains(&topic.name.as_str()),
    }
}
