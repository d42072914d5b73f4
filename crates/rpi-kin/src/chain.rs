//! Serial chains of revolute and prismatic joints as Denavit-Hartenberg tables, and their forward kinematics.

use crate::Transform;
use crate::angle::SinCos;
use core::f64::consts::FRAC_PI_2;
use nalgebra::{Matrix3, Rotation3, Translation3, Vector3};

/// Convention for the order of the four Denavit-Hartenberg transforms in a row of the table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Convention {
    /// Denavit and Hartenberg, 1955: `Rz(theta) Tz(d) Tx(a) Rx(alpha)`. The frame of a link is at its distal end.
    Standard,
    /// Craig, 1986 ("modified"): `Rx(alpha) Tx(a) Rz(theta) Tz(d)`. The frame of a link is at its own joint.
    Modified,
}

/// Twist `alpha` of a link: the angle about x between the z axes of two rows. Stored as sine and cosine, so that
/// multiples of 90° are exact.
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

    /// Creates a twist from an angle in rad. An angle within 1e-12 rad of a multiple of 90° becomes that multiple
    /// exactly.
    #[must_use]
    pub fn from_angle(alpha: f64) -> Self {
        let quarters = libm::rint(alpha / FRAC_PI_2);
        let SinCos { sin, cos } = SinCos::from_angle(alpha);
        match libm::fabs(alpha - quarters * FRAC_PI_2) < 1e-12 {
            true => Self {
                sin: libm::rint(sin),
                cos: libm::rint(cos),
            },
            false => Self { sin, cos },
        }
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

/// Row of a Denavit-Hartenberg table: one joint and its link, with an optional fixed transform before them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Link {
    /// Fixed transform from the frame of the previous row to the frame in which this row begins; `None` for the
    /// identity. Rows from descriptions that place joints freely, such as URDF, use this transform, because the four
    /// Denavit-Hartenberg parameters are badly conditioned for axes that are nearly parallel.
    pub before: Option<&'static Transform>,
    /// Denavit-Hartenberg parameter `a`: translation along x, in m.
    pub a: f64,
    /// Denavit-Hartenberg parameter `alpha`: rotation about x.
    pub alpha: LinkTwist,
    /// Denavit-Hartenberg parameter `d`: translation along z, in m.
    pub d: f64,
    /// Angle `theta` about z at joint value 0, in rad.
    pub offset: f64,
    /// Sense of the joint value: +1, or -1 if the vendor counts the value in the opposite direction.
    pub sense: f64,
    /// Kind of the joint: revolute (values in rad) or prismatic (values in m).
    pub joint: JointType,
}

impl Link {
    /// Creates a row of a revolute joint from `a` (m), `alpha` and `d` (m), with offset 0 and sense +1.
    #[must_use]
    pub const fn new(a: f64, alpha: LinkTwist, d: f64) -> Self {
        Self {
            before: None,
            a,
            alpha,
            d,
            offset: 0.0,
            sense: 1.0,
            joint: JointType::Revolute,
        }
    }

    /// Creates a row of a revolute joint about z of the frame that `before` places in the frame of the previous row.
    #[must_use]
    pub const fn placed(before: &'static Transform) -> Self {
        Self {
            before: Some(before),
            ..Self::new(0.0, LinkTwist::NONE, 0.0)
        }
    }

    /// Returns the length of the row in m: an upper bound of the distance from its frame to that of the previous row,
    /// without the travel of a prismatic joint.
    #[must_use]
    pub fn length(&self) -> f64 {
        let before = self
            .before
            .map_or(0.0, |before| before.translation.vector.norm());
        before + libm::fabs(self.a) + libm::fabs(self.d)
    }

    /// Returns the row with its joint changed to a prismatic one.
    #[must_use]
    pub const fn prismatic(self) -> Self {
        Self {
            joint: JointType::Prismatic,
            ..self
        }
    }

