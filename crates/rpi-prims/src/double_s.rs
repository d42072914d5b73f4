//! Motion over a distance in the shortest time with bounded speed, acceleration and jerk (double-S profile).
//!
//! After Biagiotti and Melchiorri, Trajectory Planning for Automatic Machines and Robots (2008), section 3.4. The peak
//! speed is found by bisection instead of their case analysis: the distance of a profile grows with its peak speed, so
//! a fixed number of halvings finds it.

/// Bounds of a motion; all positive.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Bounds {
    /// Maximum speed, m/s (or rad/s).
    pub speed: f64,
    /// Maximum acceleration, m/s².
    pub acceleration: f64,
    /// Maximum jerk, m/s³.
    pub jerk: f64,
}

/// Planned motion over a distance with given speeds at both ends.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct DoubleSProfile {
    /// Distance, m.
    pub distance: f64,
    /// Speed at the start, m/s.
    pub start_speed: f64,
    /// Speed at the end, m/s.
    pub end_speed: f64,
    /// Peak speed, m/s. Negative if the distance is too short for the bounds; the motion is then a quartic polynomial.
    pub peak_speed: f64,
    /// Bounds of speed, acceleration and jerk.
    pub bounds: Bounds,
}

/// State of a motion at a point in time.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct MotionState {
    /// Distance covered since the start, m.
    pub position: f64,
    /// Speed, m/s.
    pub speed: f64,
    /// Acceleration, m/s².
    pub acceleration: f64,
}

/// Fraction of a period by which a duration may exceed a whole number of periods, to allow for rounding.
const ROUNDING: f64 = 1e-6;

/// Number of bisection steps that determine the peak speed to the last bit of a double.
const HALVINGS: u32 = 64;

impl DoubleSProfile {
    /// Plans the fastest motion. End speeds are limited to the bounds. A negative distance counts as 0.
    #[must_use]
    pub fn plan(distance: f64, entry: f64, leave: f64, bounds: Bounds) -> DoubleSProfile {
        let cut = |v: f64| libm::fmin(libm::fmax(v, 0.0), bounds.speed);
        let mut travel = DoubleSProfile {
            distance: libm::fmax(distance, 0.0),
            start_speed: cut(entry),
            end_speed: cut(leave),
            peak_speed: bounds.speed,
            bounds,
        };
        if travel.ramp_distance(bounds.speed) > travel.distance {
            travel.peak_speed = travel.highest_peak();
        }
        travel
    }

    /// Plans a motion that takes a whole number of periods: the fastest motion, with its peak speed lowered to fit.
    /// Also returns the number of periods.
    #[must_use]
    pub fn plan_periods(
        distance: f64,
        entry: f64,
        leave: f64,
        bounds: Bounds,
        dt: f64,
    ) -> (DoubleSProfile, f64) {
        let mut travel = DoubleSProfile::plan(distance, entry, leave, bounds);
        if travel.distance.is_nan() || travel.distance <= 0.0 {
            return (travel, 0.0);
        }
        let periods = libm::ceil(travel.duration() / dt - ROUNDING);
        if travel.peak_speed > 0.0 {
            travel.peak_speed = travel.slower_peak(periods * dt);
        }
        (travel, periods)
    }

    /// Returns the largest peak speed with which the motion takes at least `duration` seconds.
    fn slower_peak(&self, duration: f64) -> f64 {
        // Bisection instead of a closed form: the formula of the duration depends on which parts of the ramps exist.
        let (mut low, mut high) = (0.5 * self.peak_speed, self.peak_speed);
        for _ in 0..HALVINGS {
            let peak = 0.5 * (low + high);
            let middle = DoubleSProfile {
                peak_speed: peak,
                ..*self
            };
            if middle.ramp_distance(peak) <= self.distance && middle.duration() < duration {
                high = peak;
            } else {
                low = peak;
            }
        }
        high
    }

    /// Returns the largest peak speed whose ramps fit into the distance; negative if none fits.
    fn highest_peak(&self) -> f64 {
        let mut low = libm::fmax(self.start_speed, self.end_speed);
        if self.ramp_distance(low) > self.distance {
            // A negative peak selects the polynomial, because no ramp between the two speeds is short enough.
            return -1.0;
        }
        let mut high = self.bounds.speed;
        for _ in 0..HALVINGS {
            let middle = 0.5 * (low + high);
            if self.ramp_distance(middle) > self.distance {
                high = middle;
            } else {
                low = middle;
            }
        }
        low
    }

    /// Returns the distance of both ramps for a peak speed.
    fn ramp_distance(&self, peak: f64) -> f64 {
        self.bounds.ramp(self.start_speed, peak).length()
            + self.bounds.ramp(peak, self.end_speed).length()
    }

