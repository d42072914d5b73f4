//! Opening what a tool is given: which kind of file it is, unpacked if it is packed.

use std::fmt;
use std::io::{ErrorKind, Read};
use std::path::{Path, PathBuf};

use flate2::read::MultiGzDecoder;

/// What a file holds, told by its name.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Kind {
    /// A program.
    Rpi,
    /// Lustre.
    Lustre,
    /// A net in the reference system's text form.
    Rpinet,
    /// A compiled image.
    Rpib,
}

const KINDS: &[(&str, Kind)] = &[
    ("rpi", Kind::Rpi),
    ("lus", Kind::Lustre),
    ("rpinet", Kind::Rpinet),
    ("rpib", Kind::Rpib),
];

impl Kind {
    /// The kind of a file by its name; `.gz` at the end does not count.
    #[must_use]
    pub fn of(path: &Path) -> Option<Kind> {
        let plain = unpacked_name(path);
        let (_, extension) = plain.rsplit_once('.')?;
        KINDS.iter().find(|k| k.0 == extension).map(|k| k.1)
    }
}

/// A file that was read.
#[derive(Clone, Debug)]
pub struct Input {
    /// Its name as it was given.
    pub path: PathBuf,
    /// What it holds.
    pub kind: Kind,
    /// Its content, unpacked.
    pub bytes: Vec<u8>,
}

impl Input {
    /// The file's name without folders and extensions.
    #[must_use]
    pub fn stem(&self) -> String {
        stem(&self.path)
    }

    /// The content as text.
    ///
    /// # Errors
    /// If it is not UTF-8, with the line.
    pub fn text(&self) -> Result<&str, InputError> {
        utf8(&self.path, &self.bytes)
    }
}

/// The marks with which texts in UTF-16 begin.
const UTF16: [&[u8]; 2] = [&[0xff, 0xfe], &[0xfe, 0xff]];

/// The content of a file as text.
///
/// # Errors
/// If it is not UTF-8, with the line.
pub fn utf8<'b>(path: &Path, bytes: &'b [u8]) -> Result<&'b str, InputError> {
    std::str::from_utf8(bytes).map_err(|e| {
        if UTF16.iter().any(|mark| bytes.starts_with(mark)) {
            return InputError::new(path, "this is UTF-16; save it as UTF-8");
        }
        let before = &bytes[..e.valid_up_to()];
        let line = 1 + before.iter().filter(|b| **b == b'\n').count();
        InputError::new(path, format!("line {line} is no text (not UTF-8)"))
    })
}

/// Why a file cannot be used, and what to do about it.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct InputError {
    /// The file.
    pub path: PathBuf,
    /// What is wrong.
    pub message: String,
    /// A way out, if one is known.
    pub help: Option<String>,
}

impl InputError {
    /// An error without a way out.
    #[must_use]
    pub fn new(path: &Path, message: impl Into<String>) -> InputError {
        InputError {
            path: path.to_owned(),
            message: message.into(),
            help: None,
        }
    }
}

impl fmt::Display for InputError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.path.display(), self.message)?;
        match &self.help {
            Some(help) => write!(f, "\n  help: {help}"),
            None => Ok(()),
        }
    }
}

impl std::error::Error for InputError {}

/// Reads a file and tells by its name what it holds.
///
/// # Errors
/// If the name tells no kind, or the file cannot be read or unpacked.
pub fn read(path: &Path) -> Result<Input, InputError> {
    let bytes = std::fs::read(path).map_err(|e| unreadable(path, &e))?;
    let kind = Kind::of(path).ok_or_else(|| {
        let known: Vec<String> = KINDS.iter().map(|k| format!(".{}", k.0)).collect();
        let help = format!("known are {} (also packed, .gz)", known.join(", "));
        InputError {
            help: Some(help),
            ..InputError::new(path, "the name does not tell what the file holds")
        }
    })?;
    let bytes = unpacked(bytes).map_err(|e| InputError::new(path, format!("broken gzip: {e}")))?;
    let bytes = match kind {
        Kind::Lustre => as_unicode(bytes),
        _ => bytes,
    };
    Ok(Input {
        path: path.to_owned(),
        kind,
        bytes,
    })
}

