//! Outcome of a run.

use rpi_image::Image;
use rpi_image::image::TextRange;
use rpi_prims::{Fault, FaultCode, FaultValues};
use serde::Serialize;

use super::recorder::RecordingStats;
use crate::realtime::TimingStats;

/// What a run of commands or a task leaves: how it ended, its timing and its records.
#[derive(Clone, PartialEq, Debug, Serialize)]
pub struct Outcome {
    /// Commands in the order of their start.
    pub commands: Vec<CommandEnd>,
    /// Number of earlier commands that are no longer listed.
    pub unlisted: u64,
    /// Number of successors that were not scheduled when their predecessor ended, and therefore started with a delay.
    pub late: u64,
    /// Number of late successors that could have taken over while the devices moved.
    pub missed: u64,
    /// Devices in the order of the cell.
    pub devices: Vec<DeviceEnd>,
    /// Timing statistics of the cycles.
    pub figures: TimingStats,
    /// Tick length in nanoseconds.
    pub tick_ns: u64,
    /// True if the run was cut off at its time limit or by the user.
    pub cut_off: bool,
    /// Reason for a forced stop of all commands, for example an emergency stop.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub stopped: Option<String>,
    /// Result of each request to the operating system for real-time resources, as text.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub grants: Vec<String>,
    /// Hash of all device values as text, if requested.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub digest: Option<String>,
    /// Statistics of the recording, if any.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub recorded: Option<RecordingStats>,
    /// Error that made the recording incomplete, for example a full disk. The run continued without it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub unrecorded: Option<String>,
    /// Number of samples lost because the sink could not keep up.
    pub samples_lost: u64,
}

/// Overall result of a run.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Status {
    /// The run had no error.
    Good,
    /// A command ended with its own error.
    CommandError,
    /// A command ended with a fault, could not be started, or was stopped.
    Fault,
}

/// Entry of the outcome of a run: one command, how long it ran and how it ended.
#[derive(Clone, PartialEq, Debug, Serialize)]
pub struct CommandEnd {
    /// Name of the command.
    pub name: String,
    /// Tick of the first cycle, from 0; `None` if the command never started.
    pub first_tick: Option<u64>,
    /// Number of executed cycles.
    pub cycles: u64,
    /// How the command ended.
    pub end: RunEnd,
    /// Devices that still moved when the command ended and were not taken over. They braked on their own.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub braked: Vec<String>,
    /// True if the command ended with an error that a branch of its task handles.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub handled: bool,
    /// Description of the discontinuity at the takeover, if any.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub jump: Option<String>,
    /// Overruns attributed to the command, if any; only on real time.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub overruns: Option<CommandOverruns>,
}

/// Number of overruns attributed to one command, with the worst of them.
#[derive(Clone, PartialEq, Eq, Debug, Serialize)]
pub struct CommandOverruns {
    /// Number of overruns.
    pub count: u64,
    /// Tick of the worst overrun, from 0.
    pub tick: u64,
    /// Computing time of the command in that tick, nanoseconds.
    pub took_ns: u64,
    /// Time by which that tick ended too late, nanoseconds.
    pub late_ns: u64,
    /// Path of the fragment with the most work; empty for the command itself.
    pub fragment: String,
}

/// How a command of a run ended: by a result, an error or an abort.
#[derive(Clone, PartialEq, Eq, Debug, Serialize)]
#[serde(rename_all = "kebab-case", tag = "how")]
pub enum RunEnd {
    /// The command ended with a named result.
    Result {
        /// Name of the result.
        name: String,
        /// True if the command ended in motion and its successor took over.
        moving: bool,
    },
    /// The command ended by its port `outTerminate`, without an error.
    Terminated,
    /// The command ended with an error.
    Error {
        /// Error number.
        number: i64,
        /// Name of the result, if it has one.
        name: Option<String>,
    },
    /// The command ended with a fault.
    Fault {
        /// Description of the fault.
        what: String,
        /// Path of the node that raised the fault.
        place: String,
        /// Source location, `file:line:column`. The runtime does not know source texts and leaves it empty.
        #[serde(skip_serializing_if = "Option::is_none")]
        at: Option<String>,
        /// Cycle and node of the fault.
        #[serde(skip)]
        origin: Box<FaultOrigin>,
    },
    /// The command was cut off at the limit of the run or by the user.
    CutOff,
    /// The command was aborted for another reason.
    Stopped {
        /// Reason of the abort as text, for example an emergency stop.
        why: String,
    },
    /// The core refused to start the command.
    Refused {
        /// Reason of the refusal as text.
        why: String,
    },
}

