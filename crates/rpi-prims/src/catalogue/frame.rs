//! Poses: position (m) and orientation of one frame in another. The reference system calls them frames.

use crate::geometry;
use crate::macros::primitive;
use crate::registry::Prim;
use crate::value_types::{Pose, Rotation, Twist, Vector};
use nalgebra::Translation3;

pub(super) const ALL: &[Prim] = &[
    FROM_POS_ROT,
    FROM_XYZ,
    TO_POS_ROT,
    TO_XYZ,
    INVERT,
    TRANSFORM,
    LERP,
    ADD_TWIST,
];

primitive! {
    /// Pose from position (m) and orientation.
    FROM_POS_ROT = "World::FrameFromPosRot";
    in { inPos: Vector = [super::spatial_fallbacks::XYZ]; inRot: Rotation = [super::spatial_fallbacks::ABC] }
    out { outValue: Pose }
    presence strict work 7;
    c Code(r"
memcpy(outValue, inPos, 3U * sizeof outValue[0]);
memcpy(outValue + 3, inRot, 4U * sizeof outValue[0]);
");
    pure |(position, rotation)| (pose(position, rotation),)
}

primitive! {
    /// Pose from the components of its position (m) and its orientation.
    FROM_XYZ = "World::FrameFromXYZ";
    in {
        inX: f64 = X(Real(0.0));
        inY: f64 = Y(Real(0.0));
        inZ: f64 = Z(Real(0.0));
        inRot: Rotation = [super::spatial_fallbacks::ABC]
    }
    out { outValue: Pose }
    presence strict work 7;
    c Code(r"
outValue[0] = inX;
outValue[1] = inY;
outValue[2] = inZ;
memcpy(outValue + 3, inRot, 4U * sizeof outValue[0]);
");
    pure |(x, y, z, rotation)| (pose(Vector::new(x, y, z), rotation),)
}

primitive! {
    /// Position (m) and orientation of a pose.
    TO_POS_ROT = "World::FrameToPosRot";
    in { inValue: Pose }
    out { outPosition: Vector; outRotation: Rotation }
    presence strict work 7;
    c Code(r"
memcpy(outPosition, inValue, 3U * sizeof outPosition[0]);
memcpy(outRotation, inValue + 3, 4U * sizeof outRotation[0]);
");
    pure |(p,): (Pose,)| (p.translation.vector, p.rotation)
}

primitive! {
    /// Components of the position (m) and orientation of a pose.
    TO_XYZ = "World::FrameToXYZ";
    in { inValue: Pose }
    out { outX: f64; outY: f64; outZ: f64; outRot: Rotation }
    presence strict work 7;
    c Code(r"
*outX = inValue[0];
*outY = inValue[1];
*outZ = inValue[2];
memcpy(outRot, inValue + 3, 4U * sizeof outRot[0]);
");
    pure |(p,): (Pose,)| (p.translation.x, p.translation.y, p.translation.z, p.rotation)
}

primitive! {
    /// Inverse pose: pose of A in B from the pose of B in A.
    INVERT = "World::FrameInvert";
    in { inValue: Pose }
    out { outValue: Pose }
    presence strict work 25;
    c Code("rpi_pose_inverse(inValue, outValue);");
    pure |(p,): (Pose,)| (p.inverse(),)
}

primitive! {
    /// Composition of poses: pose of C in A from the pose of B in A (`inFirst`) and the pose of C in B (`inSecond`).
    TRANSFORM = "World::FrameTransform";
    in { inFirst: Pose; inSecond: Pose }
    out { outValue: Pose }
    presence strict work 50;
    c Code("rpi_pose_compose(inFirst, inSecond, outValue);");
    pure |(a, b): (Pose, Pose)| (a * b,)
}

primitive! {
    /// Interpolation between two poses, `inFrom` for amount 0 and `inTo` for amount 1: linear in the position, along
    /// the shortest arc in the orientation.
    LERP = "World::FrameLerp";
    in { inFrom: Pose; inTo: Pose; inAmount: f64 }
    out { outValue: Pose }
    presence strict work 150;
    c Code(r"
double way[3];
rpi_difference(inTo, inFrom, 3, way);
rpi_add_scaled(inFrom, way, inAmount, 3, outValue);
rpi_interpolate_rotation(inFrom + 3, inTo + 3, inAmount, outValue + 3);
");
    pure |(from, to, amount)| (interpolate(from, to, amount),)
}

primitive! {
    /// Pose after one period of motion with the constant velocity `inTwist`. Pose and velocity are in coordinates of
    /// the base frame.
    ADD_TWIST = "World::FrameAddTwist";
    in { inFrame: Pose; inTwist: Twist }
    out { outValue: Pose }
    presence strict work 90;
    c Code("rpi_integrate_pose(inFrame, inTwist, rpi_dt, outValue);");
    full |cx, _, _, _, (frame, twist)| (integrate(frame, twist, cx.time.dt),)
}

/// Creates a pose from position and orientation.
pub(super) fn pose(position: Vector, rotation: Rotation) -> Pose {
    Pose::from_parts(Translation3::from(position), rotation)
}

/// Interpolates between two poses, `from` for amount 0 and `to` for amount 1: linear in the position, along the
/// shortest arc in the orientation.
pub(super) fn interpolate(from: Pose, to: Pose, amount: f64) -> Pose {
    let (p, q) = (from.translation.vector, to.translation.vector);
    pose(
        p + (q - p) * amount,
        geometry::slerp(from.rotation, to.rotation, amount),
    )
}

/// Returns the pose after `dt` seconds of motion from `frame` with the constant velocity `twist` in base coordinates.
pub(crate) fn integrate(frame: Pose, twist: Twist, dt: f64) -> Pose {
    let position = frame.translation.vector + twist.linear * dt;
    pose(position, geometry::exp(twist.angular * dt) * frame.rotation)
}
