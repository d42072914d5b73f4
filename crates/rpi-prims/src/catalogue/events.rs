//! Edges, latches, and windows over the recent values of a Boolean.

use crate::aggregates::StateRange;
use crate::context::Context;
use crate::macros::primitive;
use crate::moving_sum::Window;
use crate::registry::Prim;
use rpi_image::{SizeArgs, Value};

pub(super) const ALL: &[Prim] = &[EDGE_DETECTION, TRIGGER, LAST_N, HISTORY];

primitive! {
    /// Edge detection: true in each cycle in which the value is `Direction` and was not in the last cycle with a value.
    /// The first value counts as an edge if it is `Direction`. Cycles without a value are skipped.
    EDGE_DETECTION = "Core::EdgeDetection";
    in { inValue: bool }
    param { Direction: bool = Bool(true) }
    out { outValue: bool }
    state { bool }
    presence strict work 2;
    c Code(r"
const bool is_there = inValue == Direction;
*outValue = is_there && !*s0;
*s0 = is_there;
");
    full |_, _, (there,), (direction,), (value,)| {
        let (was_there, is_there) = (*there, value == direction);
        *there = is_there;
        (is_there && !was_there,)
    }
}

primitive! {
    /// One-shot latch: turns on with the first true `inOn` and off with the first true `inOff`, which has priority in
    /// the same cycle. It stays off until `inReset` rearms it. An absent input counts as false.
    TRIGGER = "Core::Trigger";
    in { inOn: bool = On(Bool(false)); inOff: bool = Off(Bool(false)); inReset: bool = Reset(Bool(false)) }
    out { outActive: bool }
    state { bool, bool }
    presence always work 3;
    c Code(r"
const bool is_off = inOff_present && inOff;
if (inReset_present && inReset) {
  *s0 = false;
  *s1 = false;
}
*s0 = !*s1 && !is_off && (*s0 || (inOn_present && inOn));
*s1 = *s1 || is_off;
*outActive = *s0;
*outActive_present = true;
");
    full |_, _, (active, done), (), (on, off, reset)| {
        if reset == Some(true) {
            (*active, *done) = (false, false);
        }
        let off = off == Some(true);
        *active = !*done && !off && (*active || on == Some(true));
        *done |= off;
        (Some(*active),)
    }
}

primitive! {
    /// Statistics of the last `Count` values: whether none is true, whether all are true, and the number of true
    /// values. Before the first value, all values count as false. Cycles without a value are skipped. `inReset` clears
    /// the window.
    LAST_N = "Core::BooleanLastN";
    in { inValue: bool; inReset: bool = Reset(Bool(false)) }
    param { Count: i64 = Int(1) }
    out { outNone: bool; outAll: bool; outCount: i64 }
    ring { last_n }
    presence strict work 4;
    c Code(r"
int64_t capacity;
*outCount = rpi_count(ring, ring_len, inValue, inReset, &capacity);
*outNone = *outCount == 0;
*outAll = *outCount == capacity;
");
    full |cx, _, history, _, (value, reset)| {
        let (count, of) = trues(cx, *history, value, reset);
        (count == 0, count == of, count)
    }
}

primitive! {
    /// Statistics of the values of the last `Duration` seconds, rounded up to whole cycles: whether none is true,
    /// whether all are true, and the fraction of true values (0 to 1). Before the first value, all values count as
    /// false. Cycles without a value are skipped. `inReset` clears the window.
    HISTORY = "Core::BooleanHistory";
    in { inValue: bool; inReset: bool = Reset(Bool(false)) }
    param { Duration: f64 = Real(1.0) }
    out { outNone: bool; outAll: bool; outAmount: f64 }
    ring { last_seconds }
    presence strict work 4;
    c Code(r"
int64_t capacity;
const int64_t count = rpi_count(ring, ring_len, inValue, inReset, &capacity);
*outNone = count == 0;
*outAll = count == capacity;
*outAmount = (double)count / (double)capacity;
");
    full |cx, _, history, _, (value, reset)| {
        let (count, of) = trues(cx, *history, value, reset);
        (count == 0, count == of, count as f64 / of as f64)
    }
}

fn last_n(args: &SizeArgs<'_>) -> u32 {
    let count = args.params.first().and_then(Value::as_int).unwrap_or(1);
    Window::<i64>::cells(u32::try_from(count.max(1)).unwrap_or(u32::MAX))
}

fn last_seconds(args: &SizeArgs<'_>) -> u32 {
    Window::<i64>::cells(args.cycles_of_param(0))
}

/// Adds a value to the window over the last values, which it empties first if `reset` is true. Returns the number of
/// true values in the window and the number of values that it can hold.
fn trues(cx: &mut Context<'_>, history: StateRange, value: bool, reset: bool) -> (i64, i64) {
    let window = Window::<i64>::from_region(history);
    if reset {
        window.clear(cx.slots);
    }
    let count = window.push(cx.slots, i64::from(value));
    (count, window.capacity() as i64)
}
