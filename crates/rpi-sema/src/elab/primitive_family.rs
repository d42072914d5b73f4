//! Families of primitives that exist once per value type, and the names of their members.

use rpi_image::Scalar;
use rpi_prims::PrimId;
use std::sync::OnceLock;

/// Operation that is implemented by one primitive for each value type.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum Family {
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
    Input,
}

/// For each operation, the prefix and suffix around the name of the value type.
const NAMES: &[(Family, Prefix, &str)] = &[
    (Family::Value, Prefix::Reference, "Value"),
    (Family::IsNull, Prefix::Reference, "IsNull"),
    (Family::SetNull, Prefix::Reference, "SetNull"),
    (Family::Conditional, Prefix::Reference, "Conditional"),
    (Family::OptionalPre, Prefix::Reference, "Pre"),
    (Family::Pre, Prefix::Own(""), "Pre"),
    (Family::Coalesce, Prefix::Own(""), "Coalesce"),
    (Family::Hold, Prefix::Own(""), "Hold"),
    (Family::Equals, Prefix::Reference, "Equals"),
    (Family::Read, Prefix::Own("Read"), ""),
    (Family::Sample, Prefix::Own("Sample"), ""),
    (Family::Write, Prefix::Own("Write"), ""),
    (Family::Array, Prefix::Reference, "Array"),
    (Family::ArrayGet, Prefix::Reference, "ArrayGet"),
    (Family::ArraySet, Prefix::Reference, "ArraySet"),
    (Family::Input, Prefix::Reference, "NetcommIn"),
];

/// Prefix of a primitive's name.
#[derive(Clone, Copy)]
enum Prefix {
    /// `Core::` or `World::`, as in the reference system.
    Reference,
    /// `Rpi::` followed by a word.
    Own(&'static str),
}

/// Cached members of one family, by value type.
type Row = [OnceLock<Option<PrimId>>; Scalar::ALL.len()];

/// Returns the primitive of an operation for a value type, if it exists. Lookups are cached and done on demand, because
/// a program needs few of them.
pub(super) fn member(family: Family, scalar: Scalar) -> Option<PrimId> {
    static MEMBERS: [Row; NAMES.len()] = [const { [const { OnceLock::new() }; _] }; _];
    let row = NAMES.iter().position(|row| row.0 == family)?;
    let column = Scalar::ALL.iter().position(|one| *one == scalar)?;
    *MEMBERS[row][column].get_or_init(|| registered(&NAMES[row], scalar))
}

fn registered((_, prefix, suffix): &(Family, Prefix, &str), scalar: Scalar) -> Option<PrimId> {
    let ty = type_name(scalar);
    let reference = match scalar {
        Scalar::Bool | Scalar::Int | Scalar::Real | Scalar::Time => "Core::",
        _ => "World::",
    };
    let name = match prefix {
        Prefix::Reference => format!("{reference}{ty}{suffix}"),
        Prefix::Own(word) => format!("Rpi::{word}{ty}{suffix}"),
    };
    PrimId::of(&name).or_else(|| PrimId::of(&format!("Rpi::{ty}{suffix}")))
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
