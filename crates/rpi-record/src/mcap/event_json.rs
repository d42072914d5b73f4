//! Encodes events of commands, rules and devices as JSON.

use rpi_core::{AbortReason, Cause, CommandId, Ending, Notice, RuleOutcome};
use rpi_image::Image;
use rpi_image::image::CommandEnd;
use serde_json::{Value, json};

use super::names::NameTable;
use rpi_runtime::control::Event;
use rpi_runtime::run::fault_text;

/// Reasons of an abort and their keywords.
const REASON_KEYWORDS: [(AbortReason, &str); 6] = [
    (AbortReason::Request, "request"),
    (AbortReason::Overrun, "overrun"),
    (AbortReason::EmergencyStop, "emergency stop"),
    (AbortReason::ClientLost, "client lost"),
    (AbortReason::Discontinuity, "discontinuity"),
    (AbortReason::CancelTimeout, "cancel timeout"),
];

/// Returns the word that recordings use for the reason of an abort.
pub(super) fn reason_keyword(why: AbortReason) -> &'static str {
    REASON_KEYWORDS
        .iter()
        .find(|(w, _)| *w == why)
        .map_or("?", |w| w.1)
}

/// Returns the reason of an abort for the word that recordings use; `None` for an unknown word.
pub(super) fn reason_from_keyword(word: &str) -> Option<AbortReason> {
    REASON_KEYWORDS
        .iter()
        .find(|(_, w)| *w == word)
        .map(|w| w.0)
}

/// Encodes an event as a JSON object. `tick` is the tick of the last event that had one; it is used for events without
/// a tick.
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

/// Returns the tick in which an event occurred; `None` for events that are not bound to a tick.
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
}
