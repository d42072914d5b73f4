//! Operators on vectors, rotations, poses, velocities and wrenches that the reference system does not have.

use crate::geometry;
use crate::macros::primitive;
use crate::registry::Prim;
use crate::value_types::{Pose, Rotation, Twist, Vector, Wrench};

pub(in crate::catalogue) const ALL: &[Prim] = &[
    VECTOR_SUBTRACT,
    VECTOR_NEGATE,
    VECTOR_NORM,
    FRAME_APPLY,
    ROTATION_LOGARITHM,
    ROTATION_EXPONENTIAL,
    TWIST_SCALE,
    WRENCH_ADD,
    WRENCH_TO_PARTS,
    WRENCH_FROM_PARTS,
    VECTOR_EQUALS,
    ROTATION_EQUALS,
    FRAME_EQUALS,
    TWIST_EQUALS,
    WRENCH_EQUALS,
];

primitive! {
    /// Difference of two vectors.
    VECTOR_SUBTRACT = "Rpi::VectorSubtract";
    in { inFirst: Vector; inSecond: Vector }
    out { outValue: Vector }
    presence strict work 3;
    pure |(a, b): (Vector, Vector)| (a - b,)
}

primitive! {
    /// Negated vector.
    VECTOR_NEGATE = "Rpi::VectorNegate";
    in { inValue: Vector }
    out { outValue: Vector }
    presence strict work 3;
    pure |(a,): (Vector,)| (-a,)
}

primitive! {
    /// Length of a vector.
    VECTOR_NORM = "Rpi::VectorNorm";
    in { inValue: Vector }
    out { outValue: f64 }
    presence strict work 20;
    pure |(a,): (Vector,)| (geometry::norm(a),)
}

primitive! {
    /// Point transformed by a pose: from coordinates of the frame of the pose to coordinates of the frame in which the
    /// pose is given. In m.
    FRAME_APPLY = "Rpi::FrameApply";
    in { inFirst: Pose; inSecond: Vector }
    out { outValue: Vector }
    presence strict work 30;
    pure |(pose, point): (Pose, Vector)| (pose.rotation * point + pose.translation.vector,)
}

primitive! {
    /// Rotation vector: axis times angle (rad, 0 to π) of a rotation.
    ROTATION_LOGARITHM = "Rpi::RotationLogarithm";
    in { inValue: Rotation }
    out { outValue: Vector }
    presence strict work 60;
    pure |(r,): (Rotation,)| (geometry::log(r),)
}

primitive! {
    /// Rotation about the direction of a vector by its length (rad).
    ROTATION_EXPONENTIAL = "Rpi::RotationExponential";
    in { inValue: Vector }
    out { outValue: Rotation }
    presence strict work 90;
    pure |(v,): (Vector,)| (geometry::exp(v),)
}

primitive! {
    /// Product of a velocity (linear and angular) and a real.
    TWIST_SCALE = "Rpi::TwistScale";
    in { inValue: Twist; inFactor: f64 = Factor(Real(1.0)) }
    out { outValue: Twist }
    presence strict work 6;
    pure |(t, k): (Twist, f64)| (Twist { linear: t.linear * k, angular: t.angular * k },)
}

primitive! {
    /// Sum of two wrenches with the same reference point.
    WRENCH_ADD = "Rpi::WrenchAdd";
    in { inFirst: Wrench; inSecond: Wrench }
    out { outValue: Wrench }
    presence strict work 6;
    pure |(a, b): (Wrench, Wrench)| (Wrench { force: a.force + b.force, torque: a.torque + b.torque },)
}

primitive! {
    /// Force (N) and torque (N m) of a wrench.
    WRENCH_TO_PARTS = "Rpi::WrenchToParts";
    in { inValue: Wrench }
    out { outForce: Vector; outTorque: Vector }
    presence strict work 6;
    pure |(w,): (Wrench,)| (w.force, w.torque)
}

primitive! {
    /// Wrench from force (N) and torque (N m).
    WRENCH_FROM_PARTS = "Rpi::WrenchFromParts";
    in { inForce: Vector; inTorque: Vector }
    out { outValue: Wrench }
    presence strict work 6;
    pure |(force, torque): (Vector, Vector)| (Wrench { force, torque },)
}

primitive! {
    /// True if all components of both vectors are equal.
    VECTOR_EQUALS = "Rpi::VectorEquals";
    in { inFirst: Vector; inSecond: Vector }
    out { outValue: bool }
    presence strict work 3;
    pure |(a, b): (Vector, Vector)| (a == b,)
}

primitive! {
    /// True if both rotations are equal; a quaternion and its negative are the same rotation.
    ROTATION_EQUALS = "Rpi::RotationEquals";
    in { inFirst: Rotation; inSecond: Rotation }
    out { outValue: bool }
    presence strict work 8;
    pure |(a, b): (Rotation, Rotation)| (geometry::is_same(a, b),)
}

primitive! {
    /// True if both poses have equal position and orientation.
    FRAME_EQUALS = "Rpi::FrameEquals";
    in { inFirst: Pose; inSecond: Pose }
    out { outValue: bool }
    presence strict work 11;
    pure |(a, b): (Pose, Pose)| (a.translation.vector == b.translation.vector && geometry::is_same(a.rotation, b.rotation),)
}

primitive! {
    /// True if all components of both velocities are equal.
    TWIST_EQUALS = "Rpi::TwistEquals";
    in { inFirst: Twist; inSecond: Twist }
    out { outValue: bool }
    presence strict work 6;
    pure |(a, b): (Twist, Twist)| (a.linear == b.linear && a.angular == b.angular,)
}

primitive! {
    /// True if all components of both wrenches are equal.
    WRENCH_EQUALS = "Rpi::WrenchEquals";
    in { inFirst: Wrench; inSecond: Wrench }
    out { outValue: bool }
    presence strict work 6;
    pure |(a, b): (Wrench, Wrench)| (a.force == b.force && a.torque == b.torque,)
}
