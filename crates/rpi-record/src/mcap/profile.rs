//! Profiles of recordings: the encodings that different viewers read.

use serde_json::Value;

use super::mcap_file::Encoding;
use super::ros2::topic_message::MessageLayout;
use super::topic::Topic;

/// Encoding of the messages of a recording for a kind of viewer. The content that `rpi replay` reads is the same in
/// each.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub enum Profile {
    /// JSON objects with a schema for flows and ports, which any viewer of MCAP can read.
    #[default]
    Json,
    /// ROS 2 messages in the encoding CDR, including the topics `/joint_states`, `/tf`, `/robot_description`, `/rosout`
    /// and `/diagnostics`.
    Ros2,
    /// JSON objects with a schema for flows and ports; transforms and log in the schemas of the viewer Foxglove.
    Foxglove,
}

impl Profile {
    /// All profiles with their names in options.
    pub const ALL: [(&'static str, Profile); 3] = [
        ("json", Profile::Json),
        ("ros2", Profile::Ros2),
        ("foxglove", Profile::Foxglove),
    ];

    /// Returns the profile with a name; `None` for an unknown name.
    #[must_use]
    pub fn from_name(name: &str) -> Option<Profile> {
        let found = Profile::ALL.iter().find(|(own, _)| *own == name);
        found.map(|(_, profile)| *profile)
    }

    /// Returns the name of the profile in the header of an MCAP file; empty for profiles without a name in MCAP.
    pub(super) fn mcap_name(self) -> &'static str {
        match self {
            Profile::Ros2 => "ros2",
            Profile::Json | Profile::Foxglove => "",
        }
    }
}

/// Encoder of the messages of one topic with flows or ports, in the profile of the recording.
#[derive(Clone, Debug)]
pub(super) enum TopicEncoder {
    Json,
    Ros2(MessageLayout),
}

impl TopicEncoder {
    pub(super) fn new(profile: Profile, topic: &Topic) -> TopicEncoder {
        match profile {
            Profile::Json | Profile::Foxglove => TopicEncoder::Json,
            Profile::Ros2 => TopicEncoder::Ros2(MessageLayout::of(topic)),
        }
    }

    /// Returns the encoding of the messages of a topic, with their schema.
    pub(super) fn encoding(&self, topic: &Topic) -> Encoding {
        match self {
            TopicEncoder::Json => json_encoding(&topic.name, &topic.json_schema()),
            TopicEncoder::Ros2(layout) => ros2_encoding(layout.full_name(), layout.schema()),
        }
    }

    /// Encodes the values of the fields of a topic in one cycle as a message. `time` is in nanoseconds since the Unix
    /// epoch, `cycle` is the number of the cycle; each value holds memory words, `None` is an absent value.
    pub(super) fn encode(
        &self,
        topic: &Topic,
        (time, cycle): (u64, u64),
        values: &[Option<&[u64]>],
    ) -> Vec<u8> {
        match self {
            TopicEncoder::Json => topic.to_json(cycle, values).into_bytes(),
            TopicEncoder::Ros2(layout) => layout.encode((time, cycle), values),
        }
    }
}

/// Returns the encoding of a topic whose messages are JSON objects. The schema is named after the topic.
pub(super) fn json_encoding(topic: &str, schema: &Value) -> Encoding {
    Encoding {
        message: "json",
        schema_name: format!("rpi{}", topic.replace('/', ".")),
        schema_encoding: "jsonschema",
        schema: schema.to_string().into_bytes(),
    }
}

/// Returns the encoding of a ROS 2 message type, given by its full name and its definition.
pub(super) fn ros2_encoding(full_name: String, schema: String) -> Encoding {
    Encoding {
        message: "cdr",
        schema_name: full_name,
        schema_encoding: "ros2msg",
        schema: schema.into_bytes(),
    }
}