/// Cycle and node in which a fault was raised.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct FaultOrigin {
    /// Cause of the fault.
    pub code: FaultCode,
    /// Values that caused the fault.
    pub values: FaultValues,
    /// Number of the faulty cycle of the command, from 0.
    pub cycle: u64,
    /// Name of the flow that the node computes, or the path of the node; `None` if the node is unknown.
    pub flow: Option<String>,
    /// Source range of the node, if known.
    pub text: Option<TextRange>,
}

impl FaultOrigin {
    /// Returns the origin of a fault that an image raised in a cycle.
    #[must_use]
    pub fn of(image: &Image, fault: Fault, cycle: u64) -> FaultOrigin {
        let place = image.location_of(fault.slot);
        FaultOrigin {
            code: fault.code,
            values: fault.values,
            cycle,
            flow: place.map(|place| place.flow.clone().unwrap_or_else(|| place.path.clone())),
            text: place.and_then(|place| place.range),
        }
    }
}

/// Final state of a device.
#[derive(Clone, PartialEq, Debug, Serialize)]
pub struct DeviceEnd {
    /// Name of the device.
    pub name: String,
    /// Keyword of the device's state; `ok` if the device has no error.
    pub condition: String,
    /// True if the device still moves.
    pub moving: bool,
    /// Problems reported by the device, one entry per kind and axis.
    pub troubles: Vec<DeviceProblem>,
}

/// A problem reported by a device.
#[derive(Clone, PartialEq, Debug, Serialize)]
pub struct DeviceProblem {
    /// Keyword of the problem, such as that of an exceeded limit.
    pub what: String,
    /// Whether a set-point was rejected; false if the device itself failed.
    #[serde(skip)]
    pub is_refusal: bool,
    /// Whether `value` is a place on a path and `limit` the length of the path, in m.
    #[serde(skip)]
    pub is_on_path: bool,
    /// Index of the axis, from 0; `None` if the problem concerns the whole device.
    pub axis: Option<usize>,
    /// Number of occurrences.
    pub times: u64,
    /// Time of the first occurrence, in seconds of the cell's clock.
    pub first: f64,
    /// Value of the rejected quantity at the first occurrence, in SI units.
    pub value: f64,
    /// Violated limit, in SI units; 0 if there is none.
    pub limit: f64,
}

impl RunEnd {
    /// Returns the result of a run in which this is the only ended command.
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
    /// Returns the overall result: the worst status of all commands, except for handled errors.
    ///
    /// A forced stop counts as a fault, whether or not a command was running. A refused set-point also counts as a
    /// fault unless a command that was running then ended with an error or fault.
    #[must_use]
    pub fn status(&self) -> Status {
        let troubles = self.devices.iter().flat_map(|device| &device.troubles);
        let mut refused = troubles.filter(|error| error.is_refusal);
        if self.stopped.is_some() || refused.any(|error| !self.is_handled_by_command(error)) {
            return Status::Fault;
        }
        let all = self.commands.iter().filter(|c| !c.handled);
        let all = all.map(|c| c.end.status());
        all.max_by_key(|status| *status as u8)
            .unwrap_or(Status::Good)
    }

    /// Returns true if a command that was running when a device rejected a set-point ended with an error or fault.
    /// Returns true as well if there are unlisted commands, because nothing is known about them.
    fn is_handled_by_command(&self, error: &DeviceProblem) -> bool {
        let tick = error.first * 1e9 / self.tick_ns as f64;
        let ran = |command: &CommandEnd| {
            // A refusal in one cycle is read by the command in the next one.
            let lasted = |first: f64| first - 1.0..=first + command.cycles as f64 + 1.0;
            let first = command.first_tick.map(|first| first as f64);
            first.is_some_and(|first| lasted(first).contains(&tick))
        };
        let mut bad = (self.commands.iter()).filter(|c| c.end.status() != Status::Good);
        self.unlisted > 0 || bad.any(ran)
    }

    /// Returns the outcome as one indented JSON object.
    #[must_use]
    pub fn to_json(&self) -> String {
        // Serialising strings, numbers and lists cannot fail.
        serde_json::to_string_pretty(self).unwrap_or_default()
    }
}
