//! Machine types: the types and values that ports of primitives carry, and the types at the borders of a program.

use crate::ty::Ty;
use crate::units::Dimension;
use rpi_image::{ParamType, Scalar, Type, Value};
use std::rc::Rc;

/// Type of times that are reals in seconds, as opposed to exact times in ticks.
pub(crate) const SECONDS: Ty = Ty::Real(Dimension::TIME);

/// Returns the type of values that are a scalar of this machine type, with unknown unit and frames.
pub(crate) fn scalar_ty(scalar: Scalar) -> Ty {
    match scalar {
        Scalar::Bool => Ty::Bool,
        Scalar::Int => Ty::Int,
        Scalar::Real => Ty::REAL,
        Scalar::Time => Ty::Time,
        spatial => Ty::spatial(spatial),
    }
}

/// Returns the type of a flow that carries values of this machine type, which may be an array or matrix.
pub(crate) fn flow_type(ty: Type) -> Ty {
    match ty {
        Type::Scalar(scalar) => scalar_ty(scalar),
        Type::Array(scalar, n) => Ty::Array(Rc::new(scalar_ty(scalar)), n),
        Type::Matrix(rows, cols) => Ty::Array(Rc::new(Ty::Array(Rc::new(Ty::REAL), cols)), rows),
    }
}

/// Returns the machine type with which a value of the type `ty` can be passed to a port of a primitive; `None` for
/// types that primitives do not take.
pub(crate) fn machine_type(ty: &Ty) -> Option<Type> {
    if let Some(scalar) = ty.scalar() {
        return Some(Type::Scalar(scalar));
    }
    match ty {
        Ty::Array(row, rows) => match &**row {
            Ty::Array(_, cols) => Some(Type::Matrix(*rows, *cols)),
            element => Some(Type::Array(element.scalar()?, *rows)),
        },
        _ => None,
    }
}

/// Returns the default value of a primitive's parameter; `None` if it has none.
pub(crate) fn param_default(param: &rpi_image::Param) -> Option<Value> {
    match param.ty {
        ParamType::Scalar(scalar) => param.default.value(Type::Scalar(scalar)),
        ParamType::Array(scalar) => param.default.value(Type::Array(scalar, 0)),
        ParamType::Str => {
            param
                .default
                .value(Type::Scalar(Scalar::Bool))
                .map(|value| match value {
                    Value::Str(text) => Value::Str(text),
                    Value::Slots { .. } => Value::Str(String::new()),
                })
        }
    }
}

/// Returns an array value whose elements are the given scalars.
pub(crate) fn pack_leaves(scalar: Scalar, leaves: &[Value]) -> Value {
    let n = u32::try_from(leaves.len()).unwrap_or(u32::MAX);
    Value::Slots {
        ty: Type::Array(scalar, n),
        cells: leaves
            .iter()
            .flat_map(|leaf| leaf.slots().iter().copied())
            .collect(),
    }
}

/// Returns the type and the machine type that a value has outside of the program, for the host and devices. An exact
/// time is a real in seconds there.
pub(crate) fn external_type(ty: &Ty) -> (Ty, Scalar) {
    match ty {
        Ty::Duration => (SECONDS, Scalar::Real),
        ty => (ty.clone(), ty.scalar().unwrap_or(Scalar::Bool)),
    }
}
