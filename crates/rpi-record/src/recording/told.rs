//! Encodes events of commands, rules and devices as JSON.

use rpi_core::{Cause, CommandId, Ending, Notice, Outcome, Why};
use rpi_image::Image;
use rpi_image::image::End;
use serde_json::{Value, json};

use super::names::Names;
use rpi_runtime::control::Event;
use rpi_runtime::run::fault_text;

/// Reasons of an abort and their keywords.
const WHY: [(Why, &str); 5] = [
    (Why::Request, "request"),
    (Why::Overrun, "overrun"),
    (Why::EmergencyStop, "emergency stop"),
    (Why::ClientLost, "client lost"),
    (Why::Discontinuity, "discontinuity"),
];

/// Returns the keyword of a reason.
pub(super) fn word_of(why: Why) -> &'static str {
    WHY.iter().find(|(w, _)| *w == why).map_or("?", |w| w.1)
}

/// Returns the reason with this keyword.
pub(super) fn why_by_word(word: &str) -> Option<Why> {
    WHY.iter().find(|(_, w)| *w == word).map(|w| w.0)
}

/// Encodes an event as a JSON object. `tick` is the tick of the last event that had one; it is used for events without
/// a tick.
pub(super) fn event(event: &Event, tick: u64, names: &Names) -> Value {
    match event {
        Event::Answer {
            ticket,
            tick,
            refused,
        } => json!({
            "event": "answer", "ticket": ticket.0, "tick": tick,
            "refused": refused.map(|why| format!("{why:?}")),
        }),
        Event::Freed(id) => of_command("freed", *id, tick, names),
        Event::Device {
            device,
            code,
            moving,
            tick,
        } => json!({
            "event": "device", "tick": tick, "device": names.of_device(*device), "code": code, "moving": moving,
        }),
        Event::Notice(notice) => self::notice(notice, tick, names),
    }
}

/// Returns the tick of an event, if the event has one.
pub(super) fn tick_of(event: &Event) -> Option<u64> {
    match event {
        Event::Answer { tick, .. }
        | Event::Device { tick, .. }
        | Event::Notice(
            Notice::Started { tick, .. } | Notice::Ended { tick, .. } | Notice::Braked { tick, .. },
        ) => Some(*tick),
        _ => None,
    }
}

fn of_command(what: &str, id: CommandId, tick: u64, names: &Names) -> Value {
    json!({ "event": what, "tick": tick, "command": names.of_command(id), "id": id.number() })
}

fn notice(notice: &Notice, tick: u64, names: &Names) -> Value {
    let with = |what: &str, id: CommandId, tick: u64, more: Value| {
        let mut object = of_command(what, id, tick, names);
        if let (Value::Object(object), Value::Object(more)) = (&mut object, more) {
            object.extend(more);
        }
        object
    };
    match *notice {
        Notice::Scheduled { command } => of_command("scheduled", command, tick, names),
        Notice::Cancelling { command } => of_command("cancelling", command, tick, names),
        Notice::Started { command, tick } => of_command("started", command, tick, names),
        Notice::Ended {
            command,
            tick,
            ending,
        } => {
            let image = names.image(command);
            with("ended", command, tick, self::ending(&ending, image))
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
            json!({ "actuator": resource, "device": names.of_actuator(resource) }),
        ),
        Notice::Jumped { command, jump } => {
            let quantity = format!("{:?}", jump.quantity).to_lowercase();
            let more = json!({
                "actuator": jump.resource, "quantity": quantity, "value": jump.value, "limit": jump.limit,
            });
            with("jumped", command, tick, more)
        }
        Notice::Rule { rule, outcome } => {
            let (outcome, why) = match outcome {
                Outcome::Fired => ("fired", None),
                Outcome::Failed(why) => ("failed", Some(format!("{why:?}"))),
                Outcome::Dropped => ("dropped", None),
            };
            json!({ "event": "rule", "tick": tick, "rule": rule.0, "outcome": outcome, "why": why })
        }
    }
}

fn ending(ending: &Ending, image: Option<&Image>) -> Value {
    let (cause, what) = match ending.cause {
        Cause::Result(k) => ("result", result(image, k).map(str::to_owned)),
        Cause::Terminate => ("terminate", None),
        Cause::Fault(fault) => ("fault", Some(fault_text(fault.code).to_owned())),
        Cause::Aborted(why) => ("aborted", Some(word_of(why).to_owned())),
        Cause::Stopped(rule) => ("stopped", Some(format!("rule {}", rule.0))),
    };
    json!({
        "cause": cause, "what": what, "error": ending.error, "cycles": ending.cycles,
        "cancelled": ending.cancelled, "left_moving": ending.left_moving,
    })
}

fn result(image: Option<&Image>, index: usize) -> Option<&str> {
    match &image?.end {
        End::Results(results) => results.get(index).map(|r| r.name.as_str()),
        End::Ports { .. } => None,
    }
}

#[cfg(test)]
mod tests {
    use rpi_runtime::tape::{number_of, why_of};

    use super::*;

    #[test]
    fn reasons_keep_their_numbers_and_words() {
        for (number, (why, word)) in (0..).zip(WHY) {
            assert_eq!((number_of(why), why_of(number)), (number, Some(why)));
            assert_eq!((word_of(why), why_by_word(word)), (word, Some(why)));
        }
        assert_eq!((why_of(99), why_by_word("mood")), (None, None));
    }
}
