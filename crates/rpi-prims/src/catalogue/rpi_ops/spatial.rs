//! Operators on vectors, rotations, poses, velocities and wrenches that the reference system does not have.

use crate::geometry;
use crate::macros::primitive;
use crate::registry::Prim;
use crate::value_types::{Pose, Rotation, Twist, Vector, Wrench};

pub(in crate::catalogue) const ALL: &[Prim] = &[
    VECTOR_SUBTRACT,
    VECTOR_NEGATE,
    VECTOR_DIVIDE,
    VECTOR_NORM,
    FRAME_APPLY,
    ROTATION_LOGARITHM,
    ROTATION_EXPONENTIAL,
    ROTATION_POWER,
    TWIST_SUBTRACT,
    TWIST_NEGATE,
    TWIST_SCALE,
    TWIST_DIVIDE,
    WRENCH_ADD,
    WRENCH_SUBTRACT,
    WRENCH_NEGATE,
    WRENCH_SCALE,
    WRENCH_DIVIDE,
    WRENCH_ROTATE,
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
    c Code("rpi_difference(inFirst, inSecond, 3, outValue);");
    pure |(a, b): (Vector, Vector)| (a - b,)
}

primitive! {
    /// Negated vector.
    VECTOR_NEGATE = "Rpi::VectorNegate";
    in { inValue: Vector }
    out { outValue: Vector }
    presence strict work 3;
    c Code("rpi_negation(inValue, 3, outValue);");
    pure |(a,): (Vector,)| (-a,)
}

primitive! {
    /// Quotient of a vector and a real. Division by 0 gives infinite components, or NaN for a component that is 0.
    VECTOR_DIVIDE = "Rpi::VectorDivide";
    in { inValue: Vector; inDivisor: f64 }
    out { outValue: Vector }
    presence strict work 3;
    c Code("rpi_divided(inValue, inDivisor, 3, outValue);");
    pure |(v, k): (Vector, f64)| (v / k,)
}

primitive! {
    /// Length of a vector.
    VECTOR_NORM = "Rpi::VectorNorm";
    in { inValue: Vector }
    out { outValue: f64 }
    presence strict work 20;
    c Value("rpi_norm(inValue)");
    pure |(a,): (Vector,)| (geometry::norm(a),)
}

