//! Verification of a brake: path, time law and residual together, against every axis.
//!
//! Each phase of constant jerk is cut into equal steps. At both ends of a step the derivatives of each axis are
//!
//! - velocity q' v + r',
//! - acceleration q' a + q'' v² + r'',
//! - jerk q' j + 3 q'' v a + q''' v³ + r''',
//!
//! with v, a, j of the path parameter; the residual r is taken with its exact extrema over the step, since its phases
//! can be shorter. Bending of the path between samples is covered by [`USED_SHARE`] and the jerk share of the table.

use crate::curve_bound::CurveBound;
use crate::node::{Node, USED_SHARE, tool_shares};
use crate::node_table::NodeTable;
use crate::ranges::Ranges;
use crate::residual::Residual;
use crate::stop_margin::stopping_distances;
use crate::time_law::{HeldBrake, PathState};
use crate::{Arm, Joints};
use rpi_kin::stop_profile::JerkPhase;
use rpi_kin::{AxisLimits, MAX_AXES};

/// Longest time between two samples of a verification, s.
const LONGEST_STEP: f64 = 5e-3;

/// Number of samples at which a time law is verified on the coarsest spacing of nodes, in addition to two for each
/// phase.
const COARSE_SAMPLES: f64 = 56.0;

/// Share of the requested bounds of the tool that is reserved for changes of the curvature between two samples.
const BETWEEN_SAMPLES: f64 = 1.5e-3;

/// Distance by which a time law may end beyond the known part of the path due to rounding, m (rad on a joint line).
const END_TOLERANCE: f64 = 1e-12;

/// Verifier of time laws: checks that a motion along the path keeps the limits of the arm and the bounds of the tool.
#[derive(Clone, Copy, Debug)]
pub struct Verifier<'a> {
    /// Arm whose kinematics and limits apply.
    pub arm: &'a Arm,
    /// Path of the motion, with the joint positions and their derivatives at its nodes.
    pub table: &'a NodeTable,
    /// Residual of the takeover (decaying difference between arm and path), which is added to the path.
    pub residual: &'a Residual,
    /// Ranges that the axes keep: those of [`allowed_ranges`](crate::ranges::allowed_ranges), and the ends of the path.
    pub ranges: &'a Ranges,
}

/// Progress of a verification: state and time of the motion, and the samples left.
struct Walk {
    state: PathState,
    time: f64,
    /// Number of a node near to the present position along the path, as for [`NodeTable::around`].
    cursor: usize,
    /// Number of samples that may still be taken.
    left: usize,
}

/// Position, velocity, acceleration and jerk of one axis due to the motion along the path, without the residual.
#[derive(Clone, Copy, Debug, Default)]
struct Terms {
    position: f64,
    velocity: f64,
    acceleration: f64,
    /// Smallest and largest jerk: they differ where the third derivative of the path jumps.
    jerk: [f64; 2],
}

