//! Command-line options.

use std::net::SocketAddr;
use std::path::PathBuf;

use clap::{Args, Parser, Subcommand, ValueEnum, value_parser};
use rpi_cli::{CompilerArgs, ExecutionTarget, Shell, TargetArgs, VERSION};
use rpi_driver::ClaimPolicy;
use rpi_runtime::realtime::{CommandOverrunPolicy, OverrunPolicy, RealTime, SchedulingOptions};
use rpi_serve::{OnLoss, SocketSettings};

use crate::budget_args::BudgetArgs;
use crate::debug::DebugArgs;
use crate::export::ExportArgs;
use crate::foxglove_args::FoxgloveArgs;
use crate::guard::GuardArgs;
use crate::latency_args::LatencyArgs;
use crate::live_view_args::LiveViewArgs;
use crate::recording_args::RecordingArgs;
use crate::recording_verbs::RecordingCommand;
use crate::robot_args::{CellCommand, RobotCommand};
use crate::socket_arg::parse_socket;
use crate::target_args::Target;
use crate::teach::TeachArgs;
use crate::view_args::ViewArgs;
use crate::why::WhyArgs;

/// Control core of robots: runs commands that take over from one another without a gap.
#[derive(Debug, Parser)]
#[command(name = "rpi", version = VERSION, arg_required_else_help = true)]
pub(crate) struct Cli {
    /// Subcommand of `rpi` with its options.
    #[command(subcommand)]
    pub(crate) task: CliCommand,
}

/// Subcommands of `rpi`.
#[derive(Debug, Subcommand)]
pub(crate) enum CliCommand {
    /// Run a program, a net or an image with a cell, or a node with a table of inputs.
    ///
    /// With --inputs or --step, a node of a program (.rpi, .lus) runs alone, with one row of the table per cycle.
    /// Otherwise commands run, and a summary is printed at the end. Exit status: 0 if all ended without error, 1 for a
    /// command's error, 2 for invalid input, 3 for a fault while running or for set-points that a device refused and no
    /// command handled, 4 for a crash under --guard. An interrupt (SIGINT, SIGTERM, SIGHUP) acts as the end of --time: commands are stopped, devices
    /// brake, files are completed and the summary is printed; the exit status is then 130, 143 or 129.
    Run(RunArgs),
    /// Run as a server: clients load, start, schedule and watch commands while others run.
    ///
    /// Supports the DirectIO protocol 2.0 (websocket `/DirectIO/` and pages) and JSON-RPC 2.0 (websocket `/rpc`). By
    /// default listens on this machine only; any other address requires a token and TLS. Runs until it is interrupted
    /// (SIGINT, SIGTERM, SIGHUP): then everything is stopped, and the server closes once all devices are at rest.
    Serve(ServeArgs),
    /// Record all ports of a run as a trace, or select rows of a recording.
    ///
    /// A program, net or image runs on simulated time, and the value of every port in every cycle is written in the
    /// format that `rpi replay` reads. Of recorded rows or a trace (.csv, .jsonl, .trace, plain or .gz), the selected
    /// rows are printed.
    Trace(TraceArgs),
    /// Replay a recording, or a net against a recorded trace, and compare every value.
    ///
    /// A recording (.mcap) is complete: the same requests are made in the same cycles, devices answer as recorded, and
    /// every flow, set-point and event is compared bit for bit, across all takeovers of commands.
    ///
    /// For a net, external values are taken from the trace: device ports, inputs, cancel, the wall clock. Everything
    /// else is computed and compared. Exit status: 0 if nothing differs, 1 if something differs, 2 for invalid input.
    Replay(ReplayArgs),
    /// Show a recording in the browser: the cell in 3D, plots, a timeline and the program.
    ///
    /// The page is served on this machine only, until the process is interrupted. With --report, it is written to a
    /// file that any browser opens without this tool and without a network.
    View(ViewArgs),
    /// Explain why a flow has its value: its causes, back over the cycles of a recording.
    ///
    /// The recording is replayed with the values of all ports. Causes are followed through the operands that decide (the chosen
    /// branch of an `if`, a false operand of an `and`, an absent operand, the condition of an inactive fragment) and through delays,
    /// down to inputs, sensors, constants and first values.
    Why(WhyArgs),
    /// Go through the cycles of a recording or a simulated run, forwards and backwards, with the value of every flow.
    ///
    /// Lines of commands are read from the standard input (`help` lists them), or, with --dap, requests of an editor. Breakpoints stop at
    /// lines, at changes of flows, and where a condition of the language becomes true.
    Debug(DebugArgs),
    /// Write the values of a recording as a table (CSV), one row per tick and one column per number.
    Export(ExportArgs),
    /// Examine a recording, or complete one that was cut off.
    #[command(subcommand)]
    Recording(RecordingCommand),
    /// Measure which period this machine can hold, and show why.
    ///
    /// A thread with the priority, memory locking and core that the system grants is woken periodically. Its wake-up
    /// delay, plus the cycle time of a program if one is specified, must fit into the period.
    Latency(LatencyArgs),
    /// Examine robot descriptions: URDF, Denavit-Hartenberg tables, lengths of links.
    #[command(subcommand)]
    Robot(RobotCommand),
    /// Examine cell descriptions, which list the devices.
    #[command(subcommand)]
    Cell(CellCommand),
    /// Compile a text for `rpi serve`, which starts this process: request on standard input, answer on standard output.
    #[command(hide = true)]
    CompileWorker,
    /// Move an arm by keys, and write its points to a file, for programs with `use points;`.
    ///
    /// Without --connect, the arm of the cell is simulated. Each point is written at once: the pose of the tool and the joint
    /// positions. If the standard input is not a terminal, the keys are read from it, and each motion ends before the next
    /// key counts.
    Teach(TeachArgs),
    /// Print the completion script of a shell.
    #[command(hide = true)]
    Completions {
        /// Shell for which completions are printed.
        shell: Shell,
    },
    /// Write the manual pages of all subcommands to a folder.
    #[command(hide = true)]
    Man {
        /// Folder into which the manual pages are written.
        folder: PathBuf,
    },
}