    /// Returns the duration in s.
    #[must_use]
    pub fn duration(&self) -> f64 {
        if self.peak_speed < 0.0 {
            return 2.0 * self.distance / (self.start_speed + self.end_speed);
        }
        let (up, down) = (
            self.bounds.ramp(self.start_speed, self.peak_speed),
            self.bounds.ramp(self.peak_speed, self.end_speed),
        );
        up.duration() + self.cruise_time(&up, &down) + down.duration()
    }

    fn cruise_time(&self, up: &Ramp, down: &Ramp) -> f64 {
        let rest = self.distance - up.length() - down.length();
        if rest > 0.0 && self.peak_speed > 0.0 {
            rest / self.peak_speed
        } else {
            0.0
        }
    }

    /// Returns the state `t` seconds after the start. Before the start and after the end, the speed is constant.
    #[must_use]
    pub fn state_at(&self, t: f64) -> MotionState {
        if self.peak_speed < 0.0 {
            return self.polynomial(t);
        }
        let (up, down) = (
            self.bounds.ramp(self.start_speed, self.peak_speed),
            self.bounds.ramp(self.peak_speed, self.end_speed),
        );
        let brakes = up.duration() + self.cruise_time(&up, &down);
        if t < up.duration() {
            return up.state_at(t);
        }
        if t < brakes {
            let position = up.length() + self.peak_speed * (t - up.duration());
            return MotionState {
                position,
                speed: self.peak_speed,
                acceleration: 0.0,
            };
        }
        let state = down.state_at(t - brakes);
        MotionState {
            position: self.distance - down.length() + state.position,
            ..state
        }
    }

    /// Returns the state on a quartic polynomial with zero acceleration at both ends, for distances too short for the
    /// bounds.
    fn polynomial(&self, t: f64) -> MotionState {
        let duration = self.duration();
        if t >= duration {
            let position = self.distance + self.end_speed * (t - duration);
            return MotionState {
                position,
                speed: self.end_speed,
                acceleration: 0.0,
            };
        }
        let (u, rise) = (t / duration, self.end_speed - self.start_speed);
        // The speed is entry + rise · (3u² - 2u³): its integral over the duration is the distance.
        MotionState {
            position: duration * (self.start_speed * u + rise * (u * u * u - 0.5 * u * u * u * u)),
            speed: self.start_speed + rise * u * u * (3.0 - 2.0 * u),
            acceleration: rise * 6.0 * u * (1.0 - u) / duration,
        }
    }
}

impl Bounds {
    /// Returns whether all bounds are positive.
    #[must_use]
    pub fn are_positive(&self) -> bool {
        self.speed > 0.0 && self.acceleration > 0.0 && self.jerk > 0.0
    }

    /// Returns the fastest change between two speeds with zero acceleration at both ends.
    fn ramp(&self, from: f64, to: f64) -> Ramp {
        let change = libm::fabs(to - from);
        let jerk_time = libm::fmin(
            libm::sqrt(change / self.jerk),
            self.acceleration / self.jerk,
        );
        let hold_time = if jerk_time > 0.0 {
            libm::fmax(change / (self.jerk * jerk_time) - jerk_time, 0.0)
        } else {
            0.0
        };
        let jerk = libm::copysign(self.jerk, to - from);
        Ramp {
            from,
            to,
            jerk,
            jerk_time,
            hold_time,
        }
    }
}

/// Change of speed: jerk phase, constant acceleration, opposite jerk phase.
struct Ramp {
    from: f64,
    to: f64,
    jerk: f64,
    jerk_time: f64,
    hold_time: f64,
}

impl Ramp {
    fn duration(&self) -> f64 {
        2.0 * self.jerk_time + self.hold_time
    }

    /// Returns the distance covered. The ramp is point symmetric, so its mean speed is the mean of both end speeds.
    fn length(&self) -> f64 {
        0.5 * (self.from + self.to) * self.duration()
    }

    fn state_at(&self, t: f64) -> MotionState {
        if t <= 0.0 {
            return MotionState {
                position: self.from * t,
                speed: self.from,
                acceleration: 0.0,
            };
        }
        if 2.0 * t <= self.duration() {
            return self.first_half(t);
        }
        let left = self.duration() - t;
        if left <= 0.0 {
            return MotionState {
                position: self.length() - self.to * left,
                speed: self.to,
                acceleration: 0.0,
            };
        }
        let mirror = Ramp {
            from: 0.0,
            to: 0.0,
            ..*self
        }
        .first_half(left);
        MotionState {
            position: self.length() - (self.to * left - mirror.position),
            speed: self.to - mirror.speed,
            acceleration: mirror.acceleration,
        }
    }

