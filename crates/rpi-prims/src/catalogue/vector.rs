//! Vectors: positions in m, or directions.

use crate::macros::primitive;
use crate::registry::Prim;
use crate::value_types::{Rotation, Vector};

pub(super) const ALL: &[Prim] = &[ADD, CROSS, DOT, SCALE, ROTATE, FROM_XYZ, TO_XYZ];

primitive! {
    /// Sum of two vectors.
    ADD = "World::VectorAdd";
    in { inFirst: Vector; inSecond: Vector }
    out { outValue: Vector }
    presence strict work 3;
    c Code("rpi_sum(inFirst, inSecond, 3, outValue);");
    pure |(a, b)| (a + b,)
}

primitive! {
    /// Cross product of two vectors.
    CROSS = "World::VectorCross";
    in { inFirst: Vector; inSecond: Vector }
    out { outValue: Vector }
    presence strict work 9;
    c Code("rpi_cross(inFirst, inSecond, outValue);");
    pure |(a, b): (Vector, Vector)| (a.cross(&b),)
}

primitive! {
    /// Scalar product of two vectors.
    DOT = "World::VectorDot";
    in { inFirst: Vector; inSecond: Vector }
    out { outValue: f64 }
    presence strict work 5;
    c Value("rpi_dot(inFirst, inSecond)");
    pure |(a, b): (Vector, Vector)| (a.dot(&b),)
}

primitive! {
    /// Product of a vector and a real.
    SCALE = "World::VectorScale";
    in { inValue: Vector; inFactor: f64 = Factor(Real(1.0)) }
    out { outValue: Vector }
    presence strict work 3;
    c Code("rpi_scaled(inValue, inFactor, 3, outValue);");
    pure |(v, factor): (Vector, f64)| (v * factor,)
}

primitive! {
    /// Vector rotated by `inRot`: transforms coordinates of the rotated frame to coordinates of the base frame.
    ROTATE = "World::VectorRotate";
    in { inValue: Vector; inRot: Rotation }
    out { outValue: Vector }
    presence strict work 20;
    c Code("rpi_rotate(inRot, inValue, outValue);");
    pure |(v, rotation): (Vector, Rotation)| (rotation * v,)
}

primitive! {
    /// Vector from its components.
    FROM_XYZ = "World::VectorFromXYZ";
    in { inX: f64 = X(Real(0.0)); inY: f64 = Y(Real(0.0)); inZ: f64 = Z(Real(0.0)) }
    out { outValue: Vector }
    presence strict work 3;
    c Code(r"
outValue[0] = inX;
outValue[1] = inY;
outValue[2] = inZ;
");
    pure |(x, y, z)| (Vector::new(x, y, z),)
}

primitive! {
    /// Components of a vector.
    TO_XYZ = "World::VectorToXYZ";
    in { inValue: Vector }
    out { outX: f64; outY: f64; outZ: f64 }
    presence strict work 3;
    c Code(r"
*outX = inValue[0];
*outY = inValue[1];
*outZ = inValue[2];
");
    pure |(v,): (Vector,)| (v.x, v.y, v.z)
}
