//! Changes between two velocities and accelerations, without a goal for the position.
//!
//! All values are divided by the maximum jerk.

/// Change of velocity: a ramp of the acceleration from `from` to `level`, a hold of `hold` seconds, and a ramp to `to`.
/// The accelerations are divided by the maximum jerk (s).
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct VelocityChange {
    from: f64,
    level: f64,
    to: f64,
    hold: f64,
}

/// Velocity and acceleration, divided by the maximum jerk (s², s).
pub(super) type Motion = (f64, f64);

impl VelocityChange {
    /// Plans the fastest change from `start` to `end` with the acceleration between `limits` (maximum, minimum).
    pub(super) fn new(start: Motion, end: Motion, limits: (f64, f64)) -> Self {
        let (from, to) = (start.1, end.1);
        let gained = end.0 - start.0;
        let directly = (from + to) / 2.0 * (to - from).abs();
        let squares = (from * from + to * to) / 2.0;
        let rises = gained >= directly;
        let (change, limit) = if rises {
            (gained, limits.0.max(from).max(to))
        } else {
            (-gained, -limits.1.min(from).min(to))
        };
        let square = (change + squares).max(0.0);
        let peak = libm::sqrt(square);
        let (peak, hold) = if peak > limit {
            (limit, square / limit - limit)
        } else {
            (peak, 0.0)
        };
        Self {
            from,
            level: if rises { peak } else { -peak },
            to,
            hold,
        }
    }

    /// Returns the shortest change whose gain of velocity differs from that of this change by at most `slack`, a
    /// rounding error. If both ramps are short, this rounding changes the duration by up to 1e-5 s.
    pub(super) fn shortened(self, slack: f64) -> Self {
        let sign = if self.level < 0.0 { -1.0 } else { 1.0 };
        let outer = (sign * self.from).max(sign * self.to);
        if self.hold > 0.0 || outer < 0.0 {
            return self;
        }
        let square = self.level * self.level - slack;
        let level = libm::sqrt(square.max(outer * outer)).min(sign * self.level);
        Self {
            level: sign * level,
            ..self
        }
    }

    /// Returns the change from `start` to `end` with a single ramp of the acceleration; `None` if the velocity at its
    /// end misses that of `end` by more than `tolerance`.
    pub(super) fn straight(start: Motion, end: Motion, tolerance: f64) -> Option<Self> {
        let (from, to) = (start.1, end.1);
        let gained = (from + to) / 2.0 * (to - from).abs();
        ((end.0 - start.0 - gained).abs() <= tolerance).then_some(Self {
            from,
            level: to,
            to,
            hold: 0.0,
        })
    }

    /// Plans the change from `start` to `end` that takes exactly `duration` (s) and holds one acceleration between
    /// `limits` (maximum, minimum). Returns `None` if there is none that meets the end within `tolerance`.
    pub(super) fn with_duration(
        start: Motion,
        end: Motion,
        limits: (f64, f64),
        duration: f64,
        tolerance: f64,
    ) -> Option<Self> {
        let (from, to) = (start.1, end.1);
        let gained = end.0 - start.0;
        let spare = duration - (to - from).abs();
        if spare < -1e-12 * duration {
            return None;
        }
        let spare = spare.max(0.0);
        let (high, low) = (from.max(to), from.min(to));
        let highest = limits.0.max(high).min(high + spare / 2.0);
        let lowest = limits.1.min(low).max(low - spare / 2.0);
        let squares = (from * from + to * to) / 2.0;
        // Velocity gained with the acceleration held at a level, for levels above, between and below both ends.
        let sum = duration + from + to;
        let difference = duration - from - to;
        let above = |level: f64| level * (sum - level) - squares;
        let below = |level: f64| level * (difference + level) + squares;
        if gained > above(highest) + tolerance || gained < below(lowest) - tolerance {
            return None;
        }
        let level = if gained >= above(high) {
            lower_root(sum, squares + gained)
        } else if gained <= below(low) {
            -lower_root(difference, squares - gained)
        } else {
            low + (gained - below(low)) / spare
        };
        let level = level.clamp(lowest, highest);
        Some(Self {
            from,
            level,
            to,
            hold: (duration - (level - from).abs() - (to - level).abs()).max(0.0),
        })
    }

    /// Returns the durations (s) at which changes of exactly this duration begin or cease to exist; NaN for unused
    /// entries.
    pub(super) fn durations(start: Motion, end: Motion, limits: (f64, f64)) -> [f64; 4] {
        let (from, to) = (start.1, end.1);
        let gained = end.0 - start.0;
        let squares = (from * from + to * to) / 2.0;
        let rising = |sign: f64, gained: f64, from: f64, to: f64, limit: f64| {
            let square = gained + squares;
            let peak = sign * libm::sqrt(square.max(0.0));
            let is_possible = square >= 0.0 && peak >= from.max(to);
            if !is_possible {
                f64::NAN
            } else if peak > limit {
                square / limit + limit - from - to
            } else {
                2.0 * peak - from - to
            }
        };
        let (high, low) = (limits.0.max(from).max(to), -limits.1.min(from).min(to));
        [
            rising(1.0, gained, from, to, high),
            rising(-1.0, gained, from, to, high),
            rising(1.0, -gained, -from, -to, low),
            rising(-1.0, -gained, -from, -to, low),
        ]
    }

    /// Returns the acceleration that is held between the two ramps, divided by the maximum jerk (s).
    pub(super) fn level(&self) -> f64 {
        self.level
    }

    /// Returns the duration of the whole change, s.
    pub(super) fn duration(&self) -> f64 {
        (self.level - self.from).abs() + self.hold + (self.to - self.level).abs()
    }

    /// Returns the three phases of the change in order: duration (s) and sign of the jerk (1, 0 or -1).
    pub(super) fn phases(&self) -> impl Iterator<Item = (f64, f64)> {
        let ramp = |from: f64, to: f64| ((to - from).abs(), if to < from { -1.0 } else { 1.0 });
        [
            ramp(self.from, self.level),
            (self.hold, 0.0),
            ramp(self.level, self.to),
        ]
        .into_iter()
    }

    /// Returns the distance (divided by the maximum jerk, s³) that the axis travels during the change if it begins with
    /// this velocity and acceleration.
    pub(super) fn travel(&self, velocity: f64, acceleration: f64) -> f64 {
        let (mut travel, mut v, mut a) = (0.0, velocity, acceleration);
        for (time, jerk) in self.phases() {
            travel += time * (v + time * (a / 2.0 + time * jerk / 6.0));
            v += time * (a + time * jerk / 2.0);
            a += time * jerk;
        }
        travel
    }
}

/// Returns the smaller root of `x (sum - x) = product`, without cancellation of digits.
fn lower_root(sum: f64, product: f64) -> f64 {
    let half = sum / 2.0;
    let distance = libm::sqrt((half * half - product).max(0.0));
    if half > 0.0 {
        product / (half + distance)
    } else {
        half - distance
    }
}
