//! Encodes events of commands, rules and devices as JSON.

use rpi_core::{AbortReason, Cause, CommandId, Ending, Notice, RuleOutcome};
use rpi_image::Image;
use rpi_image::image::CommandEnd;
use serde_json::{Value, json};

use super::names::NameTable;
use super::scene::LogLevel;
use rpi_runtime::control::Event;
use rpi_runtime::run::fault_text;

/// Keywords by which recordings store the reasons for aborting a command.
const REASON_KEYWORDS: [(AbortReason, &str); 6] = [
    (AbortReason::Request, "request"),
    (AbortReason::Overrun, "overrun"),
    (AbortReason::EmergencyStop, "emergency stop"),
    (AbortReason::ClientLost, "client lost"),
    (AbortReason::Discontinuity, "discontinuity"),
    (AbortReason::CancelTimeout, "cancel timeout"),
];

/// Returns the keyword by which recordings store a reason for aborting a command.
pub(super) fn reason_keyword(why: AbortReason) -> &'static str {
    REASON_KEYWORDS
        .iter()
        .find(|(w, _)| *w == why)
        .map_or("?", |w| w.1)
}

/// Returns the reason for aborting a command that recordings store by this keyword; `None` for an unknown keyword.
pub(super) fn reason_from_keyword(word: &str) -> Option<AbortReason> {
    REASON_KEYWORDS
        .iter()
        .find(|(_, w)| *w == word)
        .map(|w| w.0)
}

/// Encodes an event of the core as a JSON object. `tick` is the tick of the last event that had one; it is stored for
/// events without a tick of their own.
pub(super) fn encode_event(event: &Event, tick: u64, names: &NameTable) -> Value {
    match event {
        Event::Answer {
            ticket,
            tick,
            refused,
        } => json!({
            "event": "answer", "ticket": ticket.0, "tick": tick,
            "refused": refused.map(|why| format!("{why:?}")),
        }),
        Event::Freed(id) => command_event("freed", *id, tick, names),
        Event::Device {
            device,
            code,
            moving,
            tick,
        } => json!({
            "event": "device", "tick": tick, "device": names.device_name(*device), "code": code, "moving": moving,
        }),
        Event::Notice(notice) => self::encode_notice(notice, tick, names),
    }
}

/// Returns the severity with which viewers show an encoded event.
pub(super) fn event_level(event: &Value) -> LogLevel {
    match event["event"].as_str().unwrap_or_default() {
        "ended" if matches!(event["cause"].as_str(), Some("fault" | "aborted")) => LogLevel::Error,
        "lost" | "overrun" | "braked" | "jumped" => LogLevel::Warning,
        _ => LogLevel::Info,
    }
}

/// Returns the number of the tick in which an event occurred; `None` for events that have no tick.
pub(super) fn event_tick(event: &Event) -> Option<u64> {
    match event {
        Event::Answer { tick, .. }
        | Event::Device { tick, .. }
        | Event::Notice(
            Notice::Started { tick, .. } | Notice::Ended { tick, .. } | Notice::Braked { tick, .. },
        ) => Some(*tick),
        _ => None,
    }
}

fn command_event(what: &str, id: CommandId, tick: u64, names: &NameTable) -> Value {
    json!({ "event": what, "tick": tick, "command": names.command_name(id), "id": id.to_number() })
}

fn encode_notice(notice: &Notice, tick: u64, names: &NameTable) -> Value {
    let with = |what: &str, id: CommandId, tick: u64, more: Value| {
        let mut object = command_event(what, id, tick, names);
        if let (Value::Object(object), Value::Object(more)) = (&mut object, more) {
            object.extend(more);
        }
        object
    };
    match *notice {
        Notice::Scheduled { command } => command_event("scheduled", command, tick, names),
        Notice::Cancelling { command } => command_event("cancelling", command, tick, names),
        Notice::Started { command, tick } => command_event("started", command, tick, names),
        Notice::Ended {
            command,
            tick,
            ending,
        } => {
            let image = names.image(command);
            with("ended", command, tick, self::encode_ending(&ending, image))
        }
        Notice::Orphaned { command, kept } => {
            with("orphaned", command, tick, json!({ "kept": kept }))
        }
        Notice::Braked {
            command,
            resource,
            tick,
        } => with(
            "braked",
            command,
            tick,
            json!({ "actuator": resource, "device": names.actuator_device_name(resource) }),
        ),
        Notice::Discontinuity {
            command,
            discontinuity: jump,
        } => {
            let quantity = format!("{:?}", jump.quantity).to_lowercase();
            let more = json!({
                "actuator": jump.resource, "quantity": quantity, "value": jump.value, "limit": jump.limit,
            });
            with("jumped", command, tick, more)
        }
        Notice::Rule { rule, outcome } => {
            let (outcome, why) = match outcome {
                RuleOutcome::Fired => ("fired", None),
                RuleOutcome::Failed(why) => ("failed", Some(format!("{why:?}"))),
                RuleOutcome::Dropped => ("dropped", None),
            };
            json!({ "event": "rule", "tick": tick, "rule": rule.0, "outcome": outcome, "why": why })
        }
    }
}

fn encode_ending(ending: &Ending, image: Option<&Image>) -> Value {
    let (cause, what) = match ending.cause {
        Cause::Result(k) => ("result", result_name(image, k).map(str::to_owned)),
        Cause::Terminate => ("terminate", None),
        Cause::Fault(fault) => ("fault", Some(fault_text(fault.code).to_owned())),
        Cause::Aborted(why) => ("aborted", Some(reason_keyword(why).to_owned())),
        Cause::Stopped(rule) => ("stopped", Some(format!("rule {}", rule.0))),
    };
    json!({
        "cause": cause, "what": what, "error": ending.error, "cycles": ending.cycles,
        "cancelled": ending.cancelled, "left_moving": ending.left_moving,
    })
}

fn result_name(image: Option<&Image>, index: usize) -> Option<&str> {
    match &image?.end {
        CommandEnd::Results(results) => results.get(index).map(|r| r.name.as_str()),
        CommandEnd::Ports { .. } => None,
    }
}

#[cfg(test)]
mod tests {
    use rpi_runtime::tick_log::{reason_from_number, reason_number};

    use super::*;

    #[test]
    fn reasons_keep_their_numbers_and_words() {
        for (number, (why, word)) in (0..).zip(REASON_KEYWORDS) {
            assert_eq!(
                (reason_number(why), reason_from_number(number)),
                (number, Some(why))
            );
            assert_eq!(
                (reason_keyword(why), reason_from_keyword(word)),
                (word, Some(why))
            );
        }
        assert_eq!(
            (reason_from_number(99), reason_from_keyword("mood")),
            (None, None)
        );
    }
    #[test]
    fn viewers_show_a_command_that_failed_as_an_error() {
        let level = |cause| {
            let ending = Ending {
                cause,
                error: 0,
                cycles: 1,
                cancelled: false,
                left_moving: false,
            };
            let mut event = encode_ending(&ending, None);
            event["event"] = "ended".into();
            event_level(&event)
        };
        assert_eq!(level(Cause::Terminate), LogLevel::Info);
        assert_eq!(level(Cause::Aborted(AbortReason::Overrun)), LogLevel::Error);
        assert_eq!(
            event_level(&json!({ "event": "jumped" })),
            LogLevel::Warning
        );
    }
}