/// Options of `rpi run`.
#[derive(Args, Debug)]
pub(crate) struct RunArgs {
    /// File to run: .rpi, .lus, .rpinet or .rpib, plain or .gz.
    pub(crate) program: PathBuf,
    #[command(flatten)]
    pub(crate) node: NodeArgs,
    #[command(flatten)]
    pub(crate) target: Target,
    #[command(flatten, next_help_heading = "Single nodes")]
    pub(crate) execution: TargetArgs,
    /// Run on simulated time, as fast as possible (default).
    #[arg(long, conflicts_with = "real_time")]
    pub(crate) sim_time: bool,
    #[command(flatten)]
    pub(crate) clock: ClockArgs,
    #[command(flatten)]
    pub(crate) share: BudgetArgs,
    #[command(flatten)]
    pub(crate) guard: GuardArgs,
    /// Handling of assertions and contracts: leave out, report violations with cycle and values, or end the command by
    /// a fault.
    #[arg(long, value_name = "HOW", default_value = "report")]
    pub(crate) contracts: ContractsMode,
    /// Time from the start of a command until the next one is ready, such as 20ms.
    #[arg(long, value_parser = rpi_driver::parse_duration, value_name = "TIME")]
    pub(crate) planning_time: Option<u64>,
    /// Speed override of all motions of the library: share of the programmed speed, from 0 to 1.
    #[arg(long = "override", value_name = "SHARE", default_value = "1", value_parser = parse_override)]
    pub(crate) speed_override: f64,
    /// Policy for a takeover with a jump of position, velocity or acceleration.
    #[arg(long, value_name = "POLICY", default_value = "refuse")]
    pub(crate) on_jump: DiscontinuityPolicy,
    /// Record the run. A file .mcap gets everything, for viewers and `rpi replay`. Other files get exports and devices
    /// as rows of cycle, flow, value: JSON lines for .jsonl, else comma-separated.
    #[arg(long, value_name = "FILE")]
    pub(crate) record: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) recording: RecordingArgs,
    #[command(flatten)]
    pub(crate) foxglove: FoxgloveArgs,
    #[command(flatten)]
    pub(crate) view: LiveViewArgs,
    /// Print a digest of all device states, which is equal for runs with the same bits in every cycle.
    #[arg(long)]
    pub(crate) digest: bool,
    /// Plot the motion of the axes as SVG to this file.
    #[arg(long, value_name = "FILE")]
    pub(crate) plot: Option<PathBuf>,
    /// Write a page with the run to this file: the cell in 3D, plots and a timeline, for any browser.
    #[arg(long, value_name = "FILE")]
    pub(crate) report: Option<PathBuf>,
    /// Print the summary of the run as JSON.
    #[arg(long)]
    pub(crate) json: bool,
}

