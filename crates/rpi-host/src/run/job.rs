//! A run from beginning to end.

use std::fmt;
use std::io;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::Duration;

use rpi_core::{Continuity, LoadFault};
use rpi_image::Image;
use rpi_sim::Cell;

use super::drive::{Listener, side_by_side, taking_turns};
use super::inputs::{BadSetting, Setting};
use super::outcome::{CommandEnd, Outcome};
use super::plan::Plan;
use super::samples::Sink;
use super::share::Share;
use super::sides::sides;
use crate::control::TooMuch;
use crate::realtime::{Pace, RealTime};
use crate::recording::Wanted;

/// Is told now and then which command runs and how long it has.
pub type Progress<'a> = dyn FnMut(&CommandEnd, Duration) + 'a;

/// What is to be run, and how.
pub struct Job<'a> {
    /// The commands; all of one period, which is the tick.
    pub images: &'a [Arc<Image>],
    /// What runs, all at once: tasks on devices of their own.
    pub plans: &'a [Plan],
    /// The devices.
    pub cell: &'a Cell,
    /// What the ticks follow.
    pub pace: Pace,
    /// What is asked of the system on real time.
    pub real_time: RealTime,
    /// What happens if a command takes over with a jump.
    pub continuity: Continuity,
    /// What its commands may take of a tick, if somebody sees to that.
    pub share: Option<Share<'a>>,
    /// When it is cut off.
    pub limits: Limits,
    /// Becomes true when somebody wants it to be cut off at once.
    pub interrupted: Arc<AtomicBool>,
    /// Becomes true when somebody wants an emergency stop.
    pub emergency: Arc<AtomicBool>,
    /// Values for inputs.
    pub settings: &'a [Setting],
    /// Where everything is recorded, if it is.
    pub recording: Option<Wanted>,
    /// Who takes samples.
    pub sink: &'a mut dyn Sink,
    /// Who is told now and then how far it is.
    pub progress: Option<&'a mut Progress<'a>>,
}

/// When a run is cut off, and how slow planning is.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub struct Limits {
    /// Ticks after which the running command is stopped; none for no end.
    pub ticks: Option<u64>,
    /// Nanoseconds that it takes after a command's start until its successor is scheduled: as if planning took so long.
    pub planning_ns: u64,
}

/// The most faults that are printed for a command: a device of a wrong kind lacks every port that is used.
const MAX_FAULTS: usize = 8;

/// Why a run could not begin.
#[derive(Debug)]
pub enum Failure {
    /// Nothing is to be run.
    Nothing,
    /// The commands have different periods.
    Periods,
    /// A task says nothing about a result.
    Plan(String),
    /// The system gives no thread for the cycle.
    Thread(io::Error),
    /// The recording could not be written.
    Recording(io::Error),
    /// It may take more of a tick than is granted.
    TooMuch {
        /// The command, or all that run at once.
        what: String,
        /// By how much.
        why: TooMuch,
    },
    /// A setting does not fit.
    Setting(BadSetting),
    /// A command does not fit the cell.
    Loading {
        /// The command.
        command: String,
        /// Every reason.
        faults: Vec<LoadFault>,
        /// The devices that the cell has.
        devices: Vec<String>,
    },
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Failure::Nothing => f.write_str("there is nothing to run"),
            Failure::Periods => f.write_str("commands that follow one another need one period"),
            Failure::Plan(what) => f.write_str(what),
            Failure::Thread(error) => write!(f, "the thread of the cycle: {error}"),
            Failure::Recording(error) => write!(f, "the recording: {error}"),
            Failure::TooMuch { what, why } => f.write_str(&why.told(what)),
            Failure::Setting(bad) => write!(f, "{bad}"),
            Failure::Loading {
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
                match faults.iter().any(|f| matches!(f, LoadFault::Device(_))) {
                    true => write!(f, "\n{}", has(devices)),
                    false => Ok(()),
                }
            }
        }
    }
}

fn has(devices: &[String]) -> String {
    match devices {
        [] => "the cell has no devices".to_owned(),
        devices => format!("the cell has {}", devices.join(", ")),
    }
}

impl std::error::Error for Failure {}

/// Runs commands until the last has ended, or the run is cut off.
///
/// # Errors
/// If it could not begin; how the commands end is in the outcome.
pub fn run(mut job: Job<'_>) -> Result<Outcome, Failure> {
    let tick_ns = tick(job.images)?;
    let complete = |plan: &Plan| plan.check(job.images);
    job.plans
        .iter()
        .try_for_each(complete)
        .map_err(Failure::Plan)?;
    let recording = job.recording.take();
    let (cycle, host) = sides(&job, tick_ns, recording)?;
    job.sink.channels(&host.channels);
    let listener = Listener::new(job.sink, job.progress, tick_ns);
    match job.pace {
        Pace::Simulated => taking_turns(cycle, host, listener),
        Pace::Real | Pace::Faster(_) => side_by_side(cycle, host, listener, job.real_time),
    }
}

/// The period that all commands have.
fn tick(images: &[Arc<Image>]) -> Result<u64, Failure> {
    let period = images.first().ok_or(Failure::Nothing)?.period_ns;
    match images.iter().all(|image| image.period_ns == period) {
        true => Ok(period),
        false => Err(Failure::Periods),
    }
}
