//! Time-optimal motion of one axis to a target position, and its motions with a given duration.

use super::brake::{Return, return_into_limits};
use super::family::{Ends, Family, Member, Times};
use super::limits::AxisLimits;
use super::profile::AxisProfile;
use super::timed::TimedMotion;
use rpi_kin::state_to_rest::AxisState;

/// Signs of the jerk in the phases of a family.
pub(super) const SIGNS: [f64; 7] = [1.0, 0.0, -1.0, 0.0, -1.0, 0.0, 1.0];

/// Deviation of position and velocity from the target that counts as rounding where the exact motion is a detour; rad or
/// m, and rad/s or m/s.
pub(super) const TOLERANCE: f64 = 1e-8;

/// Deviation that always counts as rounding, with that of the numbers themselves. An exact motion over such a distance
/// takes 1e-4 s and more.
pub(super) const ROUNDING: f64 = 1e-12;

/// Deviation that counts as rounding of values of a given size.
pub(super) fn rounding(size: f64) -> f64 {
    ROUNDING + 8.0 * f64::EPSILON * size
}

/// Motion in normalised time: the durations of the phases and the sign of their first jerk.
#[derive(Clone, Copy, Debug)]
struct Plan {
    times: Times,
    sign: f64,
    duration: f64,
}

/// Planning problem of one axis, after the return into the limits, divided by the maximum jerk.
#[derive(Clone, Copy, Debug)]
pub(super) struct AxisPlanner {
    start: AxisState,
    target: AxisState,
    jerk: f64,
    entry: Return,
    ends: Ends,
    distance: f64,
    tolerance: f64,
    best: Plan,
    /// The time-optimal motion needs no return into the limits.
    is_direct: bool,
}

impl AxisPlanner {
    /// Plans the time-optimal motion. All numbers must have been checked.
    pub(super) fn new(start: AxisState, target: AxisState, limits: &AxisLimits) -> Self {
        let jerk = limits.max_jerk;
        let mut ends = Ends::new(&start, &target, limits);
        let whole = (target.position - start.position) / jerk;
        let direct = direct(&ends, whole, jerk);
        let entry = return_into_limits(&ends);
        ends.start_velocity = entry.velocity;
        ends.start_acceleration = entry.acceleration;
        let distance = whole - entry.position;
        let best = fastest(&ends, distance, jerk);
        let direct = direct.filter(|plan| plan.duration < entry.duration() + best.duration);
        Self {
            start,
            target,
            jerk,
            entry,
            ends,
            distance,
            tolerance: TOLERANCE / jerk,
            best: direct.unwrap_or(best),
            is_direct: direct.is_some(),
        }
    }

    fn entry_profile(&self) -> AxisProfile {
        let mut profile = AxisProfile::standing(self.start, self.target);
        for (time, sign) in self.entry.phases {
            profile.push(time, self.jerk * sign);
        }
        profile
    }
}

/// Planning problem of one axis of a synchronised motion.
pub(super) trait Planner {
    /// Shortest duration, s.
    fn duration(&self) -> f64;

    /// Time-optimal motion.
    fn profile(&self) -> AxisProfile;

    /// Collects the durations in s at which it may change whether there is a motion of exactly a duration.
    fn durations(&self, add: &mut dyn FnMut(f64));

    /// Returns the motion with a given duration in s, or `None` if there is none. With the shortest duration this is the
    /// time-optimal motion.
    fn profile_with_duration(&self, duration: f64) -> Option<AxisProfile>;
}

impl Planner for AxisPlanner {
    fn duration(&self) -> f64 {
        if self.is_direct {
            self.best.duration
        } else {
            self.entry.duration() + self.best.duration
        }
    }

    fn profile(&self) -> AxisProfile {
        let mut profile = if self.is_direct {
            AxisProfile::standing(self.start, self.target)
        } else {
            self.entry_profile()
        };
        for (time, sign) in self.best.times.iter().zip(SIGNS) {
            profile.push(*time, self.jerk * self.best.sign * sign);
        }
        profile.finished(self.duration())
    }

