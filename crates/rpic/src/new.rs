//! `rpic new`: creates a project that checks, tests and runs at once.

use std::fs;
use std::path::Path;

use crate::outcome::{CommandResult, Exit, write_output};

/// Files of a new project: path within the project, and text. `NAME` in a text is replaced by the name of the project;
/// the schema does not contain it.
const FILES: &[(&str, &str)] = &[
    ("rpi.toml", include_str!("../template/rpi.toml")),
    ("main.rpi", include_str!("../template/main.rpi")),
    ("cell.toml", include_str!("../template/cell.toml")),
    (
        "cell.schema.json",
        include_str!("../../../editor-support/cell.schema.json"),
    ),
    ("README.md", include_str!("../template/README.md")),
    (".gitignore", include_str!("../template/.gitignore")),
    (
        ".vscode/extensions.json",
        include_str!("../template/.vscode/extensions.json"),
    ),
];

/// Carries out `rpic new`: creates the folder `path` with a project in it. A folder that exists must be empty.
///
/// # Errors
/// Returns an error if the folder is not empty, its name cannot name a project, or a file cannot be written.
pub(crate) fn new(path: &Path) -> CommandResult {
    let name = project_name(path)?;
    let is_occupied = match fs::read_dir(path) {
        Ok(mut entries) => entries.next().is_some(),
        Err(_) => path.exists(),
    };
    if is_occupied {
        return Err(format!("{} exists and is not an empty folder", path.display()).into());
    }
    for (file, text) in FILES {
        let file = path.join(file);
        let folder = file.parent().unwrap_or(path);
        fs::create_dir_all(folder).map_err(|e| format!("{}: {e}", folder.display()))?;
        write_output(Some(&file), text.replace("NAME", &name).as_bytes())?;
    }
    let text = format!(
        "created {path}\n\nnext:\n  cd {path}\n  rpic test .\n  rpi run main.rpi\n",
        path = path.display()
    );
    write_output(None, text.as_bytes())?;
    Ok(Exit::Success)
}

/// Returns the name of a new project: the last part of its path. The name is written in quoted texts of TOML, so a name
/// with control characters, quotes or backslashes is an error.
fn project_name(path: &Path) -> Result<String, String> {
    let name = path.file_name().and_then(|name| name.to_str());
    let name = name.ok_or_else(|| format!("{} does not name a folder", path.display()))?;
    match name.contains(|c: char| c.is_control() || c == '"' || c == '\\') {
        true => Err(format!("{name:?} cannot be the name of a project")),
        false => Ok(name.to_owned()),
    }
}
