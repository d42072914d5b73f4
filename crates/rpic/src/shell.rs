//! Shell completions and manual pages, generated from the command line definition.

use std::path::Path;

use clap::CommandFactory;
use clap_complete::Shell;

use crate::args::Cli;
use crate::outcome::{CommandResult, Exit};

/// Prints the completion script of a shell.
pub(crate) fn completions(shell: Shell) -> CommandResult {
    clap_complete::generate(shell, &mut Cli::command(), "rpic", &mut std::io::stdout());
    Ok(Exit::Success)
}

/// Writes the manual pages to a folder, which is created if necessary.
pub(crate) fn man(folder: &Path) -> CommandResult {
    std::fs::create_dir_all(folder)?;
    clap_mangen::generate_to(Cli::command(), folder)?;
    Ok(Exit::Success)
}
