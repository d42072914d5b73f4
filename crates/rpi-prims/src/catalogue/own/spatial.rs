//! Algebra of vectors, rotations, poses, velocities and wrenches beyond the reference system's.

use crate::flow::{Pose, Rotation, Twist, Vector, Wrench};
use crate::geometry;
use crate::macros::primitive;
use crate::registry::Prim;

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
    /// The vector of opposite direction.
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
    /// A point given in the pose's frame, in the frame in which the pose is given.
    FRAME_APPLY = "Rpi::FrameApply";
    in { inFirst: Pose; inSecond: Vector }
    out { outValue: Vector }
    presence strict work 30;
    pure |(pose, point): (Pose, Vector)| (pose.rotation * point + pose.translation.vector,)
}

primitive! {
    /// Axis times angle (rad, at most π) of a rotation.
    ROTATION_LOGARITHM = "Rpi::RotationLogarithm";
    in { inValue: Rotation }
    out { outValue: Vector }
    presence strict work 60;
    pure |(r,): (Rotation,)| (geometry::log(r),)
}

primitive! {
    /// The rotation about the vector's direction by its length (rad).
    ROTATION_EXPONENTIAL = "Rpi::RotationExponential";
    in { inValue: Vector }
    out { outValue: Rotation }
    presence strict work 90;
    pure |(v,): (Vector,)| (geometry::exp(v),)
}

primitive! {
    /// A velocity times a factor.
    TWIST_SCALE = "Rpi::TwistScale";
    in { inValue: Twist; inFactor: f64 = Factor(Real(1.0)) }
    out { outValue: Twist }
    presence strict work 6;
    pure |(t, k): (Twist, f64)| (Twist { linear: t.linear * k, angular: t.angular * k },)
}

primitive! {
    /// Sum of two wrenches at one point.
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
    /// A wrench from force (N) and torque (N m).
    WRENCH_FROM_PARTS = "Rpi::WrenchFromParts";
    in { inForce: Vector; inTorque: Vector }
    out { outValue: Wrench }
    presence strict work 6;
    pure |(force, torque): (Vector, Vector)| (Wrench { force, torque },)
}

primitive! {
    /// True if both vectors have the same components.
    VECTOR_EQUALS = "Rpi::VectorEquals";
    in { inFirst: Vector; inSecond: Vector }
    out { outValue: bool }
    presence strict work 3;
    pure |(a, b): (Vector, Vector)| (a == b,)
}

primitive! {
    /// True if both are the same rotation.
    ROTATION_EQUALS = "Rpi::RotationEquals";
    in { inFirst: Rotation; inSecond: Rotation }
    out { outValue: bool }
    presence strict work 8;
    pure |(a, b): (Rotation, Rotation)| (geometry::is_same(a, b),)
}

primitive! {
    /// True if both poses have the same position and the same orientation.
    FRAME_EQUALS = "Rpi::FrameEquals";
    in { inFirst: Pose; inSecond: Pose }
    out { outValue: bool }
    presence strict work 11;
    pure |(a, b): (Pose, Pose)| (a.translation.vector == b.translation.vector && geometry::is_same(a.rotation, b.rotation),)
}

primitive! {
    /// True if both velocities have the same components.
    TWIST_EQUALS = "Rpi::TwistEquals";
    in { inFirst: Twist; inSecond: Twist }
    out { outValue: bool }
    presence strict work 6;
    pure |(a, b): (Twist, Twist)| (a.linear == b.linear && a.angular == b.angular,)
}

primitive! {
    /// True if both wrenches have the same components.
    WRENCH_EQUALS = "Rpi::WrenchEquals";
    in { inFirst: Wrench; inSecond: Wrench }
    out { outValue: bool }
    presence strict work 6;
    pure |(a, b): (Wrench, Wrench)| (a.force == b.force && a.torque == b.torque,)
}
