//! ZIP archives without compression (PKWARE APPNOTE 6.3, ISO/IEC 21320-1), as Functional Mock-up Units need them.
//!
//! All entries have the same date, so that the same files give the same bytes.

/// Date of all entries in the format of MS-DOS: 1980-01-01, the first one that it can represent.
const DATE: u16 = (1 << 5) | 1;
/// Version of the format that a reader must support: 2.0, with folders in the names.
const VERSION: u16 = 20;
/// Creator of the archive: Unix, so that the permissions in the attributes count.
const CREATOR: u16 = (3 << 8) | VERSION;
/// Permissions of all entries: a regular file that all may read and execute.
const ATTRIBUTES: u32 = 0o100_755 << 16;
/// Flag of names in UTF-8.
const UTF_8: u16 = 1 << 11;

/// Archive in memory to which files are added one by one.
#[derive(Default)]
pub(crate) struct Archive {
    bytes: Vec<u8>,
    directory: Vec<u8>,
    count: u16,
}

impl Archive {
    /// Adds a file. `path` has the folders, separated by `/`. Returns false if the archive would be larger than the
    /// format without extensions allows: 4 GB or 65535 files.
    pub(crate) fn add(&mut self, path: &str, content: &[u8]) -> bool {
        let (Ok(size), Ok(name), Ok(offset)) = (
            u32::try_from(content.len()),
            u16::try_from(path.len()),
            u32::try_from(self.bytes.len()),
        ) else {
            return false;
        };
        let Some(count) = self.count.checked_add(1) else {
            return false;
        };
        self.count = count;
        let common = common_fields(content, size, name);
        self.bytes.extend(0x0403_4b50_u32.to_le_bytes());
        self.bytes.extend(&common);
        self.bytes.extend(path.as_bytes());
        self.bytes.extend(content);
        self.directory.extend(0x0201_4b50_u32.to_le_bytes());
        self.directory.extend(CREATOR.to_le_bytes());
        self.directory.extend(&common);
        // No comment, on the first volume, no internal attributes.
        self.directory.extend([0; 6]);
        self.directory.extend(ATTRIBUTES.to_le_bytes());
        self.directory.extend(offset.to_le_bytes());
        self.directory.extend(path.as_bytes());
        true
    }

    /// Returns the bytes of the archive; `None` if it is larger than 4 GB.
    pub(crate) fn finish(mut self) -> Option<Vec<u8>> {
        let start = u32::try_from(self.bytes.len()).ok()?;
        let size = u32::try_from(self.directory.len()).ok()?;
        self.bytes.extend(self.directory);
        self.bytes.extend(0x0605_4b50_u32.to_le_bytes());
        // This volume and the volume of the directory: the first one.
        self.bytes.extend([0; 4]);
        self.bytes.extend(self.count.to_le_bytes());
        self.bytes.extend(self.count.to_le_bytes());
        self.bytes.extend(size.to_le_bytes());
        self.bytes.extend(start.to_le_bytes());
        self.bytes.extend([0; 2]);
        Some(self.bytes)
    }
}

/// Returns the fields that the header of a file and its entry in the directory have in common.
fn common_fields(content: &[u8], size: u32, name: u16) -> Vec<u8> {
    let mut out = Vec::new();
    out.extend(VERSION.to_le_bytes());
    out.extend(UTF_8.to_le_bytes());
    // Method 0 (stored), time 00:00.
    out.extend([0; 4]);
    out.extend(DATE.to_le_bytes());
    out.extend(checksum(content).to_le_bytes());
    out.extend(size.to_le_bytes());
    out.extend(size.to_le_bytes());
    out.extend(name.to_le_bytes());
    // No extra field.
    out.extend([0; 2]);
    out
}

/// Returns the checksum CRC-32 (ISO 3309, reflected polynomial 0xEDB88320).
fn checksum(bytes: &[u8]) -> u32 {
    let next = |crc: u32, byte: &u8| {
        let shift = |crc: u32, _| (crc >> 1) ^ (0xedb8_8320 & (crc & 1).wrapping_neg());
        (0..8).fold(crc ^ u32::from(*byte), shift)
    };
    !bytes.iter().fold(u32::MAX, next)
}

#[cfg(test)]
mod tests {
    use super::{Archive, checksum};

    /// The check value of the catalogue of parametrised CRC algorithms for CRC-32/ISO-HDLC.
    #[test]
    fn the_checksum_is_crc_32() {
        assert_eq!(checksum(b"123456789"), 0xcbf4_3926);
    }

    #[test]
    fn the_end_record_points_to_the_directory() {
        let mut archive = Archive::default();
        assert!(archive.add("a/b.txt", b"content") && archive.add("c", b""));
        let bytes = archive.finish().expect("it is small");
        let end = bytes.len() - 22;
        let word = |at: usize| u32::from_le_bytes(bytes[at..at + 4].try_into().expect("4 bytes"));
        assert_eq!(word(end), 0x0605_4b50);
        assert_eq!(bytes[end + 10], 2);
        let directory = word(end + 16) as usize;
        assert_eq!(word(directory), 0x0201_4b50);
        assert_eq!(directory + word(end + 12) as usize, end);
    }
}