/// Real-time options of `rpi run` and `rpi serve`.
#[derive(Args, Debug)]
pub(crate) struct ClockArgs {
    /// Run in real time, with priority, locked memory and a dedicated core where the system allows it.
    #[arg(long)]
    pub(crate) real_time: bool,
    /// Policy for an overrun (a cycle that ends after the next one is due): `catch-up`, `skip`, or `stop:N/M` at the
    /// Nth overrun within M cycles.
    #[arg(long, value_name = "POLICY", default_value_t, requires = "real_time")]
    pub(crate) on_overrun: OverrunPolicy,
    /// Policy for the command that took the longest in an overrun: `count`, `abort:N/M` (the command ends at its Nth
    /// overrun within M cycles) or `stop:N/M` (everything is stopped).
    #[arg(long, value_name = "POLICY", default_value_t, requires = "real_time")]
    pub(crate) on_command_overrun: CommandOverrunPolicy,
    /// SCHED_FIFO priority of the thread that runs the cycles, 1 to 99.
    #[arg(long, value_name = "N", default_value_t = SchedulingOptions::default().priority, requires = "real_time", value_parser = value_parser!(u8).range(1..100))]
    pub(crate) priority: u8,
    /// Processor core of the thread that runs the cycles, counted from 0; default: the last one.
    #[arg(long, value_name = "N", requires = "real_time")]
    pub(crate) core: Option<usize>,
    /// Restrict the thread that runs the cycles to sleeping and reading the clock: any other system call ends the
    /// process.
    #[arg(long, requires = "real_time")]
    pub(crate) fence: bool,
}

impl ClockArgs {
    /// Returns the real-time settings that the options give.
    pub(crate) fn real_time(&self) -> RealTime {
        RealTime {
            resources: SchedulingOptions {
                priority: self.priority,
                core: self.core,
            },
            overrun: self.on_overrun,
            command_overrun: self.on_command_overrun,
            syscall_filter: self.fence,
        }
    }
}

/// Policy for a command whose first set-points do not continue those of its predecessor (a jump of position, velocity
/// or acceleration).
#[derive(ValueEnum, Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum DiscontinuityPolicy {
    /// End the command with a fault before it moves anything; the device stops.
    Refuse,
    /// End all commands with their devices, not only the command with the jump.
    Stop,
    /// Report the jump and continue; the device may still refuse the set-point.
    Allow,
}

impl From<DiscontinuityPolicy> for rpi_core::Continuity {
    fn from(policy: DiscontinuityPolicy) -> Self {
        match policy {
            DiscontinuityPolicy::Refuse => Self::Reject,
            DiscontinuityPolicy::Stop => Self::AbortAll,
            DiscontinuityPolicy::Allow => Self::Allow,
        }
    }
}

/// Handling of assertions and contracts during a run.
#[derive(Clone, Copy, PartialEq, Eq, Debug, ValueEnum)]
pub(crate) enum ContractsMode {
    /// Leave assertions and contracts out; they cost nothing.
    Off,
    /// Report violations of assertions and contracts, and continue the run.
    Report,
    /// Report violations, and end the command by a fault.
    Fault,
}

impl From<ContractsMode> for ClaimPolicy {
    fn from(contracts: ContractsMode) -> ClaimPolicy {
        match contracts {
            ContractsMode::Off => ClaimPolicy::Off,
            ContractsMode::Report => ClaimPolicy::Report,
            ContractsMode::Fault => ClaimPolicy::ReportAndFault,
        }
    }
}

