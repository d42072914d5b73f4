//! Command-line tool of the control core: `rpi run`, `rpi serve`, `rpi replay`, `rpi trace`, `rpi latency`.
//!
//! Exit status: 0 for success, 1 for a command's error or a differing trace, 2 for invalid input, 3 for a fault while
//! running.

mod args;
mod budget_args;
mod cell_file;
mod exit;
mod interrupt;
mod latency;
mod node;
mod output;
mod program;
mod random;
mod random_inputs;
mod replay;
mod run;
mod serve;
mod shell;
mod target;
mod trace;

use std::process::ExitCode;

use args::{Cli, CliCommand};
use clap::Parser;
use exit::Exit;

fn main() -> ExitCode {
    let cli = Cli::parse();
    let done = match cli.task {
        CliCommand::Run(args) if args.node.is_present() => node::run(&args),
        CliCommand::Run(args) => run::run(&args),
        CliCommand::Serve(args) => serve::serve(&args),
        CliCommand::Trace(args) => trace::trace(&args),
        CliCommand::Replay(args) => replay::replay(&args),
        CliCommand::Latency(args) => latency::latency(&args),
        CliCommand::Completions { shell } => shell::completions(shell),
        CliCommand::Man { folder } => shell::man(&folder),
    };
    done.unwrap_or_else(|error| {
        rpi_diag::println_stderr!("error: {error}");
        Exit::BadInput
    })
    .into()
}
