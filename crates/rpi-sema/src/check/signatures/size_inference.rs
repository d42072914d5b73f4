//! Inference of array sizes: a size without a static argument follows from the types of the arguments, arrays or devices, in
//! calls of nodes and fragments and in steps that run commands.

use crate::check::bodies::body::Body;
use crate::check::calls::args::CallArgument;
use crate::check::signatures::static_args::StaticBinding;
use crate::check::signatures::static_args::StaticBindings;
use crate::check::signatures::static_params::StaticParamDecl;
use crate::check::signatures::static_params::static_params;
use crate::check::signatures::unit;
use crate::check::{Checker, Constant};
use crate::program::{DeclId, DeclKind};
use crate::ty::{DeviceTy, Ty};
use rpi_image::Value;
use rpi_syntax::Name;
use rpi_syntax::ast::{
    ExprKind, Ident, NamedType, Signature, StaticParam, StaticValue, Type, TypeKind, VarDecl,
};

/// Adds to `statics` the values of the size parameters of `id` without an argument that follow from the type of an
/// argument in `given`. Returns `false` if a size depends on an argument whose type is not known yet.
pub(crate) fn infer_size_params<'a>(
    cx: &mut Body<'_, 'a>,
    id: DeclId,
    given: &[CallArgument<'a>],
    statics: &mut StaticBindings,
) -> bool {
    let Some((statics_declared, ports)) =
        signature_of(cx.checker, id).filter(|_| unit::reads_rpi_syntax(cx))
    else {
        return true;
    };
    let mut known = true;
    for param in static_params(statics_declared) {
        let StaticParamDecl::Value(name, _) = param else {
            continue;
        };
        if statics.contains_key(&name.name) || given.iter().any(|arg| is_named(arg, &name.name)) {
            continue;
        }
        match infer_size(cx, ports, &name.name, given) {
            InferredSize::Size(size) => {
                let constant = Constant {
                    ty: Ty::Int,
                    leaves: [Value::int(i64::from(size))].into(),
                };
                statics.insert(name.name.clone(), StaticBinding::Value(constant));
            }
            InferredSize::Pending => known = false,
            InferredSize::Undetermined => {}
        }
    }
    known
}

fn infer_size<'a>(
    cx: &Body<'_, 'a>,
    ports: &'a [VarDecl],
    name: &Name,
    given: &[CallArgument<'a>],
) -> InferredSize {
    let ports = ports
        .iter()
        .flat_map(|port| port.names.iter().map(move |n| (n, &port.ty)));
    let mut by_place = given.iter().filter(|arg| arg.name.is_none());
    let mut size = InferredSize::Undetermined;
    for (port, ty) in ports {
        let named = given.iter().find(|arg| is_named(arg, &port.name));
        let Some(arg) = named.or_else(|| by_place.next()) else {
            continue;
        };
        match size_from_type(ty, cx.ty_of(arg.value), name) {
            InferredSize::Undetermined => {}
            InferredSize::Pending => size = InferredSize::Pending,
            known @ InferredSize::Size(_) => return known,
        }
    }
    size
}

/// Returns the static parameters of a node, fragment or command, and the ports or parameters to which a call or a step passes
/// arguments. `None` for other declarations.
fn signature_of<'a>(
    checker: &Checker<'a>,
    id: DeclId,
) -> Option<(&'a [StaticParam], &'a [VarDecl])> {
    let ports = |signature: &'a Signature| signature.inputs.as_deref().unwrap_or_default();
    match checker.program.decl(id).kind {
        DeclKind::Node(decl) => Some((&decl.signature.statics, ports(&decl.signature))),
        DeclKind::Fragment(decl) => Some((&decl.signature.statics, ports(&decl.signature))),
        DeclKind::Command(decl) => Some((&decl.statics, &decl.params)),
        _ => None,
    }
}

/// Result of inferring a size parameter from the type of an argument.
enum InferredSize {
    /// The type of the argument gives this size.
    Size(u32),
    /// The size cannot be inferred yet, because the type of the argument is unknown.
    Pending,
    /// The type of the argument is known, but it does not determine the size.
    Undetermined,
}

fn is_named(arg: &CallArgument<'_>, name: &Name) -> bool {
    arg.name.is_some_and(|given: &Ident| given.name == *name)
}

/// Returns the value of the size parameter `name` in the port type `named`, such as `D<<n>>`. `device` is the type of
/// the device that is passed for the port.
fn size_of_device(named: &NamedType, device: &DeviceTy, name: &Name) -> InferredSize {
    let mut args = named.statics.iter().zip(&device.sizes);
    let found = args.find(|(arg, _)| {
        let value = match &arg.value {
            StaticValue::Expr(value) => value.as_name(),
            _ => None,
        };
        arg.name.is_none() && value == Some(name)
    });
    match found {
        Some((_, Some(size))) => InferredSize::Size(*size),
        _ => InferredSize::Undetermined,
    }
}

/// Returns the value of the size parameter `name` in a declared port type such as `T^n`, `T^n^3` or `T^n?`. `found` is
/// the type of the argument.
fn size_from_type(mut declared: &Type, mut found: &Ty, name: &Name) -> InferredSize {
    loop {
        match (&declared.kind, found) {
            (TypeKind::Optional(inner), _) => declared = inner,
            (TypeKind::Array(array), Ty::Array(element, size)) => {
                if matches!(&array.size.kind, ExprKind::Name(size) if size == name) {
                    return InferredSize::Size(*size);
                }
                (declared, found) = (&array.element, element);
            }
            (TypeKind::Named(named), Ty::Device(device)) => {
                return size_of_device(named, device, name);
            }
            (TypeKind::Array(_), Ty::Unknown) => return InferredSize::Pending,
            _ => return InferredSize::Undetermined,
        }
    }
}
