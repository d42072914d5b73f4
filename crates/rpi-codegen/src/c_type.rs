//! C types of memory slots.

use rpi_image::{PortType, Scalar, Type};

/// C type of one memory slot.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub enum CType {
    /// `bool`.
    Bool,
    /// `int64_t`: an integer, or a point in time in ns.
    Int,
    /// `double`.
    Real,
    /// `uint64_t`: the bits of a value whose type differs between its uses, or of a history.
    Word,
}

impl CType {
    /// Returns the C type of each slot of a value of element type `scalar`.
    #[must_use]
    pub const fn of(scalar: Scalar) -> CType {
        match scalar {
            Scalar::Bool => CType::Bool,
            Scalar::Int | Scalar::Time => CType::Int,
            _ => CType::Real,
        }
    }

    /// Returns the C type of each slot of a value of type `ty`.
    #[must_use]
    pub const fn of_type(ty: Type) -> CType {
        CType::of(element(ty))
    }

    /// Returns the name of the type in C.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            CType::Bool => "bool",
            CType::Int => "int64_t",
            CType::Real => "double",
            CType::Word => "uint64_t",
        }
    }

    /// Returns the size of a value in bytes on all common machines.
    #[must_use]
    pub const fn bytes(self) -> usize {
        match self {
            CType::Bool => 1,
            _ => 8,
        }
    }
}

/// Returns the element type of a value.
pub(crate) const fn element(ty: Type) -> Scalar {
    match ty {
        Type::Scalar(s) | Type::Array(s, _) => s,
        Type::Matrix(..) => Scalar::Real,
    }
}

/// Returns the element type of a port.
pub(crate) const fn port_element(ty: PortType) -> Scalar {
    match ty {
        PortType::Scalar(s) | PortType::Array(s) => s,
        PortType::Matrix => Scalar::Real,
    }
}

/// Returns whether a port holds one value of one slot, which C passes by value.
pub(crate) const fn is_single(ty: PortType) -> bool {
    matches!(ty, PortType::Scalar(s) if s.slots() == 1)
}

impl From<Scalar> for CType {
    fn from(scalar: Scalar) -> CType {
        CType::of(scalar)
    }
}
