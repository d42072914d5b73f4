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
