//! Ports of the unit that a net is made of: inputs, outputs and exports.

use crate::clocks::ClockId;
use crate::elab::arrays;
use crate::elab::block;
use crate::elab::elementwise;
use crate::elab::entry_point::PortShape;
use crate::elab::entry_point::UPDATED_PORT;
use crate::elab::expr;
use crate::elab::flows;
use crate::elab::fragment_outputs;
use crate::elab::nodes;
use crate::elab::outside_flows;
use crate::elab::primitive_family::PrimitiveFamily;
use crate::elab::sampled_flows;
use crate::elab::scope::{FlowState, Scope};
use crate::elab::signal::{Signal, Wire, single_wire};
use crate::elab::subrange;
use crate::elab::time;
use crate::elab::{ElabMode, Elaborator, NotConstantError, Position};
use crate::ty::Ty;
use crate::typed::{BlockId, ExprId, Flow, FlowId, FlowPresence, FlowRole, Unit};
use rpi_image::{Scalar, Value};
use rpi_net::{CommandInput, ExportPort, Origin};

/// Adds the inputs of a node that runs on its own, or the values that a command takes over, to the net. The host or the
/// core sets them by their keys. Returns one entry for each leaf (scalar part).
pub(super) fn unit_inputs<'u>(elab: &mut Elaborator<'u>, scope: &mut Scope<'u>) -> Vec<PortShape> {
    let unit = scope.unit;
    let mut shapes = Vec::new();
    let ports = unit.inputs.iter();
    let ports = ports.filter(|id| unit.flow(**id).role != FlowRole::Param);
    for flow in ports {
        let declared = unit.flow(*flow);
        if let Ty::Device(_) = declared.ty {
            // A device is no input: it has the name of the in-port.
            let name = Signal::Const(Value::Str(declared.name.to_string()));
            *scope.state(*flow) = FlowState::Done(single_wire(name));
            continue;
        }
        block::set_node_name(elab, &declared.name);
        let default = declared
            .default
            .map(|id| expr::elab_expr(elab, scope, id, Position::ROOT));
        let optional = declared.optional == FlowPresence::Declared(true);
        let mut leaves: Vec<(String, Ty)> = Vec::new();
        declared.ty.for_each_leaf(&mut |path, ty| {
            leaves.push((format!("{}{path}", declared.name), ty.clone()))
        });
        let mut wire = Vec::with_capacity(leaves.len());
        for (k, (key, ty)) in leaves.into_iter().enumerate() {
            let (seen, scalar) = crate::ty::machine_types::external_type(&ty);
            let default = default.as_ref().and_then(|wire| wire.get(k)).cloned();
            let default = default.map(|signal| {
                time::convert_to_seconds(elab, &signal, &ty, Position::ROOT, declared.span)
            });
            let value = default_leaf(elab, unit, declared, (k, &ty), default.as_ref());
            let given =
                external_input_at(elab, (&key, value), scalar, Position::ROOT, declared.span);
            let given = match optional {
                true => or_default(elab, &given, scalar, default.as_ref(), declared.span),
                false => given,
            };
            wire.push(time::convert_to_ticks(
                elab,
                given,
                &ty,
                Position::ROOT,
                declared.span,
            ));
            if let Some(unit) = unit_of(&ty) {
                elab.net.input_units.insert(key.clone(), unit);
            }
            let ty = seen;
            if declared.role == FlowRole::TakenOver {
                elab.net.command_inputs.push(CommandInput {
                    key: key.clone(),
                    is_required: declared.default.is_none() && !optional,
                });
            }
            shapes.push(PortShape { key, ty, optional });
        }
        *scope.state(*flow) = FlowState::Done(wire.into());
        subrange::check_external_input(elab, scope, *flow);
    }
    shapes
}

/// Returns the value of a leaf of the default of an in-port, if it is constant: the leaf with the index `leaf.0` and the type
/// `leaf.1`, whose signal is `default`.
fn default_leaf(
    elab: &mut Elaborator<'_>,
    unit: &Unit,
    port: &Flow,
    (k, ty): (usize, &Ty),
    default: Option<&Signal>,
) -> Option<Value> {
    match (*ty == Ty::Duration, port.default) {
        (true, Some(id)) => {
            let leaves = crate::elab::evaluate_constant(elab.units, unit, id).ok();
            leaves.and_then(|leaves| leaves.get(k).cloned())
        }
        _ => default.and_then(|signal| elementwise::constant_value(elab, signal)),
    }
}

