//! Time-optimal motion of one axis to a target velocity, and its motions with a given duration.

use super::axis::{Planner, TOLERANCE, rounding};
use super::brake::{Return, return_into_limits};
use super::family::Ends;
use super::limits::AxisLimits;
use super::profile::AxisProfile;
use super::velocity::{Motion, VelocityChange};
use rpi_kin::state_to_rest::AxisState;

/// Planning problem of one axis that must reach a velocity, at whatever position. All quantities are divided by the
/// maximum jerk.
#[derive(Clone, Copy, Debug)]
pub(super) struct VelocityPlanner {
    start: AxisState,
    target: AxisState,
    jerk: f64,
    entry: Return,
    from: Motion,
    to: Motion,
    limits: (f64, f64),
    best: VelocityChange,
}

impl VelocityPlanner {
    /// Plans the time-optimal change from the velocity of `start` to that of `target`. The caller has checked that all
    /// numbers are valid. The limits of the velocity and the position of the target are not used.
    pub(super) fn new(start: AxisState, target: AxisState, limits: &AxisLimits) -> Self {
        let without_velocity_limits = AxisLimits {
            max_velocity: f64::INFINITY,
            min_velocity: f64::NEG_INFINITY,
            ..*limits
        };
        let ends = Ends::new(&start, &target, &without_velocity_limits);
        let entry = return_into_limits(&ends);
        let from = (entry.velocity, entry.acceleration);
        let to = (ends.end_velocity, ends.end_acceleration);
        let range = (ends.max_acceleration, ends.min_acceleration);
        let tolerance = TOLERANCE / limits.max_jerk;
        let speed = from.0.abs() + to.0.abs() + from.1 * from.1 + to.1 * to.1;
        let exact = VelocityChange::new(from, to, range).shortened(4.0 * f64::EPSILON * speed);
        let direct = VelocityChange::straight(from, to, tolerance)
            .filter(|direct| direct.duration() + 4.0 * libm::sqrt(tolerance) < exact.duration());
        let size = start.velocity.abs() + target.velocity.abs();
        let rounding = rounding(size) / limits.max_jerk;
        let direct = VelocityChange::straight(from, to, rounding).or(direct);
        Self {
            start,
            target,
            jerk: limits.max_jerk,
            entry,
            from,
            to,
            limits: range,
            best: direct.unwrap_or(exact),
        }
    }

    fn profile_of(&self, change: &VelocityChange, duration: f64) -> AxisProfile {
        let mut profile = AxisProfile::standing(self.start, self.target);
        for (time, sign) in self.entry.phases.into_iter().chain(change.phases()) {
            profile.push(time, self.jerk * sign);
        }
        profile.released(duration)
    }
}

impl Planner for VelocityPlanner {
    fn duration(&self) -> f64 {
        self.entry.duration() + self.best.duration()
    }

    fn profile(&self) -> AxisProfile {
        self.profile_of(&self.best, self.duration())
    }

    fn durations(&self, add: &mut dyn FnMut(f64)) {
        let entry = self.entry.duration();
        VelocityChange::durations(self.from, self.to, self.limits)
            .iter()
            .for_each(|time| add(entry + time));
    }

    fn profile_with_duration(&self, duration: f64) -> Option<AxisProfile> {
        let time = duration - self.entry.duration();
        let change = if (time - self.best.duration()).abs() <= 1e-12 * duration {
            self.best
        } else {
            let tolerance = TOLERANCE / self.jerk;
            VelocityChange::with_duration(self.from, self.to, self.limits, time, tolerance)?
        };
        Some(self.profile_of(&change, duration))
    }
}
