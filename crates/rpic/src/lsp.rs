//! `rpic lsp`: the language server, over standard input and output.

use std::io;

use crate::outcome::{CommandResult, Exit};

/// Carries out `rpic lsp`: runs the language server for one editor until the editor closes the connection.
pub(crate) fn lsp() -> CommandResult {
    rpi_lsp::serve(io::BufReader::new(io::stdin()), io::stdout())?;
    Ok(Exit::Success)
}
