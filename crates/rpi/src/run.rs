//! `rpi run`: runs commands with a cell.

use std::error::Error;
use std::fs::File;
use std::io::{self, BufWriter, IsTerminal, Write};
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

use rpi_cli::ExecutionTarget;
use rpi_core::MotionControls;
use rpi_diag::{Style, render};
use rpi_driver::{AnalysedNet, CompileOptions, Compiled, Program};
use rpi_record::mcap::{RecordingOptions, RunOutputs, RunSources};
use rpi_record::sample_output::{DigestSink, SampleFormat, SampleWriter};
use rpi_replay::faults::Faults;
use rpi_replay::monitor::ClaimMonitorSink;
use rpi_replay::motion::MotionSink;
use rpi_replay::plot;
use rpi_runtime::control::Budget;
use rpi_runtime::realtime::TimeBase;
use rpi_runtime::run::{
    self, CommandEnd, Limits, Outcome, RunBudget, RunError, RunOptions, Sink, SinkList,
    StartRecording, Status,
};

use crate::args::RunArgs;
use crate::exit::{self, Exit};
use crate::guard::{Heartbeat, HeartbeatSource};
use crate::interrupt::Interrupt;
use crate::output;
use crate::program;
use crate::run_pages::RunPages;
use crate::target;
use rpi_serve::{FoxglovePort, TaskBundle};

/// Carries out `rpi run`: runs commands or a task with a cell, records the run and prints the summary.
pub(crate) fn run(args: &RunArgs) -> exit::CommandResult {
    let compiled = compile(args)?;
    let bundle = target::task_bundle(&compiled, &args.target, target::lower_for_run)?;
    target::ensure_inputs_set(&compiled, &args.target, &bundle)?;
    let (record, plot) = output_files(args)?;
    let mut rows = record
        .filter(|path| !is_mcap(path))
        .map(|path| rows_file(path, args))
        .transpose()?;
    let mut picture = plot.map(|path| create(path, args)).transpose()?;
    let pages = RunPages::open(args, &compiled, &bundle)?;
    let mcap = pages.recording().or(record.filter(|path| is_mcap(path)));
    let mut motion = args.plot.as_ref().map(|_| MotionSink::default());
    let mut several = SinkList::default();
    several
        .0
        .extend(rows.as_mut().map(|rows| rows as &mut dyn Sink));
    several
        .0
        .extend(motion.as_mut().map(|motion| motion as &mut dyn Sink));
    let mut digest = args.digest.then(DigestSink::default);
    several
        .0
        .extend(digest.as_mut().map(|digest| digest as &mut dyn Sink));
    let mut claims = claims(&compiled, &bundle);
    several.0.push(&mut claims);
    let interrupt = Interrupt::listen()?;
    let mut outcome = execute(args, (&bundle, mcap, &pages), &interrupt, &mut several)?;
    outcome.digest = digest.map(|digest| digest.to_hex());
    let mut faults = Faults::from_outcome(&outcome);
    let (mut diagnostics, summary) = claims.into_diagnostics(&mut outcome, &mut faults);
    // The text that an image was compiled from is not known, so faults have no location.
    if !matches!(compiled.program, Program::Image(_)) {
        diagnostics.extend(faults.locate(&mut outcome, &compiled.sources));
    }
    let style = Style::for_stream(&std::io::stderr());
    rpi_diag::print_stderr!(
        "{}{summary}",
        render(&diagnostics, &compiled.sources, style)
    );
    let file = record.or(mcap).unwrap_or(Path::new("")).display();
    let recorded = match (rows, &outcome.unrecorded) {
        (Some(rows), _) => rows.finish().map_err(|e| format!("{file}: {e}").into()),
        (None, Some(why)) => Err(format!("{file}: {why}").into()),
        (None, None) => Ok(()),
    };
    let drawn = match (motion, &mut picture) {
        (Some(motion), Some(picture)) => draw(args, &motion, &outcome, picture),
        _ => Ok(()),
    };
    rpi_cli::print(&match args.json {
        true => format!("{}\n", outcome.to_json()),
        false => outcome.to_string(),
    })?;
    // The summary is printed before an error of writing the files is returned.
    recorded.and(drawn)?;
    let status = exit(&outcome, &interrupt);
    pages.finish(&interrupt)?;
    Ok(status)
}

/// Returns the paths of the recording and of the plot, or an error if the options for them contradict one another.
fn output_files(args: &RunArgs) -> Result<(Option<&Path>, Option<&Path>), &'static str> {
    let (record, plot) = (args.record.as_deref(), args.plot.as_deref());
    if record.is_some() && record == plot {
        return Err("--record and --plot must name different files");
    }
    if args.report.is_some() && [record, plot].contains(&args.report.as_deref()) {
        return Err("--report must name a file of its own");
    }
    if args.recording.needs_mcap() && !record.is_some_and(is_mcap) {
        return Err("--profile, --part-size and --part-time need --record FILE.mcap");
    }
    Ok((record, plot))
}

