//! Access to the texts of other files: on disk, or as changed in an editor.

use std::cell::RefCell;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Source of the texts of program files: the disk, or the unsaved documents of an editor.
pub trait FileLoader {
    /// Returns the text of a file; `None` if there is no such file or it is not text.
    fn text(&self, path: &Path) -> Option<String>;
}

/// Loader that reads files from disk.
#[derive(Clone, Copy, Debug, Default)]
pub struct DiskLoader;

impl FileLoader for DiskLoader {
    fn text(&self, path: &Path) -> Option<String> {
        // Pipes and devices are rejected, because reading them may block for ever.
        let is_file = std::fs::metadata(path).is_ok_and(|meta| meta.is_file());
        is_file.then(|| rpi_files::read_text(path, rpi_files::MAX_PROGRAM).ok())?
    }
}

/// Texts of the files that a check has read, so that later questions about the program see the same texts.
#[derive(Debug, Default)]
pub(crate) struct RecordedFiles(BTreeMap<PathBuf, Option<String>>);

impl FileLoader for RecordedFiles {
    fn text(&self, path: &Path) -> Option<String> {
        self.0.get(path).cloned().flatten()
    }
}

/// Loader that records the texts that another loader returns.
pub(crate) struct Recorder<'f> {
    files: &'f dyn FileLoader,
    texts: RefCell<BTreeMap<PathBuf, Option<String>>>,
}

impl<'f> Recorder<'f> {
    pub(crate) fn new(files: &'f dyn FileLoader) -> Recorder<'f> {
        Recorder {
            files,
            texts: RefCell::default(),
        }
    }

    /// Returns the texts read so far.
    pub(crate) fn into_recorded(self) -> RecordedFiles {
        RecordedFiles(self.texts.into_inner())
    }
}

impl FileLoader for Recorder<'_> {
    fn text(&self, path: &Path) -> Option<String> {
        let text = self.files.text(path);
        let mut texts = self.texts.borrow_mut();
        texts.insert(path.to_owned(), text.clone());
        text
    }
}
