//! Exact time: numbers of ticks and their conversion to seconds.

use crate::catalogue::int::lossy_conversion;
use crate::context::{Context, whole_ticks};
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
    /// Time since the first cycle of the command, in ticks; 0 in the first cycle.
    ELAPSED = "Rpi::Elapsed";
    in {}
    out { outValue: i64 }
    presence always work 0;
    role Role::Flow(CommandFlow::Elapsed)
}

interface! {
    /// Period of the command, in ticks.
    PERIOD_TICKS = "Rpi::PeriodTicks";
    in {}
    out { outValue: i64 }
    presence always work 0;
    role Role::Flow(CommandFlow::PeriodTicks)
}

primitive! {
    /// Duration of a number of ticks, in s.
    SECONDS_FROM_TICKS = "Rpi::SecondsFromTicks";
    in { inValue: i64 }
    out { outValue: f64 }
    presence strict work 3;
    c Value("rpi_seconds(inValue)");
    full |cx, _, _, _, (ticks,)| (cx.time.seconds(ticks),)
}

primitive! {
    /// Smallest whole number of ticks that is not shorter than the given time in s. Not-a-number, infinities and values
    /// out of range are faults.
    TICKS_FROM_SECONDS = "Rpi::TicksFromSeconds";
    in { inValue: f64 }
    out { outValue: i64 }
    presence strict work 10 faults;
    c Value("rpi_ticks(cx, at, inValue)");
    full |cx, place, _, _, (seconds,)| (ticks_or_fault(cx, place, seconds),)
}

/// Returns the smallest whole number of ticks that is not shorter than `seconds`; if there is none, raises a fault at
/// slot `place` and returns 0.
pub(super) fn ticks_or_fault(cx: &mut Context<'_>, place: u32, seconds: f64) -> i64 {
    cx.time.whole_ticks(seconds).unwrap_or_else(|| {
        lossy_conversion(cx, place, seconds);
        0
    })
}

primitive! {
    /// Smallest whole number of ticks that is not shorter than the given time in s, for a duration fixed when the
    /// command is loaded. A time out of range becomes the longest possible one: `1e300[s]` means never. Not-a-number
    /// becomes 0.
    WHOLE_TICKS = "Rpi::WholeTicks";
    in { inValue: f64 }
    out { outValue: i64 }
    presence strict work 10;
    c Value("rpi_saturated_ticks(inValue)");
    full |cx, _, _, _, (seconds,)| (whole_ticks(seconds, cx.time.tick_ns),)
}
