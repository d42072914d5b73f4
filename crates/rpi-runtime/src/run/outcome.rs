//! Outcome of a run.

use rpi_device::ErrorCode;
use rpi_image::Image;
use rpi_image::image::TextRange;
use rpi_prims::{Fault, FaultCode, FaultValues};
use serde::Serialize;

use super::recorder::RecordingStats;
use super::usage::AxisEnd;
use crate::realtime::TimingStats;

/// Outcome of a run of commands or tasks: how the commands ended, the timing of the ticks, and the state of the
/// devices.
#[derive(Clone, PartialEq, Debug, Serialize)]
pub struct Outcome {
    /// Commands that were started or refused, in the order of their start.
    pub commands: Vec<CommandEnd>,
    /// Number of earlier commands that are not in `commands`, because only the latest ones are listed.
    pub unlisted: u64,
    /// Number of successors that were not scheduled when their predecessors ended, and therefore started late.
    pub late: u64,
    /// Number of late successors that could have taken over while the devices moved, if they had been scheduled in
    /// time.
    pub missed: u64,
    /// Number of commands that ended in motion, because their successors took over without a stop.
    pub blended: u64,
    /// Final states of the devices, in the order of the cell.
    pub devices: Vec<DeviceEnd>,
    /// Timing statistics of the ticks.
    pub figures: TimingStats,
    /// Tick length in nanoseconds.
    pub tick_ns: u64,
    /// Whether the run ended at its limit or because the user interrupted it, before all commands had ended.
    pub cut_off: bool,
    /// Reason for which all commands were aborted, for example an emergency stop; `None` if they were not.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub stopped: Option<String>,
    /// For each requested real-time resource, such as a priority, a text that says whether the operating system granted
    /// it.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub grants: Vec<String>,
    /// Hash of all sampled device values as text; `None` if it was not requested.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub digest: Option<String>,
    /// Statistics of the recording; `None` if the run was not recorded, or not completely.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub recorded: Option<RecordingStats>,
    /// Error that made the recording incomplete, for example a full disk; `None` if there was none. The run continued
    /// without the recording.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub unrecorded: Option<String>,
    /// Number of samples that were lost because their receiver could not keep up.
    pub samples_lost: u64,
}

/// Overall result of a run, from best to worst.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Status {
    /// No command ended with an unhandled error or a fault, and no set-point was rejected.
    Good,
    /// A command ended with an error of its program that its task does not handle.
    CommandError,
    /// A command ended with a fault, could not be started, or was aborted, or a set-point was rejected.
    Fault,
}

/// Entry of the outcome of a run: one command, how long it ran and how it ended.
#[derive(Clone, PartialEq, Debug, Serialize)]
pub struct CommandEnd {
    /// Name of the command.
    pub name: String,
    /// Number of the tick of the first cycle, from 0; `None` if the command never started.
    pub first_tick: Option<u64>,
    /// Number of cycles that the command has run.
    pub cycles: u64,
    /// How the command ended: with a result, an error, a fault or an abort.
    pub end: RunEnd,
    /// Names of the devices that were moving when the command ended and were not taken over. They braked within their
    /// own limits.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub braked: Vec<String>,
    /// Whether the command ended with an error that a branch of its task handles.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub handled: bool,
    /// Description of the discontinuity of the set-points at the takeover by the command; `None` if there was none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub jump: Option<String>,
    /// Overruns (ticks that ended after the next one was due) attributed to the command; `None` if there were none or
    /// time was not real.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub overruns: Option<CommandOverruns>,
}

/// Overruns (ticks that ended after the next one was due) attributed to one command: their number and the worst one.
#[derive(Clone, PartialEq, Eq, Debug, Serialize)]
pub struct CommandOverruns {
    /// Number of overruns.
    pub count: u64,
    /// Number of the tick of the worst overrun, from 0.
    pub tick: u64,
    /// Time in nanoseconds that the command took in the tick of the worst overrun.
    pub took_ns: u64,
    /// Time in nanoseconds by which the tick of the worst overrun ended after the next one was due.
    pub late_ns: u64,
    /// Path of the command's fragment with the most work in the tick of the worst overrun; empty for the command
    /// itself.
    pub fragment: String,
}

