//! Command-line tool of the control core: `rpi run`, `rpi serve`, `rpi replay`, `rpi trace`, `rpi latency`.
//!
//! Exit status: 0 for success, 1 for a command's error or a differing trace, 2 for invalid input, 3 for a fault while
//! running.

mod args;
mod exit;
mod interrupt;
mod latency;
mod made_up;
mod node;
mod output;
mod program;
mod random;
mod replay;
mod run;
mod serve;
mod share;
mod shell;
mod target;
mod trace;

use std::process::ExitCode;

use args::{Cli, Task};
use clap::Parser;
use exit::Exit;

fn main() -> ExitCode {
    let cli = Cli::parse();
    let done = match cli.task {
        Task::Run(args) if args.node.is_asked_for() => node::run(&args),
        Task::Run(args) => run::run(&args),
        Task::Serve(args) => serve::serve(&args),
        Task::Trace(args) => trace::trace(&args),
        Task::Replay(args) => replay::replay(&args),
        Task::Latency(args) => latency::latency(&args),
        Task::Completions { shell } => shell::completions(shell),
        Task::Man { folder } => shell::man(&folder),
    };
    done.unwrap_or_else(|error| {
        rpi_diag::tell_line!("error: {error}");
        Exit::BadInput
    })
    .into()
}