    /// Returns, for a joint value `q` (rad or m), sine and cosine of the rotation about z, and the translation along z
    /// in m.
    #[inline]
    fn joint_motion(&self, q: f64) -> (SinCos, f64) {
        match self.joint {
            JointType::Revolute => (SinCos::from_angle(self.sense * q + self.offset), self.d),
            JointType::Prismatic => (SinCos::from_angle(self.offset), self.d + self.sense * q),
        }
    }

    /// Returns the row with this sense (+1 or -1) and this offset (rad) of the joint value.
    #[must_use]
    pub const fn with_sense(self, sense: f64, offset: f64) -> Self {
        Self {
            sense,
            offset,
            ..self
        }
    }
}

/// Kinematic chain: one row of a Denavit-Hartenberg table per joint, and fixed rows after the last joint
/// (`fixed_links`), usually a flange.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Chain {
    /// Denavit-Hartenberg convention of all rows.
    pub convention: Convention,
    /// Rows of the joints, in order from the base to the flange.
    pub links: &'static [Link],
    /// Rows after the last joint, each evaluated at joint value 0.
    pub fixed_links: &'static [Link],
}

impl Chain {
    /// Returns the number of joints of the chain.
    #[must_use]
    pub const fn axes(&self) -> usize {
        self.links.len()
    }

    /// Returns the sum of the lengths of all rows in m: an upper bound of the distance from the base to the flange,
    /// without the travel of prismatic joints.
    #[must_use]
    pub fn length(&self) -> f64 {
        let rows = self.links.iter().chain(self.fixed_links);
        rows.map(Link::length).sum()
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

    /// Returns the frames of the links of all joints in the base frame for the joint values `q` (rad, m), in order from
    /// the base, without the fixed rows at the end.
    pub fn link_frames<'a>(&'a self, q: &'a [f64]) -> impl Iterator<Item = Transform> + 'a {
        self.frames(q).map(|frame| frame.transform())
    }

    /// Returns the axes of all joints in the base frame for the joint values `q` (rad, m), directed in the positive
    /// sense of the joint values.
    pub fn axes_in_base<'a>(&'a self, q: &'a [f64]) -> impl Iterator<Item = JointAxis> + 'a {
        let mut previous = FrameColumns::BASE;
        self.frames(q).zip(self.links).map(move |(after, link)| {
            // The joint of a standard row rotates about z of the frame in which the row begins, that of a modified row
            // about z of its own frame.
            let turned = if self.convention == Convention::Standard {
                previous.before(link)
            } else {
                after
            };
            previous = after;
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

/// Axis of rotation or translation of a joint, in the base frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointAxis {
    /// Point on the axis, in the base frame, in m.
    pub point: Vector3<f64>,
    /// Direction of the axis in the base frame: a unit vector.
    pub direction: Vector3<f64>,
    /// Kind of the joint: revolute (values in rad) or prismatic (values in m).
    pub joint: JointType,
}

/// Frame of a link during forward kinematics: columns of its rotation matrix, and its origin in m, in the base frame.
/// Cheaper than a product of matrices, because a row of the table mixes only two columns at a time.
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
        self.before(row)
            .about_z(turn, shift)
            .about_x(row.alpha, row.a)
    }

    #[inline]
    fn modified(self, row: &Link, q: f64) -> Self {
        let (turn, shift) = row.joint_motion(q);
        self.before(row)
            .about_x(row.alpha, row.a)
            .about_z(turn, shift)
    }

    /// Returns the frame in which `row` begins: this frame moved by the fixed transform of the row.
    #[inline]
    fn before(self, row: &Link) -> Self {
        row.before.map_or(self, |placed| self.placed(placed))
    }

    /// Returns the frame whose pose relative to this frame is `placed`.
    fn placed(self, placed: &Transform) -> Self {
        let along = |v: Vector3<f64>| self.x * v.x + self.y * v.y + self.z * v.z;
        let axes = placed.rotation.matrix();
        Self {
            x: along(axes.column(0).into()),
            y: along(axes.column(1).into()),
            z: along(axes.column(2).into()),
            p: self.p + along(placed.translation.vector),
        }
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
