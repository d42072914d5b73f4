//! Access to parts of values: fields, array elements, slices, and ports of devices.

use crate::check::bodies::automaton;
use crate::check::bodies::body::Body;
use crate::check::bodies::locals;
use crate::check::bodies::locals::Local;
use crate::check::diagnostics::report;
use crate::check::diagnostics::report::join_names;
use crate::check::diagnostics::report::members_help;
use crate::check::diagnostics::report::no_member;
use crate::check::exprs::expr;
use crate::check::exprs::indexing;
use crate::check::exprs::names;
use crate::check::exprs::names::plain_name;
use crate::check::exprs::spatial_parts;
use crate::check::types::consts;
use crate::check::types::type_decls;
use crate::program::{DeclKind, Lookup};
use crate::ty::{DevicePortTy, DeviceTy, Member, Substitution, Ty};
use crate::typed::TypedKind;
use crate::typed::{BlockId, ExprId, FlowId, TargetPlace};
use rpi_diag::{Code, Diagnostic, Fix, Span};
use rpi_syntax::Name;
use rpi_syntax::ast::{self, Access, ExprKind, Field, Ident};
use std::rc::Rc;

/// Returns a description of a value for messages: its type, or "the call `f`" if the value is the tuple of a call's
/// outputs.
fn value_description(cx: &Body<'_, '_>, value: ExprId) -> String {
    match (cx.ty_of(value), &cx.unit.expr(value).kind) {
        (Ty::Tuple(_), TypedKind::Flow(flow)) => format!("the call `{}`", cx.unit.flow(*flow).name),
        (Ty::Tuple(_), _) => "this call".to_owned(),
        (ty, _) => format!("`{ty}`"),
    }
}

/// Returns the names of a device's sensor ports, for messages.
fn sensor_list(device: &DeviceTy) -> String {
    let ports = device.ports.iter().filter(|port| !port.is_actuator);
    join_names(ports.map(|port| port.name.as_str()))
}

/// Returns the equations that give a device a set-point: `arm.tcp = ...;` or `arm.joints = ...;`.
fn actuator_target_help(name: &Name, device: &DeviceTy) -> String {
    let actuators = device.ports.iter().filter(|port| port.is_actuator);
    let forms: Vec<String> = actuators
        .map(|port| format!("`{name}.{} = ...;`", port.name))
        .collect();
    match forms.is_empty() {
        true => "this device has no actuator ports".to_owned(),
        false => format!(
            "write a set-point to an actuator port: {}",
            forms.join(" or ")
        ),
    }
}

/// Returns the diagnostic for a field or output `field` that a value of type `ty` lacks, with the list of the existing
/// ones. `of` describes the value.
pub(crate) fn unknown_member(ty: &Ty, of: &str, field: &Ident) -> Diagnostic {
    let near = rpi_diag::suggest(&field.name, member_names(ty.members()));
    let diagnostic = no_member(of, &field.name, field.span, near);
    match ty {
        Ty::Tuple(_) if member_names(ty.members()).next().is_none() => {
            diagnostic.help("its values have no names: assign it to a tuple, `(a, b) = ...`")
        }
        Ty::Tuple(_) => diagnostic.help(members_help("output", member_names(ty.members()))),
        Ty::Struct(of) if !of.fields.is_empty() => {
            diagnostic.help(members_help("field", member_names(ty.members())))
        }
        _ => diagnostic,
    }
}

/// Returns the names of the fields of a struct or of the outputs of a call. Members without a name are left out.
pub(crate) fn member_names(parts: &[Member]) -> impl Iterator<Item = &str> {
    parts.iter().filter_map(|member| member.name.as_deref())
}

/// Checks a field access `base.field` and returns its typed expression. `base` may also be a fragment, a state, a
/// command or a device.
pub(crate) fn field_access<'a>(cx: &mut Body<'_, 'a>, field: &'a Field, span: Span) -> ExprId {
    if let Some(block) = named_block(cx, &field.base) {
        return block_member(cx, block, &field.field, span);
    }
    if let Some(name) = plain_name(&field.base)
        && let Some(result) = names::command_result(cx, name, &field.field, span)
    {
        return result;
    }
    if let Some(name) = plain_name(&field.base)
        && let Some(value) = enum_value_by_field(cx, name, field)
    {
        return value;
    }
    let base = expr::check_expr(cx, &field.base);
    member_access(cx, base, &field.field)
}

