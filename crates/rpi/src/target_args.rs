//! Options that select what is run, common to several subcommands.

use std::path::PathBuf;

use clap::{Args, value_parser};
use rpi_runtime::run::InputSetting;

/// Options that select the command to run, its cell, its period and its end.
#[derive(Args, Debug)]
pub(crate) struct Target {
    /// Cell description with the devices; default: `cell.toml` beside the program.
    #[arg(long, value_name = "FILE")]
    pub(crate) cell: Option<PathBuf>,
    /// Command or task to run, if the program has several.
    #[arg(long, value_name = "NAME")]
    pub(crate) command: Option<String>,
    /// Period of the cycle, such as 1ms; default: that of the image, else 1ms.
    #[arg(long, value_parser = rpi_driver::parse_duration, value_name = "TIME")]
    pub(crate) period: Option<u64>,
    /// Stop the run after this number of cycles.
    #[arg(long, value_name = "N", conflicts_with = "time", value_parser = value_parser!(u64).range(1..))]
    pub(crate) cycles: Option<u64>,
    /// Stop the run after this time, such as 10s, on the clock of the cell (simulated or real).
    #[arg(long, value_parser = rpi_driver::parse_duration, value_name = "TIME")]
    pub(crate) time: Option<u64>,
    /// Set an input of the command before the start; may be repeated.
    #[arg(long = "set", value_name = "KEY=VALUE")]
    pub(crate) settings: Vec<InputSetting>,
    /// Watch a flow that the program does not export, named by its command and the path to it, such as
    /// `Move.Approach.way.travelled`; a command, call or fragment stands for all flows inside. May be repeated.
    #[arg(long, value_name = "FLOW")]
    pub(crate) watch: Vec<String>,
}
