//! Operations on times that the reference system does not have, in the namespace `Rpi`. The delays of times are those
//! of the reference system.

use super::arrays::arrays;
use super::keyed::keyed;
use super::scalars::scalars;
use crate::aggregates::Array;
use crate::context::FaultCode;
use crate::macros::{interface, primitive};
use crate::operand::Text;
use crate::registry::Prim;
use crate::value_types::{FlowType, Time};
use rpi_image::{Role, ShapeRule};

scalars!("Rpi::Time", Time);
arrays!("Rpi::Time", Time);
keyed!("Rpi::Time", Time);

primitive! {
    /// True if both times are equal.
    EQUALS = "Rpi::TimeEquals";
    in { inFirst: Time; inSecond: Time }
    out { outValue: bool }
    presence strict work 1;
    c Value("inFirst == inSecond");
    pure |(a, b): (Time, Time)| (a == b,)
}

primitive! {
    /// True if the first time is later than the second.
    GREATER = "Rpi::TimeGreater";
    in { inFirst: Time; inSecond: Time }
    out { outValue: bool }
    presence strict work 1;
    c Value("inFirst > inSecond");
    pure |(a, b): (Time, Time)| (a > b,)
}

primitive! {
    /// True if the first time is not earlier than the second.
    GREATER_OR_EQUAL = "Rpi::TimeGreaterOrEqual";
    in { inFirst: Time; inSecond: Time }
    out { outValue: bool }
    presence strict work 1;
    c Value("inFirst >= inSecond");
    pure |(a, b): (Time, Time)| (a >= b,)
}

pub(in crate::catalogue) const ALL: &[Prim] = &[
    VALUE,
    IS_NULL,
    SET_NULL,
    CONDITIONAL,
    ARRAY,
    ARRAY_GET,
    ARRAY_SET,
    ARRAY_SLICE,
    ARRAY_IS_NULL,
    ARRAY_SET_NULL,
    NETCOMM_IN,
    NETCOMM_OUT,
    ARRAY_NETCOMM_IN,
    ARRAY_NETCOMM_OUT,
    INTER_NETCOMM_IN,
    INTER_NETCOMM_OUT,
    ARRAY_INTER_NETCOMM_IN,
    ARRAY_INTER_NETCOMM_OUT,
    EQUALS,
    GREATER,
    GREATER_OR_EQUAL,
];
