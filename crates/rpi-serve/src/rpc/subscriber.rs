//! Updates of subscriptions: the notification `update` with the object and its changes.

use rpi_core::MotionControls;
use serde_json::{Map, Value, json};

use crate::state::{
    DeviceInfo, RuleState, SourceLocation, Status, Step, Subscriber, TaskStatus, Update,
    cause_text, fault_text,
};
use crate::transport::SubscriptionSender;

/// Subscriber for a JSON-RPC client, which sends each update about one object as a notification.
pub(super) struct RpcSubscriber {
    /// Kind (`command`, `task`, `rule` or `session`) and name of the observed object; `None` for subscriptions without
    /// a named object: devices, the emergency stop and the override.
    pub(super) about: Option<(&'static str, String)>,
    pub(super) out: SubscriptionSender,
}

impl Subscriber for RpcSubscriber {
    fn notify(&mut self, update: &Update<'_>) -> bool {
        let mut params = match update {
            Update::Command(status) => self::status(status),
            Update::Discontinuity(jump) => json!({"jump": jump}),
            Update::Values(values) => json!({"values": self::values(values)}),
            Update::Rule(state) => json!({"state": rule(*state)}),
            Update::Session(open) => json!({"open": open}),
            Update::Emergency(by) => json!({"emergency": emergency(*by)}),
            Update::Controls(controls) => json!({"motion": motion(*controls)}),
            Update::Task(status) => task(status),
            Update::DeviceAdded(info) => json!({"device": info.name, "added": device(info)}),
            Update::DeviceCondition(name, code) => json!({"device": name, "error": code}),
            Update::DeviceRemoved(name) => json!({"device": name, "removed": true}),
        };
        if let Some((kind, name)) = &self.about {
            params[*kind] = json!(name);
        }
        let update = json!({"jsonrpc": "2.0", "method": "update", "params": params});
        self.out.send(update.to_string())
    }

    fn is_connected(&self) -> bool {
        self.out.is_connected()
    }
}

/// Returns the exported values of a command (key and literal of each) as a JSON object of texts. Texts keep all bits of
/// a real, unlike JSON numbers.
pub(super) fn values(values: &[(String, String)]) -> Value {
    let entries = values
        .iter()
        .map(|(key, value)| (key.clone(), json!(value)));
    Value::Object(entries.collect::<Map<_, _>>())
}

/// Returns the speed override and the pause of all motions as JSON.
pub(super) fn motion(controls: MotionControls) -> Value {
    json!({"override": controls.speed_override, "paused": controls.paused})
}

/// Returns as JSON the life-cycle state of a command and, once it has ended, how it has ended.
pub(super) fn status(status: &Status) -> Value {
    let mut object = json!({"state": status.phase.name()});
    if let Some(ending) = &status.ending {
        object["ending"] = json!({
            "cause": cause_text(ending),
            "result": status.result,
            "error": ending.error,
            "cycles": ending.cycles,
            "cancelled": ending.cancelled,
            "left_moving": ending.left_moving,
            "taken_over": status.taken_over,
            "why": fault_text(ending),
            "place": path(status.location.as_ref()),
            "at": position(status.location.as_ref()),
            "braked": status.braked,
            "jump": status.discontinuity,
        });
    }
    if let Some(jump) = &status.discontinuity {
        object["jump"] = json!(jump);
    }
    object
}

fn path(place: Option<&SourceLocation>) -> Option<&str> {
    place.map(|place| place.path.as_str())
}

fn position(place: Option<&SourceLocation>) -> Option<&str> {
    place.and_then(|place| place.position.as_deref())
}

/// Returns the state of the emergency stop as JSON: whether it is in force, and `by` whom it was requested.
pub(super) fn emergency(by: Option<&str>) -> Value {
    json!({"stopped": by.is_some(), "by": by})
}

/// Returns the progress of a task as JSON: its state, its running commands and its latest ended commands.
pub(super) fn task(status: &TaskStatus) -> Value {
    let step = |step: &Step| {
        json!({
            "command": step.title, "result": step.result, "error": step.error, "cycles": step.cycles,
            "cause": step.cause, "why": step.why,
            "place": path(step.place.as_ref()), "at": position(step.place.as_ref()), "braked": step.braked, "jump": step.jump, "handled": step.handled,
        })
    };
    let running = status.running.iter();
    let running = running.map(|(name, title)| json!({"command": name, "title": title}));
    let mut object = json!({
        "state": status.phase.name(),
        "running": running.collect::<Value>(),
        "ended": status.steps.iter().map(step).collect::<Value>(),
        "late": status.late,
        "missed": status.missed_in_motion,
    });
    if let Some(error) = &status.error {
        object["trouble"] = json!(error);
    }
    object
}

fn rule(state: RuleState) -> &'static str {
    match state {
        RuleState::Active => "active",
        RuleState::Fired => "fired",
        RuleState::Failed => "failed",
        RuleState::Dropped => "dropped",
    }
}

/// Returns a device as JSON: name, type and interfaces.
pub(super) fn device(info: &DeviceInfo) -> Value {
    let interfaces = info.interfaces.iter().map(|(name, own)| {
        let parameters = own.iter().map(|(key, value)| (key.clone(), json!(value)));
        ((*name).to_owned(), Value::Object(parameters.collect()))
    });
    json!({
        "name": info.name,
        "type": info.kind,
        "interfaces": Value::Object(interfaces.collect()),
    })
}
