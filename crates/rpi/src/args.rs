//! What can be asked for on the command line.

use std::net::SocketAddr;
use std::path::PathBuf;

use clap::{Args, Parser, Subcommand, ValueEnum, value_parser};
use clap_complete::Shell;
use rpi_driver::Claims;
use rpi_host::realtime::{OnOverrun, OverrunPolicy, RealTime, Wanted};
use rpi_host::run::Setting;
use rpi_serve::OnLoss;

use crate::share::ShareArgs;

/// Version of the tool and of the image format that it reads and writes.
const VERSION: &str = concat!(env!("CARGO_PKG_VERSION"), " (image format 2)");

/// The control core: runs commands that follow one another without a gap.
#[derive(Debug, Parser)]
#[command(name = "rpi", version = VERSION, arg_required_else_help = true)]
pub(crate) struct Cli {
    /// What to do.
    #[command(subcommand)]
    pub(crate) task: Task,
}

/// The tasks.
#[derive(Debug, Subcommand)]
pub(crate) enum Task {
    /// Run a program, a net or an image against a cell, or a node against a table.
    ///
    /// With --inputs or --step a node of a program (.rpi, .lus) is run by itself: one row of the table per cycle. Else
    /// commands run, and it shows what happened at the end. Exit status: 0 if all ended without error, 1 for a command's error, 2 for bad
    /// input, 3 for a fault while running, or set-points that a device refused and no command minded. Interrupted (SIGINT, SIGTERM, SIGHUP), it does what it does after --time: commands are stopped, devices brake,
    /// files are finished, what happened is shown; the exit status is then 130, 143 or 129.
    Run(RunArgs),
    /// Run as a server: commands are loaded, started, scheduled and watched from outside while others run.
    ///
    /// Speaks the DirectIO protocol 2.0 (websocket `/DirectIO/` and pages) and JSON-RPC 2.0 (websocket `/rpc`). Listens on
    /// this machine only, unless told otherwise; beyond it a token and TLS are needed. Runs until it is interrupted
    /// (SIGINT, SIGTERM, SIGHUP): then everything is stopped, and it closes once all devices stand still.
    Serve(ServeArgs),
    /// Record all ports of a run as a trace, or pick rows out of a recording.
    ///
    /// Of a program, net or image: runs it on simulated time and writes what every port carried in every cycle, in the
    /// form that `rpi replay` reads. Of recorded rows or a trace (.csv, .jsonl, .trace, plain or .gz): prints its rows.
    Trace(TraceArgs),
    /// Run a recording again, or a net against a recorded trace, and compare every value.
    ///
    /// A recording (.mcap) has all that is needed: the same requests are made in the same ticks, devices answer as they did, and every
    /// flow, set-point and event is compared bit for bit, across all switches of commands.
    ///
    /// What came from outside is taken from the trace: device ports, inputs, cancel, the wall clock. Everything else is
    /// computed and compared. Exit status 0 only if nothing differs, 1 if something does, 2 for bad input.
    Replay(ReplayArgs),
    /// Measure which period this machine can hold, and say why.
    ///
    /// A thread with what the system grants of priority, memory and core is woken again and again; how late that is, and how long the
    /// cycles of a program take if one is given, must fit a period.
    Latency(LatencyArgs),
    /// Print the completions of a shell.
    #[command(hide = true)]
    Completions {
        /// The shell.
        shell: Shell,
    },
    /// Write the manual pages into a folder.
    #[command(hide = true)]
    Man {
        /// The folder.
        folder: PathBuf,
    },
}

/// What to run, and against what.
#[derive(Args, Debug)]
pub(crate) struct Target {
    /// Description of the devices; without it, `cell.toml` beside the program.
    #[arg(long, value_name = "FILE")]
    pub(crate) cell: Option<PathBuf>,
    /// The command or task to run, if there are several.
    #[arg(long, value_name = "NAME")]
    pub(crate) command: Option<String>,
    /// Period of the cycle; 1ms unless an image was compiled for another one.
    #[arg(long, value_parser = rpi_driver::parse_period, value_name = "TIME")]
    pub(crate) period: Option<u64>,
    /// Stop after so many cycles.
    #[arg(long, value_name = "N", conflicts_with = "time", value_parser = value_parser!(u64).range(1..))]
    pub(crate) cycles: Option<u64>,
    /// Stop after so long (of the cell's time).
    #[arg(long, value_parser = rpi_driver::parse_period, value_name = "TIME")]
    pub(crate) time: Option<u64>,
    /// Set an input before the start; may be given several times.
    #[arg(long = "set", value_name = "KEY=VALUE")]
    pub(crate) settings: Vec<Setting>,
}

