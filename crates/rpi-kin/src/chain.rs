//! Serial chains of revolute and prismatic joints as Denavit-Hartenberg tables, and their forward kinematics.

use crate::Transform;
use crate::angle::SinCos;
use nalgebra::{Matrix3, Rotation3, Translation3, Vector3};

/// Denavit-Hartenberg convention of a table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Convention {
    /// Denavit and Hartenberg, 1955: `Rz(theta) Tz(d) Tx(a) Rx(alpha)`. The frame of a link is at its distal end.
    Standard,
    /// Craig, 1986 ("modified"): `Rx(alpha) Tx(a) Rz(theta) Tz(d)`. The frame of a link is at its own joint.
    Modified,
}

/// Twist `alpha` of a link. Sine and cosine are stored, so that multiples of 90° are exact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LinkTwist {
    sin: f64,
    cos: f64,
}

impl LinkTwist {
    /// Twist of 0 (parallel axes).
    pub const NONE: Self = Self { sin: 0.0, cos: 1.0 };
    /// Twist of 90° about x.
    pub const PLUS_90: Self = Self { sin: 1.0, cos: 0.0 };
    /// Twist of -90° about x.
    pub const MINUS_90: Self = Self {
        sin: -1.0,
        cos: 0.0,
    };

    /// Creates a twist from an angle in rad.
    #[must_use]
    pub fn from_angle(alpha: f64) -> Self {
        let SinCos { sin, cos } = SinCos::from_angle(alpha);
        Self { sin, cos }
    }
}

/// Way in which a joint moves: about its axis or along it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum JointType {
    /// Revolute joint: `theta = sense * q + offset`.
    Revolute,
    /// Prismatic joint: the offset along z is `d + sense * q`, and `theta = offset`.
    Prismatic,
}

/// Row of a Denavit-Hartenberg table.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Link {
    /// Length along x, in m.
    pub a: f64,
    /// Twist about x.
    pub alpha: LinkTwist,
    /// Offset along z, in m.
    pub d: f64,
    /// Joint angle for `q = 0`, in rad.
    pub offset: f64,
    /// +1, or -1 if the vendor defines the opposite sense of rotation.
    pub sense: f64,
    /// Whether the joint is revolute (values in rad) or prismatic (values in m).
    pub joint: JointType,
}

impl Link {
    /// Creates a row of a revolute joint without offset, in the sense of the table.
    #[must_use]
    pub const fn new(a: f64, alpha: LinkTwist, d: f64) -> Self {
        Self {
            a,
            alpha,
            d,
            offset: 0.0,
            sense: 1.0,
            joint: JointType::Revolute,
        }
    }

    /// Returns the row with a prismatic joint.
    #[must_use]
    pub const fn prismatic(self) -> Self {
        Self {
            joint: JointType::Prismatic,
            ..self
        }
    }

    /// Returns the rotation about z and the translation along z for a joint value.
    #[inline]
    fn joint_motion(&self, q: f64) -> (SinCos, f64) {
        match self.joint {
            JointType::Revolute => (SinCos::from_angle(self.sense * q + self.offset), self.d),
            JointType::Prismatic => (SinCos::from_angle(self.offset), self.d + self.sense * q),
        }
    }

    /// Returns the row with the sense and the offset (rad) of the vendor.
    #[must_use]
    pub const fn with_sense(self, sense: f64, offset: f64) -> Self {
        Self {
            sense,
            offset,
            ..self
        }
    }
}

/// Kinematic chain: one row of the Denavit-Hartenberg table per joint, and fixed rows at the end (`fixed_links`),
/// usually a flange.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Chain {
    /// Convention of the rows.
    pub convention: Convention,
    /// Rows of the joints, from the base to the flange.
    pub links: &'static [Link],
    /// Fixed rows after the last joint.
    pub fixed_links: &'static [Link],
}

impl Chain {
    /// Returns the number of joints.
    #[must_use]
    pub const fn axes(&self) -> usize {
        self.links.len()
    }

