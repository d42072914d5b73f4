//! Names that are there without a declaration, as others list them: editors, documentation.

use super::names::PREDECLARED;
use super::parts::SPATIAL_PARTS;
use crate::ty::Ty;
use rpi_image::Scalar;

/// The predeclared flows: name, registered name of the primitive, type.
pub(crate) fn predeclared() -> impl Iterator<Item = (&'static str, &'static str, &'static Ty)> {
    PREDECLARED
        .iter()
        .map(|flow| (flow.name, flow.prim.desc().name, &flow.ty))
}

/// The names of the operators that are written as calls.
#[cfg(test)]
pub(crate) fn operator_names() -> impl Iterator<Item = &'static str> {
    let specials = super::special::SPECIALS
        .iter()
        .map(|special| special.name());
    specials.chain(super::iterate::NAMES.iter().copied())
}

/// The parts of a spatial value that are read by name.
pub(crate) fn spatial_parts(scalar: Scalar) -> impl Iterator<Item = &'static str> {
    let parts = SPATIAL_PARTS.iter().filter(move |part| part.0 == scalar);
    parts.map(|part| part.1)
}