primitive! {
    /// Point transformed by a pose: from coordinates of the frame of the pose to coordinates of the frame in which the
    /// pose is given. In m.
    FRAME_APPLY = "Rpi::FrameApply";
    in { inFirst: Pose; inSecond: Vector }
    out { outValue: Vector }
    presence strict work 30;
    c Code(r"
rpi_rotate(inFirst + 3, inSecond, outValue);
rpi_sum(outValue, inFirst, 3, outValue);
");
    pure |(pose, point): (Pose, Vector)| (pose.rotation * point + pose.translation.vector,)
}

primitive! {
    /// Rotation vector: axis times angle (rad, 0 to π) of a rotation.
    ROTATION_LOGARITHM = "Rpi::RotationLogarithm";
    in { inValue: Rotation }
    out { outValue: Vector }
    presence strict work 60;
    c Code("rpi_to_rotation_vector(inValue, outValue);");
    pure |(r,): (Rotation,)| (geometry::log(r),)
}

primitive! {
    /// Rotation about the direction of a vector by its length (rad).
    ROTATION_EXPONENTIAL = "Rpi::RotationExponential";
    in { inValue: Vector }
    out { outValue: Rotation }
    presence strict work 90;
    c Code("rpi_from_axis(inValue, outValue);");
    pure |(v,): (Vector,)| (geometry::exp(v),)
}

primitive! {
    /// Rotation about the same axis by `inExponent` times the angle (0 to π) of a rotation.
    ROTATION_POWER = "Rpi::RotationPower";
    in { inValue: Rotation; inExponent: f64 }
    out { outValue: Rotation }
    presence strict work 150;
    c Code(r"
double vector[3];
rpi_to_rotation_vector(inValue, vector);
rpi_scaled(vector, inExponent, 3, vector);
rpi_from_axis(vector, outValue);
");
    pure |(r, k): (Rotation, f64)| (geometry::exp(geometry::log(r) * k),)
}

primitive! {
    /// Difference of two velocities with the same reference point.
    TWIST_SUBTRACT = "Rpi::TwistSubtract";
    in { inFirst: Twist; inSecond: Twist }
    out { outValue: Twist }
    presence strict work 6;
    c Code("rpi_difference(inFirst, inSecond, 6, outValue);");
    pure |(a, b): (Twist, Twist)| (Twist { linear: a.linear - b.linear, angular: a.angular - b.angular },)
}

primitive! {
    /// Negated velocity (linear and angular).
    TWIST_NEGATE = "Rpi::TwistNegate";
    in { inValue: Twist }
    out { outValue: Twist }
    presence strict work 6;
    c Code("rpi_negation(inValue, 6, outValue);");
    pure |(t,): (Twist,)| (Twist { linear: -t.linear, angular: -t.angular },)
}

primitive! {
    /// Product of a velocity (linear and angular) and a real.
    TWIST_SCALE = "Rpi::TwistScale";
    in { inValue: Twist; inFactor: f64 = Factor(Real(1.0)) }
    out { outValue: Twist }
    presence strict work 6;
    c Code("rpi_scaled(inValue, inFactor, 6, outValue);");
    pure |(t, k): (Twist, f64)| (Twist { linear: t.linear * k, angular: t.angular * k },)
}

primitive! {
    /// Quotient of a velocity (linear and angular) and a real.
    TWIST_DIVIDE = "Rpi::TwistDivide";
    in { inValue: Twist; inDivisor: f64 }
    out { outValue: Twist }
    presence strict work 6;
    c Code("rpi_divided(inValue, inDivisor, 6, outValue);");
    pure |(t, k): (Twist, f64)| (Twist { linear: t.linear / k, angular: t.angular / k },)
}

primitive! {
    /// Sum of two wrenches with the same reference point.
    WRENCH_ADD = "Rpi::WrenchAdd";
    in { inFirst: Wrench; inSecond: Wrench }
    out { outValue: Wrench }
    presence strict work 6;
    c Code("rpi_sum(inFirst, inSecond, 6, outValue);");
    pure |(a, b): (Wrench, Wrench)| (Wrench { force: a.force + b.force, torque: a.torque + b.torque },)
}

primitive! {
    /// Difference of two wrenches with the same reference point.
    WRENCH_SUBTRACT = "Rpi::WrenchSubtract";
    in { inFirst: Wrench; inSecond: Wrench }
    out { outValue: Wrench }
    presence strict work 6;
    c Code("rpi_difference(inFirst, inSecond, 6, outValue);");
    pure |(a, b): (Wrench, Wrench)| (Wrench { force: a.force - b.force, torque: a.torque - b.torque },)
}

primitive! {
    /// Negated wrench: the reaction to it.
    WRENCH_NEGATE = "Rpi::WrenchNegate";
    in { inValue: Wrench }
    out { outValue: Wrench }
    presence strict work 6;
    c Code("rpi_negation(inValue, 6, outValue);");
    pure |(w,): (Wrench,)| (Wrench { force: -w.force, torque: -w.torque },)
}

primitive! {
    /// Product of a wrench and a real.
    WRENCH_SCALE = "Rpi::WrenchScale";
    in { inValue: Wrench; inFactor: f64 = Factor(Real(1.0)) }
    out { outValue: Wrench }
    presence strict work 6;
    c Code("rpi_scaled(inValue, inFactor, 6, outValue);");
    pure |(w, k): (Wrench, f64)| (Wrench { force: w.force * k, torque: w.torque * k },)
}

primitive! {
    /// Quotient of a wrench and a real.
    WRENCH_DIVIDE = "Rpi::WrenchDivide";
    in { inValue: Wrench; inDivisor: f64 }
    out { outValue: Wrench }
    presence strict work 6;
    c Code("rpi_divided(inValue, inDivisor, 6, outValue);");
    pure |(w, k): (Wrench, f64)| (Wrench { force: w.force / k, torque: w.torque / k },)
}

primitive! {
    /// Wrench with the same reference point in coordinates rotated by a rotation.
    WRENCH_ROTATE = "Rpi::WrenchRotate";
    in { inValue: Wrench; inRot: Rotation }
    out { outValue: Wrench }
    presence strict work 40;
    c Code(r"
rpi_rotate(inRot, inValue, outValue);
rpi_rotate(inRot, inValue + 3, outValue + 3);
");
    pure |(w, r): (Wrench, Rotation)| (Wrench { force: r * w.force, torque: r * w.torque },)
}

primitive! {
    /// Force (N) and torque (N m) of a wrench.
    WRENCH_TO_PARTS = "Rpi::WrenchToParts";
    in { inValue: Wrench }
    out { outForce: Vector; outTorque: Vector }
    presence strict work 6;
    c Code(r"
memcpy(outForce, inValue, 3U * sizeof outForce[0]);
memcpy(outTorque, inValue + 3, 3U * sizeof outTorque[0]);
");
    pure |(w,): (Wrench,)| (w.force, w.torque)
}

primitive! {
    /// Wrench from force (N) and torque (N m).
    WRENCH_FROM_PARTS = "Rpi::WrenchFromParts";
    in { inForce: Vector; inTorque: Vector }
    out { outValue: Wrench }
    presence strict work 6;
    c Code(r"
memcpy(outValue, inForce, 3U * sizeof outValue[0]);
memcpy(outValue + 3, inTorque, 3U * sizeof outValue[0]);
");
    pure |(force, torque): (Vector, Vector)| (Wrench { force, torque },)
}

primitive! {
    /// True if all components of both vectors are equal.
    VECTOR_EQUALS = "Rpi::VectorEquals";
    in { inFirst: Vector; inSecond: Vector }
    out { outValue: bool }
    presence strict work 3;
    c Value("rpi_equal(inFirst, inSecond, 3)");
    pure |(a, b): (Vector, Vector)| (a == b,)
}

primitive! {
    /// True if both rotations are equal; a quaternion and its negative are the same rotation.
    ROTATION_EQUALS = "Rpi::RotationEquals";
    in { inFirst: Rotation; inSecond: Rotation }
    out { outValue: bool }
    presence strict work 8;
    c Value("rpi_same_rotation(inFirst, inSecond)");
    pure |(a, b): (Rotation, Rotation)| (geometry::is_same(a, b),)
}

primitive! {
    /// True if both poses have equal position and orientation.
    FRAME_EQUALS = "Rpi::FrameEquals";
    in { inFirst: Pose; inSecond: Pose }
    out { outValue: bool }
    presence strict work 11;
    c Value("rpi_equal(inFirst, inSecond, 3) && rpi_same_rotation(inFirst + 3, inSecond + 3)");
    pure |(a, b): (Pose, Pose)| (a.translation.vector == b.translation.vector && geometry::is_same(a.rotation, b.rotation),)
}

primitive! {
    /// True if all components of both velocities are equal.
    TWIST_EQUALS = "Rpi::TwistEquals";
    in { inFirst: Twist; inSecond: Twist }
    out { outValue: bool }
    presence strict work 6;
    c Value("rpi_equal(inFirst, inSecond, 6)");
    pure |(a, b): (Twist, Twist)| (a.linear == b.linear && a.angular == b.angular,)
}

primitive! {
    /// True if all components of both wrenches are equal.
    WRENCH_EQUALS = "Rpi::WrenchEquals";
    in { inFirst: Wrench; inSecond: Wrench }
    out { outValue: bool }
    presence strict work 6;
    c Value("rpi_equal(inFirst, inSecond, 6)");
    pure |(a, b): (Wrench, Wrench)| (a.force == b.force && a.torque == b.torque,)
}
