//! What can be asked for on the command line.

use std::path::PathBuf;

use clap::{Args, Parser, Subcommand};
use clap_complete::Shell;

/// Version of the tool and of the image format that it reads and writes.
const VERSION: &str = concat!(env!("CARGO_PKG_VERSION"), " (image format 1)");

/// The control core: runs commands that follow one another without a gap.
#[derive(Debug, Parser)]
#[command(name = "rpi", version = VERSION, arg_required_else_help = true)]
pub struct Cli {
    /// What to do.
    #[command(subcommand)]
    pub task: Task,
}

/// The tasks.
#[derive(Debug, Subcommand)]
pub enum Task {
    /// Run a net against a recorded trace and compare every value.
    ///
    /// What came from outside is taken from the trace: device ports, inputs, cancel, the wall clock. Everything else is
    /// computed and compared. Exit status 0 only if nothing differs, 1 if something does, 2 for bad input.
    Replay(ReplayArgs),
    /// Print the completions of a shell.
    #[command(hide = true)]
    Completions {
        /// The shell.
        shell: Shell,
    },
    /// Write the manual pages into a folder.
    #[command(hide = true)]
    Man {
        /// The folder.
        folder: PathBuf,
    },
}

/// Options of `rpi replay`.
#[derive(Args, Debug)]
pub struct ReplayArgs {
    /// The net: .rpinet, or a program (.rpi), plain or .gz.
    pub net: PathBuf,
    /// The trace, tab- or comma-separated, plain or .gz. Given several times, the recordings are joined.
    #[arg(long, required = true, value_name = "FILE")]
    pub trace: Vec<PathBuf>,
    /// The command, if the program has several.
    #[arg(long, value_name = "NAME")]
    pub command: Option<String>,
    /// Period at which the trace was recorded.
    #[arg(long, default_value = "25ms", value_parser = rpi_driver::parse_period)]
    pub period: u64,
    /// How far apart equal values may be, absolute up to 1 and relative beyond.
    #[arg(long, default_value_t = 1e-9)]
    pub tolerance: f64,
    /// Print the report as JSON.
    #[arg(long)]
    pub json: bool,
}

#[cfg(test)]
mod tests {
    use clap::CommandFactory;

    use super::*;

    #[test]
    fn the_options_do_not_contradict_each_other() {
        Cli::command().debug_assert();
    }

    #[test]
    fn the_version_names_the_image_format() {
        let format = format!("(image format {})", rpi_image::rpib::VERSION);
        assert!(VERSION.ends_with(&format));
    }
}
