//! Velocities, or twists (m/s, rad/s), and wrenches (N, N m).

use crate::geometry;
use crate::macros::primitive;
use crate::registry::Prim;
use crate::value_types::{Pose, Rotation, Twist, Vector, Wrench};

pub(super) const ALL: &[Prim] = &[
    ADD,
    CHANGE_CENTER,
    FROM_FRAMES,
    FROM_VELOCITIES,
    TO_VELOCITIES,
    FROM_XYZ,
    TO_XYZ,
    ROTATE,
    WRENCH_FROM_XYZ,
    WRENCH_TO_XYZ,
];

primitive! {
    /// Sum of two velocities (linear and angular parts).
    ADD = "World::TwistAdd";
    in { inFirst: Twist; inSecond: Twist }
    out { outValue: Twist }
    presence strict work 6;
    c Code("rpi_sum(inFirst, inSecond, 6, outValue);");
    pure |(a, b): (Twist, Twist)| (twist(a.linear + b.linear, a.angular + b.angular),)
}

primitive! {
    /// Velocity of another point of the same body; `inVector` is the vector from the first to the other point, in m.
    CHANGE_CENTER = "World::TwistChangeCenter";
    in { inValue: Twist; inVector: Vector }
    out { outValue: Twist }
    presence strict work 12;
    c Code(r"
double moved[3];
rpi_cross(inValue + 3, inVector, moved);
rpi_sum(inValue, moved, 3, outValue);
memcpy(outValue + 3, inValue + 3, 3U * sizeof outValue[0]);
");
    pure |(t, to): (Twist, Vector)| (twist(t.linear + t.angular.cross(&to), t.angular),)
}

primitive! {
    /// Velocity that moves from `inPrevFrame` to `inFrame` in one period, in coordinates of the base frame.
    FROM_FRAMES = "World::TwistFromFrames";
    in { inPrevFrame: Pose; inFrame: Pose }
    out { outValue: Twist }
    presence strict work 90;
    c Code(r"
double turn[4];
rpi_inverse(inPrevFrame + 3, turn);
rpi_compose(inFrame + 3, turn, turn);
rpi_to_rotation_vector(turn, outValue + 3);
rpi_difference(inFrame, inPrevFrame, 3, outValue);
rpi_divided(outValue, rpi_dt, 6, outValue);
");
    full |cx, _, _, _, (from, to)| (velocity(from, to, cx.time.dt),)
}

primitive! {
    /// Velocity from its linear (m/s) and angular (rad/s) parts.
    FROM_VELOCITIES = "World::TwistFromVelocities";
    in { inTransVel: Vector = [super::spatial_fallbacks::XYZ]; inRotVel: Vector = [super::spatial_fallbacks::RXYZ] }
    out { outValue: Twist }
    presence strict work 6;
    c Code(r"
memcpy(outValue, inTransVel, 3U * sizeof outValue[0]);
memcpy(outValue + 3, inRotVel, 3U * sizeof outValue[0]);
");
    pure |(linear, angular)| (twist(linear, angular),)
}

primitive! {
    /// Linear (m/s) and angular (rad/s) parts of a velocity.
    TO_VELOCITIES = "World::TwistToVelocities";
    in { inValue: Twist }
    out { outTransVel: Vector; outRotVel: Vector }
    presence strict work 6;
    c Code(r"
memcpy(outTransVel, inValue, 3U * sizeof outTransVel[0]);
memcpy(outRotVel, inValue + 3, 3U * sizeof outRotVel[0]);
");
    pure |(t,): (Twist,)| (t.linear, t.angular)
}

primitive! {
    /// Velocity from its components: linear x, y, z (m/s); angular a, b, c about z, y, x (rad/s).
    FROM_XYZ = "World::TwistFromXYZ";
    in {
        inX: f64 = X(Real(0.0));
        inY: f64 = Y(Real(0.0));
        inZ: f64 = Z(Real(0.0));
        inA: f64 = A(Real(0.0));
        inB: f64 = B(Real(0.0));
        inC: f64 = C(Real(0.0))
    }
    out { outValue: Twist }
    presence strict work 6;
    c Code(r"
outValue[0] = inX;
outValue[1] = inY;
outValue[2] = inZ;
outValue[3] = inC;
outValue[4] = inB;
outValue[5] = inA;
");
    pure |(x, y, z, a, b, c)| (twist(Vector::new(x, y, z), Vector::new(c, b, a)),)
}

primitive! {
    /// Components of a velocity: linear x, y, z (m/s); angular a, b, c about z, y, x (rad/s).
    TO_XYZ = "World::TwistToXYZ";
    in { inValue: Twist }
    out { outX: f64; outY: f64; outZ: f64; outA: f64; outB: f64; outC: f64 }
    presence strict work 6;
    c Code(r"
*outX = inValue[0];
*outY = inValue[1];
*outZ = inValue[2];
*outA = inValue[5];
*outB = inValue[4];
*outC = inValue[3];
");
    pure |(t,): (Twist,)| (t.linear.x, t.linear.y, t.linear.z, t.angular.z, t.angular.y, t.angular.x)
}

primitive! {
    /// Velocity transformed from the rotated frame to the frame in which `inRot` is given. The reference point stays.
    ROTATE = "World::TwistRotate";
    in { inValue: Twist; inRot: Rotation }
    out { outValue: Twist }
    presence strict work 40;
    c Code(r"
rpi_rotate(inRot, inValue, outValue);
rpi_rotate(inRot, inValue + 3, outValue + 3);
");
    pure |(t, rotation): (Twist, Rotation)| (twist(rotation * t.linear, rotation * t.angular),)
}

primitive! {
    /// Wrench from its components: force x, y, z (N); torque a, b, c about z, y, x (N m).
    WRENCH_FROM_XYZ = "World::WrenchFromXYZ";
    in {
        inX: f64 = X(Real(0.0));
        inY: f64 = Y(Real(0.0));
        inZ: f64 = Z(Real(0.0));
        inA: f64 = A(Real(0.0));
        inB: f64 = B(Real(0.0));
        inC: f64 = C(Real(0.0))
    }
    out { outValue: Wrench }
    presence strict work 6;
    c Code(r"
outValue[0] = inX;
outValue[1] = inY;
outValue[2] = inZ;
outValue[3] = inC;
outValue[4] = inB;
outValue[5] = inA;
");
    pure |(x, y, z, a, b, c)| (Wrench { force: Vector::new(x, y, z), torque: Vector::new(c, b, a) },)
}

primitive! {
    /// Components of a wrench: force x, y, z (N); torque a, b, c about z, y, x (N m).
    WRENCH_TO_XYZ = "World::WrenchToXYZ";
    in { inValue: Wrench }
    out { outX: f64; outY: f64; outZ: f64; outA: f64; outB: f64; outC: f64 }
    presence strict work 6;
    c Code(r"
*outX = inValue[0];
*outY = inValue[1];
*outZ = inValue[2];
*outA = inValue[5];
*outB = inValue[4];
*outC = inValue[3];
");
    pure |(w,): (Wrench,)| (w.force.x, w.force.y, w.force.z, w.torque.z, w.torque.y, w.torque.x)
}

/// Creates a velocity from its linear and angular parts.
pub(super) fn twist(linear: Vector, angular: Vector) -> Twist {
    Twist { linear, angular }
}

/// Returns the constant velocity, in base coordinates, of a motion from the pose `from` to the pose `to` in `dt`
/// seconds.
pub(super) fn velocity(from: Pose, to: Pose, dt: f64) -> Twist {
    let way = to.translation.vector - from.translation.vector;
    let turn = geometry::log(to.rotation * from.rotation.inverse());
    twist(way / dt, turn / dt)
}
