//! Predeclared names, listed for editors and documentation.

use crate::check::exprs::spatial_parts::SPATIAL_PARTS;
use crate::ty::Ty;
use crate::typed::predeclared::PREDECLARED_FLOWS;
use rpi_image::Scalar;

/// Returns the predeclared flows, such as the cycle time `dt`: the name, the registered name of the primitive that
/// provides the value, and the type.
pub(crate) fn resolve_predeclared()
-> impl Iterator<Item = (&'static str, &'static str, &'static Ty)> {
    PREDECLARED_FLOWS
        .iter()
        .map(|flow| (flow.name, flow.prim.desc().name, &flow.ty))
}

/// Returns the names of the predeclared operators in call syntax.
#[cfg(test)]
pub(crate) fn intrinsic_names() -> impl Iterator<Item = &'static str> {
    let specials = crate::check::calls::intrinsics::INTRINSICS
        .iter()
        .map(|special| special.name());
    specials.chain(crate::check::calls::iterate::ITERATORS.iter().copied())
}

/// Returns the names of the parts of a spatial type (vector, rotation, pose and the like), such as `x` for a vector.
pub(crate) fn spatial_parts(scalar: Scalar) -> impl Iterator<Item = &'static str> {
    let parts = SPATIAL_PARTS.iter().filter(move |part| part.0 == scalar);
    parts.map(|part| part.1)
}
