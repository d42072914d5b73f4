//! Updates of DirectIO subscriptions.

use rpi_core::CommandState;

use super::message::{Arg, Message};
use crate::state::{DeviceInfo, Phase, RuleState, Subscriber, Update};
use crate::transport::SubscriptionSender;

/// Subscriber for a DirectIO client: sends each update to the client with the tag of the subscription request.
pub(super) struct DioSubscriber {
    pub(super) tag: String,
    pub(super) out: SubscriptionSender,
}

impl Subscriber for DioSubscriber {
    fn notify(&mut self, update: &Update<'_>) -> bool {
        match update {
            Update::Command(status) => self.push("ns", Arg::text(phase_word(status.phase))),
            Update::Values(values) => {
                let entry =
                    |(key, value): &(String, String)| (format!("out{key}"), Arg::text(value));
                self.push("nc", Arg::Map(values.iter().map(entry).collect()))
            }
            Update::Rule(state) => self.push("rs", Arg::text(rule_word(*state))),
            Update::Session(open) => {
                let state = if *open { "ACTIVE" } else { "TERMINATED" };
                self.push("st", Arg::text(state))
            }
            // The protocol has no message for these updates.
            Update::Emergency(_)
            | Update::Controls(_)
            | Update::Task(_)
            | Update::Discontinuity(_) => true,
            Update::DeviceAdded(info) => {
                self.push("da", device(info))
                    && self.push_status(&info.name, condition_word(info.code))
            }
            Update::DeviceCondition(name, code) => self.push_status(name, condition_word(*code)),
            Update::DeviceRemoved(name) => {
                let gone = Arg::List(vec![Arg::text(*name)]);
                self.push_status(name, "off") && self.push("dr", gone)
            }
        }
    }

    fn is_connected(&self) -> bool {
        self.out.is_connected()
    }
}

impl DioSubscriber {
    fn push_status(&self, device: &str, status: &str) -> bool {
        let status = Arg::text(status);
        self.push("ds", Arg::Map(vec![(device.to_owned(), status)]))
    }

    fn push(&self, name: &str, arg: Arg) -> bool {
        self.out
            .send(Message::new(&self.tag, name, vec![arg]).to_string())
    }
}

/// Returns the word of the DirectIO protocol for the state of a device with this error code: `op` (operational) for 0,
/// else `safeop` (safe-operational: the device reports its state but does not move).
fn condition_word(code: i64) -> &'static str {
    match code {
        0 => "op",
        _ => "safeop",
    }
}

/// Returns the word of the DirectIO protocol for the life-cycle state of a command.
fn phase_word(phase: Phase) -> &'static str {
    match phase {
        Phase::Core(CommandState::Loading) => "LOADING",
        Phase::Core(CommandState::Rejected) => "REJECTED",
        Phase::Core(CommandState::Ready) => "READY",
        Phase::Core(CommandState::Scheduled) => "SCHEDULED",
        Phase::Core(CommandState::Running) => "RUNNING",
        Phase::Core(CommandState::Cancelling) => "CANCELLING",
        Phase::Core(CommandState::Terminated) => "TERMINATED",
        Phase::Unloaded => "UNLOADED",
    }
}

fn rule_word(state: RuleState) -> &'static str {
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
