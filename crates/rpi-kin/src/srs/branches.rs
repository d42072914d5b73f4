//! The eight solutions for one pose and one position of the elbow.

use super::{Joints, Reach};
use crate::angle::HALF_TURN;
use crate::ball::{self, Ball, STRAIGHT};
use nalgebra::Vector3;

/// One of the eight solutions, identified by the axes (2, 4, 6) that bend in the negative sense of the canonical chain.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Branch(u8);

impl Branch {
    /// All eight branches. The first one has no negative bend.
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

    /// Returns the index in [`ALL`](Self::ALL).
    #[must_use]
    pub const fn index(self) -> usize {
        self.0 as usize
    }

    /// Returns whether axis 2 (shoulder) bends in the negative sense.
    #[must_use]
    pub const fn shoulder(self) -> bool {
        self.0 & 1 != 0
    }

    /// Returns whether axis 4 (elbow) bends in the negative sense.
    #[must_use]
    pub const fn elbow(self) -> bool {
        self.0 & 2 != 0
    }

    /// Returns whether axis 6 (wrist) bends in the negative sense.
    #[must_use]
    pub const fn wrist(self) -> bool {
        self.0 & 4 != 0
    }

    /// Returns the canonical angles of this branch from those of the first one, not wrapped. The opposite bend needs
    /// half a turn of both adjacent axes.
    #[must_use]
    pub fn of(self, first: &Joints) -> Joints {
        let bend = |negative: bool, angle: f64| if negative { -angle } else { angle };
        let turn = |one: bool, other: bool, angle: f64| {
            if one == other {
                angle
            } else {
                angle + HALF_TURN
            }
        };
        [
            turn(self.shoulder(), false, first[0]),
            bend(self.shoulder(), first[1]),
            turn(self.shoulder(), self.elbow(), first[2]),
            bend(self.elbow(), first[3]),
            turn(self.elbow(), self.wrist(), first[4]),
            bend(self.wrist(), first[5]),
            turn(self.wrist(), false, first[6]),
        ]
    }
}

/// Returns the canonical angles of the first branch, for a pose and the direction of the elbow from the line (a unit
/// vector). Angles that the pose does not determine, next to a straight shoulder, elbow or wrist, are taken from `hint`
/// (canonical angles).
///
/// Each joint is computed from the remaining rotation after the previous joints. Near a straight joint the single
/// angles are ill-conditioned, but a later joint compensates the error of an earlier one, so that the pose stays exact.
#[must_use]
pub fn first_branch(reach: &Reach, elbow: &Vector3<f64>, hint: &Joints) -> Joints {
    let upper = reach.axis * reach.lift.cos + elbow * reach.lift.sin;
    let shoulder = Ball::towards(&upper, hint[0]);
    let fore = shoulder.undo(&forearm(reach, elbow));
    let p3 = if reach.bend.sin > STRAIGHT {
        libm::atan2(fore.y, fore.x)
    } else {
        hint[2]
    };
    let p4 = libm::atan2(reach.bend.sin, reach.bend.cos);
    let elbow = Ball {
        bent: reach.bend,
        ..Ball::of(p3, p4)
    };
    let seen = |column: usize| elbow.undo(&shoulder.undo(&reach.flange.column(column).into()));
    let [p5, p6, p7] = ball::angles(&seen(0), &seen(2), hint[4]);
    [shoulder.turn, shoulder.bend, p3, p4, p5, p6, p7]
}

/// Returns the direction of the forearm.
fn forearm(reach: &Reach, elbow: &Vector3<f64>) -> Vector3<f64> {
    let tilt = reach.lift.minus(reach.bend);
    reach.axis * tilt.cos + elbow * tilt.sin
}
