//! Formats types in source syntax.

use crate::ty::{Geometry, Member, Ty};
use crate::units::Dimension;
use rpi_image::Scalar;
use std::fmt;

impl fmt::Display for Ty {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Ty::Unknown => f.write_str("_"),
            Ty::Bool => f.write_str("bool"),
            Ty::Int => f.write_str("int"),
            Ty::Machine(machine) => write!(f, "{machine}"),
            Ty::Subrange(range) => write!(f, "subrange {range} of int"),
            Ty::Real(Dimension::ONE) => f.write_str("real"),
            Ty::Real(dim) => write!(f, "real[{dim}]"),
            Ty::Time => f.write_str("Time"),
            Ty::Duration => f.write_str("time"),
            Ty::Text => f.write_str("text"),
            Ty::Spatial(scalar, geometry) => spatial(*scalar, geometry, f),
            Ty::Enum(e) => f.write_str(&e.name),
            Ty::Struct(s) => f.write_str(&s.name),
            Ty::Array(element, n) => write!(f, "{element}^{n}"),
            Ty::Tuple(members) => tuple(members, f),
            Ty::Device(device) => f.write_str(&device.name),
            Ty::Result => f.write_str("result"),
            Ty::Generic(name) => f.write_str(name),
        }
    }
}

impl Ty {
    /// Returns a literal of this type for an initial or default value: zero for numbers (`0[m]` for a length), `false`
    /// for Booleans, the first value of an enum, and such literals for the parts of an array, struct or tuple. `None`
    /// for types without literals.
    pub fn zero_literal(&self) -> Option<String> {
        match self {
            Ty::Bool => Some("false".to_owned()),
            Ty::Int => Some("0".to_owned()),
            Ty::Subrange(range) => Some(range.clamp(0).to_string()),
            Ty::Real(dim) if dim.is_dimensionless() => Some("0.0".to_owned()),
            // A literal cannot have the unit of a type parameter.
            Ty::Real(dim) if dim.has_free() => None,
            Ty::Real(dim) => Some(format!("0[{dim}]")),
            Ty::Duration => Some("0[s]".to_owned()),
            Ty::Enum(values) => values.values.first().map(ToString::to_string),
            Ty::Array(element, n) => Some(format!("{}^{n}", element.zero_literal()?)),
            // The name of a generic instance contains its arguments and cannot be written in a program.
            Ty::Struct(of) if !of.name.contains('<') => {
                let fields: Option<Vec<String>> = of.fields.iter().map(zero_field).collect();
                Some(format!("{}{{{}}}", of.name, fields?.join("; ")))
            }
            _ => None,
        }
    }

    /// Returns the literal of [`Ty::zero_literal`] for a help text; `...` for types without literals.
    pub(crate) fn zero_or_dots(&self) -> String {
        self.zero_literal().unwrap_or("...".to_owned())
    }
}

fn zero_field(field: &Member) -> Option<String> {
    let name = field.name.as_ref()?;
    Some(format!("{name} = {}", field.ty.zero_literal()?))
}

fn spatial(scalar: Scalar, geometry: &Geometry, f: &mut fmt::Formatter<'_>) -> fmt::Result {
    write!(f, "{scalar}")?;
    if let Some(dim) = geometry.dim {
        write!(f, "<<{}>>", Ty::Real(dim))?;
    }
    match (&geometry.of, &geometry.in_frame) {
        (Some(of), Some(frame)) => write!(f, "({of} in {frame})"),
        (None, Some(frame)) => write!(f, "({frame})"),
        (Some(of), None) => write!(f, "({of} in _)"),
        (None, None) => Ok(()),
    }
}

fn tuple(members: &[Member], f: &mut fmt::Formatter<'_>) -> fmt::Result {
    f.write_str("(")?;
    for (k, member) in members.iter().enumerate() {
        if k > 0 {
            f.write_str(if member.name.is_some() { "; " } else { ", " })?;
        }
        if let Some(name) = &member.name {
            write!(f, "{name}: ")?;
        }
        write!(f, "{}", member.ty)?;
    }
    f.write_str(")")
}
