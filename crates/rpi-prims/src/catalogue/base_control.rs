//! Controllers that move a mobile platform to a pose in the plane.

use super::twist::twist;
use crate::geometry;
use crate::macros::primitive;
use crate::registry::Prim;
use crate::value_types::{Pose, Twist, Vector};
use core::f64::consts::{FRAC_PI_2, PI};

pub(super) const ALL: &[Prim] = &[OMNIDIRECTIONAL, DIFFERENTIAL];

/// Distance (m) and angle (rad) within which a goal counts as reached; also the velocity (m/s, rad/s) up to which the
/// platform counts as at rest.
const GOAL_TOLERANCE: f64 = 1e-3;
/// Angle between heading and bearing of the goal (rad) up to which a differential drive moves straight instead of
/// turning on the spot.
const HEADING_TOLERANCE: f64 = 0.1;

primitive! {
    /// Velocity, in platform coordinates, that moves an omnidirectional platform to the pose `inDest`. Each component
    /// is proportional to the remaining error, with the gains `pX`, `pY`, `pYaw` (1/s), and bounded by `velX`, `velY`
    /// (m/s) and `velYaw` (rad/s). `outCompleted` is true if the platform has reached the goal to 1 mm and 1 mrad and
    /// is at rest.
    OMNIDIRECTIONAL = "RobotBase::OmnidirectionalBaseController";
    in { inPos: Pose; inVel: Twist; inDest: Pose }
    param {
        velX: f64 = Real(0.25);
        velY: f64 = Real(0.25);
        velYaw: f64 = Real(0.3);
        pX: f64 = Real(3.0);
        pY: f64 = Real(3.0);
        pYaw: f64 = Real(3.0)
    }
    out { outVel: Twist; outCompleted: bool }
    presence strict work 150;
    c Code(r"
double inverse[7];
double left[7];
double abc[3];
rpi_pose_inverse(inPos, inverse);
rpi_pose_compose(inverse, inDest, left);
rpi_to_abc(left + 3, abc);
outVel[0] = rpi_limited(pX * left[0], velX);
outVel[1] = rpi_limited(pY * left[1], velY);
outVel[2] = 0.0;
outVel[3] = 0.0;
outVel[4] = 0.0;
outVel[5] = rpi_limited(pYaw * abc[0], velYaw);
*outCompleted = rpi_norm(inVel) < 1e-3 && rpi_norm(inVel + 3) < 1e-3 && rpi_abs(left[0]) < 1e-3 &&
                rpi_abs(left[1]) < 1e-3 && rpi_abs(abc[0]) < 1e-3;
");
    full |_, _, _, (vx, vy, vyaw, px, py, pyaw), (position, velocity, goal): (Pose, Twist, Pose)| {
        let left = position.inverse() * goal;
        let (x, y, yaw) = (left.translation.x, left.translation.y, geometry::to_abc(left.rotation).0);
        let near = |size: f64| libm::fabs(size) < GOAL_TOLERANCE;
        let rest = near(geometry::norm(velocity.linear)) && near(geometry::norm(velocity.angular));
        let wanted = planar_twist(clamp_magnitude(px * x, vx), clamp_magnitude(py * y, vy), clamp_magnitude(pyaw * yaw, vyaw));
        (wanted, rest && near(x) && near(y) && near(yaw))
    }
}

primitive! {
    /// Velocity, in platform coordinates, that moves a differential drive platform to the pose `inGoal`. The platform
    /// turns on the spot until its front or its rear, whichever is nearer, points to the goal (gain `PYaw`, 1/s). It
    /// drives forwards or backwards to the goal, slow enough to stop with a deceleration of `PX` (m/s²), and turns to
    /// the goal orientation. Bounds are `VelX` (m/s) and `VelYaw` (rad/s). `inTwist` is not used.
    DIFFERENTIAL = "RobotBase::DifferentialDriveController";
    in { inPosition: Pose; inTwist: Twist = absent; inGoal: Pose }
    param { VelX: f64 = Real(0.5); VelYaw: f64 = Real(1.0); PX: f64 = Real(3.0); PYaw: f64 = Real(3.0) }
    out { outTwist: Twist }
    presence if_all work 150;
    c Code(r"
*outTwist_present = inPosition_present && inGoal_present;
if (*outTwist_present) {
  memset(outTwist, 0, 6U * sizeof outTwist[0]);
  rpi_drive(inPosition, inGoal, VelX, VelYaw, PX, PYaw, outTwist, outTwist + 5);
}
");
    full |_, _, _, (vx, vyaw, px, pyaw), (position, _, goal)| {
        let way = position.zip(goal).map(|(position, goal)| planar_error(position, goal));
        (way.map(|way| differential(way, (vx, vyaw), (px, pyaw))),)
    }
}

/// Returns the remaining error in the plane: distance (m), bearing of the goal in platform coordinates (rad) and
/// difference of orientation (rad).
fn planar_error(position: Pose, goal: Pose) -> (f64, f64, f64) {
    let (heading, wanted) = (
        geometry::to_abc(position.rotation).0,
        geometry::to_abc(goal.rotation).0,
    );
    let way = goal.translation.vector - position.translation.vector;
    let distance = libm::sqrt(way.x * way.x + way.y * way.y);
    (
        distance,
        normalise_angle(rpi_math::atan2(way.y, way.x) - heading),
        normalise_angle(wanted - heading),
    )
}

fn differential(
    (distance, bearing, turn): (f64, f64, f64),
    bounds: (f64, f64),
    gains: (f64, f64),
) -> Twist {
    if distance < GOAL_TOLERANCE {
        return planar_twist(0.0, 0.0, clamp_magnitude(gains.1 * turn, bounds.1));
    }
    let backwards = libm::fabs(bearing) > FRAC_PI_2;
    let bearing = if backwards {
        normalise_angle(bearing + PI)
    } else {
        bearing
    };
    if libm::fabs(bearing) > HEADING_TOLERANCE {
        return planar_twist(0.0, 0.0, clamp_magnitude(gains.1 * bearing, bounds.1));
    }
    let speed = libm::sqrt(2.0 * gains.0 * distance).min(bounds.0);
    planar_twist(if backwards { -speed } else { speed }, 0.0, 0.0)
}

/// Returns the angle that differs from `angle` (rad) by full turns and lies in the range -π to π.
fn normalise_angle(angle: f64) -> f64 {
    rpi_math::atan2(rpi_math::sin(angle), rpi_math::cos(angle))
}

fn clamp_magnitude(value: f64, bound: f64) -> f64 {
    value.max(-bound).min(bound)
}

fn planar_twist(x: f64, y: f64, yaw: f64) -> Twist {
    twist(Vector::new(x, y, 0.0), Vector::new(0.0, 0.0, yaw))
}
