//! Rust types of the value types of the language, and their layout in memory slots.

use nalgebra::{Isometry3, Quaternion, Translation3, UnitQuaternion, Vector3};
use rpi_image::Scalar;

/// Rust type of a value type of the language.
pub trait FlowType: Copy {
    /// Flow type that this Rust type represents.
    const SCALAR: Scalar;
    /// Number of 64-bit slots that a value of the type takes in memory.
    const SLOTS: usize = Self::SCALAR.slots() as usize;
    /// Reads a value from the slots `cells[at..]`.
    fn load(cells: &[u64], at: usize) -> Self;
    /// Writes the value to the slots `cells[at..]`.
    fn store(self, cells: &mut [u64], at: usize);
    /// Returns the neutral value of the type: false, zero or the identity.
    fn neutral() -> Self;
}

/// Point in time, in ns since the Unix epoch.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug, Default)]
pub struct Time(pub i64);
/// Position (m) or direction.
pub type Vector = Vector3<f64>;
/// Rotation in space, as a unit quaternion.
pub type Rotation = UnitQuaternion<f64>;
/// Position (m) and orientation of one frame in another.
pub type Pose = Isometry3<f64>;

/// Velocity of a rigid body (twist): linear and angular.
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub struct Twist {
    /// Linear velocity of the reference point, m/s.
    pub linear: Vector,
    /// Angular velocity, as axis times rad/s.
    pub angular: Vector,
}

/// Force and torque at a reference point (wrench).
#[derive(Clone, Copy, PartialEq, Debug, Default)]
pub struct Wrench {
    /// Force, in N.
    pub force: Vector,
    /// Torque, in N m.
    pub torque: Vector,
}

impl FlowType for bool {
    const SCALAR: Scalar = Scalar::Bool;
    #[inline(always)]
    fn load(cells: &[u64], at: usize) -> Self {
        cells[at] != 0
    }
    #[inline(always)]
    fn store(self, cells: &mut [u64], at: usize) {
        cells[at] = u64::from(self);
    }
    #[inline(always)]
    fn neutral() -> Self {
        false
    }
}

impl FlowType for i64 {
    const SCALAR: Scalar = Scalar::Int;
    #[inline(always)]
    fn load(cells: &[u64], at: usize) -> Self {
        cells[at].cast_signed()
    }
    #[inline(always)]
    fn store(self, cells: &mut [u64], at: usize) {
        cells[at] = self.cast_unsigned();
    }
    #[inline(always)]
    fn neutral() -> Self {
        0
    }
}

impl FlowType for f64 {
    const SCALAR: Scalar = Scalar::Real;
    #[inline(always)]
    fn load(cells: &[u64], at: usize) -> Self {
        f64::from_bits(cells[at])
    }
    #[inline(always)]
    fn store(self, cells: &mut [u64], at: usize) {
        cells[at] = self.to_bits();
    }
    #[inline(always)]
    fn neutral() -> Self {
        0.0
    }
}

impl FlowType for Time {
    const SCALAR: Scalar = Scalar::Time;
    #[inline(always)]
    fn load(cells: &[u64], at: usize) -> Self {
        Time(i64::load(cells, at))
    }
    #[inline(always)]
    fn store(self, cells: &mut [u64], at: usize) {
        self.0.store(cells, at);
    }
    #[inline(always)]
    fn neutral() -> Self {
        Time(0)
    }
}

impl FlowType for Vector {
    const SCALAR: Scalar = Scalar::Vector;
    #[inline(always)]
    fn load(cells: &[u64], at: usize) -> Self {
        Vector::new(
            f64::load(cells, at),
            f64::load(cells, at + 1),
            f64::load(cells, at + 2),
        )
    }
    #[inline(always)]
    fn store(self, cells: &mut [u64], at: usize) {
        self.x.store(cells, at);
        self.y.store(cells, at + 1);
        self.z.store(cells, at + 2);
    }
    #[inline(always)]
    fn neutral() -> Self {
        Vector::zeros()
    }
}

impl FlowType for Rotation {
    const SCALAR: Scalar = Scalar::Rotation;
    #[inline(always)]
    fn load(cells: &[u64], at: usize) -> Self {
        let part = |k| f64::load(cells, at + k);
        // Not normalised again: a value must not change its bits on the way through memory.
        UnitQuaternion::new_unchecked(Quaternion::new(part(3), part(0), part(1), part(2)))
    }
    #[inline(always)]
    fn store(self, cells: &mut [u64], at: usize) {
        for (k, part) in [self.i, self.j, self.k, self.w].into_iter().enumerate() {
            part.store(cells, at + k);
        }
    }
    #[inline(always)]
    fn neutral() -> Self {
        Rotation::identity()
    }
}

impl FlowType for Pose {
    const SCALAR: Scalar = Scalar::Pose;
    #[inline(always)]
    fn load(cells: &[u64], at: usize) -> Self {
        Isometry3::from_parts(
            Translation3::from(Vector::load(cells, at)),
            Rotation::load(cells, at + 3),
        )
    }
    #[inline(always)]
    fn store(self, cells: &mut [u64], at: usize) {
        self.translation.vector.store(cells, at);
        self.rotation.store(cells, at + 3);
    }
    #[inline(always)]
    fn neutral() -> Self {
        Pose::identity()
    }
}

impl FlowType for Twist {
    const SCALAR: Scalar = Scalar::Twist;
    #[inline(always)]
    fn load(cells: &[u64], at: usize) -> Self {
        Twist {
            linear: Vector::load(cells, at),
            angular: Vector::load(cells, at + 3),
        }
    }
    #[inline(always)]
    fn store(self, cells: &mut [u64], at: usize) {
        self.linear.store(cells, at);
        self.angular.store(cells, at + 3);
    }
    #[inline(always)]
    fn neutral() -> Self {
        Twist::default()
    }
}

impl FlowType for Wrench {
    const SCALAR: Scalar = Scalar::Wrench;
    #[inline(always)]
    fn load(cells: &[u64], at: usize) -> Self {
        Wrench {
            force: Vector::load(cells, at),
            torque: Vector::load(cells, at + 3),
        }
    }
    #[inline(always)]
    fn store(self, cells: &mut [u64], at: usize) {
        self.force.store(cells, at);
        self.torque.store(cells, at + 3);
    }
    #[inline(always)]
    fn neutral() -> Self {
        Wrench::default()
    }
}
