//! Ports of primitives: their types and values as the checker sees them.

use crate::check::bodies::body::Body;
use crate::check::calls::prim::PrimArgs;
use crate::check::diagnostics::report;
use crate::check::diagnostics::report::ExpectationReason;
use crate::check::types::consts;
use crate::check::types::exact_time;
use crate::ty::machine_types::{flow_type, machine_type, pack_leaves, param_default, scalar_ty};
use crate::ty::{Member, Ty};
use crate::typed::ExprId;
use rpi_diag::{Code, Diagnostic, Span};
use rpi_image::{ParamType, PortType, PrimDesc, Scalar, ShapeArgs, Type, Value};

/// Whether a value has the machine type of the primitive's port `name`. Reports a mismatch. Units and frames are not
/// compared.
pub(crate) fn fits_port(cx: &mut Body<'_, '_>, value: ExprId, port: PortType, name: &str) -> bool {
    // Ports take times in seconds.
    exact_time::convert_to_seconds(cx, value);
    let ty = cx.ty_of(value).clone();
    let fits = ty.is_unknown() || port_accepts(port, &ty);
    if !fits {
        let expected = resolve_port_type(port);
        let wanted =
            ExpectationReason::Because(Span::NONE, format!("`{name}` takes {}", port_text(port)));
        report::type_mismatch(
            cx,
            value,
            &expected,
            &crate::ty::TypeMismatchError::Kind,
            &wanted,
        );
    }
    fits
}

pub(crate) fn fits_param(
    cx: &mut Body<'_, '_>,
    value: ExprId,
    param: ParamType,
    name: &str,
) -> bool {
    let port = match param {
        ParamType::Scalar(scalar) => PortType::Scalar(scalar),
        ParamType::Array(scalar) => PortType::Array(scalar),
        ParamType::Str => {
            let ty = cx.ty_of(value).clone();
            let fits = matches!(ty, Ty::Text | Ty::Device(_) | Ty::Unknown);
            if !fits {
                let wanted =
                    ExpectationReason::Because(Span::NONE, format!("`{name}` takes a text"));
                report::type_mismatch(
                    cx,
                    value,
                    &Ty::Text,
                    &crate::ty::TypeMismatchError::Kind,
                    &wanted,
                );
            }
            return fits;
        }
    };
    fits_port(cx, value, port, name)
}

/// Returns the result type of a call of a primitive: the type of its only out-port, or a tuple with the names and types
/// of all out-ports. `slots` are the arguments, on which array sizes depend.
pub(crate) fn prim_type(
    cx: &mut Body<'_, '_>,
    desc: &'static PrimDesc,
    slots: &PrimArgs,
    span: Span,
) -> Ty {
    let mut members = Vec::with_capacity(desc.outputs.len());
    for (k, port) in desc.outputs.iter().enumerate() {
        let ty = match port.ty {
            PortType::Scalar(scalar) => scalar_ty(scalar),
            _ => sized_output_type(cx, desc, slots, k, span),
        };
        members.push(Member {
            name: Some(port.name.into()),
            ty,
        });
    }
    match &members[..] {
        [one] => one.ty.clone(),
        _ => Ty::Tuple(members.into()),
    }
}

fn sized_output_type(
    cx: &mut Body<'_, '_>,
    desc: &'static PrimDesc,
    slots: &PrimArgs,
    port: usize,
    span: Span,
) -> Ty {
    let inputs: Vec<Option<Type>> = slots
        .inputs
        .iter()
        .map(|id| machine_type(cx.ty_of((*id)?)))
        .collect();
    let mut params = Vec::new();
    for (given, param) in slots.params.iter().zip(desc.params) {
        let value = match given {
            Some(id) => param_value(cx, *id, param.ty),
            None => param_default(param),
        };
        match value {
            Some(value) => params.push(value),
            None => return Ty::Unknown,
        }
    }
    let args = ShapeArgs {
        inputs: &inputs,
        params: &params,
    };
    match desc.out_type(port, &args) {
        Some(ty) => flow_type(ty),
        None => {
            let diagnostic = Diagnostic::new(
                Code::RPI2009,
                format!("size mismatch in the arguments of `{}`", desc.name),
            )
            .primary(span, "cannot infer the size of its result");
            report::report_diagnostic(cx, diagnostic);
            Ty::Unknown
        }
    }
}

fn param_value(cx: &mut Body<'_, '_>, id: ExprId, ty: ParamType) -> Option<Value> {
    if matches!(ty, ParamType::Str) {
        return Some(Value::Str(String::new()));
    }
    let leaves = consts::fold(cx, id)?;
    match ty {
        ParamType::Array(scalar) => Some(pack_leaves(scalar, &leaves)),
        _ => leaves.first().cloned(),
    }
}

fn port_accepts(port: PortType, ty: &Ty) -> bool {
    match (port, ty) {
        (PortType::Scalar(scalar), ty) => ty.scalar() == Some(scalar),
        (PortType::Array(scalar), Ty::Array(element, _)) => element.scalar() == Some(scalar),
        (PortType::Matrix, Ty::Array(row, _)) => {
            matches!(&**row, Ty::Array(element, _) if element.scalar() == Some(Scalar::Real))
        }
        _ => false,
    }
}

pub(crate) fn resolve_port_type(port: PortType) -> Ty {
    match port {
        PortType::Scalar(scalar) => scalar_ty(scalar),
        PortType::Array(_) | PortType::Matrix => Ty::Unknown,
    }
}

fn port_text(port: PortType) -> String {
    match port {
        PortType::Scalar(scalar) => format!("`{scalar}`"),
        PortType::Array(scalar) => format!("an array of `{scalar}`"),
        PortType::Matrix => "a matrix of reals".to_owned(),
    }
}
