//! The types of values that run through a net.

use core::fmt;

/// A value type of fixed size: what one link of a net carries.
///
/// Memory is made of 64-bit cells; [`Scalar::cells`] tells how many a value takes.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub enum Scalar {
    /// Truth value, one cell, 0 or 1.
    Bool,
    /// 64-bit signed integer.
    Int,
    /// IEEE 754 double.
    Real,
    /// Point in time, whole nanoseconds since the Unix epoch (64-bit signed).
    Time,
    /// Three reals x, y, z; metres where it is a position.
    Vector,
    /// Unit quaternion, cells x, y, z, w.
    Rotation,
    /// Position (3 cells, metres), then rotation (4 cells).
    Pose,
    /// Linear velocity (3 cells, m/s), then angular velocity (3 cells, rad/s).
    Twist,
    /// Force (3 cells, N), then torque (3 cells, N m).
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

    /// Number of 64-bit cells of one value.
    #[must_use]
    pub const fn cells(self) -> u32 {
        match self {
            Scalar::Bool | Scalar::Int | Scalar::Real | Scalar::Time => 1,
            Scalar::Vector => 3,
            Scalar::Rotation => 4,
            Scalar::Pose => 7,
            Scalar::Twist | Scalar::Wrench => 6,
        }
    }

    /// The name in `.rpi` programs and messages.
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

/// The type of a flow: one value, or an array of `len` values side by side.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub enum Type {
    /// A single value.
    One(Scalar),
    /// `len` values of one scalar type.
    Array(Scalar, u32),
    /// A dense matrix of reals, row by row.
    Matrix(u32, u32),
}

impl Type {
    /// Number of 64-bit cells of one value; saturates for absurd sizes.
    #[must_use]
    pub const fn cells(self) -> u32 {
        match self {
            Type::One(s) => s.cells(),
            Type::Array(s, n) => s.cells().saturating_mul(n),
            Type::Matrix(r, c) => r.saturating_mul(c),
        }
    }

    /// How often the [work](crate::PrimDesc::work) that a primitive declares it does for a value of this size: it is declared for
    /// arrays of up to eight elements, through which it goes once, and for matrices of up to six rows and columns, which it
    /// may multiply or eliminate.
    #[must_use]
    pub const fn work_factor(self) -> u64 {
        let factor = match self {
            Type::One(_) => 1,
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
        Type::One(s)
    }
}

impl fmt::Display for Type {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Type::One(s) => write!(f, "{s}"),
            Type::Array(s, n) => write!(f, "{s}^{n}"),
            Type::Matrix(r, c) => write!(f, "real^{r}^{c}"),
        }
    }
}
