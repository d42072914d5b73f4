//! Built-in models: descriptions of the folder `robots`, compiled in.

use super::{RobotDescription, RobotFileError, RobotFiles};
use crate::cell::error::CellErrors;
use rpi_kin::ArmModel;

macro_rules! files {
    ($($name:literal),* $(,)?) => {
        &[$(($name, include_str!(concat!("../../../../../robots/", $name)))),*]
    };
}

/// Names and texts of the files in the folder `robots`, sorted by name, compiled into the program.
const FILES: &[(&str, &str)] = files!(
    "abb-irb120.toml",
    "franka-fr3.toml",
    "franka-panda.toml",
    "kuka-iiwa-14.toml",
    "kuka-iiwa-7.toml",
    "kuka-kr16-2.toml",
    "kuka-kr210-l150.toml",
    "kuka-kr6-r900.toml",
    "kuka-lwr4+.toml",
    "linear-unit.toml",
    "portal-3.toml",
    "portal-3.urdf",
    "positioner-2.toml",
    "scara-600.toml",
    "ur10e.toml",
    "ur3e.toml",
    "ur5e.toml",
);

/// Reader of the files in the folder `robots`, which are compiled into the program.
struct BuiltinFiles;

impl RobotFiles for BuiltinFiles {
    fn read(&self, path: &str) -> Result<String, RobotFileError> {
        let file = FILES.iter().find(|(name, _)| *name == path);
        file.map(|(_, text)| (*text).to_owned())
            .ok_or_else(|| RobotFileError::new(path, "no such built-in file"))
    }
}

/// Returns the names of all built-in robot models, sorted.
#[must_use]
pub fn builtin_ids() -> Vec<&'static str> {
    let names = FILES.iter().map(|(name, _)| name);
    names
        .filter_map(|name| name.strip_suffix(".toml"))
        .collect()
}

/// Reads the description of a built-in robot model by its name, such as `ur5e`; `None` if there is no such model.
pub(in crate::cell) fn read(id: &str) -> Option<Result<RobotDescription, CellErrors>> {
    let name = format!("{id}.toml");
    let (_, text) = FILES.iter().find(|(file, _)| *file == name)?;
    Some(RobotDescription::parse(&name, text, &BuiltinFiles))
}

/// Returns a built-in robot model by its name, such as `ur5e`; `None` if there is no such model. Parses its
/// description, so not for the cycle.
#[must_use]
pub fn builtin(id: &str) -> Option<&'static ArmModel> {
    Some(read(id)?.ok()?.model)
}
