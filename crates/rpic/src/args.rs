//! What can be asked for on the command line.

use std::path::PathBuf;

use clap::{Args, Parser, Subcommand, ValueEnum};
use clap_complete::Shell;
use rpi_diag::Format;

/// Version of the tool and of the image format that it writes.
const VERSION: &str = concat!(env!("CARGO_PKG_VERSION"), " (image format 1)");

/// The compiler: from programs and nets to images.
#[derive(Debug, Parser)]
#[command(name = "rpic", version = VERSION, arg_required_else_help = true)]
pub(crate) struct Cli {
    /// What to do.
    #[command(subcommand)]
    pub(crate) task: Task,
}

/// The tasks.
#[derive(Debug, Subcommand)]
pub(crate) enum Task {
    /// Look for faults in programs and nets.
    Check(CheckArgs),
    /// Make an image, or show what lies between.
    Compile(CompileArgs),
    /// Set programs in the one style of the language.
    Fmt(FmtArgs),
    /// Say more about the code of a finding.
    Explain {
        /// The code, `RPI4001`.
        code: String,
    },
    /// Print the completions of a shell.
    Completions {
        /// The shell.
        shell: Shell,
    },
    /// Write the manual pages into a folder.
    Man {
        /// The folder.
        folder: PathBuf,
    },
}

/// Options of `rpic check`.
#[derive(Args, Debug)]
pub(crate) struct CheckArgs {
    /// Programs and nets, plain or .gz.
    #[arg(required = true)]
    pub(crate) files: Vec<PathBuf>,
    /// human, short, json, sarif or github.
    #[arg(long, default_value = "human")]
    pub(crate) format: Format,
    /// List the passes over a net and what they establish.
    #[arg(long)]
    pub(crate) explain_analysis: bool,
}

/// Options of `rpic compile`.
#[derive(Args, Debug)]
pub(crate) struct CompileArgs {
    /// A program or net, plain or .gz.
    pub(crate) file: PathBuf,
    /// The image to write; else the file's name with .rpib.
    #[arg(long, short, value_name = "FILE")]
    pub(crate) output: Option<PathBuf>,
    /// The command, if there are several.
    #[arg(long, value_name = "NAME")]
    pub(crate) command: Option<String>,
    /// Period of the cycle.
    #[arg(long, default_value = "1ms", value_parser = rpi_driver::parse_period)]
    pub(crate) period: u64,
    /// Print a form in between instead of writing an image.
    #[arg(long, value_enum)]
    pub(crate) emit: Option<Emit>,
}

/// The forms in between.
#[derive(Clone, Copy, PartialEq, Eq, Debug, ValueEnum)]
pub(crate) enum Emit {
    /// The image in readable form.
    Image,
    /// The net in the reference system's text form.
    Rpinet,
}

/// Options of `rpic fmt`.
#[derive(Args, Debug)]
pub(crate) struct FmtArgs {
    /// Programs.
    #[arg(required_unless_present = "stdin")]
    pub(crate) files: Vec<PathBuf>,
    /// Change nothing; exit status 1 if something would change.
    #[arg(long)]
    pub(crate) check: bool,
    /// From standard input to standard output.
    #[arg(long)]
    pub(crate) stdin: bool,
}
