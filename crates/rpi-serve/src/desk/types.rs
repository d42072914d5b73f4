//! What the desk and those who speak with clients say to one another.

use std::fmt;

use rpi_host::control::{Cause, Ending, Refused, Rejected, State, TooMuch};

use super::place::Place;
use super::tasks::TaskStatus;
use crate::fair::Full;

/// Where a command is in its life, as clients see it.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Phase {
    /// In the table, or on its way into it.
    Is(State),
    /// Gone.
    Unloaded,
}

/// What a command has told so far.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Status {
    pub(crate) phase: Phase,
    pub(crate) ending: Option<Ending>,
    /// The name of the result with which it has ended.
    pub(crate) result: Option<String>,
    /// Where in the program the fault is that has ended it.
    pub(crate) place: Option<Place>,
    /// The devices that it left moving, which brake on their own.
    pub(crate) braked: Vec<String>,
    /// By how much its first set-points did not join those of whoever went before, if they did not.
    pub(crate) jump: Option<String>,
    /// Another has started in its place: by the rule that stopped it, or because it ended in motion by `yield`.
    pub(crate) taken_over: bool,
}

impl Status {
    /// That of a command that has not ended.
    pub(crate) fn new(phase: Phase) -> Status {
        Status {
            phase,
            ending: None,
            result: None,
            place: None,
            braked: Vec::new(),
            jump: None,
            taken_over: false,
        }
    }
}

/// What has become of a rule.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum RuleState {
    /// It may still fire.
    Active,
    /// It has fired.
    Fired,
    /// Its condition came true, but what it was to start could not be.
    Failed,
    /// It can no longer fire.
    Dropped,
}

/// A device as clients see it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct DeviceInfo {
    pub(crate) name: String,
    /// Its type, as whoever made it calls it.
    pub(crate) kind: String,
    /// Its error code; 0 while it is well.
    pub(crate) code: i64,
    /// Whether it moves.
    pub(crate) moving: bool,
    /// What it offers: interfaces by name, with their parameters.
    pub(crate) interfaces: Vec<(&'static str, Vec<(String, String)>)>,
}

