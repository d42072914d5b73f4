//! Robot descriptions: kinematics and limits of arms as files.
//!
//! A description is a URDF, or TOML with one of three tables: `[dh]` (a Denavit-Hartenberg table), `[opw]` (the lengths of
//! an arm with ortho-parallel basis and spherical wrist) or `[urdf]` (a URDF with a choice of its links). TOML also gives
//! the limits that are not in a URDF. The built-in models are such files, compiled in.

mod builtin;
mod closed_form;
mod description;
mod dh;
mod drawing;
mod files;
mod kinematics;
mod limits;
mod opw;
mod report;
mod store;
mod urdf;
mod urdf_joint;
mod urdf_tree;

pub(super) use builtin::read as read_builtin;
pub use builtin::{builtin, builtin_ids};
pub use description::{Mesh, RobotDescription};
pub use drawing::drawing;
pub use files::{FolderFiles, NoFiles, RobotFileError, RobotFiles};
pub use report::{InverseReport, RobotReport};

pub(super) use files::{AttachedFiles, ROBOT_FILES, is_robot_file};

use super::error::CellErrors;
use super::reader::TableReader;
use super::schema;

impl RobotDescription {
    /// Parses a robot description: URDF if the name of the file ends with `.urdf` or `.xml`, otherwise TOML. `files`
    /// reads the files that the description names, such as a URDF.
    ///
    /// # Errors
    /// Returns all errors of the description, with their positions.
    pub fn parse(file: &str, text: &str, files: &dyn RobotFiles) -> Result<Self, CellErrors> {
        match files::is_urdf(file) {
            true => urdf::read_alone(file, text),
            false => description::read(file, text, files),
        }
    }

    /// Returns the JSON schema of robot descriptions in TOML, for editors.
    #[must_use]
    pub fn schema() -> String {
        schema::schema("robot", "Robot description", walk)
    }

    /// Reads a robot description: that of the built-in model `name`, or else the file with this path.
    ///
    /// # Errors
    /// Returns the errors of the description. A file that cannot be read is an error without a position.
    pub fn open(name: &str, files: &dyn RobotFiles) -> Result<Self, CellErrors> {
        if let Some(found) = builtin::read(name) {
            return found;
        }
        let text = files.read(name).map_err(|why| {
            let help = format!("built-in models: {}", builtin_ids().join(", "));
            CellErrors::of_file(name, why.to_string(), Some(help))
        })?;
        Self::parse(name, &text, files)
    }
}

/// Walks through the keys of a robot description in TOML by a recording reader.
pub(super) fn walk(reader: TableReader<'_>) {
    description::read_table(reader, "", &NoFiles);
}
