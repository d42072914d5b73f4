//! Reading of input files: their kind, and decompression.

use std::fmt;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

/// Kind of an input file, determined by its extension.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum InputKind {
    /// Program in the language RPI (`.rpi`).
    Rpi,
    /// Program in Lustre (`.lus`).
    Lustre,
    /// Net in the text format of the Robotics API (`.rpinet`).
    Rpinet,
    /// Image: the compiled form of a command (`.rpib`).
    Rpib,
}

const KINDS: &[(&str, InputKind)] = &[
    ("rpi", InputKind::Rpi),
    ("lus", InputKind::Lustre),
    ("rpinet", InputKind::Rpinet),
    ("rpib", InputKind::Rpib),
];

impl InputKind {
    /// Returns the kind of a file by its extension; a final `.gz` is ignored. Returns `None` for an unknown extension.
    #[must_use]
    pub fn from_path(path: &Path) -> Option<InputKind> {
        let plain = name_without_gz(path);
        let (_, extension) = plain.rsplit_once('.')?;
        KINDS.iter().find(|k| k.0 == extension).map(|k| k.1)
    }
}

/// Input file of a tool, read and decompressed.
#[derive(Clone, Debug)]
pub struct Input {
    /// Path of the file, as given by the user.
    pub path: PathBuf,
    /// Kind of the content, determined by the extension.
    pub kind: InputKind,
    /// Content of the file, decompressed.
    pub bytes: Vec<u8>,
}

impl Input {
    /// Returns the file name without folders and extensions, which is the name of the program or net.
    #[must_use]
    pub fn stem(&self) -> String {
        stem(&self.path)
    }

    /// Returns the content of the file as text.
    ///
    /// # Errors
    /// If it is not UTF-8; the message contains the line.
    pub fn text(&self) -> Result<&str, InputError> {
        utf8(&self.path, &self.bytes)
    }
}

/// Bytes with which a file in UTF-16 begins (byte order marks).
const UTF16: [&[u8]; 2] = [&[0xff, 0xfe], &[0xfe, 0xff]];

/// Converts the content of a file to text.
///
/// # Errors
/// If it is not UTF-8; the message contains the line.
pub fn utf8<'b>(path: &Path, bytes: &'b [u8]) -> Result<&'b str, InputError> {
    std::str::from_utf8(bytes).map_err(|e| {
        if UTF16.iter().any(|mark| bytes.starts_with(mark)) {
            return InputError::new(path, "the file is UTF-16; save it as UTF-8");
        }
        let before = &bytes[..e.valid_up_to()];
        let line = 1 + before.iter().filter(|b| **b == b'\n').count();
        InputError::new(path, format!("invalid UTF-8 in line {line}"))
    })
}

/// Error while reading an input file.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct InputError {
    /// Path of the file that cannot be read.
    pub path: PathBuf,
    /// Description of the error.
    pub message: String,
    /// Suggestion for the user, such as a file with a similar name; `None` if there is none.
    pub help: Option<String>,
}

impl InputError {
    /// Creates an error without a suggestion.
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

/// Reads a file and decides its kind by the extension.
///
/// # Errors
/// If the extension is unknown, or the file cannot be read or decompressed.
pub fn read(path: &Path) -> Result<Input, InputError> {
    let bytes = rpi_files::read(path, rpi_files::MAX_PROGRAM).map_err(|e| read_error(path, &e))?;
    let kind = InputKind::from_path(path).ok_or_else(|| {
        let known: Vec<String> = KINDS.iter().map(|k| format!(".{}", k.0)).collect();
        let help = format!(
            "known extensions: {} (also compressed, .gz)",
            known.join(", ")
        );
        InputError {
            help: Some(help),
            ..InputError::new(path, "unknown file extension")
        }
    })?;
    let bytes = match kind {
        InputKind::Lustre => as_unicode(bytes),
        _ => bytes,
    };
    Ok(Input {
        path: path.to_owned(),
        kind,
        bytes,
    })
}

/// Returns the file name without folders and extensions.
pub(crate) fn stem(path: &Path) -> String {
    let name = name_without_gz(path);
    let stem = name.split_once('.').map(|(stem, _)| stem.to_owned());
    stem.unwrap_or(name)
}

/// Returns the content as UTF-8, converted from ISO 8859-1 if it is not UTF-8. Old Lustre programs use ISO 8859-1, in
/// which each byte is the code point of its character.
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

fn name_without_gz(path: &Path) -> String {
    let name = path.file_name().map(|n| n.to_string_lossy().into_owned());
    let name = name.unwrap_or_default();
    name.strip_suffix(".gz").unwrap_or(&name).to_owned()
}

/// Returns the error for a file that cannot be read, with a suggestion for the user if possible.
#[must_use]
pub fn read_error(path: &Path, error: &std::io::Error) -> InputError {
    let (message, help) = match error.kind() {
        ErrorKind::NotFound => ("no such file".to_owned(), suggest_file(path)),
        ErrorKind::IsADirectory => {
            let help = "give a file in this folder".to_owned();
            ("this is a folder".to_owned(), Some(help))
        }
        ErrorKind::PermissionDenied => ("permission denied".to_owned(), None),
        _ => (error.to_string(), None),
    };
    InputError {
        help,
        ..InputError::new(path, message)
    }
}

/// Returns a suggestion for a file that does not exist: the existing file with the most similar name, or that the
/// folder does not exist. Returns `None` if no name is similar.
fn suggest_file(path: &Path) -> Option<String> {
    let folder = path.parent().filter(|p| !p.as_os_str().is_empty());
    let folder = folder.unwrap_or(Path::new("."));
    let Ok(entries) = std::fs::read_dir(folder) else {
        return Some(format!("the folder {} does not exist", folder.display()));
    };
    let mut names: Vec<String> = entries
        .flatten()
        .map(|e| e.file_name().to_string_lossy().into_owned())
        .filter(|name| InputKind::from_path(Path::new(name)).is_some())
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
        let kind = |name: &str| InputKind::from_path(Path::new(name));
        assert_eq!(kind("a/b.rpi"), Some(InputKind::Rpi));
        assert_eq!(kind("lin.rpinet.gz"), Some(InputKind::Rpinet));
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
        assert!(error.help.unwrap().contains("the folder"));
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
