//! Residual of a takeover: what the arm brought along and the path does not have, decaying axis by axis.

use crate::Joints;
use rpi_kin::MAX_AXES;
use rpi_kin::state_to_rest::{AxisState, Bounds, StateToRestProfile};

/// Ranges of velocity, acceleration and jerk in an interval of time: lowest and highest value of each.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Extent {
    /// Lowest and highest velocity, rad/s.
    pub velocity: (f64, f64),
    /// Lowest and highest acceleration, rad/s².
    pub acceleration: (f64, f64),
    /// Lowest and highest jerk, rad/s³.
    pub jerk: (f64, f64),
}

/// Residual of one axis: a profile to rest at 0 whose phases have been laid out by time.
#[derive(Clone, Copy, Debug, Default)]
struct AxisResidual {
    profile: StateToRestProfile,
    /// Start time of each phase, and the end of the last one; s.
    breaks: [f64; 8],
    /// State at the start of each phase.
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

    /// Extrema between two times: velocity and acceleration are monotonic between the ends of the interval, the
    /// phases' ends, and (velocity) the zeros of the acceleration.
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

    /// Lowest and highest position from now to the end.
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

    /// Largest magnitudes of velocity and acceleration.
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

/// Times at which the velocity is zero, relative to `state`; NaN where there is none.
fn turning_points(state: AxisState, jerk: f64) -> [f64; 2] {
    let (v, a) = (state.velocity, state.acceleration);
    if jerk == 0.0 {
        return [-v / a, f64::NAN];
    }
    let root = libm::sqrt(a * a - 2.0 * jerk * v);
    [(-a - root) / jerk, (-a + root) / jerk]
}

/// Returns whether a difference between arm and path is only rounding of the inverse kinematics, too small to matter
/// for any limit.
fn is_rounding(difference: &AxisState) -> bool {
    difference.position.abs() < 1e-13
        && difference.velocity.abs() < 1e-12
        && difference.acceleration.abs() < 1e-9
}

fn ordered(a: f64, b: f64) -> (f64, f64) {
    if a < b { (a, b) } else { (b, a) }
}

/// Residual of all axes: the difference between the arm and the path after a takeover, which decays to 0.
#[derive(Clone, Copy, Debug, Default)]
pub struct Residual {
    axes: [AxisResidual; MAX_AXES],
    count: usize,
    start_time: f64,
    end: f64,
}

impl Residual {
    /// Plans the decay of the given differences (arm minus path) from `start_time` (s) on, one axis after the other,
    /// within `bounds`. `None` if a number is not finite or a bound not positive.
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

    /// Returns the time of the motion at which all axes have lost their residual, s.
    #[must_use]
    pub fn end(&self) -> f64 {
        self.end
    }

    /// Returns the state of one axis at a time of the motion.
    #[must_use]
    pub fn state_at(&self, axis: usize, time: f64) -> AxisState {
        self.axes[axis].profile.state_at(time - self.start_time)
    }

    /// Adds the positions of the residual to those of the path.
    pub fn add_to(&self, joints: &mut Joints, time: f64) {
        if time < self.end {
            for (axis, joint) in joints.iter_mut().enumerate().take(self.count) {
                *joint += self.state_at(axis, time).position;
            }
        }
    }

    /// Returns the extrema of one axis between two times of the motion.
    #[must_use]
    pub fn extent(&self, axis: usize, from: f64, to: f64) -> Extent {
        self.axes[axis].extent(from - self.start_time, to - self.start_time)
    }

    /// Returns the lowest and the highest position of one axis, at any time; rad.
    #[must_use]
    pub fn span(&self, axis: usize) -> (f64, f64) {
        self.axes[axis].span()
    }

    /// Returns the largest magnitudes of velocity and acceleration of one axis.
    #[must_use]
    pub fn peaks(&self, axis: usize) -> (f64, f64) {
        self.axes[axis].peaks()
    }
}
