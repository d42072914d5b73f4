//! Kinematics of a description before its model is made: rows, joints and their limits, as far as the file has them.

use rpi_kin::chain::JointType;
use rpi_kin::{Convention, InverseKinematics, Link, MAX_AXES, Transform};

/// Row of a Denavit-Hartenberg table, with an optional fixed transform before it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Row {
    pub(super) before: Option<Transform>,
    pub(super) link: Link,
}

impl Row {
    pub(super) fn new(link: Link) -> Self {
        Self { before: None, link }
    }

    /// Creates the row of a joint that turns about z, or moves along z, of the frame that `before` places in the frame
    /// of the previous row.
    pub(super) fn placed(before: Transform, joint: JointType) -> Self {
        let plain = Link::new(0.0, rpi_kin::chain::LinkTwist::NONE, 0.0);
        let link = Link { joint, ..plain };
        let before = Some(before).filter(|before| *before != Transform::identity());
        Self { before, link }
    }
}

/// Limits of a joint as far as a description gives them, in rad and s (m and s for a linear joint); `None` if unknown.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct KnownLimits {
    pub(super) lower: Option<f64>,
    pub(super) upper: Option<f64>,
    pub(super) velocity: Option<f64>,
    pub(super) acceleration: Option<f64>,
    pub(super) jerk: Option<f64>,
}

/// Movable joint of a robot description.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Joint {
    pub(super) name: String,
    pub(super) kind: JointType,
    pub(super) limits: KnownLimits,
    /// True if the joint turns without end, so that its range is assumed.
    pub(super) is_continuous: bool,
}

impl Joint {
    /// Creates a joint without known limits.
    pub(super) fn new(name: String, kind: JointType) -> Self {
        Self {
            name,
            kind,
            limits: KnownLimits::default(),
            is_continuous: false,
        }
    }

    /// Returns the joints of robots with the most and the fewest axes, of different types. What they accept together,
    /// the schema accepts.
    pub(super) fn extremes() -> [Vec<Self>; 2] {
        let of = |kind, count| vec![Self::new(String::new(), kind); count];
        [
            of(JointType::Revolute, MAX_AXES),
            of(JointType::Prismatic, 1),
        ]
    }
}

/// Kinematics of a robot as read from a description, before a model is made of them.
#[derive(Clone, Debug)]
pub(super) struct Kinematics {
    pub(super) convention: Convention,
    pub(super) rows: Vec<Row>,
    pub(super) flange: Vec<Row>,
    pub(super) joints: Vec<Joint>,
    /// Closed form of the inverse kinematics; `None` if none is known for these kinematics.
    pub(super) inverse: Option<InverseKinematics>,
    pub(super) meshes: Vec<super::Mesh>,
    /// Name of the robot in the file; `None` if the file gives none.
    pub(super) name: Option<String>,
}