    /// Returns the pose of the flange in the base frame for the joint values `q` (rad, m). Missing values count as 0;
    /// extra values are ignored.
    #[must_use]
    pub fn flange_pose(&self, q: &[f64]) -> Transform {
        let padded = q.iter().copied().chain(core::iter::repeat(0.0));
        let joints = self.links.iter().zip(padded);
        let rows = joints.chain(self.fixed_links.iter().zip(core::iter::repeat(0.0)));
        // One loop per convention, so that the choice is not repeated for every row.
        let end = match self.convention {
            Convention::Standard => {
                rows.fold(FrameColumns::BASE, |frame, (row, q)| frame.standard(row, q))
            }
            Convention::Modified => {
                rows.fold(FrameColumns::BASE, |frame, (row, q)| frame.modified(row, q))
            }
        };
        end.transform()
    }

    /// Returns the frames of the links of all joints in the base frame, in order, without the fixed rows at the end.
    pub fn link_frames<'a>(&'a self, q: &'a [f64]) -> impl Iterator<Item = Transform> + 'a {
        self.frames(q).map(|frame| frame.transform())
    }

    /// Returns the axes of all joints in the base frame, in the positive sense of the joint values.
    pub fn axes_in_base<'a>(&'a self, q: &'a [f64]) -> impl Iterator<Item = JointAxis> + 'a {
        let mut before = FrameColumns::BASE;
        self.frames(q).zip(self.links).map(move |(after, link)| {
            // The joint of a standard row rotates about z of the previous frame, that of a modified row about z of its
            // own frame.
            let turned = if self.convention == Convention::Standard {
                before
            } else {
                after
            };
            before = after;
            JointAxis {
                point: turned.p,
                direction: turned.z * link.sense,
                joint: link.joint,
            }
        })
    }

    fn frames<'a>(&'a self, q: &'a [f64]) -> impl Iterator<Item = FrameColumns> + 'a {
        let padded = q.iter().copied().chain(core::iter::repeat(0.0));
        let mut frame = FrameColumns::BASE;
        self.links.iter().zip(padded).map(move |(link, q)| {
            frame = match self.convention {
                Convention::Standard => frame.standard(link, q),
                Convention::Modified => frame.modified(link, q),
            };
            frame
        })
    }
}

/// Axis of a joint in the base frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointAxis {
    /// Point on the axis, in m.
    pub point: Vector3<f64>,
    /// Direction of the axis: a unit vector.
    pub direction: Vector3<f64>,
    /// Whether the joint is revolute (values in rad) or prismatic (values in m).
    pub joint: JointType,
}

/// Current frame of the forward recursion: columns of its rotation and origin. Cheaper than a product of matrices,
/// because a row of the table only mixes two columns at a time.
#[derive(Clone, Copy)]
struct FrameColumns {
    x: Vector3<f64>,
    y: Vector3<f64>,
    z: Vector3<f64>,
    p: Vector3<f64>,
}

impl FrameColumns {
    const BASE: Self = Self {
        x: Vector3::new(1.0, 0.0, 0.0),
        y: Vector3::new(0.0, 1.0, 0.0),
        z: Vector3::new(0.0, 0.0, 1.0),
        p: Vector3::new(0.0, 0.0, 0.0),
    };

    #[inline]
    fn standard(self, row: &Link, q: f64) -> Self {
        let (turn, shift) = row.joint_motion(q);
        self.about_z(turn, shift).about_x(row.alpha, row.a)
    }

    #[inline]
    fn modified(self, row: &Link, q: f64) -> Self {
        let (turn, shift) = row.joint_motion(q);
        self.about_x(row.alpha, row.a).about_z(turn, shift)
    }

    #[inline]
    fn about_z(self, turn: SinCos, shift: f64) -> Self {
        Self {
            x: self.x * turn.cos + self.y * turn.sin,
            y: self.y * turn.cos - self.x * turn.sin,
            z: self.z,
            p: self.p + self.z * shift,
        }
    }

    #[inline]
    fn about_x(self, turn: LinkTwist, shift: f64) -> Self {
        Self {
            x: self.x,
            y: self.y * turn.cos + self.z * turn.sin,
            z: self.z * turn.cos - self.y * turn.sin,
            p: self.p + self.x * shift,
        }
    }

    #[inline]
    fn transform(self) -> Transform {
        let columns = Matrix3::from_columns(&[self.x, self.y, self.z]);
        Transform::from_parts(
            Translation3::from(self.p),
            Rotation3::from_matrix_unchecked(columns),
        )
    }
}
