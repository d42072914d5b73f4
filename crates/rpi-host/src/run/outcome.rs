//! What has become of a run.

use rpi_diag::{Finding, SourceMap};
use serde::Serialize;

use crate::realtime::Figures;
use crate::recording::Written;

/// What has become of a run.
#[derive(Clone, PartialEq, Debug, Serialize)]
pub struct Outcome {
    /// The commands in the order of their start.
    pub commands: Vec<CommandEnd>,
    /// Commands before these, of which only the number is known.
    pub unlisted: u64,
    /// Successors that were not scheduled when their predecessors ended, and started after a while.
    pub late: u64,
    /// Those of them whose predecessors would have let them take over in motion.
    pub missed: u64,
    /// The devices in the order of the cell.
    pub devices: Vec<DeviceEnd>,
    /// How long cycles took.
    pub figures: Figures,
    /// Length of a tick, nanoseconds.
    pub tick_ns: u64,
    /// True if it was cut off because it had run as long as asked for.
    pub cut_off: bool,
    /// Why everything was stopped, if it was: an emergency stop, say.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub stopped: Option<String>,
    /// What the system has said to what was asked of it on real time.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub grants: Vec<String>,
    /// One number for all that the devices did, if it was asked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub digest: Option<String>,
    /// What was recorded, if something was.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub recorded: Option<Written>,
    /// Why the recording is not complete, if it is not: a full disk, say. The run went on without it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub unrecorded: Option<String>,
    /// Samples that were lost because the recording could not keep up.
    pub samples_lost: u64,
}

/// How the whole run went.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Status {
    /// Without an error.
    Good,
    /// A command ended with its error.
    CommandError,
    /// A command ended with a fault, or could not be started.
    Fault,
}

/// What has become of a command.
#[derive(Clone, PartialEq, Debug, Serialize)]
pub struct CommandEnd {
    /// Its name.
    pub name: String,
    /// Tick of its first cycle, from 0; none if it never started.
    pub first_tick: Option<u64>,
    /// Number of its cycles.
    pub cycles: u64,
    /// Its end.
    pub end: RunEnd,
    /// The devices that still moved then, and that nobody took over: they have braked on their own.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub braked: Vec<String>,
    /// True if it ended with an error that a branch of its task was for.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub handled: bool,
    /// What did not join when it took over, if something did not.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub jump: Option<String>,
    /// Its cycles that took too long, if any did; only on real time.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub overruns: Option<Blame>,
}

/// Ticks that ended too late and in which a command took the longest.
#[derive(Clone, PartialEq, Eq, Debug, Serialize)]
pub struct Blame {
    /// How many there were.
    pub count: u64,
    /// Tick of the worst, from 0.
    pub tick: u64,
    /// How long the command computed in it, nanoseconds.
    pub took_ns: u64,
    /// By how much the tick ended too late, nanoseconds.
    pub late_ns: u64,
    /// The fragment that was at work, by its path; empty for the command itself.
    pub fragment: String,
}

/// How a command ended.
#[derive(Clone, PartialEq, Eq, Debug, Serialize)]
#[serde(rename_all = "kebab-case", tag = "how")]
pub enum RunEnd {
    /// With a named result.
    Result {
        /// Its name.
        name: String,
        /// True if it ended in motion, which its successor took over.
        moving: bool,
    },
    /// By its port `outTerminate`, without an error.
    Terminated,
    /// With an error.
    Error {
        /// Its number.
        number: i64,
        /// The name of the result, if it has one.
        name: Option<String>,
    },
    /// By a fault in a cycle.
    Fault {
        /// What happened.
        what: String,
        /// The node to which it happened.
        place: String,
        /// Where that stands: `file:line:column`. Known as soon as [`Outcome::find_faults`] has been told the texts.
        #[serde(skip_serializing_if = "Option::is_none")]
        at: Option<String>,
        /// The same for people, in the text that the image was made of.
        #[serde(skip)]
        told: Box<Finding>,
    },
    /// Cut off, as it had run as long as asked for.
    CutOff,
    /// Ended by force, and not as somebody had asked for it.
    Stopped {
        /// Why: an emergency stop, say.
        why: String,
    },
    /// The core did not take it.
    Refused {
        /// Why.
        why: String,
    },
}

