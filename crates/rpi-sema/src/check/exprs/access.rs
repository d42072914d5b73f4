//! Access to parts of values: fields, array elements, slices, and ports of devices.

use crate::check::bodies::automaton;
use crate::check::bodies::body::Body;
use crate::check::bodies::locals;
use crate::check::bodies::locals::Local;
use crate::check::bodies::statement;
use crate::check::diagnostics::precedence_hints;
use crate::check::diagnostics::report;
use crate::check::diagnostics::report::Wanted;
use crate::check::diagnostics::report::listed;
use crate::check::diagnostics::report::no_member;
use crate::check::exprs::expr;
use crate::check::exprs::names;
use crate::check::exprs::names::plain_name;
use crate::check::exprs::spatial_parts;
use crate::check::signatures::unit;
use crate::check::types;
use crate::check::types::consts;
use crate::check::types::is_foreign;
use crate::program::{DeclKind, Lookup};
use crate::ty::{DevicePortTy, DeviceTy, Member, Subst, Ty};
use crate::typed::{BlockId, ExprId, FlowId, Kind, Leaf, Place};
use rpi_diag::{Code, Finding, Fix, Span};
use rpi_syntax::Name;
use rpi_syntax::ast::{self, Access, ExprKind, Field, Ident, Index, Slice, SliceOf};
use std::rc::Rc;

/// Slice of an array with bounds that are known at compile time.
struct Range {
    /// Index of the first element.
    from: u32,
    /// Distance between two elements; negative in a descending slice.
    step: i32,
    /// Number of elements.
    len: u32,
}

/// Returns the name of a value in messages: its type, or "this call" for the outputs of a call.
fn owner(ty: &Ty) -> String {
    match ty {
        Ty::Tuple(_) => "this call".to_owned(),
        ty => format!("`{ty}`"),
    }
}

/// Returns the names of a device's actuator ports or of its sensor ports, for messages.
fn ports(device: &DeviceTy, actuators: bool) -> String {
    let ports = device
        .ports
        .iter()
        .filter(|port| port.is_actuator == actuators);
    listed(ports.map(|port| port.name.as_str()))
}

/// Returns the diagnostic for an unknown field or output, with the list of the existing ones.
pub(crate) fn no_part(ty: &Ty, of: &str, field: &Ident) -> Finding {
    let near = rpi_diag::suggest(&field.name, names_of(ty.members()));
    let finding = no_member(of, &field.name, field.span, near);
    let what = match ty {
        Ty::Tuple(_) => "outputs",
        Ty::Struct(_) => "fields",
        _ => return finding,
    };
    let names: Vec<&str> = names_of(ty.members()).collect();
    match names.is_empty() {
        true => finding,
        false => finding.help(format!("its {what} are {}", names.join(", "))),
    }
}

/// Returns the names of the named members.
pub(crate) fn names_of(parts: &[Member]) -> impl Iterator<Item = &str> {
    parts.iter().filter_map(|member| member.name.as_deref())
}

/// Checks `base.field`.
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

/// Reports `Mode.Moving`: an enum value is written without its type. Returns `None` if `name` is not an enum.
fn enum_value_by_field(cx: &mut Body<'_, '_>, name: &Name, field: &Field) -> Option<ExprId> {
    let Lookup::Found(id) = cx.c.program.lookup(cx.module, name) else {
        return None;
    };
    if locals::find_local(cx, name).is_some()
        || !matches!(cx.c.program.decl(id).kind, DeclKind::Type(_))
    {
        return None;
    }
    let Ty::Enum(ty) = types::type_decl(cx.c, id) else {
        return None;
    };
    let value = &field.field;
    let whole = field.base.span.merge(value.span);
    if !ty.values.contains(&value.name) {
        let near = rpi_diag::suggest(&value.name, ty.values.iter().map(Name::as_str));
        let finding = no_member(&format!("the enum `{name}`"), &value.name, value.span, near);
        return Some(cx.fault_with(finding, whole));
    }
    let finding = Finding::new(
        Code::RPI1003,
        format!("`{}` must be written without its type", value.name),
    )
    .at(field.base.span, format!("`{name}` is an enum type"))
    .fix(Fix::sure(format!("write `{}`", value.name)).replace(whole, value.name.as_str()));
    Some(cx.fault_with(finding, whole))
}