/// How a command of a run ended: with a result, an error, a fault or an abort.
#[derive(Clone, PartialEq, Eq, Debug, Serialize)]
#[serde(rename_all = "kebab-case", tag = "how")]
pub enum RunEnd {
    /// The command ended with a named result.
    Result {
        /// Name of the result.
        name: String,
        /// Whether the command ended in motion and its successor took over the moving devices.
        moving: bool,
    },
    /// The net ended by its port `outTerminate`, without an error.
    Terminated,
    /// The command ended with an error.
    Error {
        /// Error number of the command; 0 stands for no error and does not occur here.
        number: i64,
        /// Name of the result with which the command ended; `None` if it ended by a port, without a named result.
        name: Option<String>,
    },
    /// The command ended with a fault: an error at run time in one of its cycles.
    Fault {
        /// Description of the fault, with the values that caused it.
        what: String,
        /// Path of the node that raised the fault; empty if unknown.
        place: String,
        /// Position of the fault in the source, `file:line:column`. The runtime leaves it `None`, because it has no
        /// source texts; the caller may fill it in.
        #[serde(skip_serializing_if = "Option::is_none")]
        at: Option<String>,
        /// Cycle and node in which the fault was raised.
        #[serde(skip)]
        origin: Box<FaultOrigin>,
    },
    /// The command was aborted on request, at the limit of the run or by the user, or stopped by a rule.
    CutOff,
    /// The command was aborted for another reason than a request.
    Stopped {
        /// Reason of the abort as text, for example an emergency stop.
        why: String,
    },
    /// The core refused to start the command, so that it never ran.
    Refused {
        /// Reason of the refusal as text.
        why: String,
    },
}

/// Cycle and node in which a fault of a command was raised.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct FaultOrigin {
    /// Kind of the fault, such as a division by zero.
    pub code: FaultCode,
    /// Values that caused the fault, such as an index and the length of the array.
    pub values: FaultValues,
    /// Number of the command's cycle in which the fault was raised, from 0.
    pub cycle: u64,
    /// Name of the flow that the node computes, or the path of the node; `None` if the node is unknown.
    pub flow: Option<String>,
    /// Source range of the node as byte offsets in a file; `None` if it is unknown.
    pub text: Option<TextRange>,
}

impl FaultOrigin {
    /// Returns the origin of a fault that was raised in a cycle of the image. `cycle` is the number of the cycle, from
    /// 0.
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

/// State of a device at the end of a run.
#[derive(Clone, PartialEq, Debug, Serialize)]
pub struct DeviceEnd {
    /// Name of the device.
    pub name: String,
    /// Keyword of the device's error; `ok` if the device has none.
    pub condition: String,
    /// Whether the device still moves at the end of the run.
    pub moving: bool,
    /// Problems reported by the device during the run, one entry per kind and axis.
    pub troubles: Vec<DeviceProblem>,
    /// Use of the limits by each axis that has followed set-points; empty for a device without axes.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub axes: Vec<AxisEnd>,
}

/// A problem that a device has reported during a run, such as a set-point beyond a limit.
#[derive(Clone, PartialEq, Debug, Serialize)]
pub struct DeviceProblem {
    /// Keyword of the kind of problem, such as that of an exceeded limit.
    pub what: String,
    /// Whether the device rejected a set-point; false if the device itself failed.
    #[serde(skip)]
    pub is_refusal: bool,
    /// Meaning of `value` and `limit`.
    #[serde(skip)]
    pub place: ProblemPlace,
    /// Index of the axis, from 0; `None` if the problem concerns the whole device.
    pub axis: Option<usize>,
    /// Number of times that the problem was reported.
    pub times: u64,
    /// Time of the first report, in seconds since the start of the run.
    pub first: f64,
    /// Value of the rejected quantity in the first report, in SI units.
    pub value: f64,
    /// Limit that the value exceeds, in SI units; 0 if there is none.
    pub limit: f64,
}

/// Meaning of the value and the limit of a problem that a device has reported.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum ProblemPlace {
    /// The value exceeds the limit.
    None,
    /// The value is a position along a path of the tool, the limit is the length of the path, both in m.
    OnPath,
    /// The value is the place of an event from the start of the path, NaN if the path has no such point; the limit is the
    /// length of the path, both in m (rad for a motion of the axes).
    OffPath,
    /// The value is the place of an event, the limit the place that the motion has reached, both in m (rad for a motion of
    /// the axes).
    Ahead,
}

impl ProblemPlace {
    /// Returns the meaning of value and limit for an error code.
    #[must_use]
    pub fn of(code: ErrorCode) -> Self {
        match code {
            ErrorCode::EVENT_MISSED => Self::Ahead,
            ErrorCode::NO_SUCH_PLACE => Self::OffPath,
            code if code.is_on_path() => Self::OnPath,
            _ => Self::None,
        }
    }
}

impl RunEnd {
    /// Returns the overall result of a run in which only this command has ended.
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
    /// Returns the overall result of the run: the worst one of all commands, except for handled errors.
    ///
    /// An abort of all commands counts as a fault, even if no command was running. A rejected set-point also counts as
    /// a fault unless a command that was running then ended with an error or fault.
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
    /// Returns true as well if commands are missing from the list, because nothing is known about them.
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
