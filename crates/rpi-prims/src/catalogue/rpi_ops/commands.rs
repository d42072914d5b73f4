//! Flows that the core provides to a command, and checks that end the command.

use crate::context::{Context, FaultCode, FaultValues};
use crate::macros::{interface, primitive};
use crate::registry::Prim;
use rpi_image::{CommandFlow, Role};

pub(in crate::catalogue) const ALL: &[Prim] = &[
    FIRST,
    TIME,
    PREDECESSOR,
    SPEED_OVERRIDE,
    PAUSE,
    ASSERT,
    ASSERT_INDEX,
    ASSUME,
];

interface! {
    /// True in the first cycle in which the enclosing fragment is active, and again in the first cycle after its reset.
    FIRST = "Rpi::First";
    in {}
    out { outValue: bool }
    presence always work 1;
    role Role::First
}

interface! {
    /// Time since the first cycle of the command, in s; 0 in the first cycle.
    TIME = "Rpi::Time";
    in {}
    out { outValue: f64 }
    presence always work 0;
    role Role::Flow(CommandFlow::Time)
}

interface! {
    /// Number that identifies the command that preceded this one and the result with which it ended; absent if there is
    /// no preceding command.
    PREDECESSOR = "Rpi::Predecessor";
    in {}
    out { outValue: i64 }
    presence maybe work 0;
    role Role::Flow(CommandFlow::Predecessor)
}

interface! {
    /// Share of the speed, 0 to 1, that the operator has set for all motions.
    SPEED_OVERRIDE = "Rpi::SpeedOverride";
    in {}
    out { outShare: f64 }
    presence always work 0;
    role Role::Flow(CommandFlow::SpeedOverride)
}

interface! {
    /// True while the operator pauses all motions.
    PAUSE = "Rpi::Pause";
    in {}
    out { outPaused: bool }
    presence always work 0;
    role Role::Flow(CommandFlow::Pause)
}

primitive! {
    /// Outputs the Boolean at its in-port. If it is false, a fault ends the command.
    ASSERT = "Rpi::Assert";
    in { inValue: bool }
    out { outValue: bool }
    presence strict work 1 faults;
    c Value("rpi_check(cx, at, RPI_ASSERTION_FAILED, inValue)");
    full |cx, place, _, _, (holds,)| fault_unless(cx, place, holds, FaultCode::AssertionFailed)
}

primitive! {
    /// Outputs the Boolean at its first in-port, which is the result of an index check. If it is false, a fault ends
    /// the command; its message has the index and the number of elements.
    ASSERT_INDEX = "Rpi::AssertIndex";
    in { inValue: bool; inIndex: i64 = Index(Int(0)); inLength: i64 = Length(Int(0)) }
    out { outValue: bool }
    presence strict work 1 faults;
    c Code("*outValue = rpi_check(cx, at, RPI_INDEX_OUT_OF_RANGE, inValue);");
    full |cx, place, _, _, (holds, index, length)| {
        if !holds {
            cx.fault_by(FaultCode::IndexOutOfRange, place, FaultValues::Index { index, length });
        }
        (holds,)
    }
}

primitive! {
    /// Outputs the Boolean at its in-port. If it is false, a fault ends the command. The prover assumes that it is
    /// true.
    ASSUME = "Rpi::Assume";
    in { inValue: bool }
    out { outValue: bool }
    presence strict work 1 faults;
    c Value("rpi_check(cx, at, RPI_ASSERTION_FAILED, inValue)");
    full |cx, place, _, _, (holds,)| fault_unless(cx, place, holds, FaultCode::AssertionFailed)
}

fn fault_unless(cx: &mut Context<'_>, place: u32, holds: bool, otherwise: FaultCode) -> (bool,) {
    if !holds {
        cx.fault(otherwise, place);
    }
    (holds,)
}
