//! Values of earlier cycles: sample and hold, and looking back by a time.

use crate::bulk::Region;
use crate::cx::Cx;
use crate::flow::Flow;
use crate::ring::Ring;
use rpi_image::{SizeArgs, Value};

/// `Snapshot` and `AtTime` of one type.
macro_rules! sampled {
    ($prefix:literal, $t:ty) => {
        primitive! {
            /// Sample and hold: takes the value over in cycles in which `inSnapshot` is true and gives the last one taken;
            /// the parameter `Value` before. An absent value is not taken over.
            SNAPSHOT = concat!($prefix, "Snapshot");
            in { inSnapshot: bool; inValue: $t }
            param { Value: $t = Neutral }
            out { outValue: $t }
            state { $t }
            init super::sampled::first_param;
            presence always work 2;
            full |_, _, (held,), (_,), (snapshot, value)| {
                if snapshot == Some(true) {
                    *held = value.unwrap_or(*held);
                }
                (Some(*held),)
            }
        }

        primitive! {
            /// The value of an earlier cycle: `inAge` seconds, rounded down to whole cycles, before the previous one. An age of 0
            /// is the previous cycle, as in the reference system; ages are limited to `MaxAge`. Absent before there is enough
            /// history, and where the value was absent then. A cycle without an age is not remembered.
            AT_TIME = concat!($prefix, "AtTime");
            in { inValue: $t; inAge: f64 = Age(Real(0.0)) }
            param { MaxAge: f64 = Real(1.0) }
            out { outValue: $t }
            ring { super::sampled::history::<$t> }
            presence maybe work 4;
            full |cx, _, history, (max_age,), (value, age)| {
                (super::sampled::at_time::<$t>(cx, *history, max_age, value, age),)
            }
        }
    };
}

pub(super) use sampled;

/// Starts a state with the first parameter.
pub(super) fn first_param(args: &SizeArgs<'_>, state: &mut [u64]) {
    let value = args.params.first().map_or(&[][..], Value::cells);
    if value.len() == state.len() {
        state.copy_from_slice(value);
    }
}

/// Cells for the history of `MaxAge` seconds and the cycle before it.
pub(in crate::catalogue) fn history<T: Flow>(args: &SizeArgs<'_>) -> u32 {
    Ring::<T>::cells(args.cycles(0).saturating_add(1))
}

/// Remembers the value and looks back.
pub(in crate::catalogue) fn at_time<T: Flow>(
    cx: &mut Cx<'_>,
    history: Region,
    max_age: f64,
    value: Option<T>,
    age: Option<f64>,
) -> Option<T> {
    let age = age?;
    let ring = Ring::<T>::of(history);
    let oldest = ring.capacity() - 1;
    let back = ring.back(cx.cells, cycles_back(age / max_age, oldest));
    ring.push(cx.cells, value);
    back
}

/// Whole cycles in a share of the history; ages below 0 count as 0.
fn cycles_back(share: f64, oldest: usize) -> usize {
    let cycles = libm::floor(share * oldest as f64);
    (cycles.max(0.0) as usize).min(oldest.saturating_sub(1))
}