/// Options of `rpi serve`.
#[derive(Args, Debug)]
pub(crate) struct ServeArgs {
    /// Cell description with the devices; without it, only clients add devices.
    #[arg(long, value_name = "FILE")]
    pub(crate) cell: Option<PathBuf>,
    /// Network address on which the server listens.
    #[arg(long, value_name = "ADDRESS:PORT", default_value = "127.0.0.1:8080")]
    pub(crate) listen: SocketAddr,
    /// Listen on a Unix socket too: JSON-RPC, one message per line. Its clients have the role `programmer`, or the one
    /// given by `,role=ROLE`; `,mode=660` sets the permissions of the file. May be repeated.
    #[arg(long = "socket", value_name = "FILE[,role=ROLE][,mode=MODE]", value_parser = parse_socket)]
    pub(crate) sockets: Vec<SocketSettings>,
    /// File with the tokens that clients must present, one line `NAME ROLE TOKEN` for each, or a single token; required
    /// beyond this machine, as is TLS. Roles: viewer, operator, programmer, admin.
    #[arg(long, value_name = "FILE")]
    pub(crate) token_file: Option<PathBuf>,
    /// Certificate of the server in PEM, with the intermediate certificates up to an authority.
    #[arg(long, value_name = "FILE", requires = "tls_key")]
    pub(crate) tls_cert: Option<PathBuf>,
    /// Private key of the certificate of the server, in PEM.
    #[arg(long, value_name = "FILE", requires = "tls_cert")]
    pub(crate) tls_key: Option<PathBuf>,
    /// Listen beyond this machine without token or TLS: whoever reaches the port can move the devices.
    #[arg(long)]
    pub(crate) insecure: bool,
    /// Length of a cycle, such as 1ms; the periods of commands are whole multiples of it.
    #[arg(long, value_parser = rpi_driver::parse_duration, value_name = "TIME", default_value = "1ms")]
    pub(crate) period: u64,
    /// Policy for the commands of a client that has disconnected, unless the client specifies one.
    #[arg(long, value_name = "POLICY", value_parser = on_loss, default_value = "cancel")]
    pub(crate) on_loss: OnLoss,
    /// Time in which a cancelled command must end, such as 5s, unless the client specifies one; afterwards it is
    /// aborted.
    #[arg(long, value_parser = rpi_driver::parse_duration, value_name = "TIME", default_value = "5s")]
    pub(crate) grace: u64,
    /// Append each line of the log to this file, as a JSON object with time, level and message.
    #[arg(long, value_name = "FILE")]
    pub(crate) log: Option<PathBuf>,
    /// Time in which the text of a client must be compiled.
    #[arg(long, value_parser = rpi_driver::parse_duration, value_name = "TIME", default_value = "60s", conflicts_with = "in_process")]
    pub(crate) load_timeout: u64,
    /// Compile the texts of clients in the process of the server, without limits of memory and time.
    #[arg(long)]
    pub(crate) in_process: bool,
    #[command(flatten)]
    pub(crate) share: BudgetArgs,
    #[command(flatten)]
    pub(crate) clock: ClockArgs,
    #[command(flatten)]
    pub(crate) guard: GuardArgs,
    /// Record everything until the server is interrupted (SIGINT, SIGTERM, SIGHUP), to a file .mcap for viewers and
    /// `rpi replay`.
    #[arg(long, value_name = "FILE")]
    pub(crate) record: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) recording: RecordingArgs,
    #[command(flatten)]
    pub(crate) foxglove: FoxgloveArgs,
    /// Policy for a takeover with a jump of position, velocity or acceleration. Default: `refuse` for programs, `allow`
    /// for nets, as the reference system has no such check.
    #[arg(long, value_name = "POLICY")]
    pub(crate) on_jump: Option<DiscontinuityPolicy>,
}

fn tolerance(text: &str) -> Result<f64, String> {
    let number = text.parse().ok();
    let usable = number.filter(|n: &f64| n.is_finite() && *n >= 0.0);
    usable.ok_or_else(|| "expected a number of at least 0".to_owned())
}

fn on_loss(name: &str) -> Result<OnLoss, String> {
    OnLoss::from_name(name).ok_or_else(|| {
        let known = OnLoss::ALL.map(|(name, _)| name);
        format!("expected one of {}", known.join(", "))
    })
}

