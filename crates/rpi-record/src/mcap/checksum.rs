//! Integrity check of an MCAP file: verifies its checksums before its content is read.
//!
//! See <https://mcap.dev/spec>: the data-end record holds the checksum of everything before it. The footer holds the
//! checksum of the summary section and of itself. Together they cover every byte.

use crc32fast::hash as crc32;

const MAGIC: &[u8] = b"\x89MCAP0\r\n";
/// Length of a record header in bytes: the opcode and the length.
const RECORD_HEADER_LEN: usize = 1 + 8;
const DATA_END: u8 = 0x0f;
const FOOTER: u8 = 0x02;
/// Length of the footer in bytes: start of the summary, start of the summary offsets, checksum.
const FOOTER_LEN: usize = 8 + 8 + 4;
const CRC_LEN: usize = 4;

/// Verifies the checksums over all bytes of a file.
///
/// # Errors
/// Returns a description of the damage.
pub(super) fn verify(bytes: &[u8]) -> Result<(), &'static str> {
    let inner = bytes.strip_suffix(MAGIC).filter(|b| b.starts_with(MAGIC));
    let inner = inner.ok_or("the file does not start and end with the MCAP magic bytes")?;
    let footer = inner.len().checked_sub(RECORD_HEADER_LEN + FOOTER_LEN);
    let footer = footer.ok_or("the file has no footer")?;
    let about = record(inner, footer, FOOTER, FOOTER_LEN).ok_or("the file has no footer")?;
    let summary = match decode_le(&about[..8]) {
        // 0 means that the file has no summary (MCAP specification, record Footer).
        0 => footer,
        at => usize::try_from(at).unwrap_or(usize::MAX),
    };
    let data_end = summary.checked_sub(RECORD_HEADER_LEN + CRC_LEN);
    let saved = data_end.and_then(|at| record(inner, at, DATA_END, CRC_LEN));
    let (Some(saved), Some(data_end)) = (saved, data_end) else {
        return Err("the data section has no end record");
    };
    // The checksum of the summary also covers the footer, up to the checksum itself.
    let end = inner.len() - CRC_LEN;
    match (
        u64::from(crc32(&inner[..data_end])) == decode_le(saved),
        u64::from(crc32(&inner[summary..end])) == decode_le(&inner[end..]),
    ) {
        (true, true) => Ok(()),
        (false, _) => Err("the checksum of the data section is wrong"),
        (true, false) => Err("the checksum of the summary section is wrong"),
    }
}

/// Returns the content of the record at offset `at` if it has this kind and length.
fn record(bytes: &[u8], at: usize, kind: u8, len: usize) -> Option<&[u8]> {
    let head = bytes.get(at..at.checked_add(RECORD_HEADER_LEN)?)?;
    let is_expected = head[0] == kind && decode_le(&head[1..]) == len as u64;
    bytes
        .get(at + RECORD_HEADER_LEN..at + RECORD_HEADER_LEN + len)
        .filter(|_| is_expected)
}

/// Decodes a little-endian number of at most eight bytes.
fn decode_le(bytes: &[u8]) -> u64 {
    let bytes = bytes.iter().rev();
    bytes.fold(0, |number, byte| number << 8 | u64::from(*byte))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Check value of CRC-32 from the catalogue of parametrised CRC algorithms.
    #[test]
    fn the_sum_is_the_usual_one() {
        assert_eq!(crc32(b"123456789"), 0xcbf4_3926);
    }

    #[test]
    fn what_is_no_file_is_refused() {
        for bytes in [&b""[..], MAGIC, b"\x89MCAP0\r\n\x89MCAP0\r\n", &[0; 100]] {
            assert!(verify(bytes).is_err());
        }
    }
}