/// Options of `rpi run`.
#[derive(Args, Debug)]
pub(crate) struct RunArgs {
    /// What to run: .rpi, .lus, .rpinet or .rpib, plain or .gz.
    pub(crate) program: PathBuf,
    #[command(flatten)]
    pub(crate) node: NodeArgs,
    #[command(flatten)]
    pub(crate) target: Target,
    /// Run on simulated time, as fast as the machine allows (default).
    #[arg(long, conflicts_with = "real_time")]
    pub(crate) sim_time: bool,
    #[command(flatten)]
    pub(crate) clock: ClockArgs,
    #[command(flatten)]
    pub(crate) share: ShareArgs,
    /// Assertions and contracts: left out, watched and told with cycle and values, or a fault that ends the run.
    #[arg(long, value_name = "HOW", default_value = "report")]
    pub(crate) contracts: Contracts,
    /// How long it takes to have the next command ready once one has started.
    #[arg(long, value_parser = rpi_driver::parse_period, value_name = "TIME")]
    pub(crate) planning_time: Option<u64>,
    /// What happens if a command takes over with a jump of position, velocity or acceleration.
    #[arg(long, value_name = "POLICY", default_value = "refuse")]
    pub(crate) on_jump: OnJump,
    /// Record what happens. A file .mcap gets everything: viewers open it, and `rpi replay` runs it again. Others get exports and
    /// devices as rows of cycle, flow, value: JSON lines for .jsonl, else comma-separated.
    #[arg(long, value_name = "FILE")]
    pub(crate) record: Option<PathBuf>,
    /// Print one number for all that the devices did: equal for runs with the same bits in every tick.
    #[arg(long)]
    pub(crate) digest: bool,
    /// Draw the motion as SVG.
    #[arg(long, value_name = "FILE")]
    pub(crate) plot: Option<PathBuf>,
    /// Print what happened as JSON.
    #[arg(long)]
    pub(crate) json: bool,
}

/// What is asked of the machine's clock.
#[derive(Args, Debug)]
pub(crate) struct ClockArgs {
    /// Run on the machine's clock, with priority, locked memory and a core of its own where the system allows it.
    #[arg(long)]
    pub(crate) real_time: bool,
    /// What happens if a cycle ends when the next one was due already: `catch-up`, `skip`, or `stop:N/M` at the Nth of M cycles.
    #[arg(long, value_name = "POLICY", default_value_t, requires = "real_time")]
    pub(crate) on_overrun: OverrunPolicy,
    /// What becomes of the command that took the longest in such a cycle: `count`, `abort:N/M` (it ends at the Nth of its M cycles)
    /// or `stop:N/M` (everything does).
    #[arg(long, value_name = "POLICY", default_value_t, requires = "real_time")]
    pub(crate) on_command_overrun: OnOverrun,
    /// Priority of the cycle among the threads of SCHED_FIFO, 1 to 99.
    #[arg(long, value_name = "N", default_value_t = Wanted::default().priority, requires = "real_time", value_parser = value_parser!(u8).range(1..100))]
    pub(crate) priority: u8,
    /// Core of the cycle; the last one unless said otherwise.
    #[arg(long, value_name = "N", requires = "real_time")]
    pub(crate) core: Option<usize>,
    /// Forbid the cycle's thread every system call but sleeping and reading the clock: another one ends the process.
    #[arg(long, requires = "real_time")]
    pub(crate) fence: bool,
}

impl ClockArgs {
    /// What is asked of the system, and what happens to cycles that take too long.
    pub(crate) fn real_time(&self) -> RealTime {
        RealTime {
            wanted: Wanted {
                priority: self.priority,
                core: self.core,
            },
            overrun: self.on_overrun,
            commands: self.on_command_overrun,
            fence: self.fence,
        }
    }
}

/// What happens if the first set-points of a command that takes over do not join those before.
#[derive(ValueEnum, Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum OnJump {
    /// It ends with a fault before it moves anything; the device stops.
    Refuse,
    /// Everything is stopped.
    Stop,
    /// It is told; the device may still refuse the set-point.
    Allow,
}

impl From<OnJump> for rpi_core::Continuity {
    fn from(policy: OnJump) -> Self {
        match policy {
            OnJump::Refuse => Self::Refuse,
            OnJump::Stop => Self::Stop,
            OnJump::Allow => Self::Allow,
        }
    }
}

