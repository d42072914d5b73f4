//! Types shared by the server state and the protocol front ends.

use std::fmt;

use rpi_core::MotionControls;
use rpi_runtime::control::{
    BudgetExceededError, Cause, CommandError, CommandState, Ending, RequestError,
};

use super::source_location::SourceLocation;
use super::task_status::TaskStatus;
use crate::condition::ConditionError;
use crate::fair_share::QuotaError;

/// Life-cycle state of a command, as clients see it.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Phase {
    /// The command is in this state of the core. It is in the core's table, or on its way into it.
    Core(CommandState),
    /// The command was removed from the core's table.
    Unloaded,
}

impl Phase {
    /// All states.
    pub(crate) const ALL: [Phase; 8] = [
        Phase::Core(CommandState::Loading),
        Phase::Core(CommandState::Rejected),
        Phase::Core(CommandState::Ready),
        Phase::Core(CommandState::Scheduled),
        Phase::Core(CommandState::Running),
        Phase::Core(CommandState::Cancelling),
        Phase::Core(CommandState::Terminated),
        Phase::Unloaded,
    ];

    /// Returns the name of the state in the protocol.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Phase::Core(CommandState::Loading) => "loading",
            Phase::Core(CommandState::Rejected) => "rejected",
            Phase::Core(CommandState::Ready) => "ready",
            Phase::Core(CommandState::Scheduled) => "scheduled",
            Phase::Core(CommandState::Running) => "running",
            Phase::Core(CommandState::Cancelling) => "cancelling",
            Phase::Core(CommandState::Terminated) => "terminated",
            Phase::Unloaded => "unloaded",
        }
    }
}

/// State of a command for clients, and how it has ended.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Status {
    pub(crate) phase: Phase,
    pub(crate) ending: Option<Ending>,
    /// Name of the result with which the command has ended; `None` if it ended in another way or has not ended.
    pub(crate) result: Option<String>,
    /// Location in the program of the cause of the end: a fault, a device that was left moving, or a fragment whose
    /// cycles took too long; `None` if there is no such cause.
    pub(crate) location: Option<SourceLocation>,
    /// Names of the devices that were moving when the command ended; they brake within their own limits.
    pub(crate) braked: Vec<String>,
    /// Description of the discontinuity between the first set-points of the command and those of its predecessor;
    /// `None` if there was none.
    pub(crate) discontinuity: Option<String>,
    /// Whether another command has taken over: it was started by the rule that stopped this command, or this command
    /// ended in motion by `yield`.
    pub(crate) taken_over: bool,
}

impl Status {
    /// Creates the status of a command that has not ended and is in this state.
    pub(crate) fn new(phase: Phase) -> Status {
        Status {
            phase,
            ending: None,
            result: None,
            location: None,
            braked: Vec::new(),
            discontinuity: None,
            taken_over: false,
        }
    }
}

/// Progress of a rule, as clients see it.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum RuleState {
    /// The rule may still fire.
    Active,
    /// The condition was true, and the rule has stopped, cancelled and started its commands.
    Fired,
    /// The condition was true, but a command could not be started.
    Failed,
    /// The rule can no longer fire: it was withdrawn, or its condition can no longer become true.
    Dropped,
}

/// A device, as clients see it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct DeviceInfo {
    pub(crate) name: String,
    /// Name of the device type: that of the cell description, or that given by the client that added the device.
    pub(crate) kind: String,
    /// Error code that the device reports; 0 if there is no error.
    pub(crate) code: i64,
    /// Whether the device moves.
    pub(crate) moving: bool,
    /// Interfaces of the device in the DirectIO protocol: name of each, with the keys and values of its parameters.
    pub(crate) interfaces: Vec<(&'static str, Vec<(String, String)>)>,
}

