//! Constant values: parameters, defaults and initial contents.

use crate::types::{Scalar, Type};
use alloc::string::String;
use smallvec::{SmallVec, smallvec};

/// Slots of a value. One or two slots are stored inline, without allocation.
pub type SlotBits = SmallVec<[u64; 2]>;

/// Constant: the slots of a flow value, or a text (parameters only).
#[derive(Clone, PartialEq, Debug)]
pub enum Value {
    /// Value of a flow type. `cells.len()` equals `ty.cells()`.
    Slots {
        /// Flow type that says how the slots are read.
        ty: Type,
        /// Content of the slots, in the layout of [`Scalar`].
        cells: SlotBits,
    },
    /// Text: a device name or a key. It is never the value of a flow.
    Str(String),
}

impl Value {
    /// Creates a Boolean.
    #[must_use]
    pub fn bool(v: bool) -> Self {
        Self::from_scalar(Scalar::Bool, smallvec![u64::from(v)])
    }

    /// Creates an integer.
    #[must_use]
    pub fn int(v: i64) -> Self {
        Self::from_scalar(Scalar::Int, smallvec![v.cast_unsigned()])
    }

    /// Creates a constant of type real in one slot.
    #[must_use]
    pub fn real(v: f64) -> Self {
        Self::from_scalar(Scalar::Real, smallvec![v.to_bits()])
    }

    /// Creates a point in time from ns since the Unix epoch.
    #[must_use]
    pub fn time(ns: i64) -> Self {
        Self::from_scalar(Scalar::Time, smallvec![ns.cast_unsigned()])
    }

    /// Creates a real or spatial value from its components in the layout of [`Scalar`]; `None` if their number does not
    /// fit.
    #[must_use]
    pub fn from_reals(scalar: Scalar, reals: &[f64]) -> Option<Self> {
        let has_length = reals.len() == scalar.slots() as usize
            && !matches!(scalar, Scalar::Bool | Scalar::Int | Scalar::Time);
        has_length.then(|| Self::from_scalar(scalar, reals.iter().map(|r| r.to_bits()).collect()))
    }

    /// Returns the neutral value of a type: false, 0, the zero vector, the identity rotation or the identity pose.
    #[must_use]
    pub fn neutral(ty: Type) -> Self {
        let mut cells: SlotBits = smallvec![0; ty.slots() as usize];
        let (scalar, w) = match ty {
            Type::Scalar(s) | Type::Array(s, _) => (s, s.slots() as usize),
            Type::Matrix(..) => (Scalar::Real, 1),
        };
        if matches!(scalar, Scalar::Rotation | Scalar::Pose) {
            for quaternion_w in cells.iter_mut().skip(w - 1).step_by(w) {
                *quaternion_w = 1.0f64.to_bits();
            }
        }
        Value::Slots { ty, cells }
    }

    fn from_scalar(scalar: Scalar, cells: SlotBits) -> Self {
        Value::Slots {
            ty: Type::Scalar(scalar),
            cells,
        }
    }

    /// Returns the type; `None` for a text.
    #[must_use]
    pub fn ty(&self) -> Option<Type> {
        match self {
            Value::Slots { ty, .. } => Some(*ty),
            Value::Str(_) => None,
        }
    }

    /// Returns the content of the slots; empty for a text.
    #[must_use]
    pub fn slots(&self) -> &[u64] {
        match self {
            Value::Slots { cells, .. } => cells,
            Value::Str(_) => &[],
        }
    }

    /// Returns the Boolean; `None` for another type.
    #[must_use]
    pub fn as_bool(&self) -> Option<bool> {
        self.scalar_slot(Scalar::Bool).map(|c| c != 0)
    }

    /// Returns the integer; `None` for another type.
    #[must_use]
    pub fn as_int(&self) -> Option<i64> {
        self.scalar_slot(Scalar::Int).map(u64::cast_signed)
    }

    /// Returns the real; `None` for another type.
    #[must_use]
    pub fn as_real(&self) -> Option<f64> {
        self.scalar_slot(Scalar::Real).map(f64::from_bits)
    }

    /// Returns the text; `None` for another value.
    #[must_use]
    pub fn as_str(&self) -> Option<&str> {
        match self {
            Value::Str(s) => Some(s),
            Value::Slots { .. } => None,
        }
    }

    fn scalar_slot(&self, scalar: Scalar) -> Option<u64> {
        match self {
            Value::Slots {
                ty: Type::Scalar(s),
                cells,
            } if *s == scalar => cells.first().copied(),
            _ => None,
        }
    }
}
