//! Encoding of bytes that only this crate reads: as they are, or as the bytes of a ROS 2 message.

use super::mcap_file::Encoding;
use super::profile::{Profile, ros2_encoding};
use super::ros2::cdr::CdrWriter;

/// Returns the encoding (message format and schema) of a topic whose messages are bytes in the binary format `format`
/// of this project. `text` documents the format and becomes the schema.
pub(super) fn encoding(profile: Profile, format: &'static str, text: &str) -> Encoding {
    match profile {
        Profile::Json | Profile::Foxglove => Encoding {
            message: format,
            schema_name: format.to_owned(),
            schema_encoding: format,
            schema: text.as_bytes().to_vec(),
        },
        Profile::Ros2 => {
            let comment = text.lines().map(|line| format!("# {line}\n"));
            let schema: String = comment.chain(["uint8[] data\n".to_owned()]).collect();
            ros2_encoding("rpi_msgs/msg/Bytes".to_owned(), schema)
        }
    }
}

/// Encodes bytes as a message of a topic: unchanged, or as the bytes of a ROS 2 message.
pub(super) fn encode(profile: Profile, bytes: Vec<u8>) -> Vec<u8> {
    match profile {
        Profile::Json | Profile::Foxglove => bytes,
        Profile::Ros2 => {
            let mut cdr = CdrWriter::new();
            cdr.len(bytes.len());
            let mut message = cdr.finish();
            message.extend(bytes);
            message
        }
    }
}

/// Returns the bytes in a message of a topic; the inverse of [`encode`]. `message_encoding` is the encoding of the
/// message's channel: `cdr` for ROS 2, else a format with the plain bytes.
pub(super) fn decode<'a>(message_encoding: &str, data: &'a [u8]) -> &'a [u8] {
    match message_encoding {
        // Header (4) and length (4).
        "cdr" => data.get(8..).unwrap_or(&[]),
        _ => data,
    }
}
