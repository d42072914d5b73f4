//! Reading of files up to a size, decompressed if they are compressed.
//!
//! A small compressed file can hold any amount of content, and a device file has no end. Without a limit, such a file
//! takes all memory of the machine before anything is looked at.

use std::fs::File;
use std::io::{self, ErrorKind, Read};
use std::path::Path;

use flate2::read::MultiGzDecoder;

/// Maximum size of a program, a net or an image in bytes (128 MiB), compressed or decompressed.
pub const MAX_PROGRAM: u64 = 128 << 20;

/// Maximum size of recorded inputs and outputs in bytes (512 MiB), compressed or decompressed.
pub const MAX_TRACE: u64 = 512 << 20;

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
        let endless = read(Path::new("/dev/zero"), 1 << 16);
        assert_eq!(endless.unwrap_err().kind(), ErrorKind::FileTooLarge);
    }
}
