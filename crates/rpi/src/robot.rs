//! `rpi robot`: examines robot descriptions.

use std::path::Path;

use rpi_sim::robot::{
    FolderFiles, RobotDescription, RobotFiles, RobotReport, builtin_ids, drawing,
};

use crate::exit::{CommandResult, Exit};
use crate::robot_args::RobotCommand;

/// Carries out `rpi robot check`, `rpi robot list` and `rpi robot schema`.
pub(crate) fn robot(command: &RobotCommand) -> CommandResult {
    match command {
        RobotCommand::List => rpi_cli::print(format!("{}\n", builtin_ids().join("\n")))?,
        RobotCommand::Schema => rpi_cli::print(RobotDescription::schema())?,
        RobotCommand::Check { robot, poses, draw } => check(robot, *poses, draw.as_deref())?,
    }
    Ok(Exit::Success)
}

fn check(robot: &str, poses: u32, draw: Option<&Path>) -> Result<(), Box<dyn std::error::Error>> {
    let path = Path::new(robot);
    let files = FolderFiles::beside(path);
    let name = path.file_name().and_then(|name| name.to_str());
    let opened = RobotDescription::open(name.unwrap_or(robot), &files);
    let found = opened.map_err(|errors| format!("the robot description is invalid\n{errors}"))?;
    let report = RobotReport::new(&found, poses as usize);
    rpi_cli::print(format!("{report}{}", meshes_line(&found, &files)))?;
    if let Some(file) = draw {
        let written = std::fs::write(file, drawing(&found));
        written.map_err(|why| format!("{}: {why}", file.display()))?;
    }
    Ok(())
}

/// Returns a line of text with the number of mesh files that a robot description names, and the number of those that do
/// not exist.
fn meshes_line(found: &RobotDescription, files: &FolderFiles) -> String {
    let count = found.meshes.len();
    let is_missing = |file: &&str| files.exists(file) == Some(false);
    let named = found.meshes.iter().map(|mesh| mesh.file.as_str());
    let missing: Vec<&str> = named.filter(is_missing).collect();
    match (count, missing.first()) {
        (0, _) => "meshes: none\n".to_owned(),
        (_, None) => format!("meshes: {count}\n"),
        (_, Some(first)) => {
            let missing = missing.len();
            format!("meshes: {count}, of which {missing} are missing, such as {first}\n")
        }
    }
}
