//! Families of primitives that exist once per value type, and the names of their members.

use rpi_image::Scalar;
use rpi_prims::PrimId;
use std::sync::OnceLock;

/// Operation that has one primitive for each machine type of its values, such as the conditional.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum PrimitiveFamily {
    Value,
    IsNull,
    SetNull,
    Conditional,
    OptionalPre,
    Pre,
    Coalesce,
    Hold,
    Equals,
    Read,
    Sample,
    Write,
    Array,
    ArrayGet,
    ArraySet,
    ArrayConcatenate,
    Input,
}

/// For each family of primitives, the parts of a primitive's name before and after the name of the value type.
const NAMES: &[(PrimitiveFamily, Prefix, &str)] = &[
    (PrimitiveFamily::Value, Prefix::Reference, "Value"),
    (PrimitiveFamily::IsNull, Prefix::Reference, "IsNull"),
    (PrimitiveFamily::SetNull, Prefix::Reference, "SetNull"),
    (
        PrimitiveFamily::Conditional,
        Prefix::Reference,
        "Conditional",
    ),
    (PrimitiveFamily::OptionalPre, Prefix::Reference, "Pre"),
    (PrimitiveFamily::Pre, Prefix::Rpi(""), "Pre"),
    (PrimitiveFamily::Coalesce, Prefix::Rpi(""), "Coalesce"),
    (PrimitiveFamily::Hold, Prefix::Rpi(""), "Hold"),
    (PrimitiveFamily::Equals, Prefix::Reference, "Equals"),
    (PrimitiveFamily::Read, Prefix::Rpi("Read"), ""),
    (PrimitiveFamily::Sample, Prefix::Rpi("Sample"), ""),
    (PrimitiveFamily::Write, Prefix::Rpi("Write"), ""),
    (PrimitiveFamily::Array, Prefix::Reference, "Array"),
    (PrimitiveFamily::ArrayGet, Prefix::Reference, "ArrayGet"),
    (PrimitiveFamily::ArraySet, Prefix::Reference, "ArraySet"),
    (
        PrimitiveFamily::ArrayConcatenate,
        Prefix::Rpi(""),
        "ArrayConcatenate",
    ),
    (PrimitiveFamily::Input, Prefix::Reference, "NetcommIn"),
];

/// Part of a primitive's name before the name of the value type.
#[derive(Clone, Copy)]
enum Prefix {
    /// The name begins with `Core::` or `World::`, as in the reference system.
    Reference,
    /// The names begin with `Rpi::`, followed by this word.
    Rpi(&'static str),
}

/// For each value type, the primitive of one family, looked up on first use; `None` if there is no primitive for the
/// type.
type FamilyCache = [OnceLock<Option<PrimId>>; Scalar::ALL.len()];

/// Returns the primitive of a family for a value type; `None` if there is none. The look-up is done on demand and its
/// result is stored, because a program needs few primitives.
pub(super) fn member(family: PrimitiveFamily, scalar: Scalar) -> Option<PrimId> {
    static MEMBERS: [FamilyCache; NAMES.len()] = [const { [const { OnceLock::new() }; _] }; _];
    let row = NAMES.iter().position(|row| row.0 == family)?;
    let column = Scalar::ALL.iter().position(|one| *one == scalar)?;
    *MEMBERS[row][column].get_or_init(|| check_prim_call(&NAMES[row], scalar))
}

fn check_prim_call(
    (_, prefix, suffix): &(PrimitiveFamily, Prefix, &str),
    scalar: Scalar,
) -> Option<PrimId> {
    let ty = type_name(scalar);
    let reference = match scalar {
        Scalar::Bool | Scalar::Int | Scalar::Real | Scalar::Time => "Core::",
        _ => "World::",
    };
    let name = match prefix {
        Prefix::Reference => format!("{reference}{ty}{suffix}"),
        Prefix::Rpi(word) => format!("Rpi::{word}{ty}{suffix}"),
    };
    PrimId::from_name(&name).or_else(|| PrimId::from_name(&format!("Rpi::{ty}{suffix}")))
}

fn type_name(scalar: Scalar) -> &'static str {
    match scalar {
        Scalar::Bool => "Boolean",
        Scalar::Int => "Int",
        Scalar::Real => "Double",
        Scalar::Pose => "Frame",
        other => other.name(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_value_type_has_every_operation() {
        for (family, ..) in NAMES {
            for scalar in Scalar::ALL {
                assert!(member(*family, scalar).is_some(), "{family:?} of {scalar}");
            }
        }
    }
}
