//! Messages behind a header with their length, as the Language Server Protocol and the Debug Adapter Protocol send them ("base
//! protocol").

use std::io::{self, BufRead, Read, Write};

/// Maximum length of a message in bytes (256 MiB). A longer message is skipped, so that a wrong length cannot exhaust
/// the memory.
const MAX_LENGTH: u64 = 256 << 20;

/// Maximum length of a header line in bytes. A longer line is read in parts of this length.
const MAX_HEADER_LINE: u64 = 4096;

/// Returns the body of the next message, without its header; [`None`] at the end of the input.
///
/// # Errors
/// Returns an error if the input cannot be read, or ends within a message.
pub fn read_message(input: &mut impl BufRead) -> io::Result<Option<Vec<u8>>> {
    let mut length = None;
    loop {
        let mut line = Vec::new();
        if input
            .by_ref()
            .take(MAX_HEADER_LINE)
            .read_until(b'\n', &mut line)?
            == 0
        {
            return Ok(None);
        }
        let line = String::from_utf8_lossy(&line);
        match (line.trim(), length) {
            ("", Some(length)) => return read_exactly(input, length).map(Some),
            // A header without a valid length: skipped, in search of the next header.
            ("", None) => {}
            (field, _) => length = content_length(field).or(length),
        }
    }
}

/// Writes a message with its header.
///
/// # Errors
/// Returns an error if writing fails.
pub fn write_message(output: &mut impl Write, body: &str) -> io::Result<()> {
    write!(output, "Content-Length: {}\r\n\r\n{body}", body.len())?;
    output.flush()
}

fn content_length(field: &str) -> Option<u64> {
    let (name, value) = field.split_once(':')?;
    let is_length = name.trim().eq_ignore_ascii_case("content-length");
    let length = value.trim().parse().ok()?;
    (is_length && length <= MAX_LENGTH).then_some(length)
}

fn read_exactly(input: &mut impl BufRead, length: u64) -> io::Result<Vec<u8>> {
    let mut body = Vec::new();
    input.by_ref().take(length).read_to_end(&mut body)?;
    match body.len() as u64 == length {
        true => Ok(body),
        false => Err(io::ErrorKind::UnexpectedEof.into()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bodies(bytes: &[u8]) -> Vec<String> {
        let mut input = bytes;
        let next = || read_message(&mut input).ok().flatten();
        let all = std::iter::from_fn(next);
        all.map(|body| String::from_utf8(body).unwrap()).collect()
    }

    #[test]
    fn bodies_have_the_length_that_the_header_says() {
        let two = b"Content-Length: 2\r\n\r\n{}Content-Type: x\r\ncontent-length:3\r\n\r\n[1]";
        assert_eq!(bodies(two), ["{}", "[1]"]);
    }

    #[test]
    fn what_is_no_header_is_passed_over() {
        assert_eq!(
            bodies(b"rubbish\r\n\r\nContent-Length: x\r\n\r\nContent-Length: 1\r\n\r\n7"),
            ["7"]
        );
        assert_eq!(bodies(b"Content-Length: 9\r\n\r\n{}"), Vec::<String>::new());
        assert_eq!(
            bodies(b"Content-Length: 99999999999999\r\n\r\n"),
            Vec::<String>::new()
        );
    }
}
