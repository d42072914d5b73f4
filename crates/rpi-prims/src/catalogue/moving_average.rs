//! Moving averages. Before the window is full, the mean of the values so far. Cycles without a value are skipped.

use crate::aggregates::StateRange;
use crate::context::Context;
use crate::macros::primitive;
use crate::moving_sum::{Summand, Window};
use crate::registry::Prim;
use crate::value_types::Vector;
use rpi_image::SizeArgs;

pub(super) const ALL: &[Prim] = &[DOUBLE, VECTOR];

primitive! {
    /// Mean of the last `Duration` seconds, rounded up to whole cycles. Before that, the mean of the values so far.
    /// Cycles without a value are skipped. `inReset` restarts the window with the current value.
    DOUBLE = "Core::DoubleAverage";
    in { inValue: f64; inReset: bool = Reset(Bool(false)) }
    param { Duration: f64 = Real(1.0) }
    out { outValue: f64 }
    ring { cells::<f64> }
    presence strict work 8;
    c Code("rpi_mean(ring, ring_len, 1U, &inValue, inReset, outValue);");
    full |cx, _, history, _, (value, reset)| {
        let (sum, seen) = sum(cx, *history, value, reset);
        (sum / seen,)
    }
}

primitive! {
    /// Mean of the last `Duration` seconds, rounded up to whole cycles, for each component. Before that, the mean of
    /// the values so far. Cycles without a value are skipped. `inReset` restarts the window with the current value.
    VECTOR = "World::VectorAverage";
    in { inValue: Vector; inReset: bool = Reset(Bool(false)) }
    param { Duration: f64 = Real(1.0) }
    out { outValue: Vector }
    ring { cells::<Vector> }
    presence strict work 16;
    c Code("rpi_mean(ring, ring_len, 3U, inValue, inReset, outValue);");
    full |cx, _, history, _, (value, reset)| {
        let (sum, seen) = sum(cx, *history, value, reset);
        (sum / seen,)
    }
}

fn cells<T: Summand>(args: &SizeArgs<'_>) -> u32 {
    Window::<T>::cells(args.cycles_of_param(0))
}

/// Adds a value to the window over the last values, which it empties first if `reset` is true. Returns the sum of the
/// window and the number of values in it.
fn sum<T: Summand>(cx: &mut Context<'_>, history: StateRange, value: T, reset: bool) -> (T, f64) {
    let window = Window::<T>::from_region(history);
    if reset {
        window.clear(cx.slots);
    }
    let sum = window.push(cx.slots, value);
    (sum, window.len(cx.slots) as f64)
}
