//! Completions and manual pages, made from the options themselves.

use std::path::Path;

use clap::CommandFactory;
use clap_complete::Shell;

use crate::args::Cli;
use crate::outcome::{Exit, Outcome};

/// Prints the completions of a shell.
pub(crate) fn completions(shell: Shell) -> Outcome {
    clap_complete::generate(shell, &mut Cli::command(), "rpic", &mut std::io::stdout());
    Ok(Exit::Good)
}

/// Writes the manual pages into a folder, which is made if it is not there.
pub(crate) fn man(folder: &Path) -> Outcome {
    std::fs::create_dir_all(folder)?;
    clap_mangen::generate_to(Cli::command(), folder)?;
    Ok(Exit::Good)
}
