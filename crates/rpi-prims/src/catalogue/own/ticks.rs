//! Exact time: counts of ticks, and what they are in seconds.

use crate::cx::{Cx, FaultCode, whole_ticks};
use crate::macros::{interface, primitive};
use crate::registry::Prim;
use rpi_image::{CommandFlow, Role};

pub(in crate::catalogue) const ALL: &[Prim] = &[
    ELAPSED,
    PERIOD_TICKS,
    SECONDS_FROM_TICKS,
    TICKS_FROM_SECONDS,
    WHOLE_TICKS,
];

interface! {
    /// Ticks since the command's first cycle, 0 there.
    ELAPSED = "Rpi::Elapsed";
    in {}
    out { outValue: i64 }
    presence always work 0;
    role Role::Flow(CommandFlow::Elapsed)
}

interface! {
    /// Number of ticks in the period of the command.
    PERIOD_TICKS = "Rpi::PeriodTicks";
    in {}
    out { outValue: i64 }
    presence always work 0;
    role Role::Flow(CommandFlow::PeriodTicks)
}

primitive! {
    /// The seconds that a number of ticks takes.
    SECONDS_FROM_TICKS = "Rpi::SecondsFromTicks";
    in { inValue: i64 }
    out { outValue: f64 }
    presence strict work 3;
    full |cx, _, _, _, (ticks,)| (cx.clock.seconds(ticks),)
}

primitive! {
    /// The fewest whole ticks that take at least so many seconds. Not-a-number, infinities and what does not fit are faults.
    TICKS_FROM_SECONDS = "Rpi::TicksFromSeconds";
    in { inValue: f64 }
    out { outValue: i64 }
    presence strict work 10 faults;
    full |cx, place, _, _, (seconds,)| (ticks(cx, place, seconds),)
}

/// Whole ticks, or 0 and a fault.
pub(super) fn ticks(cx: &mut Cx<'_>, place: u32, seconds: f64) -> i64 {
    cx.clock.whole_ticks(seconds).unwrap_or_else(|| {
        cx.fault(FaultCode::LossyConversion, place);
        0
    })
}

primitive! {
    /// The fewest whole ticks that take at least so many seconds, of a duration that is fixed when the command is loaded. What
    /// 64 bits do not hold is the longest time that they hold: `1e300[s]` stands for never. Not-a-number is 0.
    WHOLE_TICKS = "Rpi::WholeTicks";
    in { inValue: f64 }
    out { outValue: i64 }
    presence strict work 10;
    full |cx, _, _, _, (seconds,)| (whole_ticks(seconds, cx.clock.tick_ns),)
}
