//! Values of earlier cycles: sample and hold, and look-up by age.

use crate::aggregates::StateRange;
use crate::context::Context;
use crate::ring_buffer::RingBuffer;
use crate::value_types::FlowType;
use rpi_image::{SizeArgs, Value};

/// Defines the primitives `Snapshot` and `AtTime` for one value type.
macro_rules! sampled {
    ($prefix:literal, $t:ty) => {
        primitive! {
            /// Sample and hold: stores the value in each cycle in which `inSnapshot` is true, and outputs the last
            /// stored value. The output is the parameter `Value` before the first one. An absent value is not stored.
            SNAPSHOT = concat!($prefix, "Snapshot");
            in { inSnapshot: bool; inValue: $t }
            param { Value: $t = Neutral }
            out { outValue: $t }
            state { $t }
            init super::sampled::init_with_first_param;
            presence always work 2;
            c Code(r"
if (inSnapshot_present && inSnapshot && inValue_present) {
  COPY(s0, inValue);
}
COPY(outValue, s0);
*outValue_present = true;
");
            full |_, _, (held,), (_,), (snapshot, value)| {
                if snapshot == Some(true) {
                    *held = value.unwrap_or(*held);
                }
                (Some(*held),)
            }
        }

        primitive! {
            /// Value of an earlier cycle: `inAge` seconds, rounded down to whole cycles, before the previous cycle. An
            /// age of 0 is the previous cycle, as in the reference system. Ages are limited to `MaxAge`. Absent if the
            /// history is too short, or if the value was absent then. A cycle without an age is not stored.
            AT_TIME = concat!($prefix, "AtTime");
            in { inValue: $t; inAge: f64 = Age(Real(0.0)) }
            param { MaxAge: f64 = Real(1.0) }
            out { outValue: $t }
            ring { super::sampled::history_slots::<$t> }
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
                (super::sampled::at_time::<$t>(cx, *history, max_age, value, age),)
            }
        }
    };
}

pub(super) use sampled;

/// Initialises the state of a primitive with the value of its first parameter.
pub(super) fn init_with_first_param(args: &SizeArgs<'_>, state: &mut [u64]) {
    let value = args.params.first().map_or(&[][..], Value::slots);
    if value.len() == state.len() {
        state.copy_from_slice(value);
    }
}

/// Returns the number of memory slots for a history of values over `MaxAge` seconds (parameter 0) and one more cycle.
pub(in crate::catalogue) fn history_slots<T: FlowType>(args: &SizeArgs<'_>) -> u32 {
    RingBuffer::<T>::cells(args.cycles_of_param(0).saturating_add(1))
}

/// Returns the value `age` seconds before the previous cycle, then stores the value of this cycle in `history`. `age`
/// is limited to `max_age` seconds. `None` if the history is too short, the value was absent, or `age` is absent.
pub(in crate::catalogue) fn at_time<T: FlowType>(
    cx: &mut Context<'_>,
    history: StateRange,
    max_age: f64,
    value: Option<T>,
    age: Option<f64>,
) -> Option<T> {
    let age = age?;
    let ring = RingBuffer::<T>::from_region(history);
    let oldest = ring.capacity() - 1;
    // The look-up comes before the push, so that age 0 is the previous cycle.
    let back = ring.nth_back(cx.slots, cycles_back(age / max_age, oldest));
    ring.push(cx.slots, value);
    back
}

/// Returns the number of whole cycles in the fraction `share` (0 to 1) of a history of `oldest` cycles; negative
/// fractions count as 0.
fn cycles_back(share: f64, oldest: usize) -> usize {
    let cycles = libm::floor(share * oldest as f64);
    (cycles.max(0.0) as usize).min(oldest.saturating_sub(1))
}
