//! Shell completions and manual pages, generated from the command-line options.

use std::path::Path;

use clap::CommandFactory;
use clap_complete::Shell;

use crate::args::Cli;
use crate::exit::{Exit, Outcome};

/// Prints the completions for a shell.
pub(crate) fn completions(shell: Shell) -> Outcome {
    clap_complete::generate(shell, &mut Cli::command(), "rpi", &mut std::io::stdout());
    Ok(Exit::Good)
}

/// Writes the manual pages into a folder, which is created if it does not exist.
pub(crate) fn man(folder: &Path) -> Outcome {
    std::fs::create_dir_all(folder)?;
    clap_mangen::generate_to(Cli::command(), folder)?;
    Ok(Exit::Good)
}
