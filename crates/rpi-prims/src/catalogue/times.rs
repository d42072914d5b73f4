//! Points in time: whole nanoseconds since the Unix epoch.

use super::generic::sampled;
use crate::context::{Context, FaultCode};
use crate::macros::{interface, primitive};
use crate::registry::Prim;
use crate::value_types::Time;
use rpi_image::{CommandFlow, Role};

pub(super) const ALL: &[Prim] = &[NET, WALL, ADD, DIFF, PRE, AT_TIME];

interface! {
    /// Logical time of the cycle, ns since the Unix epoch: the time of the first cycle of the command plus one period
    /// per cycle.
    NET = "Core::TimeNet";
    in {}
    out { outValue: Time }
    presence always work 0;
    role Role::Flow(CommandFlow::NetTime)
}

interface! {
    /// Time of the system clock at the start of the cycle, ns since the Unix epoch.
    WALL = "Core::TimeWall";
    in {}
    out { outValue: Time }
    presence always work 0;
    role Role::Flow(CommandFlow::WallTime)
}

primitive! {
    /// Time plus `inDelta` seconds, truncated to ns. A result out of range is a fault.
    ADD = "Core::TimeAdd";
    in { inTime: Time; inDelta: f64 }
    out { outValue: Time }
    presence strict work 3 faults;
    c Value("rpi_time_add(cx, at, inTime, inDelta)");
    full |cx, place, _, _, (time, delta)| (add_seconds(cx, place, time, delta),)
}

primitive! {
    /// Difference of two times, `inSecond` minus `inFirst`, in s.
    DIFF = "Core::TimeDiff";
    in { inFirst: Time; inSecond: Time }
    out { outValue: f64 }
    presence strict work 2;
    c Value("rpi_time_between(inFirst, inSecond)");
    pure |(first, second)| (seconds_between(first, second),)
}

interface! {
    /// Delay: value of `inValue` in the previous cycle in which the enclosing fragment was active; absent if it was
    /// absent then. Absent in the first cycle.
    PRE = "Core::TimePre";
    in { inValue: Time }
    out { outValue: Time }
    presence maybe work 1;
    role Role::Delay
}

primitive! {
    /// Value of an earlier cycle: `inAge` seconds, rounded down to whole cycles, before the previous cycle. Ages are
    /// limited to `MaxAge`. Absent if the history is too short, or if the value was absent then. A cycle without an age
    /// is not stored. Same as `AtTime` of other types.
    AT_TIME = "Core::TimeAtTime";
    in { inValue: Time; inAge: f64 = Age(Real(0.0)) }
    param { MaxAge: f64 = Real(1.0) }
    out { outValue: Time }
    ring { sampled::history_slots::<Time> }
    presence maybe work 4;
    c Code(r"
*outValue_present = false;
if (inAge_present) {
  const size_t oldest = (ring_len - 2U) / (SLOTS(outValue) + 1U) - 1U;
  const uint64_t *past = rpi_ring_entry(ring, ring_len, SLOTS(outValue), rpi_cycles_back(inAge / MaxAge, oldest));
  uint64_t *next;
  if (past != NULL) {
    *outValue_present = true;
    LOAD(outValue, past);
  }
  next = rpi_ring_push(ring, ring_len, SLOTS(outValue), inValue_present);
  if (inValue_present) {
    STORE(next, inValue);
  }
}
");
    full |cx, _, history, (max_age,), (value, age)| {
        (sampled::at_time::<Time>(cx, *history, max_age, value, age),)
    }
}

/// Returns `second` minus `first`, in s.
pub(super) fn seconds_between(first: Time, second: Time) -> f64 {
    let nanoseconds = i128::from(second.0) - i128::from(first.0);
    nanoseconds as f64 / 1e9
}

fn add_seconds(cx: &mut Context<'_>, place: u32, time: Time, seconds: f64) -> Time {
    let delta = super::int::truncate_or_fault(cx, place, seconds * 1e9);
    Time(time.0.checked_add(delta).unwrap_or_else(|| {
        cx.fault(FaultCode::IntegerOverflow, place);
        time.0
    }))
}