/// What becomes of assertions and contracts.
#[derive(Clone, Copy, PartialEq, Eq, Debug, ValueEnum)]
pub(crate) enum Contracts {
    /// They are left out and cost nothing.
    Off,
    /// They are watched; what does not hold is told, and the run goes on.
    Report,
    /// One that does not hold ends the command by a fault.
    Fault,
}

impl From<Contracts> for Claims {
    fn from(contracts: Contracts) -> Claims {
        match contracts {
            Contracts::Off => Claims::Off,
            Contracts::Report => Claims::Report,
            Contracts::Fault => Claims::ReportedFault,
        }
    }
}

/// Options of `rpi serve`.
#[derive(Args, Debug)]
pub(crate) struct ServeArgs {
    /// Description of the devices; without it there are only those that clients make.
    #[arg(long, value_name = "FILE")]
    pub(crate) cell: Option<PathBuf>,
    /// Where to listen.
    #[arg(long, value_name = "ADDRESS:PORT", default_value = "127.0.0.1:8080")]
    pub(crate) listen: SocketAddr,
    /// Listen at this Unix socket too: JSON-RPC, a message in a line.
    #[arg(long, value_name = "FILE")]
    pub(crate) socket: Option<PathBuf>,
    /// File with the token that clients must show; needed beyond this machine, as is TLS.
    #[arg(long, value_name = "FILE")]
    pub(crate) token_file: Option<PathBuf>,
    /// Certificate by which the server shows who it is, in PEM, with those between it and an authority.
    #[arg(long, value_name = "FILE", requires = "tls_key")]
    pub(crate) tls_cert: Option<PathBuf>,
    /// Private key of the certificate, in PEM.
    #[arg(long, value_name = "FILE", requires = "tls_cert")]
    pub(crate) tls_key: Option<PathBuf>,
    /// Listen beyond this machine without token or TLS all the same: whoever reaches the port moves the devices.
    #[arg(long)]
    pub(crate) insecure: bool,
    /// Length of a tick; periods of commands are whole multiples of it.
    #[arg(long, value_parser = rpi_driver::parse_period, value_name = "TIME", default_value = "1ms")]
    pub(crate) period: u64,
    /// What becomes of a client's commands when it is gone and has not said so itself.
    #[arg(long, value_name = "POLICY", value_parser = on_loss, default_value = "cancel")]
    pub(crate) on_loss: OnLoss,
    #[command(flatten)]
    pub(crate) share: ShareArgs,
    #[command(flatten)]
    pub(crate) clock: ClockArgs,
    /// Record everything until the server is interrupted (SIGINT, SIGTERM, SIGHUP): a file .mcap, which viewers open and `rpi replay` runs again.
    #[arg(long, value_name = "FILE")]
    pub(crate) record: Option<PathBuf>,
    /// What happens if a command takes over with a jump of position, velocity or acceleration. Unless given, programs are
    /// refused then and nets are allowed to: those of the reference system do not look.
    #[arg(long, value_name = "POLICY")]
    pub(crate) on_jump: Option<OnJump>,
}

fn tolerance(text: &str) -> Result<f64, String> {
    let number = text.parse().ok();
    let usable = number.filter(|n: &f64| n.is_finite() && *n >= 0.0);
    usable.ok_or_else(|| "a number from 0 up is needed".to_owned())
}

fn on_loss(name: &str) -> Result<OnLoss, String> {
    OnLoss::by_name(name).ok_or_else(|| {
        let known = OnLoss::ALL.map(|(name, _)| name);
        format!("one of {} is needed", known.join(", "))
    })
}

/// How a node is run by itself.
#[derive(Args, Debug)]
pub(crate) struct NodeArgs {
    /// The node; else the one marked by --%MAIN, or called like the file, or the last that nobody calls.
    #[arg(long, value_name = "NAME", help_heading = "Nodes by themselves")]
    pub(crate) node: Option<String>,
    /// Table of inputs: comma-separated, a header of flow names, a row per cycle; - for standard input.
    #[arg(long, value_name = "FILE", help_heading = "Nodes by themselves")]
    pub(crate) inputs: Option<PathBuf>,
    /// Where the table of outputs goes; standard output unless said.
    #[arg(long, value_name = "FILE", help_heading = "Nodes by themselves")]
    pub(crate) outputs: Option<PathBuf>,
    /// Show the node's local flows, too.
    #[arg(long, help_heading = "Nodes by themselves")]
    pub(crate) locals: bool,
    /// Ask for the inputs of each cycle.
    #[arg(long, conflicts_with = "inputs", help_heading = "Nodes by themselves")]
    pub(crate) step: bool,
    /// Make inputs up that keep what the node assumes of them, from this number on, for as many cycles as --cycles says.
    #[arg(long, value_name = "SEED", conflicts_with_all = ["inputs", "step"], help_heading = "Nodes by themselves")]
    pub(crate) random: Option<u64>,
    /// Write values of enums as numbers.
    #[arg(long, help_heading = "Nodes by themselves")]
    pub(crate) numbers: bool,
}

