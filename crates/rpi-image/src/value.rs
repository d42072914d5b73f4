//! Constant values: parameters, defaults, initial contents.

use crate::ty::{Scalar, Type};
use alloc::string::String;
use smallvec::{SmallVec, smallvec};

/// The cells of a value; one or two, as most values have, lie in place.
pub type Bits = SmallVec<[u64; 2]>;

/// A constant: the cells of a flow's value, or a text (parameters only).
#[derive(Clone, PartialEq, Debug)]
pub enum Value {
    /// A value of a flow type; `cells.len()` equals `ty.cells()`.
    Cells {
        /// Its type.
        ty: Type,
        /// Its bits, laid out as [`Scalar`] says.
        cells: Bits,
    },
    /// A text: device names, keys. Never flows through a link.
    Str(String),
}

impl Value {
    /// A Boolean.
    #[must_use]
    pub fn bool(v: bool) -> Self {
        Self::one(Scalar::Bool, smallvec![u64::from(v)])
    }

    /// An integer.
    #[must_use]
    pub fn int(v: i64) -> Self {
        Self::one(Scalar::Int, smallvec![v.cast_unsigned()])
    }

    /// A real.
    #[must_use]
    pub fn real(v: f64) -> Self {
        Self::one(Scalar::Real, smallvec![v.to_bits()])
    }

    /// A point in time, nanoseconds since the Unix epoch.
    #[must_use]
    pub fn time(ns: i64) -> Self {
        Self::one(Scalar::Time, smallvec![ns.cast_unsigned()])
    }

    /// A spatial value from its reals, laid out as [`Scalar`] says; `None` if their number does not fit.
    #[must_use]
    pub fn reals(scalar: Scalar, reals: &[f64]) -> Option<Self> {
        let fits = reals.len() == scalar.cells() as usize
            && !matches!(scalar, Scalar::Bool | Scalar::Int | Scalar::Time);
        fits.then(|| Self::one(scalar, reals.iter().map(|r| r.to_bits()).collect()))
    }

    /// The neutral value of a type: false, 0, zero vector, identity rotation and pose.
    #[must_use]
    pub fn neutral(ty: Type) -> Self {
        let mut cells: Bits = smallvec![0; ty.cells() as usize];
        let (scalar, w) = match ty {
            Type::One(s) | Type::Array(s, _) => (s, s.cells() as usize),
            Type::Matrix(..) => (Scalar::Real, 1),
        };
        if matches!(scalar, Scalar::Rotation | Scalar::Pose) {
            for quaternion_w in cells.iter_mut().skip(w - 1).step_by(w) {
                *quaternion_w = 1.0f64.to_bits();
            }
        }
        Value::Cells { ty, cells }
    }

    fn one(scalar: Scalar, cells: Bits) -> Self {
        Value::Cells {
            ty: Type::One(scalar),
            cells,
        }
    }

    /// The type, unless it is a text.
    #[must_use]
    pub fn ty(&self) -> Option<Type> {
        match self {
            Value::Cells { ty, .. } => Some(*ty),
            Value::Str(_) => None,
        }
    }

    /// The bits; empty for a text.
    #[must_use]
    pub fn cells(&self) -> &[u64] {
        match self {
            Value::Cells { cells, .. } => cells,
            Value::Str(_) => &[],
        }
    }

    /// The Boolean, if it is one.
    #[must_use]
    pub fn as_bool(&self) -> Option<bool> {
        self.single(Scalar::Bool).map(|c| c != 0)
    }

    /// The integer, if it is one.
    #[must_use]
    pub fn as_int(&self) -> Option<i64> {
        self.single(Scalar::Int).map(u64::cast_signed)
    }

    /// The real, if it is one.
    #[must_use]
    pub fn as_real(&self) -> Option<f64> {
        self.single(Scalar::Real).map(f64::from_bits)
    }

    /// The text, if it is one.
    #[must_use]
    pub fn as_str(&self) -> Option<&str> {
        match self {
            Value::Str(s) => Some(s),
            Value::Cells { .. } => None,
        }
    }

    fn single(&self, scalar: Scalar) -> Option<u64> {
        match self {
            Value::Cells {
                ty: Type::One(s),
                cells,
            } if *s == scalar => cells.first().copied(),
            _ => None,
        }
    }
}