impl Verifier<'_> {
    /// Returns true if the whole time law keeps the limits of all axes and the requested bounds of the tool, and ends
    /// on the known part of the path. `samples` is the number of samples that may still be taken in this cycle; it is
    /// reduced. If there are not enough, the result is false.
    #[must_use]
    pub fn accepts(&self, brake: &HeldBrake, samples: &mut usize) -> bool {
        let end = brake.end();
        if end > self.table.known_end() + END_TOLERANCE || end.is_nan() {
            return false;
        }
        let total: f64 = brake.phases().map(|phase| phase.duration).sum();
        let mut walk = Walk {
            state: brake.start,
            time: brake.start_time,
            cursor: 0,
            left: *samples,
        };
        let step = LONGEST_STEP.max(total / COARSE_SAMPLES);
        let mut phases = brake.phases().filter(|phase| phase.duration > 0.0);
        let within = phases.all(|phase| self.phase_is_within(&mut walk, &phase, step));
        *samples = walk.left;
        within && self.rest_is_within(&mut walk)
    }

    /// Returns true if the motion keeps all limits during a phase of constant jerk, which is checked in equal steps of
    /// at most `step` seconds. Steps are divided further where nodes are closer, so that no sample misses a bend of the
    /// path.
    fn phase_is_within(&self, walk: &mut Walk, phase: &JerkPhase, step: f64) -> bool {
        let steps = libm::ceil(phase.duration / step).max(1.0);
        let width = phase.duration / steps;
        let mut before = self.terms(&walk.state, phase.jerk, &mut walk.cursor);
        if !self.tool_is_within(&walk.state, phase.jerk, &mut walk.cursor)
            || goes_backwards(&walk.state, phase)
            || self.is_too_fast(&walk.state, phase)
        {
            return false;
        }
        for _ in 0..steps as u32 {
            let mut rest = width;
            while rest > 0.0 {
                let Some(left) = walk.left.checked_sub(1) else {
                    return false;
                };
                walk.left = left;
                let width = self.sample_time(walk, phase.jerk, rest);
                rest = if width < rest { rest - width } else { 0.0 };
                let from = walk.time;
                walk.state = walk.state.advanced(width, phase.jerk);
                walk.time += width;
                let after = self.terms(&walk.state, phase.jerk, &mut walk.cursor);
                if !self.tool_is_within(&walk.state, phase.jerk, &mut walk.cursor)
                    || !self.step_is_within(&before, &after, from, walk.time)
                {
                    return false;
                }
                before = after;
            }
        }
        true
    }

    /// Returns the time until the next sample of a phase (s), at most `longest`.
    fn sample_time(&self, walk: &mut Walk, jerk: f64, longest: f64) -> f64 {
        /// Minimum time between two samples, as a share of the maximum time.
        const SHORTEST: f64 = 1e-3;
        let (now, then) = (walk.state, walk.state.advanced(longest, jerk));
        let place = self.table.next_sample(now.s, then.s, &mut walk.cursor);
        if place >= then.s {
            return longest;
        }
        let time = (place - now.s) / now.velocity.max(then.velocity);
        time.clamp(SHORTEST * longest, longest)
    }

    fn terms(&self, state: &PathState, jerk: f64, cursor: &mut usize) -> [Terms; MAX_AXES] {
        let (one, other, share) = self.table.around(state.s, cursor);
        let PathState {
            velocity: v,
            acceleration: a,
            ..
        } = *state;
        let mut terms = [Terms::default(); MAX_AXES];
        for (axis, slot) in terms.iter_mut().enumerate().take(self.arm.axes()) {
            let mix = |of: fn(&Node) -> &Joints| {
                let (low, high) = (of(one)[axis], of(other)[axis]);
                low + share * (high - low)
            };
            let (first, second) = (mix(|n| &n.first), mix(|n| &n.second));
            let third = [mix(|n| &n.third[0]), mix(|n| &n.third[1])];
            *slot = Terms {
                position: mix(|n| &n.joints),
                velocity: first * v,
                acceleration: first * a + second * v * v,
                jerk: third.map(|third| first * jerk + 3.0 * second * v * a + third * v * v * v),
            };
        }
        terms
    }

    /// Returns true if the velocity along the path exceeds the requested one during a phase that begins with `start`.
    fn is_too_fast(&self, start: &PathState, phase: &JerkPhase) -> bool {
        let most = self.table.requested().speed.max(start.velocity) * (1.0 + 1e-9);
        let turning = -start.acceleration / phase.jerk;
        let inside = turning > 0.0 && turning < phase.duration;
        let at = |time: f64| start.advanced(time, phase.jerk).velocity;
        inside && at(turning) > most || at(phase.duration) > most
    }

    /// Returns true if acceleration and jerk of the tool are within the requested bounds.
    fn tool_is_within(&self, state: &PathState, jerk: f64, cursor: &mut usize) -> bool {
        let (one, other, share) = self.table.around(state.s, cursor);
        let curve = CurveBound::between(one, other, share);
        if curve.is_straight() {
            return true;
        }
        let requested = self.table.requested();
        let (acceleration, tool_jerk) = curve.tool_motion(state, jerk);
        let (steady, steady_jerk) = tool_shares(requested, curve.largest(), state.velocity);
        let most = 1.0 - BETWEEN_SAMPLES * (steady + steady_jerk).min(1.0);
        acceleration <= most * requested.acceleration && tool_jerk <= most * requested.jerk
    }

    fn step_is_within(
        &self,
        before: &[Terms; MAX_AXES],
        after: &[Terms; MAX_AXES],
        from: f64,
        to: f64,
    ) -> bool {
        let limits = self.arm.limits().iter().enumerate();
        limits.into_iter().all(|(axis, limits)| {
            let (one, other) = (&before[axis], &after[axis]);
            let rest = self.residual.extent(axis, from, to);
            let within = |a: f64, b: f64, rest: (f64, f64), limit: f64| {
                a.min(b) + rest.0 >= -limit && a.max(b) + rest.1 <= limit
            };
            within(
                one.velocity,
                other.velocity,
                rest.velocity,
                USED_SHARE * limits.velocity,
            ) && within(
                one.acceleration,
                other.acceleration,
                rest.acceleration,
                USED_SHARE * limits.acceleration,
            ) && within(
                one.jerk[0].min(other.jerk[0]),
                one.jerk[1].max(other.jerk[1]),
                rest.jerk,
                self.table.jerk_share() * (1.0 + 1e-7) * limits.jerk,
            ) && self.range_is_kept(axis, other, to, limits)
        })
    }

    /// Returns true if the axis could stop within its range from the state `at` plus the residual at `time` (s).
    fn range_is_kept(&self, axis: usize, at: &Terms, time: f64, limits: &AxisLimits) -> bool {
        let rest = self.residual.state_at(axis, time);
        let position = at.position + rest.position;
        let (below, above) = stopping_distances(
            at.velocity + rest.velocity,
            at.acceleration + rest.acceleration,
            limits,
        );
        let range = &self.ranges[axis];
        position - below >= range.lower && position + above <= range.upper
    }

    /// Returns true if the axes stay in their ranges, and could stop within them at any time, while the residual decays
    /// after the motion along the path has come to rest.
    fn rest_is_within(&self, walk: &mut Walk) -> bool {
        if walk.time >= self.residual.end() {
            return true;
        }
        let (one, other, share) = self.table.around(walk.state.s, &mut walk.cursor);
        let here = core::array::from_fn(|axis| {
            one.joints[axis] + share * (other.joints[axis] - one.joints[axis])
        });
        self.residual
            .can_stop(self.arm, walk.time, &here, self.ranges)
    }
}

/// Returns true if the velocity along the path becomes negative during a phase that begins with `start`: at its end, or
/// where the acceleration changes its sign.
fn goes_backwards(start: &PathState, phase: &JerkPhase) -> bool {
    /// Magnitude of the velocity along the path, m/s, up to which it counts as 0: rounding can make the velocity at
    /// rest slightly negative.
    const ROUNDING: f64 = 1e-12;
    let turning = -start.acceleration / phase.jerk;
    let inside = turning > 0.0 && turning < phase.duration;
    let lowest = if inside { turning } else { phase.duration };
    start.advanced(lowest, phase.jerk).velocity < -ROUNDING
        || start.advanced(phase.duration, phase.jerk).velocity < -ROUNDING
}
