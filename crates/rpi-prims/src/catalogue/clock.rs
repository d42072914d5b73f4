//! Clocks and times.

use crate::macros::primitive;
use crate::registry::Prim;

pub(super) const ALL: &[Prim] = &[CLOCK];

primitive! {
    /// Seconds since start, scaled: adds `Increment` times the period in each cycle, so the first output is one step, not 0.
    /// A reset starts again from 0 before adding. Stands still while the increment is absent.
    CLOCK = "Core::Clock";
    in { inReset: bool = Reset(Bool(false)); inIncrement: f64 = Increment(Real(1.0)) }
    out { outValue: f64 }
    state { f64 }
    presence strict work 2;
    full |cx, _, (time,), (), (reset, increment)| {
        *time = if reset { 0.0 } else { *time } + increment * cx.clock.dt;
        (*time,)
    }
}