impl NodeArgs {
    /// Whether a node is to be run.
    pub(crate) fn is_asked_for(&self) -> bool {
        let by_itself = self.step || self.locals || self.random.is_some();
        by_itself || self.node.is_some() || self.inputs.is_some()
    }
}

/// Options of `rpi trace`.
#[derive(Args, Debug)]
pub(crate) struct TraceArgs {
    /// What to run, or the recording to read.
    pub(crate) source: PathBuf,
    #[command(flatten)]
    pub(crate) target: Target,
    /// Write to this file instead of to standard output.
    #[arg(long, short, value_name = "FILE")]
    pub(crate) output: Option<PathBuf>,
    /// Only flows whose names fit; `*` stands for any text; may be given several times.
    #[arg(long, value_name = "PATTERN")]
    pub(crate) flow: Vec<String>,
    /// Only cycles from this one on.
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub(crate) from: u64,
    /// Only cycles up to this one.
    #[arg(long, value_name = "N", default_value_t = u64::MAX - 1, hide_default_value = true)]
    pub(crate) to: u64,
}

/// Options of `rpi replay`.
#[derive(Args, Debug)]
pub(crate) struct ReplayArgs {
    /// A recording (.mcap); or the net: .rpinet, or a program (.rpi), plain or .gz.
    pub(crate) net: PathBuf,
    /// The trace, tab- or comma-separated, plain or .gz. Given several times, the recordings are joined.
    #[arg(long, value_name = "FILE")]
    pub(crate) trace: Vec<PathBuf>,
    /// The command, if the program has several.
    #[arg(long, value_name = "NAME")]
    pub(crate) command: Option<String>,
    /// Period at which the trace was recorded.
    #[arg(long, default_value = "25ms", value_parser = rpi_driver::parse_period)]
    pub(crate) period: u64,
    /// How far apart equal values may be, absolute up to 1 and relative beyond.
    #[arg(long, default_value_t = 1e-9, value_parser = tolerance)]
    pub(crate) tolerance: f64,
    /// Print the report as JSON.
    #[arg(long)]
    pub(crate) json: bool,
}

/// Options of `rpi latency`.
#[derive(Args, Debug)]
pub(crate) struct LatencyArgs {
    /// How often the thread is woken.
    #[arg(long, value_parser = rpi_driver::parse_period, value_name = "TIME", default_value = "1ms")]
    pub(crate) period: u64,
    /// How long it is measured.
    #[arg(long, value_parser = rpi_driver::parse_period, value_name = "TIME", default_value = "10s")]
    pub(crate) time: u64,
    /// Priority among the threads of SCHED_FIFO, 1 to 99.
    #[arg(long, value_name = "N", default_value_t = Wanted::default().priority, value_parser = value_parser!(u8).range(1..100))]
    pub(crate) priority: u8,
    /// The core; the last one unless said otherwise.
    #[arg(long, value_name = "N")]
    pub(crate) core: Option<usize>,
    /// Run this program on real time for as long before, and count its cycles in.
    #[arg(long, value_name = "FILE")]
    pub(crate) program: Option<PathBuf>,
    /// Description of the program's devices; without it, `cell.toml` beside the program.
    #[arg(long, value_name = "FILE", requires = "program")]
    pub(crate) cell: Option<PathBuf>,
    /// The command or task of the program, if there are several.
    #[arg(long, value_name = "NAME", requires = "program")]
    pub(crate) command: Option<String>,
    /// Print the figures as JSON.
    #[arg(long)]
    pub(crate) json: bool,
}

#[cfg(test)]
mod tests {
    use clap::CommandFactory;

    use super::*;

    #[test]
    fn the_options_do_not_contradict_each_other() {
        Cli::command().debug_assert();
    }

    #[test]
    fn the_version_names_the_image_format() {
        let format = format!("(image format {})", rpi_image::rpib::VERSION);
        assert!(VERSION.ends_with(&format));
    }
}
