//! Command-line tool of the control core: `rpi run`, `rpi serve`, `rpi replay`, `rpi view`, `rpi debug`, `rpi export`, `rpi recording`,
//! `rpi trace`, `rpi latency`, `rpi robot`, `rpi cell`.
//!
//! Exit status: 0 for success, 1 for a command's error or a differing trace, 2 for invalid input, 3 for a fault while
//! running, 4 for a crash of the control core.

mod allocator;
mod args;
mod budget_args;
mod c_target;
mod cell_file;
mod debug;
mod exit;
mod export;
mod foxglove_args;
mod guard;
mod interrupt;
mod latency;
mod latency_args;
mod live_view_args;
mod node;
mod output;
mod own_program;
mod program;
mod random;
mod random_inputs;
mod recorded_nets;
mod recorded_run;
mod recorded_source;
mod recording_args;
mod recording_edits;
mod recording_verbs;
mod replay;
mod robot;
mod robot_args;
mod run;
mod run_pages;
mod run_report;
mod run_view;
mod serve;
mod socket_arg;
mod target;
mod target_args;
mod teach;
mod trace;
mod view;
mod view_args;
mod watched_recording;
mod why;

use std::path::Path;
use std::process::ExitCode;

use args::{Cli, CliCommand};
use clap::Parser;
use exit::{CommandResult, Exit};
use robot_args::CellCommand;

fn main() -> ExitCode {
    let cli = Cli::parse();
    if matches!(cli.task, CliCommand::Serve(_)) {
        allocator::return_memory_early();
    }
    let done = match cli.task {
        CliCommand::Run(args) if args.node.is_present() => node::run(&args),
        CliCommand::Run(args) if args.guard.is_guard() => {
            let recording = args.record.as_deref().filter(|path| run::is_mcap(path));
            guard::guard(&args.guard, recording, false)
        }
        CliCommand::Run(args) => run::run(&args),
        CliCommand::Serve(args) if args.guard.is_guard() => {
            guard::guard(&args.guard, args.record.as_deref(), true)
        }
        CliCommand::Serve(args) => serve::serve(&args),
        CliCommand::Trace(args) => trace::trace(&args),
        CliCommand::Replay(args) => replay::replay(&args),
        CliCommand::View(args) => view::view(&args),
        CliCommand::Why(args) => why::why_command(&args),
        CliCommand::Debug(args) => debug::debug(&args),
        CliCommand::Export(args) => export::export(&args),
        CliCommand::Recording(command) => recording_verbs::recording(&command),
        CliCommand::Latency(args) => latency::latency(&args),
        CliCommand::Robot(command) => robot::robot(&command),
        CliCommand::Cell(CellCommand::Check { cell }) => cell_file::check(&cell),
        CliCommand::Teach(args) => teach::teach(&args),
        CliCommand::CompileWorker => serve::compile_worker(),
        CliCommand::Cell(CellCommand::Schema) => cell_file::schema(),
        CliCommand::Completions { shell } => completions(shell),
        CliCommand::Man { folder } => man_pages(&folder),
    };
    rpi_cli::exit_code(done, Exit::BadInput)
}

/// Carries out `rpi completions`: prints the completion script of a shell.
fn completions(shell: rpi_cli::Shell) -> CommandResult {
    rpi_cli::print_completions::<Cli>(shell);
    Ok(Exit::Success)
}

/// Carries out `rpi man`: writes the manual pages of all subcommands to a folder.
fn man_pages(folder: &Path) -> CommandResult {
    rpi_cli::write_man_pages::<Cli>(folder)?;
    Ok(Exit::Success)
}
