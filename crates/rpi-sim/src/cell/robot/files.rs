//! Where the files come from that a cell or a robot description names.

use core::cell::RefCell;
use core::fmt;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Reader of the files that a cell description or a robot description names.
pub trait RobotFiles {
    /// Returns the text of a file; `path` is the path as the description writes it.
    ///
    /// # Errors
    /// Returns an error if the file does not exist, cannot be read or is not UTF-8 text.
    fn read(&self, path: &str) -> Result<String, RobotFileError>;

    /// Returns whether a file exists, such as a mesh; `None` if this reader cannot find out.
    fn exists(&self, path: &str) -> Option<bool> {
        let _ = path;
        None
    }
}

/// Error: a file that a cell description or a robot description names cannot be read.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RobotFileError {
    path: String,
    reason: String,
}

impl RobotFileError {
    /// Creates the error for the file at `path`; `reason` is the reason that the message shows after the path.
    pub fn new(path: impl Into<String>, reason: impl Into<String>) -> Self {
        Self {
            path: path.into(),
            reason: reason.into(),
        }
    }
}

impl fmt::Display for RobotFileError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.path, self.reason)
    }
}

impl core::error::Error for RobotFileError {}

/// Reader that rejects every file: for descriptions that arrive without a folder, as over a network.
pub struct NoFiles;

impl RobotFiles for NoFiles {
    fn read(&self, path: &str) -> Result<String, RobotFileError> {
        Err(RobotFileError::new(path, "a file cannot be named here"))
    }
}

/// Reader of files whose paths are relative to a folder.
pub struct FolderFiles {
    folder: PathBuf,
}

impl FolderFiles {
    /// Creates the reader for paths relative to the folder that contains `file`, a description of a cell or robot.
    #[must_use]
    pub fn beside(file: &Path) -> Self {
        let folder = file.parent().unwrap_or(Path::new("")).to_owned();
        Self { folder }
    }

    /// Returns the path of a mesh: relative to the folder, or in a ROS package, which is a folder with the name of the
    /// package in the folder or above it.
    fn mesh_path(&self, reference: &str) -> PathBuf {
        let Some(path) = reference.strip_prefix("package://") else {
            let plain = reference.strip_prefix("file://").unwrap_or(reference);
            return self.folder.join(plain);
        };
        let absolute = self.folder.canonicalize();
        let absolute = absolute.unwrap_or_else(|_| self.folder.clone());
        let candidates = absolute.ancestors().map(|folder| folder.join(path));
        let mut candidates = candidates.take(MOST_ANCESTORS);
        candidates
            .find(|candidate| candidate.exists())
            .unwrap_or_else(|| self.folder.join(path))
    }
}

/// Maximum number of folders, from the folder upwards, in which a ROS package is searched.
const MOST_ANCESTORS: usize = 32;

impl RobotFiles for FolderFiles {
    fn read(&self, path: &str) -> Result<String, RobotFileError> {
        let path = self.folder.join(path);
        let error = |reason: String| RobotFileError::new(path.display().to_string(), reason);
        let bytes = rpi_files::read(&path, rpi_files::MAX_DESCRIPTION)
            .map_err(|why| error(why.to_string()))?;
        String::from_utf8(bytes).map_err(|_| error("the file is not UTF-8 text".to_owned()))
    }

    fn exists(&self, path: &str) -> Option<bool> {
        Some(self.mesh_path(path).exists())
    }
}

/// Reader of the files that the description of a cell contains; other files are read by `others`.
pub(in crate::cell) struct AttachedFiles<'a> {
    pub(in crate::cell) attached: &'a BTreeMap<String, String>,
    pub(in crate::cell) others: &'a dyn RobotFiles,
    /// Texts of all files that were read so far, by path.
    pub(in crate::cell) used: RefCell<BTreeMap<String, String>>,
}

impl RobotFiles for AttachedFiles<'_> {
    fn read(&self, path: &str) -> Result<String, RobotFileError> {
        let text = match self.attached.get(path) {
            Some(text) => text.clone(),
            None => self.others.read(path)?,
        };
        self.used.borrow_mut().insert(path.to_owned(), text.clone());
        Ok(text)
    }

    fn exists(&self, path: &str) -> Option<bool> {
        self.others.exists(path)
    }
}

/// Reader of files whose paths are relative to the file `folder`, which `files` reads.
pub(super) struct FolderView<'a> {
    pub(super) folder: &'a str,
    pub(super) files: &'a dyn RobotFiles,
}

impl RobotFiles for FolderView<'_> {
    fn read(&self, path: &str) -> Result<String, RobotFileError> {
        self.files.read(&beside(self.folder, path))
    }
}

/// Returns the path of a file that the file `file` names by a path relative to itself.
pub(super) fn beside(file: &str, path: &str) -> String {
    match file.rsplit_once('/') {
        Some((folder, _)) if !path.starts_with('/') => format!("{folder}/{path}"),
        _ => path.to_owned(),
    }
}

/// Extensions of the files with robot descriptions.
pub(in crate::cell) const ROBOT_FILES: &[&str] = &[".urdf", ".xml", ".toml"];

/// True if a path names a URDF file, by its extension.
pub(super) fn is_urdf(path: &str) -> bool {
    path.ends_with(".urdf") || path.ends_with(".xml")
}

/// True if the value of `model` is the path of a robot description, and not the name of a built-in model.
pub(in crate::cell) fn is_robot_file(model: &str) -> bool {
    ROBOT_FILES.iter().any(|end| model.ends_with(end))
}
