//! Poses: position (m) and orientation of one frame in another. The reference system calls them frames.

use crate::flow::{Pose, Rotation, Twist, Vector};
use crate::geometry;
use crate::macros::primitive;
use crate::registry::Prim;
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
    /// A pose from position and orientation.
    FROM_POS_ROT = "World::FrameFromPosRot";
    in { inPos: Vector = [super::spatial::XYZ]; inRot: Rotation = [super::spatial::ABC] }
    out { outValue: Pose }
    presence strict work 7;
    pure |(position, rotation)| (pose(position, rotation),)
}

primitive! {
    /// A pose from the components of its position and its orientation.
    FROM_XYZ = "World::FrameFromXYZ";
    in {
        inX: f64 = X(Real(0.0));
        inY: f64 = Y(Real(0.0));
        inZ: f64 = Z(Real(0.0));
        inRot: Rotation = [super::spatial::ABC]
    }
    out { outValue: Pose }
    presence strict work 7;
    pure |(x, y, z, rotation)| (pose(Vector::new(x, y, z), rotation),)
}

primitive! {
    /// Position and orientation of a pose.
    TO_POS_ROT = "World::FrameToPosRot";
    in { inValue: Pose }
    out { outPosition: Vector; outRotation: Rotation }
    presence strict work 7;
    pure |(p,): (Pose,)| (p.translation.vector, p.rotation)
}

primitive! {
    /// Components of the position and orientation of a pose.
    TO_XYZ = "World::FrameToXYZ";
    in { inValue: Pose }
    out { outX: f64; outY: f64; outZ: f64; outRot: Rotation }
    presence strict work 7;
    pure |(p,): (Pose,)| (p.translation.x, p.translation.y, p.translation.z, p.rotation)
}

primitive! {
    /// The pose of the other frame in the one.
    INVERT = "World::FrameInvert";
    in { inValue: Pose }
    out { outValue: Pose }
    presence strict work 25;
    pure |(p,): (Pose,)| (p.inverse(),)
}

primitive! {
    /// Pose of C in A from that of B in A and of C in B.
    TRANSFORM = "World::FrameTransform";
    in { inFirst: Pose; inSecond: Pose }
    out { outValue: Pose }
    presence strict work 50;
    pure |(a, b): (Pose, Pose)| (a * b,)
}

primitive! {
    /// Pose on the way from one (amount 0) to another (amount 1): position on the line, orientation on the shortest arc.
    LERP = "World::FrameLerp";
    in { inFrom: Pose; inTo: Pose; inAmount: f64 }
    out { outValue: Pose }
    presence strict work 150;
    pure |(from, to, amount)| (between(from, to, amount),)
}

primitive! {
    /// The pose after one period of a constant velocity, both in base coordinates.
    ADD_TWIST = "World::FrameAddTwist";
    in { inFrame: Pose; inTwist: Twist }
    out { outValue: Pose }
    presence strict work 90;
    full |cx, _, _, _, (frame, twist)| (moved(frame, twist, cx.clock.dt),)
}

/// A pose from its parts.
pub(super) fn pose(position: Vector, rotation: Rotation) -> Pose {
    Pose::from_parts(Translation3::from(position), rotation)
}

/// Position on the line, orientation on the shortest arc.
pub(super) fn between(from: Pose, to: Pose, amount: f64) -> Pose {
    let (p, q) = (from.translation.vector, to.translation.vector);
    pose(
        p + (q - p) * amount,
        geometry::slerp(from.rotation, to.rotation, amount),
    )
}

/// The pose after `dt` seconds of a velocity in base coordinates.
pub(crate) fn moved(frame: Pose, twist: Twist, dt: f64) -> Pose {
    let position = frame.translation.vector + twist.linear * dt;
    pose(position, geometry::exp(twist.angular * dt) * frame.rotation)
}
