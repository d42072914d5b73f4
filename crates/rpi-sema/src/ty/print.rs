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
