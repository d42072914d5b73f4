//! Types of the values in a net.

use core::fmt;

/// Element type of fixed size: scalars in the usual sense, and vectors, poses and the like.
///
/// Memory consists of 64-bit slots. [`Scalar::slots`] is the number of slots per value.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub enum Scalar {
    /// Truth value, one slot: 0 or 1.
    Bool,
    /// 64-bit signed integer.
    Int,
    /// IEEE 754 double.
    Real,
    /// Point in time, ns since the Unix epoch (64-bit signed).
    Time,
    /// Three reals x, y, z; metres for a position.
    Vector,
    /// Unit quaternion, slots x, y, z, w.
    Rotation,
    /// Position (3 slots, m), then rotation (4 slots).
    Pose,
    /// Linear velocity (3 slots, m/s), then angular velocity (3 slots, rad/s).
    Twist,
    /// Force (3 slots, N), then torque (3 slots, N m).
    Wrench,
}

impl Scalar {
    /// All scalars in declaration order.
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

    /// Returns the number of slots of one value.
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

    /// Returns the name in `.rpi` programs and in messages.
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

/// Type of the values of a flow, which determines their slots.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub enum Type {
    /// Single value.
    Scalar(Scalar),
    /// Array: `len` values of one scalar type, contiguous in memory.
    Array(Scalar, u32),
    /// Dense matrix of reals with (rows, columns), stored row by row.
    Matrix(u32, u32),
}

impl Type {
    /// Returns the number of slots of one value; saturates at `u32::MAX`.
    #[must_use]
    pub const fn slots(self) -> u32 {
        match self {
            Type::Scalar(s) => s.slots(),
            Type::Array(s, n) => s.slots().saturating_mul(n),
            Type::Matrix(r, c) => r.saturating_mul(c),
        }
    }

    /// Returns the factor by which a value of this size multiplies the declared [work](crate::PrimDesc::work) of a
    /// primitive. The work is declared for arrays of up to 8 elements, assuming one pass, and for matrices of up to 6
    /// by 6, assuming a multiplication or an elimination (cubic).
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
