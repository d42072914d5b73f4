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
    /// The command is in the command table, or on its way into it, in this state.
    Core(CommandState),
    /// The command has been removed from the table.
    Unloaded,
}

/// State of a command and how it has ended.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Status {
    pub(crate) phase: Phase,
    pub(crate) ending: Option<Ending>,
    /// Name of the result with which the command has ended.
    pub(crate) result: Option<String>,
    /// Location of the fault in the program, if a fault ended the command.
    pub(crate) location: Option<SourceLocation>,
    /// Devices that the command left moving; they brake on their own.
    pub(crate) braked: Vec<String>,
    /// Description of the discontinuity between its first set-points and those of its predecessor, if there was one.
    pub(crate) discontinuity: Option<String>,
    /// Whether another command has taken over: started by the rule that stopped this one, or after this one ended in
    /// motion by `yield`.
    pub(crate) taken_over: bool,
}

impl Status {
    /// Creates the status of a command that has not ended.
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
    /// The rule has fired.
    Fired,
    /// The condition came true, but a command could not be started.
    Failed,
    /// The rule can no longer fire.
    Dropped,
}

/// A device, as clients see it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct DeviceInfo {
    pub(crate) name: String,
    /// Type of the device, as named by its creator.
    pub(crate) kind: String,
    /// Error code; 0 if there is no error.
    pub(crate) code: i64,
    /// Whether the device moves.
    pub(crate) moving: bool,
    /// Interfaces by name, with their parameters.
    pub(crate) interfaces: Vec<(&'static str, Vec<(String, String)>)>,
}

/// Update about an object, for its subscribers.
#[derive(Debug)]
pub(crate) enum Update<'a> {
    /// State of the command.
    Command(&'a Status),
    /// Description of the discontinuity at the takeover by the command.
    Discontinuity(&'a str),
    /// Changed exports of the command: key and value.
    Values(&'a [(String, String)]),
    /// New state of a rule.
    Rule(RuleState),
    /// Whether the session is open.
    Session(bool),
    /// Name of the client that requested the emergency stop in force; `None` if there is none.
    Emergency(Option<&'a str>),
    /// Override and pause of all motions.
    Controls(MotionControls),
    /// Progress of the task.
    Task(&'a TaskStatus),
    /// A device was added.
    DeviceAdded(&'a DeviceInfo),
    /// Name of a device and its error code; 0 if there is no error.
    DeviceCondition(&'a str, i64),
    /// Name of a removed device.
    DeviceRemoved(&'a str),
}

/// Receiver of updates about commands, tasks and rules, such as a connection.
pub(crate) trait Subscriber: Send {
    /// Sends an update. Returns false if the client is disconnected. Must not block.
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
    /// The object is in use; the text says by what.
    InUse(String),
    /// The control core refused the request because another command holds a resource; the text names both.
    ResourceHeld(String),
    /// The session of this object belongs to another client.
    NotOwner(String),
    /// An emergency stop is in force; the text names who requested it.
    EmergencyStop(String),
    /// A limit of the server is reached.
    Limit(&'static str),
    /// The share of the client in a limit is reached.
    ClientShare(&'static str),
    /// The share of all clients of the peer in a limit is reached.
    PeerShare(&'static str),
    /// The command would exceed the share of a tick that commands may take.
    OverBudget(BudgetExceededError),
    /// The request queue is full.
    QueueFull,
}

/// Name of the memory limit in messages.
pub(super) const MEMORY_LIMIT: &str = "memory";

impl ApiError {
    /// Returns the error that a client receives when a quota is used up; `what` names the limited things.
    pub(super) fn limit(full: QuotaError, what: &'static str) -> ApiError {
        match full {
            QuotaError::Exhausted => ApiError::Limit(what),
            QuotaError::ClientShare => ApiError::ClientShare(what),
            QuotaError::PeerShare => ApiError::PeerShare(what),
        }
    }
}

/// Truncates a name to at most `most` bytes.
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
            ApiError::Invalid(what) | ApiError::InUse(what) | ApiError::ResourceHeld(what) => {
                f.write_str(what)
            }
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

/// Returns the reason for which the core refused a request, as text. `actuator` is the display name of the held
/// actuator.
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

/// Returns the kind of ending as text.
pub(crate) fn cause_text(ending: &Ending) -> &'static str {
    match ending.cause {
        Cause::Result(_) => "result",
        Cause::Terminate => "terminate",
        Cause::Fault(_) => "fault",
        Cause::Aborted(_) => "aborted",
        Cause::Stopped(_) => "stopped by a rule",
    }
}

/// Returns the fault or the reason of an abort as text; `None` if the command ended regularly.
pub(crate) fn fault_text(ending: &Ending) -> Option<String> {
    match ending.cause {
        Cause::Fault(fault) => Some(rpi_runtime::run::fault_message(fault.code, fault.values)),
        Cause::Aborted(why) => Some(rpi_runtime::run::abort_text(why).to_owned()),
        _ => None,
    }
}
