//! Texts for the ends of commands, faults and refusals.

use rpi_core::{AbortReason, Cause, CommandError, Ending};
use rpi_device::{Discontinuity, Quantity};
use rpi_image::Image;
use rpi_image::image::{CommandEnd, CommandEndKind, NamedResult};
use rpi_prims::{FaultCode, FaultValues};
use rpi_sim::Cell;
use rpi_words::with_noun;

use super::outcome::{FaultOrigin, RunEnd};

/// Returns the named result with which a command ended; `None` if it ended in another way.
pub(super) fn result_of(image: &Image, ending: Ending) -> Option<&NamedResult> {
    match (ending.cause, &image.end) {
        (Cause::Result(k), CommandEnd::Results(results)) => results.get(k),
        _ => None,
    }
}

/// Converts the ending of a command to its form in the outcome of a run, with names and texts.
pub(super) fn run_end(image: &Image, ending: Ending) -> RunEnd {
    let number = ending.error;
    match ending.cause {
        Cause::Aborted(AbortReason::Request) | Cause::Stopped(_) => RunEnd::CutOff,
        Cause::Aborted(why) => RunEnd::Stopped {
            why: abort_text(why).to_owned(),
        },
        Cause::Fault(fault) => RunEnd::Fault {
            what: fault_message(fault.code, fault.values),
            place: image
                .location_of(fault.slot)
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
        Cause::Result(_) => result_end(result_of(image, ending), ending),
    }
}

fn result_end(result: Option<&NamedResult>, ending: Ending) -> RunEnd {
    let name = result.map_or_else(String::new, |r| r.name.clone());
    let yields = result.is_some_and(|r| r.kind == CommandEndKind::Yield);
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

/// Returns the description of a discontinuity of set-points, with the name of the actuator.
pub(super) fn discontinuity_text(jump: &Discontinuity, cell: &Cell) -> String {
    actuator_discontinuity_text(jump, &actuator_name(jump.resource, cell))
}

/// Returns the description of a discontinuity of set-points: quantity, value and limit. `actuator` is the name of the
/// actuator.
#[must_use]
pub fn actuator_discontinuity_text(jump: &Discontinuity, actuator: &str) -> String {
    let (what, unit) = match jump.quantity {
        Quantity::Position => ("position", ""),
        Quantity::Velocity => ("velocity", "/s"),
        Quantity::Acceleration => ("acceleration", "/s^2"),
    };
    let (value, limit) = (jump.value, jump.limit);
    format!("{what} of {actuator} would be {value:.4}{unit} where {limit:.4}{unit} is the limit")
}

/// Returns the display name of the actuator with this resource number: device name and index in the device, as in
/// `arm[2]`.
fn actuator_name(resource: u32, cell: &Cell) -> String {
    match cell.resource_owner(resource) {
        Some((device, own)) => format!("{device}[{own}]"),
        None => format!("actuator {resource}"),
    }
}

/// Returns the text for the reason for which the core did not start a command.
pub(super) fn refusal_text(why: CommandError, cell: &Cell) -> String {
    match why {
        CommandError::Unknown => "unknown command".to_owned(),
        CommandError::InvalidState(state) => format!("not allowed in state {state:?}"),
        CommandError::ResourceHeld { resource, .. } => {
            let of = actuator_name(resource, cell);
            format!("{of} is held by another command")
        }
        CommandError::SelfSuccessor => "the command would follow itself or start twice".to_owned(),
        CommandError::NeverFires => "no rule can start the command any more".to_owned(),
        CommandError::ConditionTooDeep => {
            "the condition of the rule is nested too deeply".to_owned()
        }
        CommandError::PeriodMismatch => "the period is not a multiple of the tick".to_owned(),
        CommandError::TableFull => "a table of the core is full".to_owned(),
    }
}

/// Returns, for the report of a run, why a command was ended from outside: a phrase such as "too many overruns".
#[must_use]
pub fn abort_text(why: AbortReason) -> &'static str {
    match why {
        AbortReason::Request => "aborted on request",
        AbortReason::Overrun => "too many overruns",
        AbortReason::EmergencyStop => "emergency stop",
        AbortReason::ClientLost => "the client connection was lost",
        AbortReason::CancelTimeout => {
            "it had not ended within the grace time after a cancel request"
        }
        AbortReason::Discontinuity => "discontinuous takeover by another command",
    }
}

/// Returns the text for a fault with the values that caused it.
#[must_use]
pub fn fault_message(code: FaultCode, values: FaultValues) -> String {
    match values {
        FaultValues::Unknown => fault_text(code).to_owned(),
        FaultValues::Index { index, length } => format!(
            "the index {index} lies outside of its array of {}, counted from 0",
            with_noun(length, "element")
        ),
        FaultValues::Range { value, from, to } => {
            let bounds = match (from, to) {
                (from, i64::MAX) => format!("of integers from {from}"),
                (i64::MIN, to) => format!("of integers up to {to}"),
                (from, to) => format!("from {from} to {to}"),
            };
            format!("the value {value} lies outside of its subrange {bounds}")
        }
        FaultValues::Real { bits } => {
            format!("the real {:?} has no integer value", f64::from_bits(bits))
        }
    }
}

/// Returns the advice for the operation that caused a fault, if a program can avoid it; `operation` is its text.
#[must_use]
pub fn fault_advice(code: FaultCode, operation: &str) -> Option<String> {
    let advice = match code {
        FaultCode::DivisionByZero => format!(
            "compute it only while the divisor is not 0: `if ... <> 0 then {operation} else ...`"
        ),
        FaultCode::IntegerOverflow => {
            format!("limit the operands of `{operation}`, or compute in reals: `real x`")
        }
        FaultCode::LossyConversion => {
            format!("limit the value before the conversion `{operation}`, and test it for NaN")
        }
        FaultCode::IndexOutOfRange => {
            format!("limit the index in `{operation}` to the elements of the array")
        }
        FaultCode::OutsideSubrange => "limit the value to the subrange, or widen it".to_owned(),
        _ => return None,
    };
    Some(advice)
}

/// Returns the description of a kind of fault, such as "integer division by zero".
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
