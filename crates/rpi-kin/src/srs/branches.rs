//! The eight solutions for one pose and one position of the elbow.

use super::{ElbowTriangle, Joints};
use crate::angle::HALF_TURN;
use crate::spherical_joint::{self, STRAIGHT_TOLERANCE, SphericalJoint};
use nalgebra::Vector3;

/// One of the eight solutions of the inverse kinematics for one position of the elbow, identified by the axes among 2,
/// 4 and 6 that bend in the negative sense of the canonical chain.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Branch(u8);

impl Branch {
    /// All eight branches. In the first one, no axis has a negative bend.
    pub const ALL: [Self; 8] = [
        Self(0),
        Self(1),
        Self(2),
        Self(3),
        Self(4),
        Self(5),
        Self(6),
        Self(7),
    ];

    /// Returns the branch to which these canonical angles (rad) belong: that of the senses of their bends.
    #[must_use]
    pub fn of(joints: &Joints) -> Self {
        let negative = |axis: usize, bit: u8| if joints[axis] < 0.0 { bit } else { 0 };
        Self(negative(1, 1) | negative(3, 2) | negative(5, 4))
    }

    /// Returns the index of the branch in [`ALL`](Self::ALL), from 0 to 7.
    #[must_use]
    pub const fn index(self) -> usize {
        self.0 as usize
    }

    /// Returns true if axis 2 (shoulder) bends in the negative sense.
    #[must_use]
    pub const fn is_shoulder_negative(self) -> bool {
        self.0 & 1 != 0
    }

    /// Returns true if axis 4 (elbow) bends in the negative sense.
    #[must_use]
    pub const fn is_elbow_negative(self) -> bool {
        self.0 & 2 != 0
    }

    /// Returns true if axis 6 (wrist) bends in the negative sense.
    #[must_use]
    pub const fn is_wrist_negative(self) -> bool {
        self.0 & 4 != 0
    }

    /// Returns the canonical angles (rad, not wrapped) of this branch, computed from those of the first branch: each
    /// opposite bend turns both adjacent axes by half a turn.
    #[must_use]
    pub fn apply(self, first: &Joints) -> Joints {
        let bend = |negative: bool, angle: f64| if negative { -angle } else { angle };
        let turn = |one: bool, other: bool, angle: f64| {
            if one == other {
                angle
            } else {
                angle + HALF_TURN
            }
        };
        [
            turn(self.is_shoulder_negative(), false, first[0]),
            bend(self.is_shoulder_negative(), first[1]),
            turn(
                self.is_shoulder_negative(),
                self.is_elbow_negative(),
                first[2],
            ),
            bend(self.is_elbow_negative(), first[3]),
            turn(self.is_elbow_negative(), self.is_wrist_negative(), first[4]),
            bend(self.is_wrist_negative(), first[5]),
            turn(self.is_wrist_negative(), false, first[6]),
        ]
    }
}

/// Returns the canonical angles (`sense * joint value`, rad) of the first branch, in which no bend is negative. `reach`
/// is the triangle of the pose, `elbow` the unit vector from the line shoulder-wrist to the elbow. Angles that the pose
/// does not determine, next to a straight shoulder, elbow or wrist, are taken from `hint` (canonical angles, rad).
///
/// Each joint is computed from the remaining rotation after the previous joints. Near a straight joint the single
/// angles are ill-conditioned, but a later joint compensates the error of an earlier one, so that the pose stays exact.
#[must_use]
pub fn first_branch(reach: &ElbowTriangle, elbow: &Vector3<f64>, hint: &Joints) -> Joints {
    let upper = reach.line * reach.shoulder_angle.cos + elbow * reach.shoulder_angle.sin;
    let shoulder = SphericalJoint::pointing_at(&upper, hint[0]);
    let fore = shoulder.inverse_rotate(&forearm(reach, elbow));
    let p3 = if reach.elbow_bend.sin > STRAIGHT_TOLERANCE {
        rpi_math::atan2(fore.y, fore.x)
    } else {
        hint[2]
    };
    let p4 = rpi_math::atan2(reach.elbow_bend.sin, reach.elbow_bend.cos);
    let elbow = SphericalJoint {
        bend_sin_cos: reach.elbow_bend,
        ..SphericalJoint::new(p3, p4)
    };
    let seen = |column: usize| {
        elbow.inverse_rotate(&shoulder.inverse_rotate(&reach.flange_rotation.column(column).into()))
    };
    let [p5, p6, p7] = spherical_joint::zyz_angles(&seen(0), &seen(2), hint[4]);
    [shoulder.turn, shoulder.bend, p3, p4, p5, p6, p7]
}

/// Returns the direction of the forearm, from elbow to wrist, in the base frame: a unit vector. `elbow` is the unit
/// vector from the line shoulder-wrist to the elbow.
fn forearm(reach: &ElbowTriangle, elbow: &Vector3<f64>) -> Vector3<f64> {
    let tilt = reach.shoulder_angle.difference(reach.elbow_bend);
    reach.line * tilt.cos + elbow * tilt.sin
}
