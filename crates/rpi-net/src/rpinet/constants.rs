//! Constants in a net's text: the primitives that give them, the parameters that they are made of.

use rpi_image::{ParamType, Role, Scalar, Type, Value};
use rpi_prims::registry;

/// The primitive whose parameter `Value` can be this constant.
pub(super) fn primitive(constant: &Value) -> Option<&'static str> {
    let Some(Type::One(scalar)) = constant.ty() else {
        return None;
    };
    let gives = |ty: ParamType| ty == ParamType::One(scalar);
    let mut constants = registry()
        .iter()
        .map(|p| &p.desc)
        .filter(|d| d.role == Role::Constant);
    let found = constants.find(|d| d.params.first().is_some_and(|p| gives(p.ty)));
    found.map(|d| d.name)
}

/// The reals of which `make` makes a constant: its components, or for a rotation its angles about z, y, x.
pub(super) fn parts(constant: &Value, count: usize, make: fn(&[f64]) -> Value) -> Vec<f64> {
    let components: Vec<f64> = constant
        .cells()
        .iter()
        .map(|c| f64::from_bits(*c))
        .collect();
    if components.len() == count && make(&components) == *constant {
        return components;
    }
    match constant.ty() {
        Some(Type::One(Scalar::Rotation)) => rpi_literal::angles(constant.cells()).to_vec(),
        _ => components,
    }
}
