//! Residual of a takeover: what the arm brought along and the path does not have, decaying axis by axis.

use crate::stop_margin::exact_stopping_distances;
use crate::{Arm, Joints};
use rpi_kin::state_to_rest::{AxisState, Bounds, StateToRestProfile};
use rpi_kin::{AxisLimits, MAX_AXES, Range};

/// Lowest and highest velocity, acceleration and jerk of an axis in an interval of time.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Extent {
    /// Lowest and highest velocity, rad/s.
    pub velocity: (f64, f64),
    /// Lowest and highest acceleration, rad/s².
    pub acceleration: (f64, f64),
    /// Lowest and highest jerk, rad/s³.
    pub jerk: (f64, f64),
}

/// Residual of one axis: the planned decay to 0 of its difference from the path after a takeover.
#[derive(Clone, Copy, Debug, Default)]
struct AxisResidual {
    profile: StateToRestProfile,
    /// Start time of each phase, and end time of the last one, in s since the start of the decay.
    breaks: [f64; 8],
    /// Position, velocity and acceleration at the start of each phase.
    states: [AxisState; 7],
    jerks: [f64; 7],
}

impl AxisResidual {
    fn new(profile: StateToRestProfile) -> Self {
        let mut laid = Self {
            profile,
            ..Self::default()
        };
        let mut state = profile.start();
        for (k, phase) in profile.phases().iter().enumerate() {
            laid.states[k] = state;
            laid.jerks[k] = phase.jerk;
            laid.breaks[k + 1] = laid.breaks[k] + phase.duration;
            state = state.advanced(phase.duration, phase.jerk);
        }
        laid
    }

    fn end(&self) -> f64 {
        self.breaks[7]
    }

    /// Returns the lowest and highest velocity, acceleration and jerk between two times (s, since the start of the
    /// decay). They occur at the ends of the interval or of a phase, or (velocity) where the acceleration is zero.
    fn extent(&self, from: f64, to: f64) -> Extent {
        let mut extent = Extent::default();
        if from >= self.end() {
            return extent;
        }
        let mut first = true;
        for k in 0..7 {
            let (start, end) = (self.breaks[k].max(from), self.breaks[k + 1].min(to));
            if end <= start {
                continue;
            }
            let (state, jerk, zero) = (self.states[k], self.jerks[k], self.breaks[k]);
            let one = state.advanced(start - zero, jerk);
            let other = state.advanced(end - zero, jerk);
            let mut velocity = ordered(one.velocity, other.velocity);
            if one.acceleration * other.acceleration < 0.0 {
                let peak = state.advanced(-state.acceleration / jerk, jerk).velocity;
                velocity = (velocity.0.min(peak), velocity.1.max(peak));
            }
            let here = Extent {
                velocity,
                acceleration: ordered(one.acceleration, other.acceleration),
                jerk: (jerk, jerk),
            };
            extent = if first { here } else { extent.union(&here) };
            first = false;
        }
        if to > self.end() && !first {
            extent = extent.union(&Extent::default());
        }
        extent
    }

    /// Returns the lowest and highest position (rad) during the whole decay.
    fn span(&self) -> (f64, f64) {
        let mut span = (0.0f64, 0.0f64);
        for k in 0..7 {
            let (state, jerk) = (self.states[k], self.jerks[k]);
            let duration = self.breaks[k + 1] - self.breaks[k];
            let mut take = |time: f64| {
                if time >= 0.0 && time <= duration {
                    let x = state.advanced(time, jerk).position;
                    span = (span.0.min(x), span.1.max(x));
                }
            };
            take(0.0);
            take(duration);
            for root in turning_points(state, jerk) {
                take(root);
            }
        }
        span
    }

    /// Returns true if the axis could stop at any time of the decay from `from` on (s, since its start) within `range`
    /// (rad), if the path stands at the position `path` (rad).
    ///
    /// The range of the positions is not enough: an axis that turns back passes the velocity 0 with an acceleration, and
    /// a stop, which has to lose this acceleration too, leads farther.
    fn can_stop(&self, from: f64, path: f64, range: &Range, limits: &AxisLimits) -> bool {
        (0..7).all(|k| {
            let (state, jerk) = (self.states[k], self.jerks[k]);
            let begin = (from - self.breaks[k]).max(0.0);
            let end = self.breaks[k + 1] - self.breaks[k];
            let within = |time: f64| {
                let at = state.advanced(time, jerk);
                let (below, above) = exact_stopping_distances(at.velocity, at.acceleration, limits);
                let position = path + at.position;
                position - below >= range.lower && position + above <= range.upper
            };
            // In between, the place of the stop moves outwards until the brake is to be released, and inwards from there.
            let mut farthest = releases(state, jerk, limits.jerk).into_iter();
            begin >= end
                || within(begin)
                    && within(end)
                    && farthest.all(|time| !(begin < time && time < end) || within(time))
        })
    }

    /// Returns the largest magnitudes of velocity and acceleration during the decay.
    fn peaks(&self) -> (f64, f64) {
        let all = self.extent(0.0, self.end());
        (
            all.velocity.0.abs().max(all.velocity.1.abs()),
            all.acceleration.0.abs().max(all.acceleration.1.abs()),
        )
    }
}

impl Extent {
    fn union(&self, other: &Self) -> Self {
        let join = |a: (f64, f64), b: (f64, f64)| (a.0.min(b.0), a.1.max(b.1));
        Self {
            velocity: join(self.velocity, other.velocity),
            acceleration: join(self.acceleration, other.acceleration),
            jerk: join(self.jerk, other.jerk),
        }
    }
}

