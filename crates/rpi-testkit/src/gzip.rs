//! Reading of recorded data, compressed or not.

use std::io;
use std::path::Path;

/// Returns the text of a file, decompressed if it begins with the magic number of gzip (RFC 1952, section 2.3.1).
///
/// # Errors
///
/// Returns an error if the file cannot be read, is invalid gzip, is too large, or is not UTF-8.
pub fn read_maybe_gz(path: impl AsRef<Path>) -> io::Result<String> {
    let bytes = rpi_files::read(path.as_ref(), rpi_files::MAX_TRACE)?;
    String::from_utf8(bytes).map_err(|error| io::Error::new(io::ErrorKind::InvalidData, error))
}

#[cfg(test)]
mod tests {
    use std::io::Write;

    use super::*;

    #[test]
    fn plain_and_packed_text_read_the_same() {
        let dir = std::env::temp_dir().join(format!("rpi-testkit-gz-{}", std::process::id()));
        std::fs::create_dir_all(&dir).unwrap();
        let mut packed = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::default());
        packed.write_all("cycle;1\n".as_bytes()).unwrap();
        std::fs::write(dir.join("a.gz"), packed.finish().unwrap()).unwrap();
        std::fs::write(dir.join("a"), "cycle;1\n").unwrap();
        assert_eq!(read_maybe_gz(dir.join("a.gz")).unwrap(), "cycle;1\n");
        assert_eq!(read_maybe_gz(dir.join("a")).unwrap(), "cycle;1\n");
        assert!(read_maybe_gz(dir.join("b")).is_err());
        std::fs::remove_dir_all(dir).unwrap();
    }
}
