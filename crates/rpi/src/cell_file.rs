//! Reads cell descriptions.

use std::error::Error;
use std::path::Path;

use rpi_sim::Cell;

/// Reads a cell description. Returns the cell and its text.
///
/// # Errors
/// If the file cannot be read or is invalid; the message has its name.
pub(crate) fn read(path: &Path) -> Result<(Cell, String), Box<dyn Error>> {
    let name = path.display().to_string();
    let bytes = std::fs::read(path).map_err(|e| format!("{name}: {e}"))?;
    let text = rpi_driver::utf8(path, &bytes).map_err(|e| e.to_string())?;
    let cell = Cell::parse(&name, text);
    let cell = cell.map_err(|errors| format!("the cell is invalid\n{errors}"))?;
    Ok((cell, text.to_owned()))
}