/// Reports `Mode.Moving`, because an enum value is written without its type, and returns an expression without a value.
/// Returns `None` if `name` is not an enum.
fn enum_value_by_field(cx: &mut Body<'_, '_>, name: &Name, field: &Field) -> Option<ExprId> {
    let Lookup::Found(id) = cx.checker.program.lookup(cx.module, name) else {
        return None;
    };
    if locals::find_local(cx, name).is_some()
        || !matches!(cx.checker.program.decl(id).kind, DeclKind::Type(_))
    {
        return None;
    }
    let Ty::Enum(ty) = type_decls::type_decl(cx.checker, id) else {
        return None;
    };
    let value = &field.field;
    let whole = field.base.span.merge(value.span);
    if !ty.values.contains(&value.name) {
        let near = rpi_diag::suggest(&value.name, ty.values.iter().map(Name::as_str));
        let diagnostic = no_member(&format!("the enum `{name}`"), &value.name, value.span, near);
        return Some(cx.report_error_expr(diagnostic, whole));
    }
    let diagnostic = Diagnostic::new(
        Code::RPI1003,
        format!("`{}` must be written without its type", value.name),
    )
    .primary(field.base.span, format!("`{name}` is an enum type"))
    .fix(Fix::sure(format!("write `{}`", value.name)).replace(whole, value.name.as_str()));
    Some(cx.report_error_expr(diagnostic, whole))
}

/// Reports `Mode::Moving`, because an enum value is written without its type, and returns an expression without a
/// value. Returns `None` if the path does not start with an enum.
pub(crate) fn enum_value_by_path(cx: &mut Body<'_, '_>, name: &Name, span: Span) -> Option<ExprId> {
    let (of, value) = name.rsplit_once("::")?;
    let Lookup::Found(id) = cx.checker.program.lookup(cx.module, &of.into()) else {
        return None;
    };
    if !matches!(cx.checker.program.decl(id).kind, DeclKind::Type(_)) {
        return None;
    }
    let Ty::Enum(ty) = type_decls::type_decl(cx.checker, id) else {
        return None;
    };
    if !ty.values.iter().any(|known| known == value) {
        let values = || ty.values.iter().map(Name::as_str);
        let near = rpi_diag::suggest(value, values());
        let diagnostic = no_member(&format!("the enum `{of}`"), value, span, near)
            .help(members_help("value", values()));
        return Some(cx.report_error_expr(diagnostic, span));
    }
    let diagnostic = Diagnostic::new(
        Code::RPI1003,
        format!("`{value}` must be written without its type"),
    )
    .primary(span, format!("`{of}` is an enum type"))
    .fix(Fix::sure(format!("write `{value}`")).replace(span, value));
    Some(cx.report_error_expr(diagnostic, span))
}

/// Returns the block of the inline fragment or state that the expression `inner` or `outer.inner` names; `None` for
/// other expressions.
fn named_block(cx: &Body<'_, '_>, expr: &ast::Expr) -> Option<BlockId> {
    let local = match (plain_name(expr), &expr.kind) {
        (Some(name), _) => locals::find_local(cx, name),
        (None, ExprKind::Field(field)) => {
            let outer = named_block(cx, &field.base)?;
            locals::find_in_block(cx, outer, &field.field.name)
        }
        _ => None,
    };
    match local? {
        Local::Block(block) | Local::State(block) => Some(block),
        _ => None,
    }
}

/// Returns an expression that reads the flow `field` of an inline fragment or state from outside of it. Reports an
/// unknown flow.
pub(crate) fn block_member(
    cx: &mut Body<'_, '_>,
    block: BlockId,
    field: &Ident,
    span: Span,
) -> ExprId {
    match locals::find_in_block(cx, block, &field.name) {
        Some(Local::Flow(flow)) => names::flow_expr(cx, flow, span),
        Some(Local::Constant(constant)) => names::constant_expr(cx, &constant, span),
        Some(Local::AmbiguousState(places, _)) => {
            names::ambiguous_state(cx, &field.name, places, span)
        }
        _ => {
            let near = cx.checker.suggest(&field.name, locals::names_in(cx, block));
            let flows = members_help("flow", locals::names_in(cx, block));
            let what = match automaton::is_state(cx, block) {
                true => "state",
                false => "fragment",
            };
            let of = format!("the {what} `{}`", cx.unit.block(block).name);
            let diagnostic = no_member(&of, &field.name, field.span, near);
            cx.report_error_expr(
                diagnostic.help(format!(
                    "{flows}; define `{0}` in the {what}: `{0} = ...;`",
                    field.name
                )),
                span,
            )
        }
    }
}

