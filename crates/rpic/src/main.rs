//! The compiler on the command line: `rpic check`, `compile`, `import`, `fmt`, `test`, `doc`, `new`, `explain`, `graph`, `lsp`.
//!
//! Exit status: 0 for success, 1 if errors were reported, 2 for wrong usage or a file that cannot be read.

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

/// Allocator. Compilation allocates many small objects; with the system allocator a check takes a quarter longer.
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
