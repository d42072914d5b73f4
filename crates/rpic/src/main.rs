//! The compiler on the command line: `rpic check`, `compile`, `import`, `fmt`, `test`, `doc`, `new`, `explain`, `graph`, `lsp`.
//!
//! Exit status: 0 if all is well, 1 if something was found, 2 for bad usage or a file that cannot be read.

mod args;
mod check;
mod compile;
mod coverage;
mod doc;
mod explain;
mod fmt;
mod lsp;
mod machine;
mod mend;
mod new;
mod outcome;
mod shell;
mod test;

use std::process::ExitCode;

use args::{Cli, Task};
use clap::Parser;
use mimalloc::MiMalloc;
use outcome::Exit;

/// Programs are many small pieces: the platform's allocator would take a quarter of the time of a check.
#[global_allocator]
static ALLOCATOR: MiMalloc = MiMalloc;

fn main() -> ExitCode {
    let done = match Cli::parse().task {
        Task::Check(args) => check::check(&args),
        Task::Compile(args) => compile::compile(&args),
        Task::Import(args) => compile::import(&args),
        Task::Fmt(args) => fmt::fmt(&args),
        Task::Test(args) => test::test(&args),
        Task::Doc(args) => doc::doc(&args),
        Task::New { path } => new::new(&path),
        Task::Explain { code, .. } => match code {
            Some(code) => explain::explain(&code),
            None => explain::list(),
        },
        Task::Lsp => lsp::lsp(),
        Task::Machine(args) => machine::machine(&args),
        Task::Graph(args) => compile::graph(&args),
        Task::Completions { shell } => shell::completions(shell),
        Task::Man { folder } => shell::man(&folder),
    };
    done.unwrap_or_else(|error| {
        rpi_diag::tell_line!("error: {error}");
        Exit::BadInput
    })
    .into()
}