    fn first_half(&self, t: f64) -> MotionState {
        let (rising, held) = (
            libm::fmin(t, self.jerk_time),
            libm::fmax(t - self.jerk_time, 0.0),
        );
        let acceleration = self.jerk * rising;
        let speed = self.from + 0.5 * acceleration * rising;
        MotionState {
            position: self.from * rising
                + acceleration * rising * rising / 6.0
                + (speed + 0.5 * acceleration * held) * held,
            speed: speed + acceleration * held,
            acceleration,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{Bounds, DoubleSProfile};

    const BOUNDS: Bounds = Bounds {
        speed: 0.25,
        acceleration: 1.0,
        jerk: 10.0,
    };

    /// Returns motions with distances and end speeds over five orders of magnitude.
    fn cases() -> impl Iterator<Item = DoubleSProfile> {
        let distances = [0.0, 1e-6, 1e-3, 0.01, 0.05, 0.2, 1.0, 5.0];
        let speeds = [0.0, 0.01, 0.1, 0.25, 0.4];
        distances.into_iter().flat_map(move |d| {
            speeds.into_iter().flat_map(move |v| {
                speeds
                    .into_iter()
                    .map(move |w| DoubleSProfile::plan(d, v, w, BOUNDS))
            })
        })
    }

    #[test]
    fn ends_at_its_distance_with_its_speed() {
        for travel in cases().filter(|t| t.distance > 0.0) {
            let end = travel.state_at(travel.duration());
            assert!(
                (end.position - travel.distance).abs() < 1e-9,
                "{travel:?} {end:?}"
            );
            assert!(
                (end.speed - travel.end_speed).abs() < 1e-9,
                "{travel:?} {end:?}"
            );
        }
    }

    #[test]
    fn holds_its_bounds_where_they_can_be_held() {
        for travel in cases().filter(|t| t.distance > 0.0 && t.peak_speed >= 0.0) {
            let step = travel.duration() / 1000.0;
            for k in 0..=1000 {
                let now = travel.state_at(step * f64::from(k));
                assert!(
                    now.speed <= BOUNDS.speed + 1e-9 && now.speed >= -1e-9,
                    "{travel:?} {now:?}"
                );
                assert!(
                    now.acceleration.abs() <= BOUNDS.acceleration + 1e-9,
                    "{travel:?} {now:?}"
                );
            }
        }
    }

    #[test]
    fn speed_is_the_slope_of_the_way_and_jerk_is_bounded() {
        for travel in cases().filter(|t| t.distance > 0.0) {
            let h = travel.duration() * 1e-4;
            for k in 1..10_000 {
                let [a, b, c] = [k - 1, k, k + 1].map(|k| travel.state_at(h * f64::from(k)));
                let slope = (c.position - a.position) / (2.0 * h);
                let rounding = BOUNDS.jerk * h * h + 1e-12 / h;
                let curved = if travel.peak_speed < 0.0 {
                    1e-3 * b.acceleration.abs()
                } else {
                    0.0
                };
                assert!(
                    (slope - b.speed).abs() < 1e-9 + rounding + curved,
                    "{travel:?} at {k}"
                );
                let jerk = (c.acceleration - a.acceleration) / (2.0 * h);
                assert!(
                    travel.peak_speed < 0.0 || jerk.abs() <= BOUNDS.jerk * (1.0 + 1e-6),
                    "{travel:?} at {k}: {jerk}"
                );
            }
        }
    }

    #[test]
    fn whole_periods_are_hit() {
        let dt = 1e-3;
        for fast in cases().filter(|t| t.distance > 0.0 && t.peak_speed > 0.0) {
            let (slow, periods) = DoubleSProfile::plan_periods(
                fast.distance,
                fast.start_speed,
                fast.end_speed,
                BOUNDS,
                dt,
            );
            let left = periods * dt - slow.duration();
            assert!((-1e-8..dt).contains(&left), "{slow:?} {periods}");
            // Where the ends leave no other choice of speed, the motion is stretched when it runs. The stretch is small
            // except for tiny distances.
            let share = left / (periods * dt);
            assert!(share < 3e-3 || slow.distance < 0.05, "{slow:?} {periods}");
            assert!(slow.duration() - fast.duration() < dt, "{slow:?} {fast:?}");
        }
    }

    #[test]
    fn rest_to_rest_takes_the_time_of_the_textbook() {
        // The expected duration is D/v + v/a + a/j for 1 m with 0.25 m/s, 1 m/s² and 10 m/s³.
        let travel = DoubleSProfile::plan(1.0, 0.0, 0.0, BOUNDS);
        assert!((travel.duration() - (4.0 + 0.25 + 0.1)).abs() < 1e-9);
    }
}
