//! Spatial values from several real parameters, for in-ports that are not connected.

use crate::geometry;
use crate::value_types::{Rotation, Vector};
use rpi_image::{Fallback, Scalar, Value};

/// Vector from the parameters `X`, `Y`, `Z`; 0 by default.
pub(super) const XYZ: Fallback =
    Fallback::ComposedOfParams(&[("X", 0.0), ("Y", 0.0), ("Z", 0.0)], vector);
/// Vector from the parameters `RX`, `RY`, `RZ`; 0 by default.
pub(super) const RXYZ: Fallback =
    Fallback::ComposedOfParams(&[("RX", 0.0), ("RY", 0.0), ("RZ", 0.0)], vector);
/// Axis from the parameters `X`, `Y`, `Z`; the x axis by default.
pub(super) const AXIS: Fallback =
    Fallback::ComposedOfParams(&[("X", 1.0), ("Y", 0.0), ("Z", 0.0)], vector);
/// Rotation from the Euler angles `A`, `B`, `C` (rad); the identity by default.
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
