//! The compiler on the command line: `rpic check`, `compile`, `fmt`, `explain`.
//!
//! Exit status: 0 if all is well, 1 if something was found, 2 for bad input.

mod args;
mod check;
mod emit;
mod fmt;
mod shell;

use std::process::ExitCode;

use args::{Cli, Task};
use clap::Parser;

/// A task's end: whether all is well.
type Outcome = Result<bool, Box<dyn std::error::Error>>;

fn main() -> ExitCode {
    let done = match Cli::parse().task {
        Task::Check(args) => check::check(&args),
        Task::Compile(args) => emit::compile(&args),
        Task::Fmt(args) => fmt::fmt(&args),
        Task::Explain { code } => check::explain(&code),
        Task::Completions { shell } => shell::completions(shell),
        Task::Man { folder } => shell::man(&folder),
    };
    match done {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::from(1),
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::from(2)
        }
    }
}
