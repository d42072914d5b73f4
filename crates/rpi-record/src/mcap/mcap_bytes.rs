//! Encoding of MCAP records that the MCAP library writes only at the end of its own files
//! (<https://mcap.dev/spec>): the index of a file that another process began.

use std::collections::BTreeMap;

/// Content of an MCAP record, in the order of its fields.
#[derive(Clone, PartialEq, Eq, Debug, Default)]
pub(super) struct RecordBytes(pub(super) Vec<u8>);

impl RecordBytes {
    pub(super) fn number8(mut self, number: u8) -> RecordBytes {
        self.0.push(number);
        self
    }

    pub(super) fn number16(mut self, number: u16) -> RecordBytes {
        self.0.extend(number.to_le_bytes());
        self
    }

    pub(super) fn number32(mut self, number: u32) -> RecordBytes {
        self.0.extend(number.to_le_bytes());
        self
    }

    pub(super) fn number64(mut self, number: u64) -> RecordBytes {
        self.0.extend(number.to_le_bytes());
        self
    }

    /// Adds bytes with their number before them. The number is 32 bits wide, and so the bytes of a recording are fewer.
    pub(super) fn counted(mut self, bytes: &[u8]) -> RecordBytes {
        let count = u32::try_from(bytes.len()).unwrap_or(u32::MAX);
        self.0.extend(count.to_le_bytes());
        self.0.extend(bytes);
        self
    }

    pub(super) fn text(self, text: &str) -> RecordBytes {
        self.counted(text.as_bytes())
    }

    /// Adds a map from channels to numbers.
    pub(super) fn channel_map(self, map: &BTreeMap<u16, u64>) -> RecordBytes {
        let entry = |entries: RecordBytes, (channel, number): (&u16, &u64)| {
            entries.number16(*channel).number64(*number)
        };
        let entries = map.iter().fold(RecordBytes::default(), entry);
        self.counted(&entries.0)
    }

    /// Returns the whole record: opcode, length and content.
    pub(super) fn record(self, opcode: u8) -> Vec<u8> {
        let head = RecordBytes::default()
            .number8(opcode)
            .number64(self.0.len() as u64);
        [head.0, self.0].concat()
    }
}

/// Takes a little-endian number from the beginning of `rest`; `None` if `rest` is shorter.
pub(super) fn take_u16(rest: &mut &[u8]) -> Option<u16> {
    let (number, after) = rest.split_first_chunk()?;
    *rest = after;
    Some(u16::from_le_bytes(*number))
}

/// Takes a little-endian number from the beginning of `rest`; `None` if `rest` is shorter.
pub(super) fn take_u32(rest: &mut &[u8]) -> Option<u32> {
    let (number, after) = rest.split_first_chunk()?;
    *rest = after;
    Some(u32::from_le_bytes(*number))
}

/// Takes a little-endian number from the beginning of `rest`; `None` if `rest` is shorter.
pub(super) fn take_u64(rest: &mut &[u8]) -> Option<u64> {
    let (number, after) = rest.split_first_chunk()?;
    *rest = after;
    Some(u64::from_le_bytes(*number))
}

/// Takes a text with its length from the beginning of `rest`; `None` if `rest` is shorter or not UTF-8.
pub(super) fn take_text<'a>(rest: &mut &'a [u8]) -> Option<&'a str> {
    let length = usize::try_from(take_u32(rest)?).ok()?;
    let (text, after) = rest.split_at_checked(length)?;
    *rest = after;
    std::str::from_utf8(text).ok()
}
