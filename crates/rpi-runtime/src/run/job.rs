//! Execution of a run from start to end.

use std::fmt;
use std::io;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64};
use std::time::Duration;

use rpi_core::{Continuity, LoadError, MotionControls};
use rpi_image::Image;
use rpi_sim::{Cell, OpenError};

use super::budget_check::RunBudget;
use super::inputs::{InputSetting, InputSettingError};
use super::outcome::{CommandEnd, Outcome};
use super::plan::{ExecutablePlan, PlanError};
use super::recorder::StartRecording;
use super::run_loop::{HostLoop, run_alternating, run_threaded};
use super::samples::Sink;
use super::setup::setup;
use crate::control::BudgetExceededError;
use crate::realtime::{RealTime, TimeBase};

/// Callback that shows the progress of a run: the command that started last, and the elapsed time of the run.
pub type Progress<'a> = dyn FnMut(&CommandEnd, Duration) + 'a;

/// Description of a run: commands, tasks, cell, time base and policies.
pub struct RunOptions<'a> {
    /// Images of the commands that the plans refer to by index. All have the same period, which is the tick length.
    pub images: &'a [Arc<Image>],
    /// Plans of the tasks, which run in parallel with separate devices.
    pub plans: &'a [ExecutablePlan],
    /// Devices, simulated or real, that the commands of the run may use.
    pub cell: &'a Cell,
    /// Whether ticks follow one another at once (simulated time) or by the clock (real time).
    pub time_base: TimeBase,
    /// Real-time options for the cycle thread, and policies for overruns (ticks that end after the next one was due).
    pub real_time: RealTime,
    /// Policy for a takeover in which the first set-points do not continue those of the predecessor.
    pub continuity: Continuity,
    /// Time budget of all commands together in a tick; `None` disables the check.
    pub budget: Option<RunBudget<'a>>,
    /// Speed override (a factor from 0 to 1) and pause of all motions during the run.
    pub controls: MotionControls,
    /// Maximum length of the run, and simulated planning time.
    pub limits: Limits,
    /// Flag that ends the run as soon as it is set to true.
    pub interrupted: Arc<AtomicBool>,
    /// Flag that causes an emergency stop as soon as it is set to true.
    pub emergency: Arc<AtomicBool>,
    /// Number of the next tick, which the cycle writes after each tick. Other threads may read it during the run.
    pub next_tick: Arc<AtomicU64>,
    /// Values that the user gives for inputs of the commands, as texts.
    pub settings: &'a [InputSetting],
    /// Recording of the run, not started yet; `None` if the run is not recorded.
    pub recording: Option<Box<dyn StartRecording>>,
    /// Receiver of the sampled values of the run's flows.
    pub sink: &'a mut dyn Sink,
    /// Callback that shows the progress of the run to the user, if there is one.
    pub progress: Option<&'a mut Progress<'a>>,
}

/// Maximum length of a run, and simulated planning time.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub struct Limits {
    /// Number of ticks after which the running commands are aborted; `None` for no limit.
    pub ticks: Option<u64>,
    /// Delay in nanoseconds between the start of a command and the scheduling of its successors. It simulates the time
    /// of planning.
    pub planning_ns: u64,
}

/// Maximum number of load errors that are printed per command. A device of the wrong kind lacks every port, so that the
/// errors can be many.
const MAX_FAULTS: usize = 8;

/// Error that prevents a run, or ends it before it is complete.
#[derive(Debug)]
pub enum RunError {
    /// The program contains no command and no task that could be run.
    NoCommands,
    /// The commands have different periods, although all commands of a run need the same one.
    DifferentPeriods,
    /// A task does not handle a result of a command, or handles a result that the command does not have.
    Plan(PlanError),
    /// The cycle thread cannot be created, or ended unexpectedly.
    Thread(io::Error),
    /// The recording cannot be written.
    Recording(io::Error),
    /// A command, or the commands that may run in parallel, exceed the time budget of a tick.
    BudgetExceeded {
        /// Name of the command, or the set of parallel commands.
        what: String,
        /// Time that the commands need in a tick, and time that they may use.
        why: BudgetExceededError,
    },
    /// A device cannot be connected to its controller.
    Device(OpenError),
    /// A value that the user gives for an input cannot be applied.
    Setting(InputSettingError),
    /// A command cannot run with the devices of the cell.
    Load {
        /// Name of the command that cannot run.
        command: String,
        /// All load errors of the command.
        faults: Vec<LoadError>,
        /// Names of the devices in the cell, for the message about an unknown device; empty if no device name is
        /// unknown.
        devices: Vec<String>,
    },
}

impl fmt::Display for RunError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            RunError::NoCommands => f.write_str("there is nothing to run"),
            RunError::DifferentPeriods => f.write_str("all commands need the same period"),
            RunError::Plan(error) => write!(f, "{error}"),
            RunError::Thread(error) => write!(f, "cycle thread error: {error}"),
            RunError::Recording(error) => write!(f, "cannot write the recording: {error}"),
            RunError::BudgetExceeded { what, why } => f.write_str(&why.message(what)),
            RunError::Device(error) => write!(f, "{error}"),
            RunError::Setting(bad) => write!(f, "{bad}"),
            RunError::Load {
                command,
                faults,
                devices,
            } => {
                write!(f, "{command} cannot run in this cell:")?;
                let mut shown = faults.iter().take(MAX_FAULTS);
                shown.try_for_each(|fault| write!(f, "\n  {fault}"))?;
                if let Some(more @ 1..) = faults.len().checked_sub(MAX_FAULTS) {
                    write!(f, "\n  and {more} more")?;
                }
                match faults
                    .iter()
                    .any(|f| matches!(f, LoadError::UnknownDevice(_)))
                {
                    true => write!(f, "\n{}", devices_text(devices)),
                    false => Ok(()),
                }
            }
        }
    }
}

fn devices_text(devices: &[String]) -> String {
    match devices {
        [] => "the cell has no devices".to_owned(),
        devices => format!("the cell has {}", devices.join(", ")),
    }
}

impl std::error::Error for RunError {}

/// Runs commands until the last one has ended, the limit is reached, or the user interrupts the run.
///
/// # Errors
/// Returns an error if the run cannot begin, or if a command cannot be loaded later. Faults and errors of commands are
/// part of the outcome.
pub fn run(mut job: RunOptions<'_>) -> Result<Outcome, RunError> {
    let tick_ns = common_period(job.images)?;
    let complete = |plan: &ExecutablePlan| plan.check(job.images);
    job.plans
        .iter()
        .try_for_each(complete)
        .map_err(RunError::Plan)?;
    let recording = job.recording.take();
    let (cycle, host) = setup(&job, tick_ns, recording)?;
    job.sink.channels(&host.channels);
    let listener = HostLoop::new(job.sink, job.progress, tick_ns);
    match job.time_base {
        TimeBase::Simulated => run_alternating(cycle, host, listener),
        TimeBase::Real | TimeBase::Accelerated(_) => {
            run_threaded(cycle, host, listener, job.real_time)
        }
    }
}

/// Returns the period in nanoseconds that all commands of a run have in common. Different periods are an error.
fn common_period(images: &[Arc<Image>]) -> Result<u64, RunError> {
    let period = images.first().ok_or(RunError::NoCommands)?.period_ns;
    match images.iter().all(|image| image.period_ns == period) {
        true => Ok(period),
        false => Err(RunError::DifferentPeriods),
    }
}
