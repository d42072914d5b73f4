//! Constant values: parameters, defaults and initial contents.

use crate::types::{Scalar, Type};
use alloc::string::String;
use smallvec::{SmallVec, smallvec};

/// Contents of the 64-bit slots of a value. One or two slots are stored without a heap allocation.
pub type SlotBits = SmallVec<[u64; 2]>;

/// Constant value: the slots of a value of a flow type, or a text. Only parameters can be texts.
#[derive(Clone, PartialEq, Debug)]
pub enum Value {
    /// Value of a flow type. The number of slots equals `ty.slots()`.
    Slots {
        /// Type of the value, which gives the meaning of the slots.
        ty: Type,
        /// Contents of the slots, in the layout that [`Scalar`] describes.
        cells: SlotBits,
    },
    /// Text, such as the name of a device or a key. A flow never has a text as its value.
    Str(String),
}

impl Value {
    /// Creates a Boolean constant.
    #[must_use]
    pub fn bool(v: bool) -> Self {
        Self::from_scalar(Scalar::Bool, smallvec![u64::from(v)])
    }

    /// Creates an integer constant.
    #[must_use]
    pub fn int(v: i64) -> Self {
        Self::from_scalar(Scalar::Int, smallvec![v.cast_unsigned()])
    }

    /// Creates a constant of type real.
    #[must_use]
    pub fn real(v: f64) -> Self {
        Self::from_scalar(Scalar::Real, smallvec![v.to_bits()])
    }

    /// Creates a constant point in time from ns since the Unix epoch.
    #[must_use]
    pub fn time(ns: i64) -> Self {
        Self::from_scalar(Scalar::Time, smallvec![ns.cast_unsigned()])
    }

    /// Creates a real, vector, rotation, pose, twist or wrench from its components in the order that [`Scalar`]
    /// describes. Returns `None` if the number of components does not fit, or if the type is a Boolean, an integer or a
    /// time.
    #[must_use]
    pub fn from_reals(scalar: Scalar, reals: &[f64]) -> Option<Self> {
        let has_length = reals.len() == scalar.slots() as usize
            && !matches!(scalar, Scalar::Bool | Scalar::Int | Scalar::Time);
        has_length.then(|| Self::from_scalar(scalar, reals.iter().map(|r| r.to_bits()).collect()))
    }

    /// Returns the neutral value of a type: false, 0, the zero vector, twist or wrench, the identity rotation or the
    /// identity pose; for an array or a matrix, in every element.
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

    /// Returns the type of the value; `None` for a text.
    #[must_use]
    pub fn ty(&self) -> Option<Type> {
        match self {
            Value::Slots { ty, .. } => Some(*ty),
            Value::Str(_) => None,
        }
    }

    /// Returns the contents of the slots of the value; empty for a text.
    #[must_use]
    pub fn slots(&self) -> &[u64] {
        match self {
            Value::Slots { cells, .. } => cells,
            Value::Str(_) => &[],
        }
    }

    /// Returns the value of a Boolean constant; `None` for a constant of another type.
    #[must_use]
    pub fn as_bool(&self) -> Option<bool> {
        self.scalar_slot(Scalar::Bool).map(|c| c != 0)
    }

    /// Returns the value of an integer constant; `None` for a constant of another type.
    #[must_use]
    pub fn as_int(&self) -> Option<i64> {
        self.scalar_slot(Scalar::Int).map(u64::cast_signed)
    }

    /// Returns the value of a constant of type real; `None` for a constant of another type.
    #[must_use]
    pub fn as_real(&self) -> Option<f64> {
        self.scalar_slot(Scalar::Real).map(f64::from_bits)
    }

    /// Returns the text; `None` for a constant that is not a text.
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