/// Change of an object, as sent to the subscribers to the object.
#[derive(Debug)]
pub(crate) enum Update<'a> {
    /// A command has entered this life-cycle state.
    Command(&'a Status),
    /// The first set-points of a command do not continue those of its predecessor. The text describes the
    /// discontinuity.
    Discontinuity(&'a str),
    /// Exports of a command have changed: key and literal of each.
    Values(&'a [(String, String)]),
    /// A rule has entered this state: active, fired, failed or dropped.
    Rule(RuleState),
    /// A session was opened (true) or closed (false).
    Session(bool),
    /// The emergency stop was requested or reset: name of the requester of the stop in force; `None` if there is none.
    Emergency(Option<&'a str>),
    /// The speed override or the pause of all motions was set.
    Controls(MotionControls),
    /// The progress of a task has changed.
    Task(&'a TaskStatus),
    /// A device was added, or existed when the client subscribed.
    DeviceAdded(&'a DeviceInfo),
    /// The error code of a device has changed: name of the device and the code; 0 if there is no error.
    DeviceCondition(&'a str, i64),
    /// The device with this name was removed.
    DeviceRemoved(&'a str),
}

/// Receiver of updates about one object or about all devices, such as a connection of a client.
pub(crate) trait Subscriber: Send {
    /// Sends an update to the client. Returns false if the client is disconnected. Must not block.
    fn notify(&mut self, update: &Update<'_>) -> bool;

    /// Returns whether the client is still connected.
    fn is_connected(&self) -> bool;
}

/// Error answer to a request of a client.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum ApiError {
    /// The request names an object that does not exist; the text is its kind and name.
    Unknown(String),
    /// The request is invalid; the text is the whole message.
    Invalid(String),
    /// The command or task cannot be loaded, for these reasons.
    Rejected(Vec<String>),
    /// The control core refused the request.
    Refused(CommandError),
    /// The object that the request concerns is in use; the text is the whole message.
    InUse(String),
    /// The control core refused the request because another command holds an actuator; the text names both.
    ResourceHeld(String),
    /// The object with this name belongs to the session of another client.
    NotOwner(String),
    /// The client lacks the right that the request needs; the text is the whole message.
    Forbidden(String),
    /// The maximum number of clients is connected, so that this one may only request an emergency stop.
    NoPlace,
    /// An emergency stop is in force; the text names who requested it.
    EmergencyStop(String),
    /// The limit of the server with this name is reached.
    Limit(&'static str),
    /// The client has its whole share of the limited resource with this name.
    ClientShare(&'static str),
    /// All clients of the peer together have their whole share of the limited resource with this name.
    PeerShare(&'static str),
    /// The command would exceed the share of a tick that the cycles of all commands together may take.
    OverBudget(BudgetExceededError),
    /// The queue of requests to the control core is full.
    QueueFull,
}

/// Name of the limit on memory, for messages.
pub(super) const MEMORY_LIMIT: &str = "memory";

impl ApiError {
    /// Converts a quota error to the error for the client; `what` names the limited resource.
    pub(super) fn limit(full: QuotaError, what: &'static str) -> ApiError {
        match full {
            QuotaError::Exhausted => ApiError::Limit(what),
            QuotaError::ClientShare => ApiError::ClientShare(what),
            QuotaError::PeerShare => ApiError::PeerShare(what),
        }
    }
}

/// Returns the name, cut at a character boundary to at most `most` bytes.
pub(super) fn truncated(name: &str, most: usize) -> String {
    name[..name.floor_char_boundary(most)].to_owned()
}

/// Callback for the result of a request. The text is the name of the created object; empty if there is none.
pub(crate) type Reply = Box<dyn FnOnce(Result<String, ApiError>) + Send>;

impl From<RequestError> for ApiError {
    fn from(why: RequestError) -> ApiError {
        match why {
            RequestError::UnknownCommand => ApiError::Unknown("command".to_owned()),
            RequestError::TableFull => ApiError::Limit("commands"),
            RequestError::QueueFull => ApiError::QueueFull,
            RequestError::OutOfMemoryQuota => ApiError::Limit(MEMORY_LIMIT),
            RequestError::BudgetExceeded(why) => ApiError::OverBudget(why),
            RequestError::Load(faults) => {
                ApiError::Rejected(faults.iter().map(ToString::to_string).collect())
            }
            RequestError::ValueSize { .. } => ApiError::Invalid(why.to_string()),
        }
    }
}

impl From<ConditionError> for ApiError {
    fn from(error: ConditionError) -> ApiError {
        ApiError::Invalid(error.to_string())
    }
}

impl fmt::Display for ApiError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            ApiError::Unknown(what) => write!(f, "there is no {what}"),
            ApiError::Invalid(what)
            | ApiError::InUse(what)
            | ApiError::ResourceHeld(what)
            | ApiError::Forbidden(what) => f.write_str(what),
            ApiError::NoPlace => f.write_str(
                "limit reached: connections; this one accepts `emergency.stop` only and ends soon",
            ),
            ApiError::Rejected(reasons) => f.write_str(&reasons.join("; ")),
            ApiError::Refused(why) => f.write_str(&refusal_text(*why, "an actuator that it needs")),
            ApiError::NotOwner(what) => {
                write!(f, "{what} belongs to the session of another client")
            }
            ApiError::EmergencyStop(by) => {
                write!(
                    f,
                    "emergency stop by {by} is in force; reset it first (`emergency.reset`)"
                )
            }
            ApiError::Limit(what) => write!(f, "limit reached: {what}"),
            ApiError::ClientShare(what) => write!(
                f,
                "limit reached: {what} of one client; unload or close what is no longer needed"
            ),
            ApiError::PeerShare(what) => write!(
                f,
                "limit reached: {what} of all clients of one peer; unload, close or remove what is no longer needed"
            ),
            ApiError::OverBudget(why) => {
                let alone = why.needed_ns > why.granted_ns;
                let less = "reduce its work per cycle, measure the machine (`rpic machine`, `rpi serve --machine FILE`) or raise `--cycle-share`";
                match alone {
                    true => write!(f, "{why}; {less}"),
                    false => write!(f, "{why}; end or unschedule other commands first, {less}"),
                }
            }
            ApiError::QueueFull => {
                f.write_str("the request queue of the server is full; try again")
            }
        }
    }
}

/// Describes the state of a command, with a hint for the next action.
fn state_hint(state: CommandState) -> &'static str {
    match state {
        CommandState::Loading => "it is being loaded",
        CommandState::Rejected => "it cannot run here",
        CommandState::Ready => "it is ready, but not running",
        CommandState::Scheduled => {
            "it is scheduled by a rule; withdraw the rule or unload the command first"
        }
        CommandState::Running => "it is already running",
        CommandState::Cancelling => "it is running and being cancelled",
        CommandState::Terminated => "it has ended; load it again to run it again",
    }
}

/// Returns the reason for which the core refused a request, as text. `actuator` is the display name of the actuator
/// that another command holds, if that is the reason.
pub(crate) fn refusal_text(why: CommandError, actuator: &str) -> String {
    match why {
        CommandError::Unknown => "unknown command or rule".to_owned(),
        CommandError::InvalidState(state) => {
            format!("not possible in this state: {}", state_hint(state))
        }
        CommandError::ResourceHeld { .. } => format!("{actuator} is held by another command"),
        CommandError::SelfSuccessor => {
            "a command cannot follow itself or be started twice by one rule".to_owned()
        }
        CommandError::NeverFires => "the rule can never fire".to_owned(),
        CommandError::ConditionTooDeep => "the condition is nested too deeply".to_owned(),
        CommandError::PeriodMismatch => {
            "the period must be a whole multiple of the tick".to_owned()
        }
        CommandError::TableFull => "the command table is full".to_owned(),
    }
}

/// Returns the kind of ending of a command as text: result, terminate, fault, aborted, or stopped by a rule.
pub(crate) fn cause_text(ending: &Ending) -> &'static str {
    match ending.cause {
        Cause::Result(_) => "result",
        Cause::Terminate => "terminate",
        Cause::Fault(_) => "fault",
        Cause::Aborted(_) => "aborted",
        Cause::Stopped(_) => "stopped by a rule",
    }
}

/// Returns the fault or the reason of the abort that ended a command, as text; `None` if the command ended otherwise.
pub(crate) fn fault_text(ending: &Ending) -> Option<String> {
    match ending.cause {
        Cause::Fault(fault) => Some(rpi_runtime::run::fault_message(fault.code, fault.values)),
        Cause::Aborted(why) => Some(rpi_runtime::run::abort_text(why).to_owned()),
        _ => None,
    }
}