/// Options of `rpi run` for running a single node instead of a command.
#[derive(Args, Debug)]
pub(crate) struct NodeArgs {
    /// Node to run; default: the one marked by --%MAIN, or named like the file, or the last one that is never called.
    #[arg(long, value_name = "NAME", help_heading = "Single nodes")]
    pub(crate) node: Option<String>,
    /// Table of inputs: comma-separated, a header of flow names, one row per cycle; - for standard input.
    #[arg(long, value_name = "FILE", help_heading = "Single nodes")]
    pub(crate) inputs: Option<PathBuf>,
    /// File for the table of outputs; default: standard output.
    #[arg(long, value_name = "FILE", help_heading = "Single nodes")]
    pub(crate) outputs: Option<PathBuf>,
    /// Show the local flows of the node in the table of outputs, too.
    #[arg(long, help_heading = "Single nodes")]
    pub(crate) locals: bool,
    /// Prompt for the inputs of each cycle on standard input.
    #[arg(long, conflicts_with = "inputs", help_heading = "Single nodes")]
    pub(crate) step: bool,
    /// Generate random inputs from this seed that satisfy the assumptions of the node, for the number of cycles of
    /// --cycles.
    #[arg(long, value_name = "SEED", conflicts_with_all = ["inputs", "step"], help_heading = "Single nodes")]
    pub(crate) random: Option<u64>,
    /// Write enum values as numbers instead of names in the table of outputs.
    #[arg(long, help_heading = "Single nodes")]
    pub(crate) numbers: bool,
}

impl NodeArgs {
    /// Returns true if the options ask for a single node to be run instead of a command.
    pub(crate) fn is_present(&self) -> bool {
        let by_itself = self.step || self.locals || self.random.is_some();
        by_itself || self.node.is_some() || self.inputs.is_some()
    }
}

/// Options of `rpi trace`.
#[derive(Args, Debug)]
pub(crate) struct TraceArgs {
    /// Program, net or image to run, or recording to read.
    pub(crate) source: PathBuf,
    #[command(flatten)]
    pub(crate) target: Target,
    /// Write the rows to this file instead of standard output.
    #[arg(long, short, value_name = "FILE")]
    pub(crate) output: Option<PathBuf>,
    /// Print only flows whose names match this pattern, in which `*` matches any text; may be repeated.
    #[arg(long, value_name = "PATTERN")]
    pub(crate) flow: Vec<String>,
    /// Print only cycles from this number on, as numbered in the rows.
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub(crate) from: u64,
    /// Print only cycles up to this number, as numbered in the rows.
    #[arg(long, value_name = "N", default_value_t = u64::MAX - 1, hide_default_value = true)]
    pub(crate) to: u64,
}

/// Options of `rpi replay`.
#[derive(Args, Debug)]
pub(crate) struct ReplayArgs {
    /// Recording (.mcap), net (.rpinet) or program (.rpi) to replay, plain or .gz.
    pub(crate) net: PathBuf,
    /// Recorded trace with which the run is compared, tab- or comma-separated, plain or .gz. If repeated, the traces
    /// are joined.
    #[arg(long, value_name = "FILE")]
    pub(crate) trace: Vec<PathBuf>,
    /// Command to replay, if the program has several.
    #[arg(long, value_name = "NAME")]
    pub(crate) command: Option<String>,
    /// Period of the cycle at which the trace was recorded, such as 25ms.
    #[arg(long, default_value = "25ms", value_parser = rpi_driver::parse_duration)]
    pub(crate) period: u64,
    /// Tolerance of the comparison of reals: absolute for values up to 1, relative beyond.
    #[arg(long, default_value_t = 1e-9, value_parser = tolerance)]
    pub(crate) tolerance: f64,
    /// Run the commands of a recording in C, too, beside the core: every flow and set-point must have the same bits.
    #[arg(long, value_name = "TARGET", default_value = "core")]
    pub(crate) against: ExecutionTarget,
    #[command(flatten)]
    pub(crate) compiler: CompilerArgs,
    /// Print the report of the comparison as JSON.
    #[arg(long)]
    pub(crate) json: bool,
}

/// Parses the value of `--override`: a share of the programmed speed from 0 to 1. Returns a message for any other text.
fn parse_override(text: &str) -> Result<f64, String> {
    let share = text
        .parse()
        .ok()
        .filter(|share| (0.0..=1.0).contains(share));
    share.ok_or_else(|| "expected a share from 0 to 1, such as 0.5".to_owned())
}

#[cfg(test)]
mod tests {
    use clap::CommandFactory;

    use super::*;

    #[test]
    fn the_options_do_not_contradict_each_other() {
        Cli::command().debug_assert();
    }
}
