//! Where the texts of other files come from: the disk, or an editor that has changed them.

use std::path::Path;

/// Gives the text of a file.
pub trait Files {
    /// The text of a file; none if there is no such file, or no text in it.
    fn text(&self, path: &Path) -> Option<String>;
}

/// The files on disk.
#[derive(Clone, Copy, Debug, Default)]
pub struct Disk;

impl Files for Disk {
    fn text(&self, path: &Path) -> Option<String> {
        // A pipe or a device may never end, or never begin.
        let is_file = std::fs::metadata(path).is_ok_and(|meta| meta.is_file());
        is_file.then(|| std::fs::read_to_string(path).ok())?
    }
}
