//! Reading of files up to a size, decompressed if they are compressed, and of lines up to a length.
//!
//! A small compressed file can hold any amount of content, and a device file has no end. Without a limit, such a file
//! takes all memory of the machine before anything is looked at.

pub mod framing;

use std::fs::File;
use std::io::{self, BufRead, ErrorKind, Read};
use std::path::Path;

use flate2::read::MultiGzDecoder;

/// Maximum size of a program, a net or an image in bytes (128 MiB), compressed or decompressed.
pub const MAX_PROGRAM: u64 = 128 << 20;

/// Maximum size of recorded inputs and outputs in bytes (512 MiB), compressed or decompressed.
pub const MAX_TRACE: u64 = 512 << 20;

/// Maximum size in bytes of a description beside a program (16 MiB): of a cell, a robot, a machine, a project or points.
pub const MAX_DESCRIPTION: u64 = 16 << 20;

/// Maximum length of a line of a table in bytes (16 MiB).
pub const MAX_LINE: u64 = 16 << 20;

/// First two bytes of a gzip file (RFC 1952, section 2.3.1).
const GZIP: [u8; 2] = [0x1f, 0x8b];

/// Returns the content of a file, decompressed if it is a gzip file. `most` is the maximum size in bytes.
///
/// # Errors
/// Returns an error if the file cannot be read, is invalid gzip, or has more than `most` bytes, compressed or
/// decompressed.
pub fn read(path: &Path, most: u64) -> io::Result<Vec<u8>> {
    decompress(limited(File::open(path)?, most)?, most)
}

/// Returns the bytes of a file as they are. `most` is the maximum size in bytes.
///
/// # Errors
/// Returns an error if the file cannot be read, or has more than `most` bytes.
pub fn read_unchanged(path: &Path, most: u64) -> io::Result<Vec<u8>> {
    limited(File::open(path)?, most)
}

/// Returns the text of a file. `most` is the maximum size in bytes.
///
/// # Errors
/// Returns an error if the file cannot be read, is not UTF-8, or has more than `most` bytes.
pub fn read_text(path: &Path, most: u64) -> io::Result<String> {
    text_from(File::open(path)?, most)
}

/// Returns the text of a stream, such as the standard input. `most` is the maximum size in bytes.
///
/// # Errors
/// Returns an error if the stream cannot be read, is not UTF-8, or has more than `most` bytes.
pub fn text_from(stream: impl Read, most: u64) -> io::Result<String> {
    utf8(limited(stream, most)?)
}

/// Returns the lines of a stream, without their ends. `most` is the maximum length of a line in bytes.
///
/// # Errors
/// An item is an error if the stream cannot be read, or the line is not UTF-8 or has more than `most` bytes.
pub fn lines(mut stream: impl BufRead, most: u64) -> impl Iterator<Item = io::Result<String>> {
    let mut next = move || {
        let mut line = Vec::new();
        let count = stream
            .by_ref()
            .take(most.saturating_add(1))
            .read_until(b'\n', &mut line)?;
        if line.pop_if(|byte| *byte == b'\n').is_some() {
            line.pop_if(|byte| *byte == b'\r');
        } else if line.len() as u64 > most {
            let message = format!("the line has more than {most} bytes");
            return Err(io::Error::new(ErrorKind::FileTooLarge, message));
        }
        utf8(line).map(|line| (count > 0).then_some(line))
    };
    std::iter::from_fn(move || next().transpose())
}

fn utf8(bytes: Vec<u8>) -> io::Result<String> {
    let no_text = |_| io::Error::new(ErrorKind::InvalidData, "stream did not contain valid UTF-8");
    String::from_utf8(bytes).map_err(no_text)
}

/// Returns the content of a file, decompressed if it begins with the magic number of gzip, else unchanged. `most` is
/// the maximum size in bytes after decompression.
///
/// # Errors
/// Returns an error if the content is invalid gzip, or has more than `most` bytes.
pub fn decompress(bytes: Vec<u8>, most: u64) -> io::Result<Vec<u8>> {
    match bytes.starts_with(&GZIP) {
        true => limited(MultiGzDecoder::new(bytes.as_slice()), most).map_err(gzip_error),
        false => Ok(bytes),
    }
}

fn gzip_error(error: io::Error) -> io::Error {
    match error.kind() {
        ErrorKind::FileTooLarge => error,
        kind => io::Error::new(kind, format!("invalid gzip file: {error}")),
    }
}

/// Returns all bytes of a stream, or an error if it has more than `most` bytes.
fn limited(stream: impl Read, most: u64) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    stream
        .take(most.saturating_add(1))
        .read_to_end(&mut bytes)?;
    match bytes.len() as u64 > most {
        true => {
            let message = format!("the content has more than {} MB", most >> 20);
            Err(io::Error::new(ErrorKind::FileTooLarge, message))
        }
        false => Ok(bytes),
    }
}

#[cfg(test)]
mod tests {
    use std::io::Write;

    use flate2::Compression;
    use flate2::write::GzEncoder;

    use super::*;

    fn packed(bytes: &[u8]) -> Vec<u8> {
        let mut packed = GzEncoder::new(Vec::new(), Compression::best());
        packed.write_all(bytes).unwrap();
        packed.finish().unwrap()
    }

    #[test]
    fn content_within_the_limit_is_read_and_more_is_an_error() {
        for content in [b"let".to_vec(), vec![b' '; 1 << 20]] {
            let size = content.len() as u64;
            for bytes in [content.clone(), packed(&content)] {
                let whole = decompress(bytes.clone(), size).unwrap();
                assert_eq!(whole, content);
                let more =
                    limited(bytes.as_slice(), size - 1).and_then(|b| decompress(b, size - 1));
                assert_eq!(more.unwrap_err().kind(), ErrorKind::FileTooLarge);
            }
        }
    }

    #[test]
    fn a_file_without_end_is_an_error() {
        let path = Path::new("/dev/zero");
        let errors = [
            read(path, 1 << 16).map(drop),
            read_unchanged(path, 1 << 16).map(drop),
            read_text(path, 1 << 16).map(drop),
        ];
        for error in errors.map(Result::unwrap_err) {
            assert_eq!(error.kind(), ErrorKind::FileTooLarge);
        }
    }

    #[test]
    fn lines_are_read_up_to_a_length() {
        let read = |text: &[u8], most| -> io::Result<Vec<String>> { lines(text, most).collect() };
        for text in ["", "a", "a\n", "a\nb", "a\r\n\nb\r", "\n"] {
            let same: Vec<&str> = text.lines().collect();
            assert_eq!(read(text.as_bytes(), 100).unwrap(), same, "{text:?}");
        }
        assert_eq!(read(b"abc\nd", 3).unwrap(), ["abc", "d"]);
        assert_eq!(
            read(b"abcd\n", 3).unwrap_err().kind(),
            ErrorKind::FileTooLarge
        );
        assert_eq!(read(b"\xff", 3).unwrap_err().kind(), ErrorKind::InvalidData);
        let endless = std::io::BufReader::new(File::open("/dev/zero").unwrap());
        assert!(lines(endless, 1 << 16).next().unwrap().is_err());
    }

    #[test]
    fn a_text_is_utf_8() {
        assert_eq!(text_from(&b"let"[..], 3).unwrap(), "let");
        let error = text_from(&b"\xff"[..], 3).unwrap_err();
        assert_eq!(error.kind(), ErrorKind::InvalidData);
    }
}