/// Writes the plot of the motion as SVG to the file `picture`. `outcome` is the result of the run, which the plot
/// shows, too.
fn draw(
    args: &RunArgs,
    motion: &MotionSink,
    outcome: &Outcome,
    picture: &mut File,
) -> Result<(), Box<dyn Error>> {
    let title = args.program.file_name().unwrap_or_default();
    let drawing = plot::render_svg(&motion.to_plot(&title.to_string_lossy(), outcome));
    let file = args.plot.as_deref().unwrap_or(Path::new("")).display();
    let drawn = picture.write_all(drawing.as_bytes());
    drawn.map_err(|e| format!("{file}: {e}").into())
}

fn compile(args: &RunArgs) -> Result<Compiled, Box<dyn Error>> {
    if args.execution.execution == ExecutionTarget::C {
        return Err("--target c runs single nodes (--node); for commands, record the run and compare it with `rpi replay FILE.mcap --against c`".into());
    }
    if !args.execution.external.is_empty() {
        return Err("--extern applies to single nodes (--node) and to `rpic test`; commands with external functions run in C (`rpic compile --emit c`)".into());
    }
    if args.share.is_present() && !args.clock.real_time {
        return Err("--cycle-share and --machine require --real-time; cycles of simulated time have no time limit".into());
    }
    let options = CompileOptions {
        claims: args.contracts.into(),
        period_ns: args.target.period,
        ..target::compile_options(&args.target)?
    };
    let compiled = program::load(&args.program, options)?;
    program::ensure_linked(&compiled)?;
    Ok(compiled)
}

/// Creates the observer that reports violated assertions and contracts of all commands that run.
fn claims(compiled: &Compiled, bundle: &TaskBundle) -> ClaimMonitorSink {
    let runs = |net: &&AnalysedNet| bundle.images.iter().any(|image| image.name == net.name);
    let nets = compiled.nets().iter().filter(runs);
    ClaimMonitorSink::new(nets.map(|net| (net.name.as_str(), net.claims.as_slice())))
}

/// Runs the commands. `recorded` is the file of the recording of the run, and `pages` show it.
fn execute(
    args: &RunArgs,
    (bundle, recorded, pages): (&TaskBundle, Option<&Path>, &RunPages),
    interrupt: &Interrupt,
    sink: &mut dyn Sink,
) -> Result<Outcome, Box<dyn Error>> {
    let (cell, text) = target::cell(&args.program, &args.target, bundle)?;
    let recording = recorded.map(|path| mcap_recording(path, args, text));
    let foxglove = args.foxglove.open_local()?;
    let outputs = RunOutputs {
        recording: recording.transpose()?,
        live: foxglove.as_ref().map(FoxglovePort::viewers),
        values: pages.values(),
    };
    let tick_ns = bundle.images.first().map_or(1, |image| image.period_ns);
    let mut progress = ProgressLine::default();
    let mut show_progress =
        |command: &CommandEnd, elapsed: Duration| progress.show(command, elapsed);
    let shows = std::io::stderr().is_terminal();
    let next_tick = Arc::<AtomicU64>::default();
    let heartbeat = heartbeat(args, tick_ns, &next_tick, interrupt)?;
    let outcome = run::run(RunOptions {
        images: &bundle.images,
        plans: std::slice::from_ref(&bundle.plan),
        cell: &cell,
        time_base: match args.clock.real_time {
            true => TimeBase::Real,
            false => TimeBase::Simulated,
        },
        real_time: args.clock.real_time(),
        continuity: args.on_jump.into(),
        budget: share(args, bundle, tick_ns)?,
        controls: MotionControls {
            speed_override: args.speed_override,
            ..MotionControls::default()
        },
        limits: Limits {
            ticks: target::ticks(&args.target, tick_ns),
            planning_ns: args.planning_time.unwrap_or(0),
        },
        interrupted: interrupt.flag(),
        emergency: interrupt.emergency(),
        next_tick,
        settings: &args.target.settings,
        recording: outputs
            .is_needed()
            .then(|| Box::new(outputs) as Box<dyn StartRecording>),
        sink,
        progress: if shows {
            Some(&mut show_progress)
        } else {
            None
        },
    });
    drop((heartbeat, foxglove));
    progress.clear();
    outcome.map_err(|failure| run_error(failure, recorded))
}

/// Returns the error of a run for its user. `recorded` is the file of the recording of the run.
fn run_error(failure: RunError, recorded: Option<&Path>) -> Box<dyn Error> {
    let file = recorded.unwrap_or(Path::new("")).display();
    match failure {
        RunError::Recording(why) => format!("{file}: {why}").into(),
        RunError::BudgetExceeded { .. } => format!("{failure}\n  {BUDGET_HELP}").into(),
        other => other.into(),
    }
}

