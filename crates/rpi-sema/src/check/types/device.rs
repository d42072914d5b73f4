//! Resolution of device types.

use crate::check::bodies::body::Body;
use crate::check::reuse;
use crate::check::signatures::instance::instance_key;
use crate::check::signatures::static_args;
use crate::check::signatures::static_args::StaticBinding;
use crate::check::signatures::static_args::StaticBindings;
use crate::check::signatures::static_params;
use crate::check::types::type_decls::check_fields;
use crate::check::types::value_types;
use crate::check::{Checker, Constant, Lazy};
use crate::program::DeclId;
use crate::ty::{DevicePortTy, DeviceTy, Ty};
use crate::typed::{Unit, UnitKind};
use rpi_diag::Span;
use rpi_image::Value;
use rpi_syntax::ast::{DeviceDecl, DeviceSection, NamedType, PortKind, Type, TypeKind, VarDecl};
use std::rc::Rc;

/// Returns a device type with its static arguments. Parameters without an argument are given later by the cell
/// description.
pub(crate) fn resolve_device_type<'a>(
    cx: &mut Body<'_, 'a>,
    id: DeclId,
    decl: &'a DeviceDecl,
    named: &'a NamedType,
) -> Ty {
    let bound = static_args::bind_statics(cx, id, &named.statics);
    let mut statics = bound.statics;
    add_defaults(cx.checker, id, decl, &mut statics);
    device_type_instance(cx.checker, id, decl, &Rc::new(statics))
}

/// Checks the declaration of a device type on its own.
pub(crate) fn check_device<'a>(checker: &mut Checker<'a>, id: DeclId, decl: &'a DeviceDecl) {
    let mut statics = StaticBindings::new();
    add_defaults(checker, id, decl, &mut statics);
    device_type_instance(checker, id, decl, &Rc::new(statics));
}

/// Module and name of the device type whose number of axes the cell decides.
const ARM: (&str, &str) = ("motion", "Arm");

/// Adds to `statics` the values of the static parameters of a device type that have no argument: for the arm of the library
/// the number of axes of the cell's arms if it is known, otherwise the defaults.
fn add_defaults<'a>(
    checker: &mut Checker<'a>,
    id: DeclId,
    decl: &'a DeviceDecl,
    statics: &mut StaticBindings,
) {
    let program = checker.program;
    let module = &program.module(program.decl(id).module).name;
    let is_arm = (module.as_str(), decl.name.name.as_str()) == ARM;
    let axes = static_params::static_params(&decl.statics)
        .into_iter()
        .next();
    if let (true, Some(count), Some(axes)) = (is_arm, program.arm_axes, axes) {
        let count = Constant {
            ty: Ty::Int,
            leaves: [Value::int(i64::from(count))].into(),
        };
        let name = axes.name().name.clone();
        statics.entry(name).or_insert(StaticBinding::Value(count));
    }
    static_params::add_default_statics(checker, id, statics);
}

/// Returns the type that a device declaration defines for these static arguments.
fn device_type_instance<'a>(
    checker: &mut Checker<'a>,
    id: DeclId,
    decl: &'a DeviceDecl,
    statics: &Rc<StaticBindings>,
) -> Ty {
    let key = instance_key(id, statics);
    if let Some(Lazy::Done(Some(ty))) = checker.types.get(&key) {
        return ty.clone();
    }
    let unit = Unit::new(decl.name.name.clone(), UnitKind::Constant, Span::NONE);
    let mut body = Body::new(checker, id, statics.clone(), unit);
    body.in_signature = true;
    let ports = device_ports(&mut body, decl);
    let has_diagnostics = !body.diagnostics.is_empty();
    let frames = body.finish().free_frames;
    if has_diagnostics {
        reuse::taint(checker);
    }
    let ty = Ty::Device(Rc::new(DeviceTy {
        name: decl.name.name.clone(),
        ports,
        frames,
        sizes: sizes(decl, statics),
    }));
    checker.types.insert(key, Lazy::Done(Some(ty.clone())));
    ty
}

/// Returns the values of the static parameters of a device type in their order; `None` for a parameter without an
/// integer value.
fn sizes(decl: &DeviceDecl, statics: &StaticBindings) -> Vec<Option<u32>> {
    let params = static_params::static_params(&decl.statics).into_iter();
    let sizes = params.map(|param| match statics.get(&param.name().name)? {
        StaticBinding::Value(value) => {
            let size = value.leaves.first()?.as_int()?;
            u32::try_from(size).ok()
        }
        _ => None,
    });
    sizes.collect()
}

/// Returns the ports of a device declaration. Ports with the same actuator number belong to one actuator.
fn device_ports<'a>(cx: &mut Body<'_, 'a>, decl: &'a DeviceDecl) -> Vec<DevicePortTy> {
    let mut ports = Vec::new();
    let mut actuator = 0;
    for section in &decl.sections {
        section_ports(cx, section, &mut actuator, &mut ports);
    }
    ports
}

/// Appends the ports of a section of a device declaration to `ports`. `actuator` is the number of the next actuator and
/// is increased.
fn section_ports<'a>(
    cx: &mut Body<'_, 'a>,
    section: &'a DeviceSection,
    actuator: &mut u32,
    ports: &mut Vec<DevicePortTy>,
) {
    let is_actuator = section.kind == PortKind::Actuator;
    for port in &section.ports {
        for alternative in &port.alternatives {
            let before = ports.len();
            alternative_ports(cx, alternative, is_actuator, *actuator, ports);
            if is_actuator && port.alternatives.len() == 1 {
                // `a, b: T` are two actuators, `a: T | b: U` is one.
                for (k, port) in (0..).zip(&mut ports[before..]) {
                    port.actuator = *actuator + k;
                }
            }
        }
        if is_actuator {
            *actuator = ports.iter().map(|p| p.actuator).max().unwrap_or(0) + 1;
        }
    }
}

/// Appends the ports that `decl` declares to `ports`: one alternative for the set-points of actuator number `actuator`,
/// or a sensor.
fn alternative_ports<'a>(
    cx: &mut Body<'_, 'a>,
    decl: &'a VarDecl,
    is_actuator: bool,
    actuator: u32,
    ports: &mut Vec<DevicePortTy>,
) {
    let (inner, optional) = match &decl.ty.kind {
        TypeKind::Optional(inner) => (&**inner, true),
        _ => (&decl.ty, false),
    };
    let ty = has_known_size(cx, inner).then(|| match &inner.kind {
        TypeKind::Struct(parts) if !is_actuator => Ty::Tuple(check_fields(cx, parts).into()),
        _ => value_types::resolve_value_type(cx, inner),
    });
    // Times cross the device interface in seconds: a device does not know the cycle time.
    let ty = ty.map(|ty| crate::ty::machine_types::external_type(&ty).0);
    for name in &decl.names {
        ports.push(DevicePortTy {
            name: name.name.clone(),
            ty: ty.clone(),
            optional,
            is_actuator,
            actuator,
        });
    }
}

/// Whether the compiler knows all array sizes in a type. Some sizes depend on parameters that only the cell description
/// gives.
fn has_known_size(cx: &Body<'_, '_>, ty: &Type) -> bool {
    match &ty.kind {
        TypeKind::Optional(inner) => has_known_size(cx, inner),
        TypeKind::Array(array) => {
            let open = array.size.as_name().and_then(|name| cx.statics.get(name));
            !matches!(open, Some(StaticBinding::LoadTime)) && has_known_size(cx, &array.element)
        }
        TypeKind::Struct(parts) => parts.iter().all(|part| has_known_size(cx, &part.ty)),
        _ => true,
    }
}
