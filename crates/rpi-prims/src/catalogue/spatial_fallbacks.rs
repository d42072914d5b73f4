//! Spatial values from several real parameters, for in-ports that are not connected.

use crate::geometry;
use crate::value_types::{Rotation, Vector};
use rpi_image::{Fallback, Scalar, Value};

/// Value of an unconnected in-port: the vector of the parameters `X`, `Y`, `Z`, each 0 by default.
pub(super) const XYZ: Fallback =
    Fallback::ComposedOfParams(&[("X", 0.0), ("Y", 0.0), ("Z", 0.0)], vector);
/// Value of an unconnected in-port: the vector of the parameters `RX`, `RY`, `RZ`, each 0 by default.
pub(super) const RXYZ: Fallback =
    Fallback::ComposedOfParams(&[("RX", 0.0), ("RY", 0.0), ("RZ", 0.0)], vector);
/// Value of an unconnected in-port: the axis with the components in the parameters `X`, `Y`, `Z`; the x axis by
/// default.
pub(super) const AXIS: Fallback =
    Fallback::ComposedOfParams(&[("X", 1.0), ("Y", 0.0), ("Z", 0.0)], vector);
/// Value of an unconnected in-port: the rotation with the Euler angles (rad) in the parameters `A`, `B`, `C`; the
/// identity by default.
pub(super) const ABC: Fallback =
    Fallback::ComposedOfParams(&[("A", 0.0), ("B", 0.0), ("C", 0.0)], rotation);

fn vector(parts: &[f64]) -> Value {
    let v = Vector::new(part(parts, 0), part(parts, 1), part(parts, 2));
    value(Scalar::Vector, v.as_slice())
}

fn rotation(parts: &[f64]) -> Value {
    let r: Rotation = geometry::from_abc(part(parts, 0), part(parts, 1), part(parts, 2));
    value(Scalar::Rotation, &[r.i, r.j, r.k, r.w])
}

fn part(parts: &[f64], k: usize) -> f64 {
    parts.get(k).copied().unwrap_or(0.0)
}

fn value(scalar: Scalar, reals: &[f64]) -> Value {
    Value::from_reals(scalar, reals).unwrap_or_else(|| Value::neutral(scalar.into()))
}