/// Returns the signal of an optional input: until the input is set, its default or an absent value. `given` is the
/// input itself.
fn or_default(
    elab: &mut Elaborator<'_>,
    given: &Signal,
    scalar: Scalar,
    default: Option<&Signal>,
    span: rpi_diag::Span,
) -> Signal {
    let Signal::Port(value) = given else {
        return given.clone();
    };
    let updated = Signal::Port(rpi_net::PortRef {
        port: UPDATED_PORT,
        ..*value
    });
    let is_open = nodes::add_family_member(
        elab,
        PrimitiveFamily::IsNull,
        Scalar::Time,
        &[updated],
        Position::ROOT,
        span,
    );
    let otherwise = default.cloned().unwrap_or(Signal::Absent);
    let inputs = [is_open, otherwise, given.clone()];
    nodes::add_family_member(
        elab,
        PrimitiveFamily::Conditional,
        scalar,
        &inputs,
        Position::ROOT,
        span,
    )
}

/// Adds inputs to the net for a value that the program leaves open, such as `any` of Kind 2, and returns their signals.
pub(super) fn open_value<'u>(
    elab: &mut Elaborator<'u>,
    scope: &Scope<'u>,
    id: ExprId,
    at: Position,
) -> Wire {
    let expr = scope.unit.expr(id);
    if elab.mode == ElabMode::Constant {
        return elab.fail(NotConstantError::RunTime(expr.span));
    }
    elab.naming.serial += 1;
    let name = format!("{}#any{}", elab.naming.name, elab.naming.serial - 1);
    let mut leaves: Vec<(String, Ty)> = Vec::new();
    let mut leaf = |path: String, ty: &Ty| leaves.push((format!("{name}{path}"), ty.clone()));
    expr.ty
        .for_each_leaf(&mut |path, ty| leaf(path.to_owned(), ty));
    let leaves = leaves.into_iter();
    let signals = leaves.map(|(key, ty)| {
        let given = external_input_at(
            elab,
            (&key, None),
            time::external_scalar(&ty),
            at,
            expr.span,
        );
        time::convert_to_ticks(elab, given, &ty, at, expr.span)
    });
    signals.collect()
}

pub(super) fn external_input(
    elab: &mut Elaborator<'_>,
    key: &str,
    scalar: Scalar,
    span: rpi_diag::Span,
) -> Signal {
    external_input_at(elab, (key, None), scalar, Position::ROOT, span)
}

/// Adds an input to the net that is set from outside by its key, with an optional initial value, and returns its
/// signal.
fn external_input_at(
    elab: &mut Elaborator<'_>,
    (key, default): (&str, Option<Value>),
    scalar: Scalar,
    at: Position,
    span: rpi_diag::Span,
) -> Signal {
    let Some(prim) = crate::elab::primitive_family::member(PrimitiveFamily::Input, scalar) else {
        return Signal::Absent;
    };
    let value = |param: &rpi_image::Param| match param.name {
        "Key" => Some(Value::Str(key.to_owned())),
        "Value" if default.is_some() => default.clone(),
        _ => crate::ty::machine_types::param_default(param),
    };
    let params = prim.desc().params.iter().filter_map(value).collect();
    let wire = nodes::add_prim(elab, prim, Vec::new(), params, at, span);
    if let Some(Signal::Port(port)) = wire.first() {
        let node = &mut elab.net.nodes[port.node.index()];
        key.clone_into(&mut node.name);
        node.origin.flow = Some(key.to_owned());
    }
    wire.first().cloned().unwrap_or(Signal::Absent)
}

/// Returns the unit of the values of a leaf outside of the program; `None` if they have none. A duration is a number of seconds there.
fn unit_of(ty: &Ty) -> Option<String> {
    match ty {
        Ty::Real(dimension) if !dimension.is_dimensionless() && !dimension.has_free() => {
            Some(dimension.to_string())
        }
        Ty::Duration => Some("s".to_owned()),
        _ => None,
    }
}

