//! What the desk and those who speak with clients say to one another.

use std::fmt;

use rpi_host::control::{Cause, Ending, Refused, Rejected, State};

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
    /// Another has started in its place: by the rule that stopped it, or because it ended in motion by `yield`.
    pub(crate) taken_over: bool,
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
    /// Exports of the command that have changed: key and value.
    Values(&'a [(String, String)]),
    /// The state of the rule.
    Rule(RuleState),
    /// Whether the session is open.
    Session(bool),
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
    /// More than the server grants.
    Limit(&'static str),
    /// The server has too much to do.
    Busy,
}

/// Is told what became of a request; the text is the name of what was made, if something was.
pub(crate) type Reply = Box<dyn FnOnce(Result<String, Failure>) + Send>;

impl From<Rejected> for Failure {
    fn from(why: Rejected) -> Failure {
        match why {
            Rejected::Unknown => Failure::Unknown("command".to_owned()),
            Rejected::Full => Failure::Limit("commands"),
            Rejected::Busy => Failure::Busy,
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
            Failure::Bad(what) | Failure::InUse(what) => f.write_str(what),
            Failure::Rejected(reasons) => f.write_str(&reasons.join("; ")),
            Failure::Refused(why) => f.write_str(&refused(*why)),
            Failure::Limit(what) => write!(f, "limit reached: {what}"),
            Failure::Busy => f.write_str("the server has too much to do, try again"),
        }
    }
}

fn refused(why: Refused) -> String {
    match why {
        Refused::Unknown => "the control core does not know it".to_owned(),
        Refused::State(state) => format!("that does not fit the state {state:?}"),
        Refused::Held { resource, .. } => format!(
            "actuator {} of device {} is held by another command",
            resource & 0xffff,
            resource >> 16
        ),
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