/// Reports `Mode::Moving`: an enum value is written without its type. Returns `None` if the path does not start
/// with an enum.
pub(crate) fn enum_value_by_path(cx: &mut Body<'_, '_>, name: &Name, span: Span) -> Option<ExprId> {
    let (of, value) = name.rsplit_once("::")?;
    let Lookup::Found(id) = cx.c.program.lookup(cx.module, &of.into()) else {
        return None;
    };
    if !matches!(cx.c.program.decl(id).kind, DeclKind::Type(_)) {
        return None;
    }
    let Ty::Enum(ty) = types::type_decl(cx.c, id) else {
        return None;
    };
    if !ty.values.iter().any(|known| known == value) {
        let near = rpi_diag::suggest(value, ty.values.iter().map(Name::as_str));
        let finding = no_member(&format!("the enum `{of}`"), value, span, near);
        return Some(cx.fault_with(finding, span));
    }
    let finding = Finding::new(
        Code::RPI1003,
        format!("`{value}` must be written without its type"),
    )
    .at(span, format!("`{of}` is an enum type"))
    .fix(Fix::sure(format!("write `{value}`")).replace(span, value));
    Some(cx.fault_with(finding, span))
}

/// Returns the block of the inline fragment or state that `inner` or `outer.inner` names.
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

/// Reads a flow of an inline fragment or state from outside of it.
pub(crate) fn block_member(
    cx: &mut Body<'_, '_>,
    block: BlockId,
    field: &Ident,
    span: Span,
) -> ExprId {
    match locals::find_in_block(cx, block, &field.name) {
        Some(Local::Flow(flow)) => names::flow_expr(cx, flow, span),
        Some(Local::Constant(constant)) => names::constant_expr(cx, &constant, span),
        Some(Local::States(places, _)) => names::ambiguous_state(cx, &field.name, places, span),
        _ => {
            let near = cx.c.suggest(&field.name, locals::names_in(cx, block));
            let what = match automaton::is_state(cx, block) {
                true => "state",
                false => "fragment",
            };
            let of = format!("the {what} `{}`", cx.unit.block(block).name);
            let finding = no_member(&of, &field.name, field.span, near);
            cx.fault_with(finding, span)
        }
    }
}

