//! Online trajectory generation for poses: position and orientation on one straight way, arriving together.

use super::twist::twist;
use crate::flow::{Pose, Rotation, Twist, Vector};
use crate::geometry;
use crate::macros::primitive;
use crate::registry::Prim;

pub(super) const ALL: &[Prim] = &[FRAME_OTG];

primitive! {
    /// One step of a motion from the current pose and velocity towards a pose that itself moves with a velocity (absent: at
    /// rest), all in base coordinates, with bounded velocities and accelerations (m/s, m/s², rad/s, rad/s²). It heads for
    /// where the goal will be when it could be reached, at a velocity from which four fifths of the acceleration suffice to
    /// stop there, and changes the velocity towards that one as fast as the bounds allow.
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
    full |cx, _, _, _, (from, velocity, to, goal_velocity, v, a, w, alpha)| {
        let (Some(from), Some(to), Some(v), Some(a), Some(w), Some(alpha)) = (from, to, v, a, w, alpha) else {
            return (None, None);
        };
        let velocity = velocity.unwrap_or_default();
        let goal = (to, goal_velocity.unwrap_or_default());
        let limits = Limits { velocity: (v, w), acceleration: (a, alpha) };
        let next = step(from, velocity, goal, limits, cx.clock.dt, geometry::log);
        (Some(super::frame::moved(from, next, cx.clock.dt)), Some(next))
    }
}

/// Largest velocity and acceleration, linear and angular.
#[derive(Clone, Copy)]
pub(crate) struct Limits {
    pub(crate) velocity: (f64, f64),
    pub(crate) acceleration: (f64, f64),
}

/// Share of the acceleration that is planned for stopping.
const BRAKING: f64 = 0.8;

/// The velocity of the next period. `log` gives the way of a rotation.
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
    let (linear, angular) = sizes(way);
    let time = quotient(linear, limits.velocity.0).max(quotient(angular, limits.velocity.1));
    let way = sum(way, goal_velocity, time);
    let wanted = scaled(way, pace(way, limits, dt));
    let change = sum(wanted, velocity, -1.0);
    let (linear, angular) = sizes(change);
    let share =
        share(linear, limits.acceleration.0 * dt).min(share(angular, limits.acceleration.1 * dt));
    sum(velocity, change, share)
}

/// How much of a way to cover per second.
fn pace(way: Twist, limits: Limits, dt: f64) -> f64 {
    let (linear, angular) = sizes(way);
    let stop = |length: f64, acceleration: f64| libm::sqrt(2.0 * BRAKING * acceleration * length);
    let fast = (
        limits.velocity.0.min(stop(linear, limits.acceleration.0)),
        limits.velocity.1.min(stop(angular, limits.acceleration.1)),
    );
    let per_period = share(linear, fast.0 * dt).min(share(angular, fast.1 * dt));
    per_period / dt
}

/// Largest share of a size, up to all of it, that keeps a bound.
fn share(size: f64, bound: f64) -> f64 {
    if size > bound { bound / size } else { 1.0 }
}

/// Time for a way; none where there is no speed.
fn quotient(way: f64, speed: f64) -> f64 {
    if speed > 0.0 { way / speed } else { 0.0 }
}

fn sizes(t: Twist) -> (f64, f64) {
    (geometry::norm(t.linear), geometry::norm(t.angular))
}

fn scaled(t: Twist, factor: f64) -> Twist {
    twist(t.linear * factor, t.angular * factor)
}

fn sum(a: Twist, b: Twist, factor: f64) -> Twist {
    twist(a.linear + b.linear * factor, a.angular + b.angular * factor)
}