/// How a device ended.
#[derive(Clone, PartialEq, Debug, Serialize)]
pub struct DeviceEnd {
    /// Its name.
    pub name: String,
    /// A word for its condition, `ok` if it is well.
    pub condition: String,
    /// True if it still moves.
    pub moving: bool,
    /// What it had against its commands, one entry per kind and axis.
    pub troubles: Vec<Trouble>,
}

/// Something that a device had against its commands.
#[derive(Clone, PartialEq, Debug, Serialize)]
pub struct Trouble {
    /// What, in a word.
    pub what: String,
    /// Whether it is about a set-point, and not that the device itself has failed.
    #[serde(skip)]
    pub is_refusal: bool,
    /// Which axis, from 0; none if it concerns the whole device.
    pub axis: Option<usize>,
    /// How often.
    pub times: u64,
    /// When first, seconds of the cell's time.
    pub first: f64,
    /// The value that was refused then, in SI units.
    pub value: f64,
    /// The limit that it broke; 0 where there is none.
    pub limit: f64,
}

impl RunEnd {
    /// How a run is judged that ends so.
    #[must_use]
    pub fn status(&self) -> Status {
        match self {
            RunEnd::Result { .. } | RunEnd::Terminated | RunEnd::CutOff => Status::Good,
            RunEnd::Error { .. } => Status::CommandError,
            RunEnd::Fault { .. } | RunEnd::Refused { .. } | RunEnd::Stopped { .. } => Status::Fault,
        }
    }
}

impl Outcome {
    /// How the run went: as its worst command, but for errors that its task has a branch for. One that was stopped has not gone
    /// well, whether a command ran then or not; neither has one in which a device had something against its set-points and no
    /// command minded.
    #[must_use]
    pub fn status(&self) -> Status {
        let troubles = self.devices.iter().flat_map(|device| &device.troubles);
        let mut refused = troubles.filter(|trouble| trouble.is_refusal);
        if self.stopped.is_some() || refused.any(|trouble| !self.is_minded(trouble)) {
            return Status::Fault;
        }
        let all = self.commands.iter().filter(|c| !c.handled);
        let all = all.map(|c| c.end.status());
        all.max_by_key(|status| *status as u8)
            .unwrap_or(Status::Good)
    }

    /// Whether a command that ran when a device refused something has not ended well. Of those that are not listed nothing is
    /// known any more.
    fn is_minded(&self, trouble: &Trouble) -> bool {
        let tick = trouble.first * 1e9 / self.tick_ns as f64;
        let ran = |command: &CommandEnd| {
            // What is refused in one cycle is read in the next.
            let lasted = |first: f64| first - 1.0..=first + command.cycles as f64 + 1.0;
            let first = command.first_tick.map(|first| first as f64);
            first.is_some_and(|first| lasted(first).contains(&tick))
        };
        let mut bad = (self.commands.iter()).filter(|c| c.end.status() != Status::Good);
        self.unlisted > 0 || bad.any(ran)
    }

    /// Finds where the faults of commands stand in the texts that their images were made of, and gives what is told of each.
    #[must_use]
    pub fn find_faults(&mut self, sources: &SourceMap) -> Vec<Finding> {
        let mut found = Vec::new();
        for command in &mut self.commands {
            let RunEnd::Fault { at, told, .. } = &mut command.end else {
                continue;
            };
            let span = told.span();
            if !span.is_none() {
                *at = Some(format!(
                    "{}:{}",
                    sources.name(span.file),
                    sources.line_col(span)
                ));
                found.push((**told).clone());
            }
        }
        found
    }

    /// The outcome for programs: one JSON object, indented.
    #[must_use]
    pub fn to_json(&self) -> String {
        // Strings, numbers and lists of these cannot fail to be written.
        serde_json::to_string_pretty(self).unwrap_or_default()
    }
}