/// Checks access to a member of a value by name: a field, an output, or a sensor port.
pub(crate) fn member_access(cx: &mut Body<'_, '_>, base: ExprId, field: &Ident) -> ExprId {
    let span = cx.span_of(base).merge(field.span);
    match cx.ty_of(base).clone() {
        Ty::Unknown => cx.fault(span),
        Ty::Device(device) => sensor_access(cx, base, &device, field, span),
        Ty::Spatial(..) => spatial_parts::spatial_part(cx, base, field, span),
        ty => match member_of(&ty, &field.name) {
            Some((at, ty)) => cx.add(Kind::Part { base, at }, ty, span),
            None => cx.fault_with(no_part(&ty, &owner(&ty), field), span),
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
        let finding = no_member(
            &format!("the device type `{}`", device.name),
            &field.name,
            field.span,
            near,
        );
        return cx.fault_with(finding, span);
    };
    let port = &device.ports[index];
    if port.is_actuator {
        let finding = Finding::new(
            Code::RPI6001,
            format!("`{}` is an actuator port", field.name),
        )
        .at(field.span, "an actuator port cannot be read")
        .help(format!(
            "read measured values and the last set-point from its sensor ports: {}",
            ports(device, false)
        ));
        return cx.fault_with(finding, span);
    }
    let Some(ty) = port_type(cx, base, device, port, field.span) else {
        return cx.fault(span);
    };
    let port = u32::try_from(index).unwrap_or(u32::MAX);
    cx.add(Kind::Sensor { device: base, port }, ty, span)
}

/// Returns the type of a device's port, with the frames of this device. Reports a size that depends on a parameter
/// without a value.
fn port_type(
    cx: &mut Body<'_, '_>,
    base: ExprId,
    device: &DeviceTy,
    port: &DevicePortTy,
    span: Span,
) -> Option<Ty> {
    let Some(ty) = &port.ty else {
        let finding = Finding::new(
            Code::RPI2008,
            format!("cannot infer the size of `{}`", port.name),
        )
        .at(
            span,
            format!("it depends on a parameter of `{}`", device.name),
        )
        .help(format!(
            "give the parameter in the type: `{}<<7>>`",
            device.name
        ));
        report::report_diagnostic(cx, finding);
        return None;
    };
    let Kind::Flow(flow) = cx.unit.expr(base).kind else {
        return Some(ty.clone());
    };
    Some(ty.substituted(&device_frame_subst(cx, device, flow)))
}

/// Returns the substitution of the frames of a device type by those of the device that `flow` holds: `tcp` becomes
/// `arm.tcp`.
pub(crate) fn device_frame_subst(cx: &Body<'_, '_>, device: &DeviceTy, flow: FlowId) -> Subst {
    let name = &cx.unit.flow(flow).name;
    let frame = |local: &rpi_syntax::Name| (local.clone(), Some(format!("{name}.{local}").into()));
    Subst {
        frames: device.frames.iter().map(frame).collect(),
        ..Subst::default()
    }
}

/// Returns the actuator port that the target `arm.tcp` defines, and its type.
pub(crate) fn actuator_target<'a>(
    cx: &mut Body<'_, 'a>,
    flow: FlowId,
    device: &Rc<DeviceTy>,
    target: &'a ast::Target,
) -> (Place, Ty) {
    let nowhere = (Place::Nowhere, Ty::Unknown);
    let [Access::Field(field)] = &target.path[..] else {
        let finding = Finding::new(
            Code::RPI1003,
            format!("cannot define the device `{}`", target.name.name),
        )
        .at(target.span, "only its actuator ports can be defined")
        .help(format!("write `{}.port = ...;`", target.name.name));
        report::report_diagnostic(cx, finding);
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
        let finding = match device.port(&field.name) {
            Some(_) => Finding::new(Code::RPI6001, format!("`{}` is a sensor port", field.name))
                .at(field.span, "a sensor port cannot be defined")
                .help(format!("write set-points to {}", ports(device, true))),
            None => no_member(&of, &field.name, field.span, near),
        };
        report::report_diagnostic(cx, finding);
        return nowhere;
    };
    let base = cx.add(
        Kind::Flow(flow),
        Ty::Device(device.clone()),
        target.name.span,
    );
    let ty = port_type(cx, base, device, &device.ports[index], field.span);
    let port = u32::try_from(index).unwrap_or(u32::MAX);
    (
        Place::Port { device: flow, port },
        ty.unwrap_or(Ty::Unknown),
    )
}

/// Checks `base[index]`.
pub(crate) fn index_access<'a>(cx: &mut Body<'_, 'a>, index: &'a Index, span: Span) -> ExprId {
    let base = expr::check_expr(cx, &index.base);
    if precedence_hints::is_unit_index(cx, base, &index.index) {
        return precedence_hints::unit_after_flow(cx, base, &index.index, span);
    }
    let at = expr::check_expr(cx, &index.index);
    if is_foreign(cx.ty_of(base), &["map<"]) {
        check_map_key(cx, base, at);
        return report_not_an_array(cx, base, span);
    }
    statement::expect_type(
        cx,
        at,
        &Ty::Int,
        &Wanted::By(Span::NONE, "an index must be an integer".into()),
    );
    if let Ty::Tuple(members) = cx.ty_of(base).clone()
        && !unit::reads_rpi_syntax(cx)
        && members.iter().all(|member| member.name.is_none())
    {
        return tuple_index(cx, base, at, &members, span);
    }
    let Ty::Array(element, n) = cx.ty_of(base).clone() else {
        return report_not_an_array(cx, base, span);
    };
    match const_int(cx, at) {
        Some(k) => match checked_index(cx, k, n, cx.span_of(at)) {
            Some(k) => {
                let at = k * leaves(&element);
                cx.add(Kind::Part { base, at }, (*element).clone(), span)
            }
            None => cx.fault(span),
        },
        None => cx.add(Kind::Select { base, index: at }, (*element).clone(), span),
    }
}

