//! Rotations. They are stored as unit quaternions; only these conversions use Euler angles a, b, c (about z, the new y
//! and the new x, in rad).

use crate::geometry;
use crate::macros::primitive;
use crate::registry::Prim;
use crate::value_types::{Rotation, Vector};

pub(super) const ALL: &[Prim] = &[
    FROM_ABC,
    TO_ABC,
    FROM_AXIS_ANGLE,
    TO_AXIS_ANGLE,
    FROM_QUATERNION,
    TO_QUATERNION,
    INVERT,
    TRANSFORM,
];

primitive! {
    /// Rotation from Euler angles in rad: by `inA` about z, then by `inB` about the new y, then by `inC` about the new
    /// x.
    FROM_ABC = "World::RotationFromABC";
    in { inA: f64 = A(Real(0.0)); inB: f64 = B(Real(0.0)); inC: f64 = C(Real(0.0)) }
    out { outValue: Rotation }
    presence strict work 80;
    c Code("rpi_from_abc(inA, inB, inC, outValue);");
    pure |(a, b, c)| (geometry::from_abc(a, b, c),)
}

primitive! {
    /// Euler angles of a rotation in rad (about z, the new y and the new x). `outB` lies between -π/2 and π/2; at these
    /// limits (gimbal lock) `outC` is 0.
    TO_ABC = "World::RotationToABC";
    in { inValue: Rotation }
    out { outA: f64; outB: f64; outC: f64 }
    presence strict work 100;
    c Code(r"
double abc[3];
rpi_to_abc(inValue, abc);
*outA = abc[0];
*outB = abc[1];
*outC = abc[2];
");
    pure |(rotation,)| geometry::to_abc(rotation)
}

primitive! {
    /// Rotation by `inAngle` (rad) about `inAxis`, which should be a unit vector: its length scales the angle.
    FROM_AXIS_ANGLE = "World::RotationFromAxisAngle";
    in { inAxis: Vector = [super::spatial_fallbacks::AXIS]; inAngle: f64 = Angle(Real(0.0)) }
    out { outValue: Rotation }
    presence strict work 50;
    c Code(r"
double vector[3];
rpi_scaled(inAxis, inAngle, 3, vector);
rpi_from_axis(vector, outValue);
");
    pure |(axis, angle): (Vector, f64)| (geometry::exp(axis * angle),)
}

primitive! {
    /// Unit axis and angle (rad, 0 to π) of a rotation. The axis is x for the identity.
    TO_AXIS_ANGLE = "World::RotationToAxisAngle";
    in { inValue: Rotation }
    out { outAxis: Vector; outAngle: f64 }
    presence strict work 50;
    c Code("*outAngle = rpi_to_axis(inValue, outAxis);");
    pure |(rotation,)| geometry::to_axis_angle(rotation)
}

primitive! {
    /// Rotation from a quaternion, which is normalised. The zero quaternion gives the identity.
    FROM_QUATERNION = "World::RotationFromQuaternion";
    in {
        inX: f64 = X(Real(1.0));
        inY: f64 = Y(Real(0.0));
        inZ: f64 = Z(Real(0.0));
        inW: f64 = W(Real(0.0))
    }
    out { outValue: Rotation }
    presence strict work 16;
    c Code("rpi_from_quaternion(inX, inY, inZ, inW, outValue);");
    pure |(x, y, z, w)| (geometry::from_quaternion(x, y, z, w),)
}

primitive! {
    /// Unit quaternion of a rotation, with `outW` not negative.
    TO_QUATERNION = "World::RotationToQuaternion";
    in { inValue: Rotation }
    out { outX: f64; outY: f64; outZ: f64; outW: f64 }
    presence strict work 6;
    c Code(r"
const double sign = inValue[3] < 0.0 ? -1.0 : 1.0;
*outX = inValue[0] * sign;
*outY = inValue[1] * sign;
*outZ = inValue[2] * sign;
*outW = inValue[3] * sign;
");
    pure |(r,): (Rotation,)| {
        let sign = if r.w < 0.0 { -1.0 } else { 1.0 };
        (r.i * sign, r.j * sign, r.k * sign, r.w * sign)
    }
}

primitive! {
    /// Inverse of a rotation.
    INVERT = "World::RotationInvert";
    in { inValue: Rotation }
    out { outValue: Rotation }
    presence strict work 3;
    c Code("rpi_inverse(inValue, outValue);");
    pure |(rotation,): (Rotation,)| (rotation.inverse(),)
}

primitive! {
    /// Composition of rotations: `inFirst`, then `inSecond` in the rotated frame.
    TRANSFORM = "World::RotationTransform";
    in { inFirst: Rotation; inSecond: Rotation }
    out { outValue: Rotation }
    presence strict work 28;
    c Code("rpi_compose(inFirst, inSecond, outValue);");
    pure |(a, b): (Rotation, Rotation)| (a * b,)
}
