//! Online trajectory generation for poses: position and orientation move on one straight path and arrive together.

use super::twist::twist;
use crate::geometry;
use crate::macros::primitive;
use crate::registry::Prim;
use crate::value_types::{Pose, Rotation, Twist, Vector};

pub(super) const ALL: &[Prim] = &[FRAME_OTG];

primitive! {
    /// Online trajectory generation: one step from the current pose and velocity towards a goal pose with bounded
    /// velocities and accelerations (m/s, m/s², rad/s, rad/s²). The goal may move with the velocity `inDestVel`
    /// (absent: at rest). All values are in coordinates of the base frame. The step aims at the predicted position of
    /// the goal when it can be reached. The desired velocity allows stopping there with 80 % of the acceleration; the
    /// actual velocity changes towards it as fast as the bounds allow.
    FRAME_OTG = "World::FrameOTG";
    in {
        inCurPos: Pose;
        inCurVel: Twist = absent;
        inDestPos: Pose;
        inDestVel: Twist = absent;
        inMaxTransVel: f64 = MaxTransVel(Real(1.0));
        inMaxTransAcc: f64 = MaxTransAcc(Real(1.0));
        inMaxRotVel: f64 = MaxRotVel(Real(1.0));
        inMaxRotAcc: f64 = MaxRotAcc(Real(1.0))
    }
    out { outPos: Pose; outVel: Twist }
    presence if_all work 300;
    c Code(r"
const bool is_present = inCurPos_present && inDestPos_present && inMaxTransVel_present && inMaxTransAcc_present &&
                        inMaxRotVel_present && inMaxRotAcc_present;
if (is_present) {
  static const double rest[6] = {0.0, 0.0, 0.0, 0.0, 0.0, 0.0};
  const double velocity[2] = {inMaxTransVel, inMaxRotVel};
  const double acceleration[2] = {inMaxTransAcc, inMaxRotAcc};
  rpi_approach(inCurPos, inCurVel_present ? inCurVel : rest, inDestPos, inDestVel_present ? inDestVel : rest, velocity,
               acceleration, rpi_dt, outVel);
  rpi_integrate_pose(inCurPos, outVel, rpi_dt, outPos);
}
*outPos_present = is_present;
*outVel_present = is_present;
");
    full |cx, _, _, _, (from, velocity, to, goal_velocity, v, a, w, alpha)| {
        let (Some(from), Some(to), Some(v), Some(a), Some(w), Some(alpha)) = (from, to, v, a, w, alpha) else {
            return (None, None);
        };
        let velocity = velocity.unwrap_or_default();
        let goal = (to, goal_velocity.unwrap_or_default());
        let limits = Limits { velocity: (v, w), acceleration: (a, alpha) };
        let next = step(from, velocity, goal, limits, cx.time.dt, geometry::log);
        (Some(super::frame::integrate(from, next, cx.time.dt)), Some(next))
    }
}

/// Limits of a motion: maximum velocity (m/s, rad/s) and acceleration (m/s², rad/s²), each as (linear, angular).
#[derive(Clone, Copy)]
pub(crate) struct Limits {
    pub(crate) velocity: (f64, f64),
    pub(crate) acceleration: (f64, f64),
}

/// Fraction of the maximum acceleration with which stops are planned. The margin avoids overshoot in discrete time.
const BRAKING_FRACTION: f64 = 0.8;

/// Returns the velocity in the next period for a motion from a pose and velocity towards a goal pose, which may move
/// with `goal_velocity`. `log` computes the rotation vector of a rotation; the model of a known fault in
/// [`crate::differences`] passes its own.
pub(crate) fn step(
    from: Pose,
    velocity: Twist,
    (to, goal_velocity): (Pose, Twist),
    limits: Limits,
    dt: f64,
    log: impl Fn(Rotation) -> Vector,
) -> Twist {
    let turn = from.rotation * log(from.rotation.inverse() * to.rotation);
    let way = twist(to.translation.vector - from.translation.vector, turn);
    let (linear, angular) = magnitudes(way);
    let time = travel_time(linear, limits.velocity.0).max(travel_time(angular, limits.velocity.1));
    let way = add_scaled(way, goal_velocity, time);
    let wanted = scale(way, path_rate(way, limits, dt));
    let change = add_scaled(wanted, velocity, -1.0);
    let (linear, angular) = magnitudes(change);
    let share = scale_within(linear, limits.acceleration.0 * dt)
        .min(scale_within(angular, limits.acceleration.1 * dt));
    add_scaled(velocity, change, share)
}

/// Returns the fraction of the remaining path `way` (m, rad) to cover per second (1/s), so that the velocity stays
/// within `limits` and allows a stop at the end of the path.
fn path_rate(way: Twist, limits: Limits, dt: f64) -> f64 {
    let (linear, angular) = magnitudes(way);
    let stop =
        |length: f64, acceleration: f64| libm::sqrt(2.0 * BRAKING_FRACTION * acceleration * length);
    let fast = (
        limits.velocity.0.min(stop(linear, limits.acceleration.0)),
        limits.velocity.1.min(stop(angular, limits.acceleration.1)),
    );
    let per_period = scale_within(linear, fast.0 * dt).min(scale_within(angular, fast.1 * dt));
    per_period / dt
}

/// Returns the largest factor, at most 1, by which a vector of length `size` must be scaled so that it is not longer
/// than `bound`.
fn scale_within(size: f64, bound: f64) -> f64 {
    if size > bound { bound / size } else { 1.0 }
}

/// Returns the time to travel the distance `way` at `speed`, in s; 0 if the speed is 0.
fn travel_time(way: f64, speed: f64) -> f64 {
    if speed > 0.0 { way / speed } else { 0.0 }
}

fn magnitudes(t: Twist) -> (f64, f64) {
    (geometry::norm(t.linear), geometry::norm(t.angular))
}

fn scale(t: Twist, factor: f64) -> Twist {
    twist(t.linear * factor, t.angular * factor)
}

fn add_scaled(a: Twist, b: Twist, factor: f64) -> Twist {
    twist(a.linear + b.linear * factor, a.angular + b.angular * factor)
}
