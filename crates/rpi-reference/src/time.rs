//! Exact time: a leaf of type `time` counts ticks (M2.4), while inputs and outputs are in seconds. A tick equals the
//! period here.

use rpi_sema::ty::Ty;

use crate::value::{EvalError, Leaf, Value};

/// Period of a cycle in seconds, which is also the length of a tick, the unit of exact times.
pub(crate) struct Period {
    seconds: f64,
}

impl Period {
    pub(crate) fn from_seconds(seconds: f64) -> Period {
        Period { seconds }
    }

    /// Returns the duration of a number of ticks in seconds. A tick is rounded to whole nanoseconds.
    fn seconds_of(&self, ticks: i64) -> f64 {
        let tick_ns = (self.seconds * 1e9).round();
        ticks as f64 * tick_ns / 1e9
    }

    /// Returns the smallest number of ticks that last at least the given seconds; `None` if it does not fit into 64
    /// bits.
    fn whole_ticks(&self, seconds: f64) -> Option<i64> {
        let about = (seconds / self.seconds).floor();
        // Beyond this limit the number of ticks does not fit into 64 bits.
        if about.is_nan() || about.abs() > 9.2e18 {
            return None;
        }
        let about = about as i64;
        // The quotient is rounded, so the neighbouring numbers are tried as well.
        (about - 2..=about + 2).find(|ticks| self.seconds_of(*ticks) >= seconds)
    }

    /// Converts leaf (scalar part) number `k` of an input or constant of type `ty` from the external representation
    /// (times in seconds) to that of the interpreter (times in ticks). A time beyond 64 bits becomes absent.
    pub(crate) fn internal_leaf(&self, leaf: Leaf, ty: &Ty, k: usize) -> Leaf {
        match (leaf, is_time(ty, k)) {
            (Some(Value::Real(seconds)), true) => self.whole_ticks(seconds).map(Value::Int),
            (leaf, _) => leaf,
        }
    }

    /// Converts leaf (scalar part) number `k` of a value of type `ty` from the representation of the interpreter (times
    /// in ticks) to that of outputs (times in seconds).
    pub(crate) fn to_external(&self, leaf: Leaf, ty: &Ty, k: usize) -> Leaf {
        match (leaf, is_time(ty, k)) {
            (Some(Value::Int(ticks)), true) => Some(Value::Real(self.seconds_of(ticks))),
            (leaf, _) => leaf,
        }
    }

    /// Evaluates primitives that convert between ticks and seconds or provide the time of the core. Returns `None` for
    /// other primitives. `cycle` is the number of the current cycle, from 1. `chosen` is true if the value is needed,
    /// so that a conversion can fault.
    pub(crate) fn time_operator(
        &self,
        cycle: u64,
        name: &str,
        operands: &[Leaf],
        chosen: bool,
    ) -> Option<Result<Leaf, EvalError>> {
        let elapsed = (cycle - 1).cast_signed();
        Some(Ok(match (name, operands) {
            ("Rpi::Time", _) => Some(Value::Real(self.seconds_of(elapsed))),
            ("Rpi::Elapsed", _) => Some(Value::Int(elapsed)),
            ("Rpi::PeriodTicks", _) => Some(Value::Int(1)),
            ("Core::CycleTime", _) => Some(Value::Real(self.seconds)),
            ("Rpi::SecondsFromTicks", [Some(Value::Int(ticks))]) => {
                Some(Value::Real(self.seconds_of(*ticks)))
            }
            ("Rpi::WholeTicks", [Some(Value::Real(seconds))]) => {
                let never = if *seconds > 0.0 { i64::MAX } else { i64::MIN };
                let otherwise = if seconds.is_nan() { 0 } else { never };
                Some(Value::Int(self.whole_ticks(*seconds).unwrap_or(otherwise)))
            }
            ("Rpi::TicksFromSeconds", [Some(Value::Real(seconds))]) => {
                match self.whole_ticks(*seconds) {
                    None if chosen => return Some(Err(EvalError::Fault("conversion"))),
                    ticks => Some(Value::Int(ticks.unwrap_or(0))),
                }
            }
            ("Rpi::SecondsFromTicks" | "Rpi::WholeTicks" | "Rpi::TicksFromSeconds", _) => None,
            _ => return None,
        }))
    }
}

/// Returns whether leaf (scalar part) number `k` of a type is an exact time.
fn is_time(ty: &Ty, k: usize) -> bool {
    match ty {
        Ty::Duration => true,
        Ty::Array(..) | Ty::Struct(_) | Ty::Tuple(_) => {
            let mut leaves = Vec::new();
            ty.for_each_leaf(&mut |_, leaf| leaves.push(*leaf == Ty::Duration));
            leaves.get(k).copied().unwrap_or(false)
        }
        _ => false,
    }
}
