//! Subcommands of `rpi robot` and `rpi cell`.

use std::path::PathBuf;

use clap::{Subcommand, value_parser};

/// Subcommands of `rpi robot`.
#[derive(Debug, Subcommand)]
pub(crate) enum RobotCommand {
    /// Print what a robot description gives: axes with limits, reach, inverse kinematics, and what is assumed.
    ///
    /// The inverse kinematics is tested on random poses within the ranges of the axes. Exit status: 0 if the
    /// description is valid, 2 otherwise.
    Check {
        /// Robot description (.urdf, .toml), or the name of a built-in model.
        robot: String,
        /// Number of random poses on which the inverse kinematics is tested.
        #[arg(long, value_name = "N", default_value_t = 10_000, value_parser = value_parser!(u32).range(1..=10_000_000))]
        poses: u32,
        /// Draw the kinematic chain from the side and from above as SVG to this file.
        #[arg(long, value_name = "FILE")]
        draw: Option<PathBuf>,
    },
    /// Print the names of the built-in robot models.
    List,
    /// Print the JSON schema of robot descriptions in TOML, for editors.
    Schema,
}

/// Subcommands of `rpi cell`.
#[derive(Debug, Subcommand)]
pub(crate) enum CellCommand {
    /// Check a cell description and the robot descriptions that it names, and print its devices.
    ///
    /// Exit status: 0 if the description is valid, 2 otherwise.
    Check {
        /// File with the cell description (TOML).
        cell: PathBuf,
    },
    /// Print the JSON schema of cell descriptions, with which editors complete keys and mark errors.
    Schema,
}