/// The content, unpacked if it begins as gzip does (RFC 1952, section 2.3.1).
fn unpacked(bytes: Vec<u8>) -> std::io::Result<Vec<u8>> {
    if !bytes.starts_with(&[0x1f, 0x8b]) {
        return Ok(bytes);
    }
    let mut out = Vec::new();
    MultiGzDecoder::new(bytes.as_slice()).read_to_end(&mut out)?;
    Ok(out)
}

/// A file's name without folders and extensions.
pub(crate) fn stem(path: &Path) -> String {
    let name = unpacked_name(path);
    let stem = name.split_once('.').map(|(stem, _)| stem.to_owned());
    stem.unwrap_or(name)
}

/// Lustre programs of before Unicode are written in ISO 8859-1, where a byte is the number of its character.
fn as_unicode(bytes: Vec<u8>) -> Vec<u8> {
    match std::str::from_utf8(&bytes) {
        Ok(_) => bytes,
        Err(_) => bytes
            .into_iter()
            .map(char::from)
            .collect::<String>()
            .into_bytes(),
    }
}

fn unpacked_name(path: &Path) -> String {
    let name = path.file_name().map(|n| n.to_string_lossy().into_owned());
    let name = name.unwrap_or_default();
    name.strip_suffix(".gz").unwrap_or(&name).to_owned()
}

/// Why a file that the user names can not be read, and what may have been meant.
#[must_use]
pub fn unreadable(path: &Path, error: &std::io::Error) -> InputError {
    let (message, help) = match error.kind() {
        ErrorKind::NotFound => ("there is no such file".to_owned(), nearest(path)),
        ErrorKind::IsADirectory => {
            let help = "name a file in it".to_owned();
            ("this is a folder".to_owned(), Some(help))
        }
        ErrorKind::PermissionDenied => ("this file may not be read".to_owned(), None),
        _ => (error.to_string(), None),
    };
    InputError {
        help,
        ..InputError::new(path, message)
    }
}

/// The file that was meant, as far as names tell.
fn nearest(path: &Path) -> Option<String> {
    let folder = path.parent().filter(|p| !p.as_os_str().is_empty());
    let folder = folder.unwrap_or(Path::new("."));
    let Ok(entries) = std::fs::read_dir(folder) else {
        return Some(format!("there is no folder {} either", folder.display()));
    };
    let mut names: Vec<String> = entries
        .flatten()
        .map(|e| e.file_name().to_string_lossy().into_owned())
        .filter(|name| Kind::of(Path::new(name)).is_some())
        .collect();
    names.sort();
    let wanted = path.file_name()?.to_string_lossy().into_owned();
    let found = rpi_diag::suggest(&wanted, names.iter().map(String::as_str))?;
    let near = path.with_file_name(found);
    Some(format!("did you mean {}?", near.display()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_tell_kinds() {
        let kind = |name: &str| Kind::of(Path::new(name));
        assert_eq!(kind("a/b.rpi"), Some(Kind::Rpi));
        assert_eq!(kind("lin.rpinet.gz"), Some(Kind::Rpinet));
        assert_eq!(kind("lin.txt"), None);
        assert_eq!(kind("rpi"), None);
    }

    #[test]
    fn a_missing_file_is_told_with_what_may_have_been_meant() {
        let dir = tempfile::tempdir().unwrap();
        std::fs::write(dir.path().join("blending.rpi"), "").unwrap();
        let error = read(&dir.path().join("blendng.rpi")).unwrap_err();
        assert!(error.message.contains("no such file"));
        assert!(error.help.unwrap().contains("blending.rpi"));
        let error = read(&dir.path().join("sub/a.rpi")).unwrap_err();
        assert!(error.help.unwrap().contains("no folder"));
        assert!(read(dir.path()).unwrap_err().message.contains("folder"));
    }

    #[test]
    fn content_that_is_no_text_is_told_with_its_line() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("a.rpi");
        std::fs::write(&path, b"ok\n\xff").unwrap();
        let error = read(&path).unwrap().text().unwrap_err();
        assert!(error.message.contains("line 2"));
    }

    #[test]
    fn stems_have_no_folders_and_extensions() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("lin-3.rpinet");
        std::fs::write(&path, "{}").unwrap();
        assert_eq!(read(&path).unwrap().stem(), "lin-3");
    }
}
