//! The compiler on the command line: `rpic check`, `compile`, `import`, `fmt`, `test`, `doc`, `new`, `explain`, `graph`, `lsp`.
//!
//! Exit status: 0 for success, 1 if errors were reported, 2 for wrong usage or a file that cannot be read.

mod args;
mod c_target;
mod check;
mod compile;
mod coverage;
mod doc;
mod explain;
mod fix;
mod fmt;
mod fmu;
mod lsp;
mod machine;
mod new;
mod outcome;
mod test;

use std::path::Path;
use std::process::ExitCode;

use args::{Cli, CliCommand};
use clap::Parser;
use mimalloc::MiMalloc;
use outcome::{CommandResult, Exit};

/// Global allocator of the tool. Compilation allocates many small objects; with the allocator of the system, a check
/// takes a quarter longer.
#[global_allocator]
static ALLOCATOR: MiMalloc = MiMalloc;

fn main() -> ExitCode {
    let done = match Cli::parse().task {
        CliCommand::Check(args) => check::check(&args),
        CliCommand::Compile(args) => compile::compile(&args),
        CliCommand::Import(args) => compile::import(&args),
        CliCommand::Fmt(args) => fmt::fmt(&args),
        CliCommand::Test(args) => test::test(&args),
        CliCommand::Doc(args) => doc::doc(&args),
        CliCommand::New { path } => new::new(&path),
        CliCommand::Explain { code, .. } => match code {
            Some(code) => explain::explain(&code),
            None => explain::list(),
        },
        CliCommand::Lsp => lsp::lsp(),
        CliCommand::Machine(args) => machine::machine(&args),
        CliCommand::Graph(args) => compile::graph(&args),
        CliCommand::Completions { shell } => completions(shell),
        CliCommand::Man { folder } => man_pages(&folder),
    };
    rpi_cli::exit_code(done, Exit::BadInput)
}

/// Carries out `rpic completions`: prints the completion script of a shell.
fn completions(shell: rpi_cli::Shell) -> CommandResult {
    rpi_cli::print_completions::<Cli>(shell);
    Ok(Exit::Success)
}

/// Carries out `rpic man`: writes the manual pages of all subcommands to a folder.
fn man_pages(folder: &Path) -> CommandResult {
    rpi_cli::write_man_pages::<Cli>(folder)?;
    Ok(Exit::Success)
}