/// Checks `t[0]` of a Kind 2 tuple. The index must be constant, as each element has a type of its own.
fn tuple_index(
    cx: &mut Body<'_, '_>,
    base: ExprId,
    at: ExprId,
    members: &[crate::ty::Member],
    span: Span,
) -> ExprId {
    let Some(k) = consts::fold(cx, at).and_then(|leaves| leaves.first()?.as_int()) else {
        return cx.fault(span);
    };
    let count = u32::try_from(members.len()).unwrap_or(u32::MAX);
    let Some(k) = checked_index(cx, k, count, cx.span_of(at)) else {
        return cx.fault(span);
    };
    let before = &members[..k as usize];
    let from = before.iter().map(|member| leaves(&member.ty)).sum();
    let ty = members[k as usize].ty.clone();
    cx.add(Kind::Part { base, at: from }, ty, span)
}

/// Returns the value of an integer expression if it is known at compile time.
pub(crate) fn const_int(cx: &mut Body<'_, '_>, id: ExprId) -> Option<i64> {
    match &cx.unit.expr(id).kind {
        Kind::Literal(value) => value.as_int(),
        Kind::Flow(_) if cx.unit.kind != crate::typed::UnitKind::Constant => None,
        _ => consts::fold_silently(cx, id)?
            .first()
            .and_then(Leaf::as_int),
    }
}

/// Reports a key whose type is not the key type of the Kind 2 map.
fn check_map_key(cx: &mut Body<'_, '_>, base: ExprId, at: ExprId) {
    let found = cx.ty_of(at).clone();
    let Ty::Struct(map) = cx.ty_of(base) else {
        return;
    };
    let args = map.name.strip_prefix("map<").unwrap_or_default();
    let wanted = key_type(args).to_owned();
    if !found.is_unknown() && found.to_string() != wanted {
        let message = format!("expected `{wanted}`, found `{found}`");
        let finding = Finding::new(Code::RPI2001, message)
            .at(cx.span_of(at), format!("this is `{found}`"))
            .also(cx.span_of(base), "the map");
        report::report_diagnostic(cx, finding);
    }
}

fn report_not_an_array(cx: &mut Body<'_, '_>, base: ExprId, span: Span) -> ExprId {
    let ty = cx.ty_of(base).clone();
    // No error for the element of a Kind 2 map: the map itself has been reported as not executable.
    if ty.is_unknown() || is_foreign(&ty, &["map<"]) {
        return cx.fault(span);
    }
    let finding = Finding::new(Code::RPI2006, "only arrays can be indexed")
        .at(cx.span_of(base), format!("this is `{ty}`"))
        .help("the value of the previous cycle is `pre x`, with an initial value `0 -> pre x`");
    cx.fault_with(finding, span)
}

/// Returns an array index as `u32`; reports an index that is out of bounds.
pub(crate) fn checked_index(cx: &mut Body<'_, '_>, k: i64, n: u32, span: Span) -> Option<u32> {
    let index = u32::try_from(k).ok().filter(|k| *k < n);
    if index.is_none() {
        let finding = Finding::new(Code::RPI2009, format!("index {k} is out of bounds")).at(
            span,
            format!(
                "the array has {}, counted from 0",
                rpi_diag::counted(n, "element")
            ),
        );
        report::report_diagnostic(cx, finding);
    }
    index
}

/// Checks `base[from..to step s]`.
pub(crate) fn slice_access<'a>(cx: &mut Body<'_, 'a>, slice: &'a SliceOf, span: Span) -> ExprId {
    let base = expr::check_expr(cx, &slice.base);
    let Ty::Array(element, n) = cx.ty_of(base).clone() else {
        return report_not_an_array(cx, base, span);
    };
    let Some(range) = slice_range(cx, &slice.slice, n, span) else {
        return cx.fault(span);
    };
    let ty = Ty::Array(element, range.len);
    let (from, step) = (range.from, range.step);
    cx.add(Kind::Slice { base, from, step }, ty, span)
}