/// Starts the heartbeat of a run, which reports the number of the next tick, `next_tick`, to the guard or to the service
/// manager.
fn heartbeat(
    args: &RunArgs,
    tick_ns: u64,
    next_tick: &Arc<AtomicU64>,
    interrupt: &Interrupt,
) -> io::Result<Heartbeat> {
    let (real_time, next_tick) = (args.clock.real_time, Arc::clone(next_tick));
    let source = HeartbeatSource {
        // Cycles of simulated time may wait for the recorder, so they never count as stalled.
        ticks: Box::new(move || match real_time {
            true => next_tick.load(Ordering::Relaxed),
            false => 0,
        }),
        period_ns: tick_ns,
        is_stopped: false,
        interrupted: interrupt.flag(),
    };
    Heartbeat::start(source, args.guard.guarded)
}

/// Help text for an error that commands exceed their share of a cycle.
const BUDGET_HELP: &str = "reduce its work per cycle, use a longer --period, measure the machine (`rpic machine`, --machine FILE), \
    or raise --cycle-share PERCENT (`off` for no limit); see `rpic explain RPI7003`";

/// Returns the maximum computing time of commands in a cycle, with their work bounds. `tick_ns` is the length of the
/// cycle in ns. Returns `None` without a limit, and on simulated time, where a cycle may take any time.
fn share<'a>(
    args: &RunArgs,
    bundle: &'a TaskBundle,
    tick_ns: u64,
) -> Result<Option<RunBudget<'a>>, Box<dyn Error>> {
    let share = args.share.parse_share().filter(|_| args.clock.real_time);
    let machine = args.program.with_file_name(rpi_driver::MACHINE);
    let budget = |share| {
        let ns = args.share.ns_per_operation(Some(&machine))?;
        Ok(RunBudget {
            budget: Budget::from_share(tick_ns, share, ns),
            work: &bundle.work,
        })
    };
    share.map(budget).transpose()
}

/// Returns true if a file is a recording in the format MCAP, by its extension `.mcap`.
pub(crate) fn is_mcap(path: &Path) -> bool {
    path.extension()
        .is_some_and(|extension| extension == "mcap")
}

/// Creates a recording in the format MCAP, which contains everything that `rpi replay` needs. `cell` is the text of the
/// cell description.
fn mcap_recording(
    path: &Path,
    args: &RunArgs,
    cell: String,
) -> Result<RecordingOptions, Box<dyn Error>> {
    let origin = run_sources(args, cell)?;
    let first = create(path, args)?;
    Ok(args.recording.options((path, first), origin))
}

/// Returns what a recording contains about the program and the cell, whose text is `cell`.
pub(crate) fn run_sources(args: &RunArgs, cell: String) -> Result<RunSources, Box<dyn Error>> {
    let name = args.program.file_name().unwrap_or_default();
    Ok(RunSources {
        program: name.to_string_lossy().into_owned(),
        program_bytes: rpi_files::read_unchanged(&args.program, rpi_files::MAX_PROGRAM)?,
        cell,
    })
}

/// Creates an output file of the run. Returns an error if the file is the program or the cell description, because it
/// would be overwritten.
pub(crate) fn create(path: &Path, args: &RunArgs) -> Result<File, Box<dyn Error>> {
    let cell = target::cell_file(&args.program, &args.target);
    output::create(path, &[&args.program, &cell])
}

fn rows_file(path: &Path, args: &RunArgs) -> Result<SampleWriter<BufWriter<File>>, Box<dyn Error>> {
    let form = SampleFormat::from_file_name(&path.to_string_lossy());
    let file = create(path, args)?;
    Ok(SampleWriter::new(BufWriter::new(file), form))
}

fn exit(outcome: &Outcome, interrupt: &Interrupt) -> Exit {
    match outcome.status() {
        Status::Good if outcome.cut_off => interrupt.exit().unwrap_or(Exit::Success),
        Status::Good => Exit::Success,
        Status::CommandError => Exit::CommandError,
        Status::Fault => Exit::Fault,
    }
}

/// Line on the terminal that shows the progress of a run: the running command and the time since the start.
#[derive(Default)]
struct ProgressLine {
    shown: bool,
}

impl ProgressLine {
    fn show(&mut self, command: &CommandEnd, elapsed: Duration) {
        self.shown = true;
        rpi_diag::print_stderr!("\r\x1b[2K{}  {:.1} s", command.name, elapsed.as_secs_f64());
        let _ = std::io::stderr().flush();
    }

    fn clear(&self) {
        if self.shown {
            rpi_diag::print_stderr!("\r\x1b[2K");
        }
    }
}
