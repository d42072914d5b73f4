//! Time-optimal motion of one axis to a target position, and its motions with a given duration.

use super::brake::{Return, return_into_limits};
use super::family::{Ends, Family, Member, Times};
use super::limits::AxisLimits;
use super::profile::AxisProfile;
use super::timed::TimedMotion;
use rpi_kin::state_to_rest::AxisState;

/// Sign of the jerk in each of the seven phases of a time-optimal motion: rise, hold, fall, cruise, fall, hold, rise of
/// the acceleration.
pub(super) const SIGNS: [f64; 7] = [1.0, 0.0, -1.0, 0.0, -1.0, 0.0, 1.0];

/// Deviation of position (rad or m) and velocity (rad/s or m/s) from the target that counts as rounding if a motion
/// exactly to the target would take a detour.
pub(super) const TOLERANCE: f64 = 1e-8;

/// Deviation of position (rad or m) and velocity (rad/s or m/s) that always counts as rounding, in addition to the
/// rounding of the numbers themselves. A motion over such a small distance takes 1e-4 s and more.
pub(super) const ROUNDING: f64 = 1e-12;

/// Returns the deviation that counts as rounding for values of the magnitude `size`, in their unit.
pub(super) fn rounding(size: f64) -> f64 {
    ROUNDING + 8.0 * f64::EPSILON * size
}

/// Plan of a motion in time units in which the maximum jerk is 1: durations of its seven phases, and the sign of its
/// first jerk.
#[derive(Clone, Copy, Debug)]
struct Plan {
    times: Times,
    sign: f64,
    duration: f64,
}

/// Planning problem of one axis with a target position, after the return of the start into the limits. All quantities
/// are divided by the maximum jerk.
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
    /// True if the time-optimal motion needs no return into the limits.
    is_direct: bool,
}

impl AxisPlanner {
    /// Plans the time-optimal motion from `start` to `target`. The caller has checked that all numbers are valid.
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

/// Planner of one axis of a synchronised motion, which may need to take longer than its own time-optimal motion.
pub(super) trait Planner {
    /// Returns the duration of the time-optimal motion, s.
    fn duration(&self) -> f64;

    /// Returns the time-optimal motion of the axis.
    fn profile(&self) -> AxisProfile;

    /// Calls `add` with the durations (s) at which motions of exactly this duration begin or cease to exist.
    fn durations(&self, add: &mut dyn FnMut(f64));

    /// Returns the motion that takes exactly `duration` (s); `None` if there is none. With the shortest duration, it is
    /// the time-optimal motion.
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

/// Motion that may miss the target, with the distance by which it does.
type Rough = (Plan, f64);

/// Returns the motion that consists of a single phase of maximum jerk, of any duration, and its deviation from the
/// target (the larger one of velocity and position, divided by the maximum jerk).
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

/// Returns the time-optimal motion over `distance`; all quantities are divided by the maximum jerk `jerk`.
///
/// A motion that misses the target only by rounding replaces the exact one if it is much shorter. At a target with a
/// velocity or an acceleration, the shortest duration jumps: an axis that is past the target by a rounding error would
/// have to return. So a motion that is planned again on its way must not miss its own end by rounding.
fn fastest(ends: &Ends, distance: f64, jerk: f64) -> Plan {
    let (mut best, rough) = candidates(ends, distance, TOLERANCE / jerk);
    // Twice the time from rest to rest over a distance of the tolerance.
    let detour = 2.0 * rpi_math::cbrt(32.0 * TOLERANCE / jerk);
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

/// Returns the shortest motion to an end velocity that differs from that of the target by rounding only, if the shape
/// of the shortest change of velocity changes at the target velocity; `None` otherwise.
///
/// The shape changes where the change of velocity consists of one ramp of the acceleration, or where the acceleration
/// just reaches zero. Near this, the position after the change grows with the root of the difference of velocity: a
/// rounding error of 1e-14 m/s moves it by 1e-6 m.
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

/// Returns the time-optimal motion without a return into the limits; `None` if there is none, or if the return is
/// needed.
///
/// A target with an acceleration may have a velocity that exceeds its limit after the target. The states on the last
/// part of the way to such a target do so as well: they count as outside of the limits although they are not.
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

/// Returns the time-optimal motion, and a shorter motion that misses the target by less than `tolerance`, if there is
/// one.
///
/// A duration is possible if the target lies between the travels of both extremal motions with this duration. So the
/// shortest duration is the first one at which one of them reaches the target. Both have the same travel at the start
/// of a segment, which decides the one to search.
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