fn slice_range<'a>(cx: &mut Body<'_, 'a>, slice: &'a Slice, n: u32, span: Span) -> Option<Range> {
    let (from, to) = (
        consts::const_integer(cx, &slice.from)?,
        consts::const_integer(cx, &slice.to)?,
    );
    let step = match &slice.step {
        Some(step) => consts::const_integer(cx, step)?,
        None => 1,
    };
    let (first, last) = (
        checked_index(cx, from, n, slice.from.span)?,
        checked_index(cx, to, n, slice.to.span)?,
    );
    let distance = i64::from(last) - i64::from(first);
    if step == 0 || (distance != 0 && distance.signum() != step.signum()) {
        let finding = Finding::new(Code::RPI2009, "the slice never reaches its end")
            .at(span, format!("from {from} to {to} in steps of {step}"));
        report::report_diagnostic(cx, finding);
        return None;
    }
    Some(Range {
        from: first,
        step: i32::try_from(step).ok()?,
        len: u32::try_from(distance / step + 1).ok()?,
    })
}

/// Returns the first leaf and the type of the part that a path of fields, elements and slices selects in a value of
/// type `ty` that starts at leaf `at`.
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
            let k = checked_index(cx, k, *n, index.span)?;
            (k * leaves(element), (**element).clone())
        }
        (Access::Slice(slice), Ty::Array(element, n)) => resolve_slice(cx, element, *n, slice)?,
        (Access::Index(ast::Expr { span, .. }), _) => return not_indexable(cx, ty, *span),
        (Access::Slice(slice), _) => return not_indexable(cx, ty, slice.from.span),
    };
    resolve_path(cx, &inner, at + offset, rest)
}

/// Returns the first leaf and the type of a field; reports an unknown field.
pub(crate) fn resolve_field(cx: &mut Body<'_, '_>, ty: &Ty, field: &Ident) -> Option<(u32, Ty)> {
    let found = member_of(ty, &field.name);
    if found.is_none() {
        let names = ty.members().iter().filter_map(|m| m.name.as_deref());
        let near = rpi_diag::suggest(&field.name, names);
        let finding = no_member(&format!("`{ty}`"), &field.name, field.span, near);
        report::report_diagnostic(cx, finding);
    }
    found
}

fn resolve_slice<'a>(
    cx: &mut Body<'_, 'a>,
    element: &Rc<Ty>,
    n: u32,
    slice: &'a Slice,
) -> Option<(u32, Ty)> {
    let span = slice.from.span.merge(slice.to.span);
    let range = slice_range(cx, slice, n, span)?;
    if range.step != 1 {
        let finding = Finding::new(
            Code::RPI2009,
            "only adjacent elements can be defined together",
        )
        .at(span, format!("a step of {}", range.step));
        report::report_diagnostic(cx, finding);
        return None;
    }
    Some((
        range.from * leaves(element),
        Ty::Array(element.clone(), range.len),
    ))
}

fn not_indexable(cx: &mut Body<'_, '_>, ty: &Ty, span: Span) -> Option<(u32, Ty)> {
    let finding = Finding::new(Code::RPI2006, "only arrays can be indexed")
        .at(span, format!("this indexes `{ty}`"));
    report::report_diagnostic(cx, finding);
    None
}

/// Returns the first of the types between `map<` and `>`. Commas inside brackets belong to a type.
fn key_type(args: &str) -> &str {
    let mut depth = 0;
    let end = args.find(|c| {
        depth += match c {
            '<' | '(' | '[' => 1,
            '>' | ')' | ']' => -1,
            _ => 0,
        };
        c == ',' && depth == 0
    });
    end.map_or(args, |end| &args[..end])
}

/// Returns the number of leaves of a type, saturating, for use as an offset.
pub(crate) fn leaves(ty: &Ty) -> u32 {
    u32::try_from(ty.leaf_count()).unwrap_or(u32::MAX)
}

/// Returns the first leaf and the type of the member with this name.
pub(crate) fn member_of(ty: &Ty, name: &str) -> Option<(u32, Ty)> {
    let members = ty.members();
    let index = members
        .iter()
        .position(|m| m.name.as_deref() == Some(name))?;
    let before = members[..index].iter().map(|m| leaves(&m.ty));
    Some((before.sum(), members[index].ty.clone()))
}
