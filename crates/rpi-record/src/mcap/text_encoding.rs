//! Encoding of JSON texts: as they are, or as the text of a ROS 2 `std_msgs/String`.

use serde_json::{Value, json};

use super::mcap_file::Encoding;
use super::profile::{Profile, json_encoding, ros2_encoding};
use super::ros2::cdr::CdrWriter;
use super::ros2::definitions;

/// Returns the encoding of a topic whose messages are JSON texts: JSON objects with these properties, or ROS 2 strings.
pub(super) fn encoding(profile: Profile, topic: &str, properties: &Value) -> Encoding {
    match profile {
        Profile::Json | Profile::Foxglove => json_encoding(
            topic,
            &json!({ "type": "object", "properties": properties }),
        ),
        Profile::Ros2 => {
            let name = "std_msgs/String";
            ros2_encoding(definitions::full_name(name), definitions::schema(name))
        }
    }
}

/// Encodes a JSON text as a message of a topic: unchanged, or as a ROS 2 string.
pub(super) fn encode(profile: Profile, text: &str) -> Vec<u8> {
    match profile {
        Profile::Json | Profile::Foxglove => text.as_bytes().to_vec(),
        Profile::Ros2 => {
            let mut cdr = CdrWriter::new();
            cdr.string(text);
            cdr.finish()
        }
    }
}

/// Returns the JSON text in a message of a topic; the inverse of [`encode`]. `message_encoding` is the encoding of the
/// message's channel: `cdr` for ROS 2, else plain text.
pub(super) fn decode<'a>(message_encoding: &str, data: &'a [u8]) -> &'a [u8] {
    match message_encoding {
        // Header (4), length (4), text, final zero.
        "cdr" => {
            let text = data.get(8..).unwrap_or(&[]);
            text.strip_suffix(&[0]).unwrap_or(text)
        }
        _ => data,
    }
}
