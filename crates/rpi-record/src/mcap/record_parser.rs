//! Parses the records that a recording needs.
//!
//! The MCAP library reserves memory for a text by its length field before it reads the text, up to 4 GiB. Length fields are
//! therefore checked against the size of the record first.

use mcap::records::{Record, op};

use super::error::RecordingError;

/// Layout of the beginning of an MCAP record, up to its last text. The lengths of its texts are checked by it.
struct TextLayout {
    /// Number of bytes before the first text.
    before: usize,
    /// Number of texts that follow one another, each with a length field.
    texts: usize,
    /// Whether a map from texts to texts follows.
    has_map: bool,
    /// Minimum number of bytes after them, which the library slices without a check.
    after: usize,
}

/// Returns the layout of records with this opcode; `None` for kinds of records that a recording does not need.
fn layout(opcode: u8) -> Option<TextLayout> {
    let layout = |before, texts, has_map, after| TextLayout {
        before,
        texts,
        has_map,
        after,
    };
    match opcode {
        op::HEADER => Some(layout(0, 2, false, 0)),
        // The third text is the schema itself, which may be any bytes.
        op::SCHEMA => Some(layout(2, 3, false, 0)),
        op::CHANNEL => Some(layout(4, 2, true, 0)),
        op::MESSAGE => Some(layout(0, 0, false, 0)),
        // The length of the data and the checksum.
        op::ATTACHMENT => Some(layout(16, 2, false, 8 + 4)),
        op::METADATA => Some(layout(0, 1, true, 0)),
        _ => None,
    }
}

/// Parses the content `data` of an MCAP record; `None` for a kind of record that a recording does not need.
///
/// # Errors
/// Returns an error if the record is damaged.
pub(super) fn parse(opcode: u8, data: &[u8]) -> Result<Option<Record<'_>>, RecordingError> {
    let Some(layout) = layout(opcode) else {
        return Ok(None);
    };
    if !layout.fits(data) {
        let why = "a text in a record is longer than the record";
        return Err(RecordingError::Damaged(why.to_owned()));
    }
    let record = mcap::parse_record(opcode, data);
    let record = record.map_err(|error| RecordingError::Damaged(error.to_string()))?;
    Ok(Some(record))
}

impl TextLayout {
    /// Returns whether all texts lie within the record whose content is `data`.
    fn fits(&self, data: &[u8]) -> bool {
        let Some(mut rest) = data.get(self.before..) else {
            return false;
        };
        let texts = (0..self.texts).all(|_| skip_text(&mut rest).is_some());
        let is_complete = texts && (!self.has_map || skip_map(&mut rest).is_some());
        is_complete && rest.len() >= self.after
    }
}

/// Takes a 32-bit length field and this number of bytes from the beginning of `rest`, and returns the bytes; `None` if
/// `rest` is shorter.
fn take_counted<'a>(rest: &mut &'a [u8]) -> Option<&'a [u8]> {
    let (len, after) = rest.split_first_chunk()?;
    let len = usize::try_from(u32::from_le_bytes(*len)).ok()?;
    let (counted, after) = after.split_at_checked(len)?;
    *rest = after;
    Some(counted)
}

fn skip_text(rest: &mut &[u8]) -> Option<()> {
    take_counted(rest).map(drop)
}

fn skip_map(rest: &mut &[u8]) -> Option<()> {
    let mut entries = take_counted(rest)?;
    while !entries.is_empty() {
        skip_text(&mut entries)?;
    }
    Some(())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A text with its length field.
    fn text(content: &str) -> Vec<u8> {
        let len = u32::try_from(content.len()).unwrap_or(u32::MAX);
        [&len.to_le_bytes(), content.as_bytes()].concat()
    }

    #[test]
    fn a_length_beyond_the_record_is_refused() {
        let (key, value) = (text("form"), text("2"));
        let map_len = u32::try_from(key.len() + value.len()).unwrap_or(0);
        let record = [text("rpi"), map_len.to_le_bytes().to_vec(), key, value].concat();
        assert!(matches!(
            parse(op::METADATA, &record),
            Ok(Some(Record::Metadata(_)))
        ));
        // Each length field in turn: name, map, key, value.
        for at in [0, 7, 11, 19] {
            let mut damaged = record.clone();
            damaged[at + 3] = 0xff;
            assert!(
                parse(op::METADATA, &damaged).is_err(),
                "length field at {at}"
            );
        }
        assert!(parse(op::CHANNEL, &[0; 3]).is_err());
        assert_eq!(
            parse(op::STATISTICS, &[0xff; 20]).map(|found| found.is_none()),
            Ok(true)
        );
        assert!(parse(op::SCHEMA, &[0xff; 20]).is_err());
    }
}