/// Something that a client has asked to be told.
#[derive(Debug)]
pub(crate) enum Update<'a> {
    /// The state of the command.
    Command(&'a Status),
    /// By how much the command has jumped as it took over.
    Jumped(&'a str),
    /// Exports of the command that have changed: key and value.
    Values(&'a [(String, String)]),
    /// The state of the rule.
    Rule(RuleState),
    /// Whether the session is open.
    Session(bool),
    /// Who has stopped everything, if somebody has.
    Emergency(Option<&'a str>),
    /// How far the task is.
    Task(&'a TaskStatus),
    /// A device is there.
    DeviceAdded(&'a DeviceInfo),
    /// Whether a device is well; its error code if not.
    DeviceCondition(&'a str, i64),
    /// A device is no more.
    DeviceRemoved(&'a str),
}

/// Somebody who is told.
pub(crate) trait Sink: Send {
    /// Tells; false if nobody listens any more. Must not wait.
    fn tell(&mut self, update: &Update<'_>) -> bool;

    /// Whether somebody listens still.
    fn is_heard(&self) -> bool;
}

/// What was asked for could not be done.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Failure {
    /// There is no such thing.
    Unknown(String),
    /// The request makes no sense.
    Bad(String),
    /// The command cannot run: every reason.
    Rejected(Vec<String>),
    /// The control core refused it.
    Refused(Refused),
    /// It is in use, by whom and for what.
    InUse(String),
    /// The control core refused it, as somebody holds what is needed: what, who.
    Held(String),
    /// Its session belongs to another client.
    NotYours(String),
    /// Everything is stopped, by whom.
    Stopped(String),
    /// More than the server grants.
    Limit(&'static str),
    /// More than the server grants one client beside others.
    Share(&'static str),
    /// More than the server grants all clients from one place beside others.
    Place(&'static str),
    /// More of a tick than commands may take.
    TooMuch(TooMuch),
    /// The server has too much to do.
    Busy,
}

/// The limit on what commands and tasks take.
pub(super) const MEMORY: &str = "memory";

impl Failure {
    /// A limit on this is reached.
    pub(super) fn limit(full: Full, what: &'static str) -> Failure {
        match full {
            Full::All => Failure::Limit(what),
            Full::Share => Failure::Share(what),
            Full::Place => Failure::Place(what),
        }
    }
}

/// As much of what somebody calls something as is kept: `most` bytes.
pub(super) fn shortened(name: &str, most: usize) -> String {
    name[..name.floor_char_boundary(most)].to_owned()
}

/// Is told what became of a request; the text is the name of what was made, if something was.
pub(crate) type Reply = Box<dyn FnOnce(Result<String, Failure>) + Send>;

impl From<Rejected> for Failure {
    fn from(why: Rejected) -> Failure {
        match why {
            Rejected::Unknown => Failure::Unknown("command".to_owned()),
            Rejected::Full => Failure::Limit("commands"),
            Rejected::Busy => Failure::Busy,
            Rejected::Memory => Failure::Limit(MEMORY),
            Rejected::TooMuch(why) => Failure::TooMuch(why),
            Rejected::Loading(faults) => {
                Failure::Rejected(faults.iter().map(ToString::to_string).collect())
            }
            Rejected::Value { .. } => Failure::Bad(why.to_string()),
        }
    }
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Failure::Unknown(what) => write!(f, "there is no {what}"),
            Failure::Bad(what) | Failure::InUse(what) | Failure::Held(what) => f.write_str(what),
            Failure::Rejected(reasons) => f.write_str(&reasons.join("; ")),
            Failure::Refused(why) => f.write_str(&refused(*why, "an actuator that it needs")),
            Failure::NotYours(what) => write!(f, "{what} belongs to the session of another client"),
            Failure::Stopped(by) => {
                write!(
                    f,
                    "everything is stopped since an emergency stop by {by}; it must be reset first (`emergency.reset`)"
                )
            }
            Failure::Limit(what) => write!(f, "limit reached: {what}"),
            Failure::Share(what) => write!(
                f,
                "limit reached: {what} of one client, which has as much as it leaves free for others; unload or close what is not needed any more"
            ),
            Failure::Place(what) => write!(
                f,
                "limit reached: {what} of all clients from one place, which have no more than three times what they leave free for others; unload, close or remove what is not needed any more"
            ),
            Failure::TooMuch(why) => {
                let alone = why.needed_ns > why.granted_ns;
                let less = "let it do less in a cycle, measure the machine (`rpic machine`, `rpi serve --machine FILE`) or grant more (`--cycle-share`)";
                match alone {
                    true => write!(f, "{why}; {less}"),
                    false => write!(f, "{why}; end or unschedule others first, {less}"),
                }
            }
            Failure::Busy => f.write_str("the server has too much to do, try again"),
        }
    }
}

/// Where a command is in its life, with what helps.
fn told(state: State) -> &'static str {
    match state {
        State::Loading => "it is being loaded",
        State::Rejected => "it cannot run here",
        State::Ready => "it is ready, and does not run",
        State::Scheduled => {
            "it is scheduled, a rule will start it; withdrawing that, or unloading it, takes it off"
        }
        State::Running => "it runs already",
        State::Cancelling => "it runs, and was asked to end",
        State::Terminated => "it has ended; what is to run again is loaded again",
    }
}

/// Why the core has refused something; `actuator` is what people call the one that is held.
pub(crate) fn refused(why: Refused, actuator: &str) -> String {
    match why {
        Refused::Unknown => "the control core does not know it".to_owned(),
        Refused::State(state) => format!("that does not fit its state: {}", told(state)),
        Refused::Held { .. } => format!("{actuator} is held by another command"),
        Refused::Successor => "a command would follow itself or start twice".to_owned(),
        Refused::Never => "the rule could never fire".to_owned(),
        Refused::Condition => "the condition is nested too deeply".to_owned(),
        Refused::Period => "the period is no whole multiple of the tick".to_owned(),
        Refused::Full => "the table is full".to_owned(),
    }
}

/// How a command has ended, in words.
pub(crate) fn cause(ending: &Ending) -> &'static str {
    match ending.cause {
        Cause::Result(_) => "result",
        Cause::Terminate => "terminate",
        Cause::Fault(_) => "fault",
        Cause::Aborted(_) => "aborted",
        Cause::Stopped(_) => "stopped by a rule",
    }
}

/// Why it has ended so, where that is not its own doing.
pub(crate) fn why(ending: &Ending) -> Option<&'static str> {
    match ending.cause {
        Cause::Fault(fault) => Some(rpi_host::run::fault_text(fault.code)),
        Cause::Aborted(why) => Some(rpi_host::run::stop_text(why)),
        _ => None,
    }
}
