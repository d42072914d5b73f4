//! Whether a file of MCAP is what was written: its checksums, looked at before anything in it is believed.
//!
//! <https://mcap.dev/spec>: the record at the end of the data has one over all before it; the footer has one over the summary
//! that follows, and over itself. Together they hold every byte.

use crc32fast::hash as crc32;

const MAGIC: &[u8] = b"\x89MCAP0\r\n";
/// A record begins with its kind and its length.
const HEAD: usize = 1 + 8;
const DATA_END: u8 = 0x0f;
const FOOTER: u8 = 0x02;
/// What is in the footer: where the summary begins, where its offsets do, its checksum.
const FOOTER_LEN: usize = 8 + 8 + 4;
const CRC_LEN: usize = 4;

/// Checks every byte of a file.
///
/// # Errors
/// What is wrong with it.
pub(super) fn check(bytes: &[u8]) -> Result<(), &'static str> {
    let inner = bytes.strip_suffix(MAGIC).filter(|b| b.starts_with(MAGIC));
    let inner = inner.ok_or("it does not begin and end as one")?;
    let footer = inner.len().checked_sub(HEAD + FOOTER_LEN);
    let footer = footer.ok_or("it has no footer")?;
    let about = record(inner, footer, FOOTER, FOOTER_LEN).ok_or("it has no footer")?;
    let summary = match number(&about[..8]) {
        0 => footer,
        at => usize::try_from(at).unwrap_or(usize::MAX),
    };
    let data_end = summary.checked_sub(HEAD + CRC_LEN);
    let saved = data_end.and_then(|at| record(inner, at, DATA_END, CRC_LEN));
    let (Some(saved), Some(data_end)) = (saved, data_end) else {
        return Err("its data have no end");
    };
    let end = inner.len() - CRC_LEN;
    match (
        u64::from(crc32(&inner[..data_end])) == number(saved),
        u64::from(crc32(&inner[summary..end])) == number(&inner[end..]),
    ) {
        (true, true) => Ok(()),
        (false, _) => Err("the checksum of its data does not fit"),
        (true, false) => Err("the checksum of its summary does not fit"),
    }
}

/// What is in the record of this kind and length that begins at a place.
fn record(bytes: &[u8], at: usize, kind: u8, len: usize) -> Option<&[u8]> {
    let head = bytes.get(at..at.checked_add(HEAD)?)?;
    let fits = head[0] == kind && number(&head[1..]) == len as u64;
    bytes.get(at + HEAD..at + HEAD + len).filter(|_| fits)
}

/// At most eight bytes, the low one first.
fn number(bytes: &[u8]) -> u64 {
    let bytes = bytes.iter().rev();
    bytes.fold(0, |number, byte| number << 8 | u64::from(*byte))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The check value that catalogues of such sums give for this one.
    #[test]
    fn the_sum_is_the_usual_one() {
        assert_eq!(crc32(b"123456789"), 0xcbf4_3926);
    }

    #[test]
    fn what_is_no_file_is_refused() {
        for bytes in [&b""[..], MAGIC, b"\x89MCAP0\r\n\x89MCAP0\r\n", &[0; 100]] {
            assert!(check(bytes).is_err());
        }
    }
}
