//! Edges, latches and windows over the recent past of a Boolean.

use crate::bulk::Region;
use crate::cx::Cx;
use crate::macros::primitive;
use crate::registry::Prim;
use crate::window::Window;
use rpi_image::{SizeArgs, Value};

pub(super) const ALL: &[Prim] = &[EDGE_DETECTION, TRIGGER, LAST_N, HISTORY];

primitive! {
    /// True exactly in cycles in which the value is `Direction` while it was not in the last cycle with a value. The first
    /// value counts as a change. Cycles without a value are passed over.
    EDGE_DETECTION = "Core::EdgeDetection";
    in { inValue: bool }
    param { Direction: bool = Bool(true) }
    out { outValue: bool }
    state { bool }
    presence strict work 2;
    full |_, _, (there,), (direction,), (value,)| {
        let (was_there, is_there) = (*there, value == direction);
        *there = is_there;
        (is_there && !was_there,)
    }
}

primitive! {
    /// One-shot latch: on from the first `inOn`, off for good from the first `inOff` (which wins in one cycle) until a
    /// reset arms it again. An absent input counts as false.
    TRIGGER = "Core::Trigger";
    in { inOn: bool = On(Bool(false)); inOff: bool = Off(Bool(false)); inReset: bool = Reset(Bool(false)) }
    out { outActive: bool }
    state { bool, bool }
    presence always work 3;
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
    /// The last `Count` values: whether none and whether all of them were true, and how many. What was before the first
    /// value counts as false. Cycles without a value are passed over.
    LAST_N = "Core::BooleanLastN";
    in { inValue: bool; inReset: bool = Reset(Bool(false)) }
    param { Count: i64 = Int(1) }
    out { outNone: bool; outAll: bool; outCount: i64 }
    ring { last_n }
    presence strict work 4;
    full |cx, _, history, _, (value, reset)| {
        let (count, of) = trues(cx, *history, value, reset);
        (count == 0, count == of, count)
    }
}

primitive! {
    /// The values of the last `Duration` seconds, rounded up to whole cycles: whether none and whether all of them were
    /// true, and which share (0 to 1). What was before the first value counts as false. Cycles without a value are passed
    /// over.
    HISTORY = "Core::BooleanHistory";
    in { inValue: bool; inReset: bool = Reset(Bool(false)) }
    param { Duration: f64 = Real(1.0) }
    out { outNone: bool; outAll: bool; outAmount: f64 }
    ring { last_seconds }
    presence strict work 4;
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
    Window::<i64>::cells(args.cycles(0))
}

/// Adds a value to the history: how many are true now, of how many.
fn trues(cx: &mut Cx<'_>, history: Region, value: bool, reset: bool) -> (i64, i64) {
    let window = Window::<i64>::of(history);
    if reset {
        window.clear(cx.cells);
    }
    let count = window.push(cx.cells, i64::from(value));
    (count, window.capacity() as i64)
}
