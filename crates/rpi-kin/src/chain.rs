//! Serial chains of joints that turn or slide, written down as Denavit-Hartenberg tables, and their forward kinematics.

use crate::Transform;
use crate::angle::SinCos;
use nalgebra::{Matrix3, Rotation3, Translation3, Vector3};

/// Which of the two Denavit-Hartenberg conventions a table uses.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Convention {
    /// Denavit and Hartenberg 1955: `Rz(theta) Tz(d) Tx(a) Rx(alpha)`; a link's frame stands at its far end.
    Standard,
    /// Craig 1986 ("modified"): `Rx(alpha) Tx(a) Rz(theta) Tz(d)`; a link's frame stands on its own joint.
    Modified,
}

/// The twist `alpha` of a link, as sine and cosine so that quarter turns are exact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Twist {
    sin: f64,
    cos: f64,
}

impl Twist {
    /// Parallel axes.
    pub const NONE: Self = Self { sin: 0.0, cos: 1.0 };
    /// A quarter turn about x.
    pub const PLUS_90: Self = Self { sin: 1.0, cos: 0.0 };
    /// A quarter turn about x, the other way.
    pub const MINUS_90: Self = Self {
        sin: -1.0,
        cos: 0.0,
    };

    /// Any other angle in radians.
    #[must_use]
    pub fn of(alpha: f64) -> Self {
        let SinCos { sin, cos } = SinCos::of(alpha);
        Self { sin, cos }
    }
}

/// What a joint does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Joint {
    /// It turns about its axis: `theta = sense * q + offset`.
    Turns,
    /// It slides along its axis: `d` grows by `sense * q`, and `theta = offset`.
    Slides,
}

/// One row of a Denavit-Hartenberg table.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Link {
    /// Length along x, in m.
    pub a: f64,
    /// Twist about x.
    pub alpha: Twist,
    /// Offset along z, in m.
    pub d: f64,
    /// Joint angle at `q = 0`, in rad.
    pub offset: f64,
    /// +1, or -1 where the vendor counts the axis the other way round.
    pub sense: f64,
    /// Whether it turns or slides.
    pub joint: Joint,
}

impl Link {
    /// A row without offset, turning in the sense of the table.
    #[must_use]
    pub const fn new(a: f64, alpha: Twist, d: f64) -> Self {
        Self {
            a,
            alpha,
            d,
            offset: 0.0,
            sense: 1.0,
            joint: Joint::Turns,
        }
    }

    /// The same row with a joint that slides.
    #[must_use]
    pub const fn sliding(self) -> Self {
        Self {
            joint: Joint::Slides,
            ..self
        }
    }

    /// The turn about z and the shift along it for a joint value.
    #[inline]
    fn moved(&self, q: f64) -> (SinCos, f64) {
        match self.joint {
            Joint::Turns => (SinCos::of(self.sense * q + self.offset), self.d),
            Joint::Slides => (SinCos::of(self.offset), self.d + self.sense * q),
        }
    }

    /// The same row with the vendor's zero and sense of rotation.
    #[must_use]
    pub const fn counted(self, sense: f64, offset: f64) -> Self {
        Self {
            sense,
            offset,
            ..self
        }
    }
}

/// A chain: one row for each joint and fixed rows at the end (`tail`), usually a flange.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Chain {
    /// How the rows are meant.
    pub convention: Convention,
    /// One row for each joint, from the base on.
    pub links: &'static [Link],
    /// Fixed rows after the last joint.
    pub tail: &'static [Link],
}

impl Chain {
    /// The number of joints.
    #[must_use]
    pub const fn axes(&self) -> usize {
        self.links.len()
    }

    /// The flange in the base for the joint values `q` (rad, m). Missing values count as zero, surplus ones are ignored.
    #[must_use]
    pub fn flange(&self, q: &[f64]) -> Transform {
        let padded = q.iter().copied().chain(core::iter::repeat(0.0));
        let joints = self.links.iter().zip(padded);
        let rows = joints.chain(self.tail.iter().zip(core::iter::repeat(0.0)));
        // One loop for each convention: the choice is not made again on every row.
        let end = match self.convention {
            Convention::Standard => {
                rows.fold(Moving::BASE, |frame, (row, q)| frame.standard(row, q))
            }
            Convention::Modified => {
                rows.fold(Moving::BASE, |frame, (row, q)| frame.modified(row, q))
            }
        };
        end.transform()
    }

    /// The frame of each link in the base, one for each joint, in order (the tail left out).
    pub fn link_frames<'a>(&'a self, q: &'a [f64]) -> impl Iterator<Item = Transform> + 'a {
        self.frames(q).map(|frame| frame.transform())
    }

    /// The axis of each joint in the base, in the sense in which q counts.
    pub fn axes_in_base<'a>(&'a self, q: &'a [f64]) -> impl Iterator<Item = Axis> + 'a {
        let mut before = Moving::BASE;
        self.frames(q).zip(self.links).map(move |(after, link)| {
            // Standard rows turn about the z of the frame before them, modified rows about their own.
            let turned = if self.convention == Convention::Standard {
                before
            } else {
                after
            };
            before = after;
            Axis {
                point: turned.p,
                direction: turned.z * link.sense,
                joint: link.joint,
            }
        })
    }

    fn frames<'a>(&'a self, q: &'a [f64]) -> impl Iterator<Item = Moving> + 'a {
        let padded = q.iter().copied().chain(core::iter::repeat(0.0));
        let mut frame = Moving::BASE;
        self.links.iter().zip(padded).map(move |(link, q)| {
            frame = match self.convention {
                Convention::Standard => frame.standard(link, q),
                Convention::Modified => frame.modified(link, q),
            };
            frame
        })
    }
}

/// The axis of a joint in the base.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Axis {
    /// A point on it, in m.
    pub point: Vector3<f64>,
    /// Its direction: a unit vector.
    pub direction: Vector3<f64>,
    /// What the joint does about or along it.
    pub joint: Joint,
}

/// A frame on its way along the chain: the columns of its rotation and its origin. Cheaper than multiplying matrices,
/// because a row of the table only mixes two columns at a time.
#[derive(Clone, Copy)]
struct Moving {
    x: Vector3<f64>,
    y: Vector3<f64>,
    z: Vector3<f64>,
    p: Vector3<f64>,
}

impl Moving {
    const BASE: Self = Self {
        x: Vector3::new(1.0, 0.0, 0.0),
        y: Vector3::new(0.0, 1.0, 0.0),
        z: Vector3::new(0.0, 0.0, 1.0),
        p: Vector3::new(0.0, 0.0, 0.0),
    };

    #[inline]
    fn standard(self, row: &Link, q: f64) -> Self {
        let (turn, shift) = row.moved(q);
        self.about_z(turn, shift).about_x(row.alpha, row.a)
    }

    #[inline]
    fn modified(self, row: &Link, q: f64) -> Self {
        let (turn, shift) = row.moved(q);
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
    fn about_x(self, turn: Twist, shift: f64) -> Self {
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
