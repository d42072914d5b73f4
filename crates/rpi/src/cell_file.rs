//! Reads cell descriptions.

use std::error::Error;
use std::path::Path;

use rpi_sim::Cell;
use rpi_sim::robot::FolderFiles;

use crate::exit::{CommandResult, Exit};

/// Reads a cell description and the robot descriptions that it names. Returns the cell, and the text of the description
/// with the robot descriptions included.
///
/// # Errors
/// Returns an error with the name of the file if it cannot be read or is invalid.
pub(crate) fn read(path: &Path) -> Result<(Cell, String), Box<dyn Error>> {
    let name = path.display().to_string();
    let bytes = rpi_files::read_unchanged(path, rpi_files::MAX_DESCRIPTION);
    let bytes = bytes.map_err(|e| format!("{name}: {e}"))?;
    let text = rpi_driver::utf8(path, &bytes).map_err(|e| e.to_string())?;
    let cell = Cell::parse_with(&name, text, &FolderFiles::beside(path));
    let cell = cell.map_err(|errors| format!("the cell is invalid\n{errors}"))?;
    let text = cell.self_contained(text);
    Ok((cell, text))
}

/// Carries out `rpi cell check`: reads a cell description and prints its devices.
pub(crate) fn check(path: &Path) -> CommandResult {
    let (cell, _) = read(path)?;
    let mut lines = format!("{}: valid\n", path.display());
    for device in &cell.devices {
        lines += &format!("  {}: {}\n", device.name, device.kind.summary());
    }
    rpi_cli::print(&lines)?;
    Ok(Exit::Success)
}

/// Carries out `rpi cell schema`: prints the JSON schema of cell descriptions.
pub(crate) fn schema() -> CommandResult {
    rpi_cli::print(Cell::schema())?;
    Ok(Exit::Success)
}