/// Exports the outputs of a node that runs on its own. Returns one entry for each leaf (scalar part).
pub(super) fn unit_outputs<'u>(elab: &mut Elaborator<'u>, scope: &mut Scope<'u>) -> Vec<PortShape> {
    let unit = scope.unit;
    let mut shapes = Vec::new();
    for flow in &unit.outputs {
        let declared = unit.flow(*flow);
        let wire = flows::elab_flow(elab, scope, *flow, declared.span);
        block::set_node_name(elab, &declared.name);
        let wire = outside_flows::off_clock_absent(elab, scope, *flow, &wire, declared.span);
        let mut leaves: Vec<(String, Ty)> = Vec::new();
        declared.ty.for_each_leaf(&mut |path, ty| {
            leaves.push((format!("{}{path}", declared.name), ty.clone()))
        });
        for ((key, ty), signal) in leaves.into_iter().zip(wire.iter()) {
            elab_export(elab, &key, signal, &ty, declared.span);
            let optional = declared.optional != FlowPresence::Declared(false);
            let ty = crate::ty::machine_types::external_type(&ty).0;
            shapes.push(PortShape { key, ty, optional });
        }
    }
    shapes
}

pub(super) fn elab_export(
    elab: &mut Elaborator<'_>,
    key: &str,
    signal: &Signal,
    ty: &Ty,
    span: rpi_diag::Span,
) {
    let port = export_port(elab, key, signal, ty, Position::ROOT, span);
    elab.net.exports.extend(port);
}

/// Returns the export of a signal under a key; `None` if its type cannot be exported. A constant is exported in the
/// cycles in which the fragment of `at` is active.
pub(super) fn export_port(
    elab: &mut Elaborator<'_>,
    key: &str,
    signal: &Signal,
    ty: &Ty,
    at: Position,
    span: rpi_diag::Span,
) -> Option<ExportPort> {
    let signal = time::convert_to_seconds(elab, signal, ty, at, span);
    let source = arrays::port_of(elab, &signal, time::external_scalar(ty), at, span)?;
    Some(ExportPort {
        key: key.to_owned(),
        source,
        unit: unit_of(ty).unwrap_or_default(),
        origin: Origin {
            span,
            flow: Some(key.to_owned()),
        },
    })
}

/// Exports the local flows of a unit under their names, with the names of their blocks before them. Returns one entry
/// for each leaf (scalar part).
pub(super) fn elab_locals<'u>(elab: &mut Elaborator<'u>, scope: &mut Scope<'u>) -> Vec<PortShape> {
    let unit = scope.unit;
    let mut shapes = Vec::new();
    for id in (0..).map(FlowId).take(unit.flows.len()) {
        let declared = unit.flow(id);
        let is_device = matches!(declared.ty, Ty::Device(_));
        if declared.role != FlowRole::Local || is_device {
            continue;
        }
        let is_inner = declared.block != BlockId::ROOT;
        let wire =
            fragment_outputs::read_flow(elab, scope, (id, is_inner), Position::ROOT, declared.span);
        let wire = match is_inner {
            true => wire,
            false => outside_flows::off_clock_absent(elab, scope, id, &wire, declared.span),
        };
        let name = unit.flow_path(id);
        block::set_node_name(elab, &name);
        let mut leaves: Vec<(String, Ty)> = Vec::new();
        declared
            .ty
            .for_each_leaf(&mut |path, ty| leaves.push((format!("{name}{path}"), ty.clone())));
        for ((key, ty), signal) in leaves.into_iter().zip(wire.iter()) {
            if let Some(port) = export_port(elab, &key, signal, &ty, Position::ROOT, declared.span)
            {
                elab.kept_exports.push(port);
                let optional = declared.optional != FlowPresence::Declared(false);
                let ty = crate::ty::machine_types::external_type(&ty).0;
                shapes.push(PortShape { key, ty, optional });
            }
        }
    }
    shapes
}

pub(super) fn exports<'u>(elab: &mut Elaborator<'u>, scope: &mut Scope<'u>) {
    let unit = scope.unit;
    for (k, block) in unit.blocks.iter().enumerate() {
        let fragment = scope.fragments[k].unwrap_or(rpi_net::FragmentId::ROOT);
        for export in &block.exports {
            scope.base = fragment;
            let wire = sampled_flows::read_at(
                elab,
                scope,
                export.value,
                ClockId::BASE,
                Position::in_fragment(fragment),
            );
            scope.base = rpi_net::FragmentId::ROOT;
            block::set_node_name(elab, &export.key);
            let mut leaves: Vec<(String, Ty)> = Vec::new();
            let ty = &unit.expr(export.value).ty;
            ty.for_each_leaf(&mut |path, ty| {
                leaves.push((format!("{}{path}", export.key), ty.clone()))
            });
            for ((key, ty), signal) in leaves.into_iter().zip(wire.iter()) {
                elab_export(elab, &key, signal, &ty, export.span);
            }
        }
    }
}
