//! Position in the frames of a websocket (RFC 6455, section 5.2): their length is known before memory is made for them.

use std::io::Cursor;

use tungstenite::protocol::frame::FrameHeader;
use tungstenite::protocol::frame::coding::OpCode;

/// Length in bytes of the part of a head that every frame has.
const FIRST_BYTES: usize = 2;
/// Flag in the second byte of a head: the payload has a mask of four bytes.
const MASKED: u8 = 0x80;

/// Position in the frames that a client sends.
#[derive(Default)]
pub(super) struct FramePosition {
    /// Bytes of an incomplete head.
    head: Vec<u8>,
    /// Number of bytes of the payload that were not read yet.
    payload_left: u64,
}

impl FramePosition {
    /// Returns the maximum number of bytes to read next, at least 1. More could be a part of the next frame.
    pub(super) fn most(&self) -> usize {
        match self.payload_left {
            0 => head_bytes(&self.head) - self.head.len(),
            left => usize::try_from(left).unwrap_or(usize::MAX),
        }
    }

    /// Advances by the bytes that were read, at most [`FramePosition::most`]. Returns the length of the payload if they
    /// complete the head of a data frame.
    pub(super) fn advance(&mut self, bytes: &[u8]) -> Option<u64> {
        if self.payload_left > 0 {
            self.payload_left = self.payload_left.saturating_sub(bytes.len() as u64);
            return None;
        }
        self.head.extend_from_slice(bytes);
        if self.head.len() < head_bytes(&self.head) {
            return None;
        }
        // An invalid head is an error of the library, which reads the same bytes.
        let parsed = FrameHeader::parse(&mut Cursor::new(&self.head))
            .ok()
            .flatten();
        self.head.clear();
        let (head, length) = parsed?;
        self.payload_left = length;
        matches!(head.opcode, OpCode::Data(_)).then_some(length)
    }
}

/// Returns the length in bytes of the head that begins with these bytes, as far as they show it.
fn head_bytes(beginning: &[u8]) -> usize {
    let Some(second) = beginning.get(1) else {
        return FIRST_BYTES;
    };
    let length = match second & !MASKED {
        126 => 2,
        127 => 8,
        _ => 0,
    };
    let mask = if second & MASKED == 0 { 0 } else { 4 };
    FIRST_BYTES + length + mask
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Reads bytes as far as the position allows in each step. Returns the lengths of data frames, and the place of each
    /// step.
    fn read(mut bytes: &[u8]) -> (Vec<u64>, usize) {
        let (mut position, mut lengths, mut steps) = (FramePosition::default(), Vec::new(), 0);
        while !bytes.is_empty() {
            let (now, later) = bytes.split_at(position.most().min(bytes.len()));
            lengths.extend(position.advance(now));
            (bytes, steps) = (later, steps + 1);
        }
        (lengths, steps)
    }

    #[test]
    fn the_length_of_each_data_frame_is_known_from_its_head() {
        let long = [&[0x82, 126, 1, 0], &[7; 256][..]].concat();
        let masked = [0x81, 0x82, 1, 2, 3, 4, 5, 6];
        let ping = [0x89, 0x01, 9];
        let parts = [0x01, 0x01, b'x', 0x80, 0x00];
        let all = [&long[..], &ping, &masked, &parts, &ping].concat();
        assert_eq!(read(&all).0, [256, 2, 1, 0]);
        let huge = [0x81, 127, 0, 0, 1, 0, 0, 0, 0, 0, 7];
        assert_eq!(read(&huge).0, [1 << 40]);
    }

    #[test]
    fn no_read_crosses_the_end_of_a_frame() {
        let frames = [0x81, 0x01, b'x', 0x81, 0x00, 0x89, 0x00];
        assert_eq!(read(&frames).1, 4);
        let mut byte_by_byte = FramePosition::default();
        let lengths: Vec<u64> = frames
            .iter()
            .filter_map(|byte| byte_by_byte.advance(&[*byte]))
            .collect();
        assert_eq!(lengths, [1, 0]);
    }
}
