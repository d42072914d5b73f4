//! Updates of DirectIO subscriptions.

use rpi_core::State;

use super::message::{Arg, Message};
use crate::state::{DeviceInfo, Phase, RuleState, Sink, Update};
use crate::wire::Post;

/// Subscriber that sends updates with the tag of its subscription.
pub(super) struct DioSink {
    pub(super) tag: String,
    pub(super) out: Post,
}

impl Sink for DioSink {
    fn tell(&mut self, update: &Update<'_>) -> bool {
        match update {
            Update::Command(status) => self.push("ns", Arg::text(phase(status.phase))),
            Update::Values(values) => {
                let entry =
                    |(key, value): &(String, String)| (format!("out{key}"), Arg::text(value));
                self.push("nc", Arg::Map(values.iter().map(entry).collect()))
            }
            Update::Rule(state) => self.push("rs", Arg::text(rule(*state))),
            Update::Session(open) => {
                let state = if *open { "ACTIVE" } else { "TERMINATED" };
                self.push("st", Arg::text(state))
            }
            // The protocol has no message for these updates.
            Update::Emergency(_) | Update::Task(_) | Update::Jumped(_) => true,
            Update::DeviceAdded(info) => {
                self.push("da", device(info)) && self.push_status(&info.name, condition(info.code))
            }
            Update::DeviceCondition(name, code) => self.push_status(name, condition(*code)),
            Update::DeviceRemoved(name) => {
                let gone = Arg::List(vec![Arg::text(*name)]);
                self.push_status(name, "off") && self.push("dr", gone)
            }
        }
    }

    fn is_heard(&self) -> bool {
        self.out.is_heard()
    }
}

impl DioSink {
    fn push_status(&self, device: &str, status: &str) -> bool {
        let status = Arg::text(status);
        self.push("ds", Arg::Map(vec![(device.to_owned(), status)]))
    }

    fn push(&self, name: &str, arg: Arg) -> bool {
        self.out
            .put(Message::new(&self.tag, name, vec![arg]).to_string())
    }
}

/// Returns the protocol's word for the state of a device: operational, or safe-operational (reports its state but does
/// not move).
fn condition(code: i64) -> &'static str {
    match code {
        0 => "op",
        _ => "safeop",
    }
}

/// Returns the protocol's word for the life-cycle state of a command.
fn phase(phase: Phase) -> &'static str {
    match phase {
        Phase::Is(State::Loading) => "LOADING",
        Phase::Is(State::Rejected) => "REJECTED",
        Phase::Is(State::Ready) => "READY",
        Phase::Is(State::Scheduled) => "SCHEDULED",
        Phase::Is(State::Running) => "RUNNING",
        Phase::Is(State::Cancelling) => "CANCELLING",
        Phase::Is(State::Terminated) => "TERMINATED",
        Phase::Unloaded => "UNLOADED",
    }
}

fn rule(state: RuleState) -> &'static str {
    match state {
        RuleState::Active => "ACTIVE",
        RuleState::Fired => "FIRED",
        RuleState::Failed => "FIREFAILED",
        RuleState::Dropped => "INACTIVE",
    }
}

fn device(info: &DeviceInfo) -> Arg {
    let parameters = |parameters: &[(String, String)]| {
        let entry = |(key, value): &(String, String)| (key.clone(), Arg::text(value));
        Arg::Map(parameters.iter().map(entry).collect())
    };
    let interfaces = info.interfaces.iter();
    let interfaces = interfaces.map(|(name, own)| ((*name).to_owned(), parameters(own)));
    let about = vec![
        ("type".to_owned(), Arg::text(&info.kind)),
        ("interfaces".to_owned(), Arg::Map(interfaces.collect())),
    ];
    Arg::Map(vec![(info.name.clone(), Arg::Map(about))])
}