/// Returns the times (s, relative to `state`) at which the velocity is zero under the constant `jerk`; NaN or infinite
/// if there is none.
fn turning_points(state: AxisState, jerk: f64) -> [f64; 2] {
    let (v, a) = (state.velocity, state.acceleration);
    if jerk == 0.0 {
        return [-v / a, f64::NAN];
    }
    let root = libm::sqrt(a * a - 2.0 * jerk * v);
    [(-a - root) / jerk, (-a + root) / jerk]
}

/// Returns the times (s, relative to `state`) under the constant `jerk` at which a stop would have to release its brake
/// with the jerk `most`, because the acceleration loses just the velocity while it decays: a² = 2 `most` |v|. NaN or
/// infinite if there is none.
fn releases(state: AxisState, jerk: f64, most: f64) -> [f64; 4] {
    let (v, a) = (state.velocity, state.acceleration);
    let roots = |most: f64| {
        // jerk (jerk - most) t² + 2 a (jerk - most) t + a² - 2 most v = 0
        let root = libm::sqrt(a * a - jerk * (a * a - 2.0 * most * v) / (jerk - most));
        match jerk == 0.0 {
            true => [(a * a - 2.0 * most * v) / (2.0 * a * most), f64::NAN],
            false => [(-a - root) / jerk, (-a + root) / jerk],
        }
    };
    let ([a, b], [c, d]) = (roots(most), roots(-most));
    [a, b, c, d]
}

/// Returns true if a difference between arm and path is only a rounding error of the inverse kinematics, too small to
/// matter for any limit.
fn is_rounding(difference: &AxisState) -> bool {
    difference.position.abs() < 1e-13
        && difference.velocity.abs() < 1e-12
        && difference.acceleration.abs() < 1e-9
}

fn ordered(a: f64, b: f64) -> (f64, f64) {
    if a < b { (a, b) } else { (b, a) }
}

/// Residual of all axes: the difference between the arm and the path after a takeover, which decays to 0. It is added
/// to the joint positions of the path.
#[derive(Clone, Copy, Debug, Default)]
pub struct Residual {
    axes: [AxisResidual; MAX_AXES],
    count: usize,
    start_time: f64,
    end: f64,
}

impl Residual {
    /// Plans the decay of the differences (arm minus path) of the `count` first axes from the time `start_time` of the
    /// motion (s) on, each axis within its own `bounds`. `None` if a number is not finite or a bound not positive.
    #[must_use]
    pub fn new(
        count: usize,
        start_time: f64,
        difference: impl Fn(usize) -> AxisState,
        bounds: impl Fn(usize) -> Bounds,
    ) -> Option<Self> {
        let mut residual = Self {
            count,
            start_time,
            end: start_time,
            ..Self::default()
        };
        for axis in 0..count {
            let start = difference(axis);
            if is_rounding(&start) {
                continue;
            }
            let planned = AxisResidual::new(StateToRestProfile::new(start, 0.0, bounds(axis))?);
            residual.end = residual.end.max(start_time + planned.end());
            residual.axes[axis] = planned;
        }
        Some(residual)
    }

    /// Returns the time of the motion (s) from which the differences of all axes are 0.
    #[must_use]
    pub fn end(&self) -> f64 {
        self.end
    }

    /// Returns position, velocity and acceleration of the residual of one axis (counted from 0) at a time of the motion
    /// (s).
    #[must_use]
    pub fn state_at(&self, axis: usize, time: f64) -> AxisState {
        self.axes[axis].profile.state_at(time - self.start_time)
    }

    /// Adds the positions of the residual at a time of the motion (s) to `joints`, the joint positions of the path.
    pub fn add_to(&self, joints: &mut Joints, time: f64) {
        if time < self.end {
            for (axis, joint) in joints.iter_mut().enumerate().take(self.count) {
                *joint += self.state_at(axis, time).position;
            }
        }
    }

    /// Returns the lowest and highest velocity, acceleration and jerk of the residual of one axis (counted from 0)
    /// between two times of the motion (s).
    #[must_use]
    pub fn extent(&self, axis: usize, from: f64, to: f64) -> Extent {
        self.axes[axis].extent(from - self.start_time, to - self.start_time)
    }

    /// Returns true if each axis of `arm` keeps its range (rad) from the time `from` of the motion (s) on, and could stop
    /// within it at any time, while the path stands at the joint positions `path` (rad).
    #[must_use]
    pub fn can_stop(
        &self,
        arm: &Arm,
        from: f64,
        path: &Joints,
        ranges: &[Range; MAX_AXES],
    ) -> bool {
        let from = from - self.start_time;
        let limits = arm.limits().iter().enumerate();
        limits.into_iter().all(|(axis, limits)| {
            let (residual, range) = (&self.axes[axis], &ranges[axis]);
            let (low, high) = residual.span();
            path[axis] + low >= range.lower
                && path[axis] + high <= range.upper
                && residual.can_stop(from, path[axis], range, limits)
        })
    }

    /// Returns the largest magnitudes of velocity (rad/s) and acceleration (rad/s²) of the residual of one axis
    /// (counted from 0).
    #[must_use]
    pub fn peaks(&self, axis: usize) -> (f64, f64) {
        self.axes[axis].peaks()
    }
}
