//! Topics with the exact content of a recording, from which `rpi replay` replays it.

use std::collections::BTreeMap;
use std::sync::Arc;

use rpi_image::Image;
use serde_json::{Value, json};

use super::mcap_file::Encoding;
use super::part_writer::EncodedTopic;
use super::profile::Profile;
use super::{bytes_encoding, text_encoding};

/// Topic with the tick log: the exchange with the devices and the sampled values of every tick, bit for bit.
pub(super) const TAPE: &str = "/rpi/tape";
/// Topic with the images of the commands.
pub(super) const IMAGES: &str = "/rpi/images";
/// Topic with the requests to the core.
pub(super) const REQUESTS: &str = "/rpi/requests";
/// Topic with the events of the core, the devices and the recorder.
pub(super) const EVENTS: &str = "/events";

/// Beginning of the topics from which a recording is replayed.
const EXACT_TOPICS: &str = "/rpi/";

/// Returns whether a topic is for replays, and not for viewers.
pub(super) fn is_exact(topic: &str) -> bool {
    topic.starts_with(EXACT_TOPICS)
}

/// Name of the binary format in which the tick log of one tick is stored as a message.
const TAPE_FORMAT: &str = "rpi-tape-1";
/// Documentation of the binary format of the tick log. It is stored in every recording as the schema of the topic.
const TAPE_FORMAT_DOC: &str = include_str!("form.txt");
/// Name of the binary format in which the image of a command is stored as a message.
const IMAGE_FORMAT: &str = "rpi-image-1";
const IMAGE_FORMAT_DOC: &str = "\
A compiled command: its number in the recording (64 bits, little-endian), then the content of a file .rpib.
";

/// Encoder of the messages from which a recording can be replayed: ticks, images, requests and events.
pub(super) struct OwnTopics {
    profile: Profile,
    tick_log: Arc<EncodedTopic>,
    images: Arc<EncodedTopic>,
    requests: Arc<EncodedTopic>,
    events: Arc<EncodedTopic>,
}

impl OwnTopics {
    pub(super) fn new(profile: Profile) -> OwnTopics {
        let ticket = json!({ "ticket": { "type": "integer" }, "ask": { "type": "string" } });
        let event = json!({ "tick": { "type": "integer" }, "event": { "type": "string" } });
        let text = |name: &str, fields: &Value| {
            topic(name, text_encoding::encoding(profile, name, fields))
        };
        let bytes =
            |name: &str, format, doc| topic(name, bytes_encoding::encoding(profile, format, doc));
        OwnTopics {
            profile,
            tick_log: bytes(TAPE, TAPE_FORMAT, TAPE_FORMAT_DOC),
            images: bytes(IMAGES, IMAGE_FORMAT, IMAGE_FORMAT_DOC),
            requests: text(REQUESTS, &ticket),
            events: text(EVENTS, &event),
        }
    }

    /// Returns the topics that viewers show, too: the events.
    pub(super) fn for_viewers(&self) -> impl Iterator<Item = &Arc<EncodedTopic>> {
        std::iter::once(&self.events)
    }

    /// Encodes a request to the core, given as JSON. Returns its topic and the message data.
    pub(super) fn request(&self, request: &Value) -> (&Arc<EncodedTopic>, Vec<u8>) {
        let text = request.to_string();
        (&self.requests, text_encoding::encode(self.profile, &text))
    }

    /// Encodes an event, given as JSON. Returns its topic and the message data.
    pub(super) fn event(&self, event: &Value) -> (&Arc<EncodedTopic>, Vec<u8>) {
        let text = event.to_string();
        (&self.events, text_encoding::encode(self.profile, &text))
    }

    /// Encodes the image of a command with its number in the recording. Returns its topic and the message data.
    pub(super) fn image(&self, number: usize, image: &Image) -> (&Arc<EncodedTopic>, Vec<u8>) {
        let mut bytes = (number as u64).to_le_bytes().to_vec();
        bytes.extend(image.to_bytes());
        (&self.images, bytes_encoding::encode(self.profile, bytes))
    }

    /// Encodes the words of one tick of the tick log. Returns its topic and the message data.
    pub(super) fn tick(&self, words: &[u64]) -> (&Arc<EncodedTopic>, Vec<u8>) {
        let bytes = words.iter().flat_map(|word| word.to_le_bytes()).collect();
        (&self.tick_log, bytes_encoding::encode(self.profile, bytes))
    }
}

fn topic(name: &str, encoding: Encoding) -> Arc<EncodedTopic> {
    Arc::new(EncodedTopic {
        name: name.to_owned(),
        encoding,
        metadata: BTreeMap::new(),
    })
}
