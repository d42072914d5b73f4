//! Constant values: parameters, defaults and initial contents.

use crate::ty::{Scalar, Type};
use alloc::string::String;
use smallvec::{SmallVec, smallvec};

/// Slots of a value. One or two slots are stored inline, without allocation.
pub type Bits = SmallVec<[u64; 2]>;

/// Constant: the slots of a flow value, or a text (parameters only).
#[derive(Clone, PartialEq, Debug)]
pub enum Value {
    /// Value of a flow type. `cells.len()` equals `ty.cells()`.
    Cells {
        /// Type of the value.
        ty: Type,
        /// Content of the slots, in the layout of [`Scalar`].
        cells: Bits,
    },
    /// Text: a device name or a key. It is never the value of a flow.
    Str(String),
}

impl Value {
    /// Creates a Boolean.
    #[must_use]
    pub fn bool(v: bool) -> Self {
        Self::one(Scalar::Bool, smallvec![u64::from(v)])
    }

    /// Creates an integer.
    #[must_use]
    pub fn int(v: i64) -> Self {
        Self::one(Scalar::Int, smallvec![v.cast_unsigned()])
    }

    /// Creates a real.
    #[must_use]
    pub fn real(v: f64) -> Self {
        Self::one(Scalar::Real, smallvec![v.to_bits()])
    }

    /// Creates a point in time from ns since the Unix epoch.
    #[must_use]
    pub fn time(ns: i64) -> Self {
        Self::one(Scalar::Time, smallvec![ns.cast_unsigned()])
    }

    /// Creates a real or spatial value from its components in the layout of [`Scalar`]; `None` if their number does not
    /// fit.
    #[must_use]
    pub fn reals(scalar: Scalar, reals: &[f64]) -> Option<Self> {
        let fits = reals.len() == scalar.cells() as usize
            && !matches!(scalar, Scalar::Bool | Scalar::Int | Scalar::Time);
        fits.then(|| Self::one(scalar, reals.iter().map(|r| r.to_bits()).collect()))
    }

    /// Returns the neutral value of a type: false, 0, the zero vector, the identity rotation or the identity pose.
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

    /// Returns the type; `None` for a text.
    #[must_use]
    pub fn ty(&self) -> Option<Type> {
        match self {
            Value::Cells { ty, .. } => Some(*ty),
            Value::Str(_) => None,
        }
    }

    /// Returns the content of the slots; empty for a text.
    #[must_use]
    pub fn cells(&self) -> &[u64] {
        match self {
            Value::Cells { cells, .. } => cells,
            Value::Str(_) => &[],
        }
    }

    /// Returns the Boolean; `None` for another type.
    #[must_use]
    pub fn as_bool(&self) -> Option<bool> {
        self.single(Scalar::Bool).map(|c| c != 0)
    }

    /// Returns the integer; `None` for another type.
    #[must_use]
    pub fn as_int(&self) -> Option<i64> {
        self.single(Scalar::Int).map(u64::cast_signed)
    }

    /// Returns the real; `None` for another type.
    #[must_use]
    pub fn as_real(&self) -> Option<f64> {
        self.single(Scalar::Real).map(f64::from_bits)
    }

    /// Returns the text; `None` for another value.
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