    fn durations(&self, add: &mut dyn FnMut(f64)) {
        let entry = self.entry.duration();
        Family::new(&self.ends).durations_at(self.distance, |time| add(entry + time));
        let mirror = Family::new(&self.ends.mirrored());
        mirror.durations_at(-self.distance, |time| add(entry + time));
    }

    fn profile_with_duration(&self, duration: f64) -> Option<AxisProfile> {
        if (duration - self.duration()).abs() <= 1e-12 * duration {
            return Some(self.profile().finished(duration));
        }
        let time = duration - self.entry.duration();
        let timed = TimedMotion::new(&self.ends, self.distance, time, self.tolerance)?;
        let mut profile = self.entry_profile();
        timed.each_phase(|phase, sign| profile.push(phase, self.jerk * sign));
        Some(profile.finished(duration))
    }
}

/// Motion that may miss the target by a distance.
type Rough = (Plan, f64);

/// Returns the motion with one phase of maximum jerk, or of none, and by what it misses the target.
fn straight_ramp(ends: &Ends, distance: f64) -> Rough {
    let (from, to) = (ends.start_acceleration, ends.end_acceleration);
    let time = (to - from).abs();
    let gained = (from + to) / 2.0 * time;
    let velocity_error = ends.end_velocity - ends.start_velocity - gained;
    let sign = if to < from { -1.0 } else { 1.0 };
    let travelled = time * (ends.start_velocity + time * (from / 2.0 + time * sign / 6.0));
    let plan = Plan {
        times: [time, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
        sign,
        duration: time,
    };
    (plan, velocity_error.abs().max((distance - travelled).abs()))
}

/// Returns the time-optimal motion.
///
/// A motion that misses the target by rounding replaces the exact one. Where the target has a velocity or an
/// acceleration, the shortest duration jumps: past the target by a rounding error, an axis must go back. So a motion that
/// is planned anew on its way must not miss its own rest by rounding.
fn fastest(ends: &Ends, distance: f64, jerk: f64) -> Plan {
    let (mut best, rough) = candidates(ends, distance, TOLERANCE / jerk);
    // Twice the time from rest to rest over a distance of the tolerance.
    let detour = 2.0 * libm::cbrt(32.0 * TOLERANCE / jerk);
    for (rough, error) in rough.into_iter().chain([straight_ramp(ends, distance)]) {
        let speed = ends.start_velocity.abs() + ends.end_velocity.abs();
        let is_rounding =
            error * jerk <= rounding(jerk * (distance.abs() + speed * rough.duration.max(1.0)));
        let is_detour = error * jerk <= TOLERANCE && rough.duration + detour < best.duration;
        if is_detour || is_rounding && rough.duration < best.duration {
            best = rough;
        }
    }
    near_change_of_shape(ends, distance, jerk)
        .filter(|near| near.duration + detour < best.duration)
        .unwrap_or(best)
}

/// Returns the shortest motion to an end velocity that cannot be distinguished from that of the target, if the shape of the
/// shortest change of velocity changes there.
///
/// This is so for a change with one ramp, and for one in which the acceleration just reaches zero. Beside it, the
/// position after the change grows with the root of the difference: a rounding error of 1e-14 m/s makes it 1e-6 m.
fn near_change_of_shape(ends: &Ends, distance: f64, jerk: f64) -> Option<Plan> {
    let (from, to) = (ends.start_acceleration, ends.end_acceleration);
    let squares = from * from + to * to;
    let size = ends.start_velocity.abs() + ends.end_velocity.abs() + squares;
    let slack = rounding(size * jerk) / jerk;
    let beside = 4.0 * f64::EPSILON * size;
    let mut best: Option<Plan> = None;
    for gained in [
        (from + to) / 2.0 * (to - from).abs(),
        squares / 2.0,
        -squares / 2.0,
    ] {
        let reached = ends.start_velocity + gained;
        if (ends.end_velocity - reached).abs() > slack {
            continue;
        }
        for end_velocity in [reached, reached - beside, reached + beside] {
            let shifted = Ends {
                end_velocity,
                ..*ends
            };
            let plan = candidates(&shifted, distance, 0.0).0;
            if best.is_none_or(|best| plan.duration < best.duration) {
                best = Some(plan);
            }
        }
    }
    best
}

/// Returns the time-optimal motion without a return into the limits, if it exists and the return is not needed.
///
/// The velocity of a target with an acceleration may be such that it exceeds its limit afterwards. The states on the last
/// part of the way to it do so as well: they count as outside of the limits, but are not.
fn direct(ends: &Ends, distance: f64, jerk: f64) -> Option<Plan> {
    let Ends {
        start_velocity: v,
        start_acceleration: a,
        end_velocity,
        end_acceleration,
        ..
    } = *ends;
    let coasting = |v: f64, a: f64| v + a * a.abs() / 2.0;
    // States on the way exceed the limits by rounding.
    let slack = 1.0 + 1e-12;
    let is_inside = |v: f64| v <= slack * ends.max_velocity && v >= slack * ends.min_velocity;
    let is_outside_at_both =
        !is_inside(coasting(v, a)) && !is_inside(coasting(end_velocity, end_acceleration));
    let is_steep = a > slack * ends.max_acceleration || a < slack * ends.min_acceleration;
    if !is_outside_at_both || !is_inside(v) || is_steep {
        return None;
    }
    let plan = fastest(ends, distance, jerk);
    let mut motion = (v, a);
    for (time, sign) in plan.times.into_iter().zip(SIGNS) {
        let (v, a, jerk) = (motion.0, motion.1, plan.sign * sign);
        // The extremum of the velocity within the phase, or its end.
        let turn = (-a * jerk).clamp(0.0, time);
        let velocity = |time: f64| v + time * (a + time * jerk / 2.0);
        motion = (velocity(time), a + time * jerk);
        if !is_inside(velocity(turn)) || !is_inside(motion.0) {
            return None;
        }
    }
    Some(plan)
}

/// Returns the time-optimal motion, and a motion before it that misses the target by less than `tolerance`.
///
/// A duration is possible if the target is between the travels of both extremal motions with this duration, so the
/// shortest one is the first at which one of both reaches the target. Both have the same travel at the start of a
/// segment, which decides the one to search.
fn candidates(ends: &Ends, distance: f64, tolerance: f64) -> (Plan, Option<Rough>) {
    let farthest = Family::new(ends);
    let mut nearest = None;
    let mut rough = None;
    let segments: &[bool] = if farthest.has_two_segments() {
        &[true, false]
    } else {
        &[false]
    };
    for is_first in segments {
        let start = farthest.segment_start(*is_first);
        let left = distance - farthest.position(start);
        if left.abs() <= tolerance && rough.is_none() {
            rough = Some((plan(&farthest, start, 1.0), left.abs()));
        }
        if left >= 0.0 {
            if let Some(member) = farthest.first_reaching(*is_first, distance, tolerance) {
                return (plan(&farthest, member, 1.0), rough);
            }
        } else {
            let mirror = nearest.get_or_insert_with(|| Family::new(&ends.mirrored()));
            if let Some(member) = mirror.first_reaching(*is_first, -distance, tolerance) {
                return (plan(mirror, member, -1.0), rough);
            }
        }
    }
    // Not reached: the last segment ends with a cruise of any duration.
    (plan(&farthest, farthest.segment_start(false), 1.0), rough)
}

fn plan(family: &Family, member: Member, sign: f64) -> Plan {
    let times = family.times(member);
    Plan {
        times,
        sign,
        duration: times.iter().sum(),
    }
}
