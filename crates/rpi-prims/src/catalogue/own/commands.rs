//! Flows that the core gives to a command, and checks that end it.

use crate::cx::{Cx, FaultCode};
use crate::macros::{interface, primitive};
use crate::registry::Prim;
use rpi_image::{CommandFlow, Role};

pub(in crate::catalogue) const ALL: &[Prim] =
    &[FIRST, TIME, PREDECESSOR, ASSERT, ASSERT_INDEX, ASSUME];

interface! {
    /// True exactly in the first cycle in which the surrounding fragment is active, and again after its restart.
    FIRST = "Rpi::First";
    in {}
    out { outValue: bool }
    presence always work 1;
    role Role::First
}

interface! {
    /// Seconds since the command's first cycle, 0 there.
    TIME = "Rpi::Time";
    in {}
    out { outValue: f64 }
    presence always work 0;
    role Role::Flow(CommandFlow::Time)
}

interface! {
    /// Identity of the result by which the predecessor ended; absent without a predecessor.
    PREDECESSOR = "Rpi::Predecessor";
    in {}
    out { outValue: i64 }
    presence maybe work 0;
    role Role::Flow(CommandFlow::Predecessor)
}

primitive! {
    /// Lets the value through; a fault ends the command in the cycle in which it is false.
    ASSERT = "Rpi::Assert";
    in { inValue: bool }
    out { outValue: bool }
    presence strict work 1 faults;
    full |cx, place, _, _, (holds,)| checked(cx, place, holds, FaultCode::AssertionFailed)
}

primitive! {
    /// Lets the value through, which says that an index lies within its array; a fault ends the command in the cycle in which
    /// it is false.
    ASSERT_INDEX = "Rpi::AssertIndex";
    in { inValue: bool }
    out { outValue: bool }
    presence strict work 1 faults;
    full |cx, place, _, _, (holds,)| checked(cx, place, holds, FaultCode::IndexOutOfRange)
}

primitive! {
    /// Lets the value through; a fault ends the command in the cycle in which it is false. What proves properties of the
    /// program takes it as given.
    ASSUME = "Rpi::Assume";
    in { inValue: bool }
    out { outValue: bool }
    presence strict work 1 faults;
    full |cx, place, _, _, (holds,)| checked(cx, place, holds, FaultCode::AssertionFailed)
}

fn checked(cx: &mut Cx<'_>, place: u32, holds: bool, otherwise: FaultCode) -> (bool,) {
    if !holds {
        cx.fault(otherwise, place);
    }
    (holds,)
}
