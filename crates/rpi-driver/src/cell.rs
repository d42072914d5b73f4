//! Description of the robot cell beside a program (`cell.toml`), as far as programs depend on it.

use std::path::Path;

use rpi_sim::Cell;
use rpi_sim::robot::FolderFiles;

use crate::file_loader::FileLoader;

/// File name of the description of a cell.
const CELL: &str = "cell.toml";

/// Where the number of axes of an `Arm` without a static argument comes from.
#[derive(Clone, Copy, PartialEq, Eq, Default, Debug)]
pub enum ArmAxes {
    /// From the arms of the cell that `cell.toml` beside the program describes, otherwise as `Library`.
    #[default]
    CellFile,
    /// From the arms of another cell.
    Known(u32),
    /// From the default of the standard library: 7.
    Library,
}

impl From<Option<u32>> for ArmAxes {
    /// Takes the number of axes of the arms of a cell; `None` if the cell has no arms, or different ones.
    fn from(axes: Option<u32>) -> ArmAxes {
        axes.map_or(ArmAxes::Library, ArmAxes::Known)
    }
}

impl ArmAxes {
    /// Returns the number of axes if `from_file` is that of `cell.toml` beside the program; `None` for the default of the
    /// standard library.
    pub(crate) fn or_from_file(self, from_file: Option<u32>) -> Option<u32> {
        match self {
            ArmAxes::CellFile => from_file,
            ArmAxes::Known(axes) => Some(axes),
            ArmAxes::Library => None,
        }
    }
}

/// Returns the number of axes of the arms of the cell that `cell.toml` in a folder describes. `None` if there is no such file,
/// or if its arms differ. An invalid description decides nothing: its errors are reported when the cell is used.
pub(crate) fn arm_axes(folder: &Path, files: &dyn FileLoader) -> Option<u32> {
    let path = folder.join(CELL);
    let text = files.text(&path)?;
    let name = path.display().to_string();
    let cell = Cell::parse_with(&name, &text, &FolderFiles::beside(&path));
    cell.ok()?.arm_axes()
}
