//! Constants in a net's text: the primitives that produce them and the parameters that encode them.

use rpi_image::{ParamType, Role, Scalar, Type, Value};
use rpi_prims::registry;

/// Returns the name of a constant primitive whose parameter `Value` can hold this constant; `None` if there is none.
pub(super) fn constant_primitive(constant: &Value) -> Option<&'static str> {
    let wanted = match constant.ty()? {
        Type::Scalar(scalar) => ParamType::Scalar(scalar),
        Type::Array(scalar, _) => ParamType::Array(scalar),
        Type::Matrix(..) => return None,
    };
    let gives = |ty: ParamType| ty == wanted;
    let mut constants = registry()
        .iter()
        .map(|p| &p.desc)
        .filter(|d| d.role == Role::Constant);
    let found = constants.find(|d| d.params.first().is_some_and(|p| gives(p.ty)));
    found.map(|d| d.name)
}

/// Returns the `count` reals from which `make` builds a constant: its components, or the Euler angles about z, y and x
/// of a rotation.
pub(super) fn constant_parts(
    constant: &Value,
    count: usize,
    make: fn(&[f64]) -> Value,
) -> Vec<f64> {
    let components: Vec<f64> = constant
        .slots()
        .iter()
        .map(|c| f64::from_bits(*c))
        .collect();
    if components.len() == count && make(&components) == *constant {
        return components;
    }
    match constant.ty() {
        Some(Type::Scalar(Scalar::Rotation)) => {
            rpi_literal::euler_angles(constant.slots()).to_vec()
        }
        _ => components,
    }
}
