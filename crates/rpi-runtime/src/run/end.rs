//! Texts for the ends of commands, faults and refusals.

use rpi_core::{Cause, Ending, Refused, Why};
use rpi_device::{Jump, Quantity};
use rpi_image::Image;
use rpi_image::image::{End, EndKind, EndResult};
use rpi_prims::FaultCode;
use rpi_sim::Cell;

use super::outcome::{FaultOrigin, RunEnd};

/// Returns the named result with which a command ended.
pub(super) fn result_of(image: &Image, ending: Ending) -> Option<&EndResult> {
    match (ending.cause, &image.end) {
        (Cause::Result(k), End::Results(results)) => results.get(k),
        _ => None,
    }
}

/// Returns how a command ended.
pub(super) fn of(image: &Image, ending: Ending) -> RunEnd {
    let number = ending.error;
    match ending.cause {
        Cause::Aborted(Why::Request) | Cause::Stopped(_) => RunEnd::CutOff,
        Cause::Aborted(why) => RunEnd::Stopped {
            why: stop_text(why).to_owned(),
        },
        Cause::Fault(fault) => RunEnd::Fault {
            what: fault_text(fault.code).to_owned(),
            place: image
                .place_of(fault.cell)
                .map_or_else(String::new, |p| p.path.clone()),
            at: None,
            // The faulty cycle is included in the count, and cycles are numbered from 0.
            origin: Box::new(FaultOrigin::of(
                image,
                fault,
                ending.cycles.saturating_sub(1),
            )),
        },
        Cause::Terminate if number == 0 => RunEnd::Terminated,
        Cause::Terminate => RunEnd::Error { number, name: None },
        Cause::Result(_) => result(result_of(image, ending), ending),
    }
}

fn result(result: Option<&EndResult>, ending: Ending) -> RunEnd {
    let name = result.map_or_else(String::new, |r| r.name.clone());
    let yields = result.is_some_and(|r| r.kind == EndKind::Yield);
    match ending.error {
        0 => RunEnd::Result {
            name,
            moving: yields && !ending.left_moving,
        },
        number => RunEnd::Error {
            number,
            name: Some(name),
        },
    }
}

/// Returns the description of a discontinuity, with the name of the actuator.
pub(super) fn jump(jump: &Jump, cell: &Cell) -> String {
    jump_text(jump, &actuator(jump.resource, cell))
}

/// Returns the description of a discontinuity of an actuator's set-point.
#[must_use]
pub fn jump_text(jump: &Jump, actuator: &str) -> String {
    let (what, unit) = match jump.quantity {
        Quantity::Position => ("position", ""),
        Quantity::Velocity => ("velocity", "/s"),
        Quantity::Acceleration => ("acceleration", "/s^2"),
    };
    let (value, limit) = (jump.value, jump.limit);
    format!("{what} of {actuator} would be {value:.4}{unit} where {limit:.4}{unit} is the limit")
}

/// Returns the display name of an actuator, for example `arm[2]`.
fn actuator(resource: u32, cell: &Cell) -> String {
    match cell.actuator(resource) {
        Some((device, own)) => format!("{device}[{own}]"),
        None => format!("actuator {resource}"),
    }
}

/// Returns the text for the reason for which the core did not start a command.
pub(super) fn refused(why: Refused, cell: &Cell) -> String {
    match why {
        Refused::Unknown => "unknown command".to_owned(),
        Refused::State(state) => format!("not allowed in state {state:?}"),
        Refused::Held { resource, .. } => {
            let of = actuator(resource, cell);
            format!("{of} is held by another command")
        }
        Refused::Successor => "the command would follow itself or start twice".to_owned(),
        Refused::Never => "no rule can start the command any more".to_owned(),
        Refused::Condition => "the condition of the rule is nested too deeply".to_owned(),
        Refused::Period => "the period is not a multiple of the tick".to_owned(),
        Refused::Full => "a table of the core is full".to_owned(),
    }
}

/// Returns the text for the reason of an abort.
#[must_use]
pub fn stop_text(why: Why) -> &'static str {
    match why {
        Why::Request => "aborted on request",
        Why::Overrun => "too many overruns",
        Why::EmergencyStop => "emergency stop",
        Why::ClientLost => "the client connection was lost",
        Why::Discontinuity => "discontinuous takeover by another command",
    }
}

/// Returns the text for a fault code.
// Recordings contain this text and replays compare it, so a changed text makes old recordings with a fault differ.
#[must_use]
pub fn fault_text(code: FaultCode) -> &'static str {
    match code {
        FaultCode::IntegerOverflow => "the result does not fit a 64-bit integer",
        FaultCode::DivisionByZero => "integer division by zero",
        FaultCode::LossyConversion => "this real has no integer value",
        FaultCode::IndexOutOfRange => "the index lies outside of its array",
        FaultCode::ShapeMismatch => "matrices or arrays whose shapes do not fit",
        FaultCode::ConcurrentAccess => "two writers of one actuator in a cycle",
        FaultCode::MissingSample => "a sensor had no sample",
        FaultCode::DeviceFailed => "the device refuses its set-point or has failed",
        FaultCode::SetPointMissing => "a moving actuator got no set-point and was stopped",
        FaultCode::Discontinuity => "its first set-points do not join those of who went before",
        FaultCode::EmergencyStop => "an emergency stop was demanded",
        FaultCode::OutsideSubrange => "the value lies outside of its subrange",
        FaultCode::AssertionFailed => "an assertion does not hold",
    }
}