/// Checks access to a member of a value by name: a field, an output of a call, or a sensor port of a device. Returns
/// its typed expression.
pub(crate) fn member_access(cx: &mut Body<'_, '_>, base: ExprId, field: &Ident) -> ExprId {
    let span = cx.span_of(base).merge(field.span);
    match cx.ty_of(base).clone() {
        Ty::Unknown => cx.error_expr(span),
        Ty::Device(device) => sensor_access(cx, base, &device, field, span),
        Ty::Spatial(..) => spatial_parts::spatial_part(cx, base, field, span),
        ty => match find_member(&ty, &field.name) {
            Some((at, ty)) => cx.add(TypedKind::Part { base, at }, ty, span),
            None => cx.report_error_expr(
                unknown_member(&ty, &value_description(cx, base), field),
                span,
            ),
        },
    }
}

fn sensor_access(
    cx: &mut Body<'_, '_>,
    base: ExprId,
    device: &Rc<DeviceTy>,
    field: &Ident,
    span: Span,
) -> ExprId {
    let found = device.ports.iter().position(|port| port.name == field.name);
    let Some(index) = found else {
        let near = rpi_diag::suggest(&field.name, device.ports.iter().map(|p| p.name.as_str()));
        let diagnostic = no_member(
            &format!("the device type `{}`", device.name),
            &field.name,
            field.span,
            near,
        );
        let sensors = device.ports.iter().filter(|port| !port.is_actuator);
        let help = members_help("sensor port", sensors.map(|port| port.name.as_str()));
        return cx.report_error_expr(diagnostic.help(help), span);
    };
    let port = &device.ports[index];
    if port.is_actuator {
        let diagnostic = Diagnostic::new(
            Code::RPI6001,
            format!("`{}` is an actuator port", field.name),
        )
        .primary(field.span, "an actuator port cannot be read")
        .help(format!(
            "read measured values and the last set-point from its sensor ports: {}",
            sensor_list(device)
        ));
        return cx.report_error_expr(diagnostic, span);
    }
    let Some(ty) = port_type(cx, base, device, port, field.span) else {
        return cx.error_expr(span);
    };
    let port = u32::try_from(index).unwrap_or(u32::MAX);
    cx.add(TypedKind::Sensor { device: base, port }, ty, span)
}

/// Returns the type of a device's port. The frames in the type are those of the device that the expression `base`
/// reads. Reports an array size that depends on a parameter without a value, and returns `None`.
fn port_type(
    cx: &mut Body<'_, '_>,
    base: ExprId,
    device: &DeviceTy,
    port: &DevicePortTy,
    span: Span,
) -> Option<Ty> {
    let Some(ty) = &port.ty else {
        let diagnostic = Diagnostic::new(
            Code::RPI2008,
            format!("cannot infer the size of `{}`", port.name),
        )
        .primary(
            span,
            format!("it depends on a parameter of `{}`", device.name),
        )
        .help(format!(
            "give the parameter in the type: `{}<<7>>`",
            device.name
        ));
        report::report_diagnostic(cx, diagnostic);
        return None;
    };
    let TypedKind::Flow(flow) = cx.unit.expr(base).kind else {
        return Some(ty.clone());
    };
    Some(ty.substituted(&device_frame_subst(cx, device, flow)))
}

/// Returns the substitution that replaces the frames of a device type by those of the device that `flow` holds: `tcp`
/// becomes `arm.tcp`.
pub(crate) fn device_frame_subst(
    cx: &Body<'_, '_>,
    device: &DeviceTy,
    flow: FlowId,
) -> Substitution {
    let name = &cx.unit.flow(flow).name;
    let frame = |local: &rpi_syntax::Name| (local.clone(), Some(format!("{name}.{local}").into()));
    Substitution {
        frames: device.frames.iter().map(frame).collect(),
        ..Substitution::default()
    }
}

