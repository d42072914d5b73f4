//! Access to the texts of other files: on disk, or as changed in an editor.

use std::path::Path;

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
