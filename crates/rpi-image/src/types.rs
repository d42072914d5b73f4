//! Types of the values in a net.

use core::fmt;

/// Element type of fixed size: scalars in the usual sense, and vectors, rotations, poses, twists and wrenches.
///
/// Memory consists of 64-bit slots. [`Scalar::slots`] is the number of slots of one value.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub enum Scalar {
    /// Truth value in one slot: 0 or 1.
    Bool,
    /// 64-bit signed integer in one slot.
    Int,
    /// IEEE 754 double in one slot, in SI units.
    Real,
    /// Point in time: ns since the Unix epoch, as a 64-bit signed integer in one slot.
    Time,
    /// Vector of three reals x, y, z in three slots; in metres for a position.
    Vector,
    /// Rotation as a unit quaternion in four slots, in the order x, y, z, w.
    Rotation,
    /// Position (3 slots, in metres), then rotation (4 slots, unit quaternion).
    Pose,
    /// Linear velocity (3 slots, in m/s), then angular velocity (3 slots, in rad/s).
    Twist,
    /// Force (3 slots, in N), then torque (3 slots, in N m).
    Wrench,
}

impl Scalar {
    /// All element types, in declaration order.
    pub const ALL: [Scalar; 9] = [
        Scalar::Bool,
        Scalar::Int,
        Scalar::Real,
        Scalar::Time,
        Scalar::Vector,
        Scalar::Rotation,
        Scalar::Pose,
        Scalar::Twist,
        Scalar::Wrench,
    ];

    /// Returns the number of 64-bit slots of one value of this type.
    #[must_use]
    pub const fn slots(self) -> u32 {
        match self {
            Scalar::Bool | Scalar::Int | Scalar::Real | Scalar::Time => 1,
            Scalar::Vector => 3,
            Scalar::Rotation => 4,
            Scalar::Pose => 7,
            Scalar::Twist | Scalar::Wrench => 6,
        }
    }

    /// Returns the name of the type in `.rpi` programs and in messages, such as `real` or `Pose`.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Scalar::Bool => "bool",
            Scalar::Int => "int",
            Scalar::Real => "real",
            Scalar::Time => "Time",
            Scalar::Vector => "Vector",
            Scalar::Rotation => "Rotation",
            Scalar::Pose => "Pose",
            Scalar::Twist => "Twist",
            Scalar::Wrench => "Wrench",
        }
    }
}

impl fmt::Display for Scalar {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// Type of the values of a flow. It gives the number of slots of a value.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub enum Type {
    /// Single value of the given element type.
    Scalar(Scalar),
    /// Array with an element type and a length. The elements are contiguous in memory.
    Array(Scalar, u32),
    /// Dense matrix of reals with the numbers of rows and columns, stored row by row.
    Matrix(u32, u32),
}

impl Type {
    /// Returns the number of 64-bit slots of one value; at most `u32::MAX`.
    #[must_use]
    pub const fn slots(self) -> u32 {
        match self {
            Type::Scalar(s) => s.slots(),
            Type::Array(s, n) => s.slots().saturating_mul(n),
            Type::Matrix(r, c) => r.saturating_mul(c),
        }
    }

    /// Returns the factor by which the work bound of a primitive grows for a value of this type (see
    /// [work](crate::PrimDesc::work)); at least 1. The declared bound holds for arrays of up to 8 elements, with one
    /// pass over the elements, and for matrices of up to 6 by 6, with a cubic operation such as a multiplication.
    #[must_use]
    pub const fn work_factor(self) -> u64 {
        let factor = match self {
            Type::Scalar(_) => 1,
            Type::Array(_, n) => (n as u64).div_ceil(8),
            Type::Matrix(r, c) => {
                let (rows, cols) = (r as u64, c as u64);
                let longer = if rows > cols { rows } else { cols };
                rows.saturating_mul(cols)
                    .saturating_mul(longer)
                    .div_ceil(216)
            }
        };
        if factor == 0 { 1 } else { factor }
    }
}

impl From<Scalar> for Type {
    fn from(s: Scalar) -> Self {
        Type::Scalar(s)
    }
}

impl fmt::Display for Type {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Type::Scalar(s) => write!(f, "{s}"),
            Type::Array(s, n) => write!(f, "{s}^{n}"),
            Type::Matrix(r, c) => write!(f, "real^{r}^{c}"),
        }
    }
}