/// Returns the actuator port that the target `arm.tcp` of an equation defines, and the type of the port. `flow` holds
/// the device. After an error, it returns a target and a type that cause no further errors.
pub(crate) fn actuator_target<'a>(
    cx: &mut Body<'_, 'a>,
    flow: FlowId,
    device: &Rc<DeviceTy>,
    target: &'a ast::Target,
) -> (TargetPlace, Ty) {
    let nowhere = (TargetPlace::Nowhere, Ty::Unknown);
    let [Access::Field(field)] = &target.path[..] else {
        let diagnostic = Diagnostic::new(
            Code::RPI1003,
            format!("cannot define the device `{}`", target.name.name),
        )
        .primary(target.span, "only its actuator ports can be defined")
        .help(actuator_target_help(&target.name.name, device));
        report::report_diagnostic(cx, diagnostic);
        return nowhere;
    };
    let actuators = device.ports.iter().filter(|port| port.is_actuator);
    let Some(index) = device
        .ports
        .iter()
        .position(|p| p.is_actuator && p.name == field.name)
    else {
        let near = rpi_diag::suggest(&field.name, actuators.map(|p| p.name.as_str()));
        let of = format!("the device type `{}`", device.name);
        let diagnostic = match device.port(&field.name) {
            Some(_) => Diagnostic::new(Code::RPI6001, format!("`{}` is a sensor port", field.name))
                .primary(field.span, "a sensor port cannot be defined")
                .help(actuator_target_help(&target.name.name, device)),
            None => no_member(&of, &field.name, field.span, near),
        };
        report::report_diagnostic(cx, diagnostic);
        return nowhere;
    };
    let base = cx.add(
        TypedKind::Flow(flow),
        Ty::Device(device.clone()),
        target.name.span,
    );
    let ty = port_type(cx, base, device, &device.ports[index], field.span);
    let port = u32::try_from(index).unwrap_or(u32::MAX);
    (
        TargetPlace::Port { device: flow, port },
        ty.unwrap_or(Ty::Unknown),
    )
}

/// Returns the first leaf (scalar part) and the type of the part that a path of fields, elements and slices selects in
/// a value. The value has the type `ty` and starts at leaf `at`. `None` after an error.
pub(crate) fn resolve_path<'a>(
    cx: &mut Body<'_, 'a>,
    ty: &Ty,
    at: u32,
    path: &'a [Access],
) -> Option<(u32, Ty)> {
    let Some((first, rest)) = path.split_first() else {
        return Some((at, ty.clone()));
    };
    if ty.is_unknown() {
        return None;
    }
    let (offset, inner) = match (first, ty) {
        (Access::Field(field), _) => resolve_field(cx, ty, field)?,
        (Access::Index(index), Ty::Array(element, n)) => {
            let k = consts::const_integer(cx, index)?;
            let k = indexing::checked_index(cx, k, *n, index.span)?;
            (k * leaf_count(element), (**element).clone())
        }
        (Access::Slice(slice), Ty::Array(element, n)) => {
            indexing::resolve_slice(cx, element, *n, slice)?
        }
        (Access::Index(ast::Expr { span, .. }), _) => {
            return indexing::not_indexable(cx, ty, *span);
        }
        (Access::Slice(slice), _) => return indexing::not_indexable(cx, ty, slice.from.span),
    };
    resolve_path(cx, &inner, at + offset, rest)
}

/// Returns the index of the first leaf (scalar part) and the type of a field. Reports an unknown field and returns
/// `None`.
pub(crate) fn resolve_field(cx: &mut Body<'_, '_>, ty: &Ty, field: &Ident) -> Option<(u32, Ty)> {
    let found = find_member(ty, &field.name);
    if found.is_none() {
        let diagnostic = unknown_member(ty, &format!("`{ty}`"), field);
        report::report_diagnostic(cx, diagnostic);
    }
    found
}

/// Returns the number of leaves (scalar parts) of a type. A number above `u32::MAX` is returned as `u32::MAX`.
pub(crate) fn leaf_count(ty: &Ty) -> u32 {
    u32::try_from(ty.leaf_count()).unwrap_or(u32::MAX)
}

/// Returns the index of the first leaf (scalar part) and the type of the member with this name; `None` if there is no
/// such member.
pub(crate) fn find_member(ty: &Ty, name: &str) -> Option<(u32, Ty)> {
    let members = ty.members();
    let index = members
        .iter()
        .position(|m| m.name.as_deref() == Some(name))?;
    let before = members[..index].iter().map(|m| leaf_count(&m.ty));
    Some((before.sum(), members[index].ty.clone()))
}
