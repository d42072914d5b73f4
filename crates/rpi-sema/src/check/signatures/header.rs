//! Headers of callables: the ports, and everything else that a caller needs.

use crate::check::Checker;
use crate::check::bodies::body::Body;
use crate::check::bodies::locals;
use crate::check::bodies::statement;
use crate::check::calls::frame_binding;
use crate::check::diagnostics::report;
use crate::check::exprs::expr;
use crate::check::limits::nesting;
use crate::check::reuse;
use crate::check::signatures::alias;
use crate::check::signatures::instance::instance_key;
use crate::check::signatures::instance::instance_name;
use crate::check::signatures::static_args::StaticBinding;
use crate::check::signatures::static_args::StaticBindings;
use crate::check::signatures::static_params;
use crate::check::signatures::unit;
use crate::check::types;
use crate::check::types::DeclaredType;
use crate::check::types::time_sums;
use crate::hash::FastSet;
use crate::program::{DeclId, DeclKind, Lookup, NameSpace};
use crate::ty::{Member, Ty};
use crate::typed::{FlowId, FlowPresence, FlowRole, Unit, UnitKind};
use rpi_diag::{Code, Diagnostic, Span};
use rpi_image::{Role, StateSize};
use rpi_prims::PrimId;
use rpi_syntax::Name;
use rpi_syntax::ast::{
    CommandDecl, FragmentDecl, Ident, NodeDecl, NodeDef, NodeKind, PrimitiveDecl, Signature,
    VarDecl,
};
use std::rc::Rc;

/// Name, ports and kind of a callable, as its callers see them, for one choice of static arguments.
#[derive(Debug)]
pub(crate) struct Header {
    pub(crate) decl: DeclId,
    pub(crate) statics: Rc<StaticBindings>,
    /// Name of the callable with its static arguments, such as `fill<<3>>`.
    pub(crate) name: Name,
    pub(crate) kind: UnitKind,
    pub(crate) span: Span,
    /// In-ports and parameters, in the order of [`Unit::inputs`].
    pub(crate) inputs: Vec<Port>,
    pub(crate) outputs: Vec<Port>,
    /// Names of frames in the port types that are not declared. Each stands for the frame of an argument.
    pub(crate) free_frames: Vec<Name>,
}

impl Header {
    /// Whether static parameters that are types, or values that distinguish instances, have been replaced by arguments.
    pub(crate) fn is_instance(&self) -> bool {
        let mut statics = self.statics.values();
        statics.any(|value| matches!(value, StaticBinding::Type(_) | StaticBinding::Value(_)))
    }

    /// Returns the type of a call: the type of the only output, or a tuple type of several outputs.
    pub(crate) fn result_type(&self) -> Ty {
        if let [one] = &self.outputs[..] {
            return one.ty.clone();
        }
        let member = |port: &Port| Member {
            name: Some(port.name.clone()),
            ty: port.ty.clone(),
        };
        Ty::Tuple(self.outputs.iter().map(member).collect())
    }
}

/// Input or output of a callable unit, as its callers see it.
#[derive(Debug)]
pub(crate) struct Port {
    pub(crate) name: Name,
    pub(crate) ty: Ty,
    pub(crate) role: FlowRole,
    pub(crate) has_default: bool,
    /// Whether the port has the identity pose as its default.
    pub(crate) is_identity_by_default: bool,
    /// Whether the port is a static parameter, declared in `<<...>>`.
    pub(crate) is_static: bool,
    /// Whether the port is the condition of the clock of another port.
    pub(crate) is_clock: bool,
    /// Clock of the port: the name of the port that is its condition, and the value of that port for which the clock
    /// ticks. `None` if the port has a value in every cycle.
    pub(crate) clock: Option<(Name, u32)>,
    /// Whether the port is declared optional (`T?`), so that its value may be absent.
    pub(crate) optional: bool,
    pub(crate) span: Span,
}

/// Returns the ports of a callable for these static arguments, and checks its signature on first use. Errors in the
/// signature are reported once. `None` if the declaration is not callable or nested too deeply.
pub(crate) fn check_header(
    checker: &mut Checker<'_>,
    id: DeclId,
    statics: Rc<StaticBindings>,
) -> Option<Rc<Header>> {
    let key = instance_key(id, &statics);
    if let Some(header) = checker.headers.get(&key) {
        return header.clone();
    }
    // Headers can nest: a default value may call a unit with default values.
    let is_inside = checker.limits.header_depth > 0;
    if is_inside && !nesting::may_nest(checker, "call", checker.program.decl(id).span) {
        return None;
    }
    let before = checker.diagnostics.len();
    checker.limits.header_depth += 1;
    let header = new_header(checker, id, statics).map(Rc::new);
    checker.limits.header_depth -= 1;
    if is_inside && checker.diagnostics.len() > before {
        reuse::taint(checker);
    }
    checker.headers.insert(key, header.clone());
    header
}

/// Returns the ports of a static parameter of `id` that stands for a node, as `signature` declares them.
pub(crate) fn node_param_header<'a>(
    checker: &mut Checker<'a>,
    id: DeclId,
    statics: &StaticBindings,
    signature: &'a Signature,
) -> Header {
    let mut ports = |decls: &'a Option<Vec<VarDecl>>, role| -> Vec<Port> {
        let decls = decls.as_deref().unwrap_or_default();
        let types = static_params::signature_port_types(checker, id, statics, decls);
        let names = decls.iter().flat_map(|decl| {
            let has_default = decl.default.is_some();
            decl.names.iter().map(move |name| (name, has_default))
        });
        let ports = names.zip(types);
        ports
            .map(|((name, has_default), ty)| node_param_port(name, ty, role, has_default))
            .collect()
    };
    Header {
        inputs: ports(&signature.inputs, FlowRole::Input),
        outputs: ports(&signature.outputs, FlowRole::Output),
        decl: id,
        statics: Rc::default(),
        name: signature.name.name.clone(),
        kind: UnitKind::Node,
        span: signature.name.span,
        free_frames: Vec::new(),
    }
}

fn new_header(
    checker: &mut Checker<'_>,
    id: DeclId,
    statics: Rc<StaticBindings>,
) -> Option<Header> {
    let decl = checker.program.decl(id);
    let (kind, span) = (unit_kind(decl.kind)?, decl.span);
    let params = static_params::static_params_of_decl(checker, id);
    let name = instance_name(checker.program, &decl.name, &params, &statics);
    let unit = Unit::new(name.clone(), kind, span);
    let mut body = Body::new(checker, id, statics.clone(), unit);
    declare_ports(&mut body, id);
    let unit = body.finish();
    let params = params.into_iter();
    let params: Vec<Name> = params.map(|param| param.name().name.clone()).collect();
    let clocks = unit.flows.iter().filter_map(|flow| flow.clock);
    let deciding: FastSet<FlowId> = clocks.map(|on| on.flow).collect();
    let port = |id: &FlowId| Port {
        is_static: params.contains(&unit.flow(*id).name),
        is_clock: deciding.contains(id),
        ..port_of_flow(&unit, *id)
    };
    let ports = |ids: &[FlowId]| ids.iter().map(port).collect();
    Some(Header {
        decl: id,
        statics,
        name,
        kind,
        span,
        inputs: ports(&unit.inputs),
        outputs: ports(&unit.outputs),
        free_frames: unit.free_frames.clone(),
    })
}

/// Returns the description of a port of a static parameter that stands for a node.
fn node_param_port(name: &Ident, ty: Ty, role: FlowRole, has_default: bool) -> Port {
    Port {
        name: name.name.clone(),
        ty,
        role,
        has_default,
        is_identity_by_default: false,
        is_static: false,
        is_clock: false,
        clock: None,
        optional: false,
        span: name.span,
    }
}

/// Returns the description of the port that a flow of a unit represents, as callers of the unit see it.
fn port_of_flow(unit: &Unit, id: FlowId) -> Port {
    let flow = unit.flow(id);
    Port {
        name: flow.name.clone(),
        ty: flow.ty.clone(),
        role: flow.role,
        has_default: flow.default.is_some(),
        is_identity_by_default: unit.identity_defaults.contains(&id),
        is_static: false,
        is_clock: false,
        clock: flow
            .clock
            .map(|on| (unit.flow(on.flow).name.clone(), on.value)),
        optional: flow.optional == FlowPresence::Declared(true),
        span: flow.span,
    }
}

/// Returns the kind of unit that a declaration of this kind defines; `None` if the declaration is not callable.
pub(crate) fn unit_kind(kind: DeclKind<'_>) -> Option<UnitKind> {
    Some(match kind {
        DeclKind::Node(node) => match node.kind {
            NodeKind::Node => UnitKind::Node,
            NodeKind::Function | NodeKind::Contract => UnitKind::Function,
        },
        DeclKind::Primitive(primitive) => primitive_kind(&primitive.signature.name.name),
        DeclKind::Fragment(_) => UnitKind::Fragment,
        DeclKind::Command(_) => UnitKind::Command,
        DeclKind::Test(_) => UnitKind::Test,
        DeclKind::Task(_) => UnitKind::Task,
        _ => return None,
    })
}

/// Returns the kind of unit for the primitive `name`: a function if it computes its result without state, otherwise a
/// node.
fn primitive_kind(name: &str) -> UnitKind {
    let is_pure = |prim: PrimId| {
        let desc = prim.desc();
        desc.role == Role::Compute && matches!(desc.state, StateSize::None)
    };
    match PrimId::from_name(name).is_some_and(is_pure) {
        true => UnitKind::Function,
        false => UnitKind::Node,
    }
}

/// Declares the ports of the callable `id` in its body.
pub(crate) fn declare_ports(cx: &mut Body<'_, '_>, id: DeclId) {
    cx.in_signature = true;
    report_type_param_redefinition(cx, id);
    declare_load_time_params(cx, id);
    match cx.checker.program.decl(id).kind {
        DeclKind::Node(node) => declare_node_ports(cx, node),
        DeclKind::Fragment(fragment) => declare_fragment_ports(cx, fragment),
        DeclKind::Primitive(primitive) => declare_primitive_ports(cx, primitive),
        DeclKind::Command(command) => declare_command_ports(cx, command),
        DeclKind::Task(task) => declare_inputs(cx, &task.params, FlowRole::Param),
        _ => {}
    }
    cx.in_signature = false;
}

/// Reports a type parameter of Lustre that has the name of a type declared in the file.
fn report_type_param_redefinition(cx: &mut Body<'_, '_>, id: DeclId) {
    for param in static_params::static_params_of_decl(cx.checker, id) {
        let crate::check::signatures::static_params::StaticParamDecl::Type(name, _) = param else {
            continue;
        };
        let found = cx
            .checker
            .program
            .lookup_in(NameSpace::Type, cx.module, &name.name);
        if let Lookup::Found(first) = found
            && !unit::reads_rpi_syntax(cx)
            && matches!(cx.checker.program.decl(first).kind, DeclKind::Type(_))
        {
            let first = cx.checker.program.decl(first).span;
            report::report_diagnostic(
                cx,
                crate::program::duplicate_name_error(&name.name, name.span, first),
            );
        }
    }
}

/// Declares a flow for each static parameter whose value is known only when the command is loaded.
fn declare_load_time_params(cx: &mut Body<'_, '_>, id: DeclId) {
    for param in static_params::static_params_of_decl(cx.checker, id) {
        let crate::check::signatures::static_params::StaticParamDecl::Value(name, def) = param
        else {
            continue;
        };
        if !matches!(cx.statics.get(&name.name), Some(StaticBinding::LoadTime)) {
            continue;
        }
        let ty = match &def.ty {
            Some(ty) => types::resolve_type(cx, ty),
            None => static_params::static_param_type(cx.checker, id, def, &cx.statics.clone()),
        };
        let optional = false;
        let flow = locals::declare_flow(cx, name, &DeclaredType { ty, optional }, FlowRole::Param);
        cx.unit.inputs.push(flow);
        if let Some(default) = &def.value {
            check_port_default(cx, flow, default);
        }
    }
}

fn declare_node_ports<'a>(cx: &mut Body<'_, 'a>, node: &'a NodeDecl) {
    match (&node.definition, &node.signature.outputs) {
        (NodeDef::Alias(callee), None) => alias::declare_alias_ports(cx, callee),
        _ if node.kind == NodeKind::Contract => declare_contract_ports(cx, &node.signature),
        _ => declare_signature_ports(cx, &node.signature),
    }
}

fn declare_signature_ports<'a>(cx: &mut Body<'_, 'a>, signature: &'a Signature) {
    let inputs = signature.inputs.as_deref().unwrap_or_default();
    let outputs = signature.outputs.as_deref().unwrap_or_default();
    declare_inputs(cx, inputs, FlowRole::Input);
    declare_outputs(cx, outputs);
    statement::resolve_clocks_of(cx, inputs);
    statement::resolve_clocks_of(cx, outputs);
    check_input_clocks(cx);
}

/// Reports an in-port whose clock depends on an out-port, because the caller could not know when to pass a value.
fn check_input_clocks(cx: &mut Body<'_, '_>) {
    for id in cx.unit.inputs.clone() {
        let port = cx.unit.flow(id).clone();
        let Some(on) = port.clock.filter(|on| cx.unit.outputs.contains(&on.flow)) else {
            continue;
        };
        let clock = cx.unit.flow(on.flow);
        let message = format!("the clock of the in-port `{}` is an out-port", port.name);
        let diagnostic = Diagnostic::new(Code::RPI3007, message)
            .primary(port.span, format!("sampled by `{}`", clock.name))
            .secondary(clock.span, "an out-port, known only after the call")
            .help("declare the clock as an in-port");
        report::report_diagnostic(cx, diagnostic);
    }
}

/// Declares the ports of a contract that is declared on its own. The contract reads inputs and outputs of the node, so
/// that both are in-ports here.
fn declare_contract_ports<'a>(cx: &mut Body<'_, 'a>, signature: &'a Signature) {
    for ports in [&signature.inputs, &signature.outputs] {
        declare_inputs(cx, ports.as_deref().unwrap_or_default(), FlowRole::Input);
    }
}

fn declare_fragment_ports<'a>(cx: &mut Body<'_, 'a>, fragment: &'a FragmentDecl) {
    declare_signature_ports(cx, &fragment.signature);
    if fragment.when.is_some() {
        for id in cx.unit.outputs.clone() {
            cx.unit.flows[id.0 as usize].optional = FlowPresence::Declared(true);
        }
    }
}

fn declare_primitive_ports<'a>(cx: &mut Body<'_, 'a>, primitive: &'a PrimitiveDecl) {
    declare_signature_ports(cx, &primitive.signature);
}

fn declare_command_ports<'a>(cx: &mut Body<'_, 'a>, command: &'a CommandDecl) {
    declare_inputs(cx, &command.params, FlowRole::Param);
    declare_inputs(cx, &command.given, FlowRole::TakenOver);
}

fn declare_inputs<'a>(cx: &mut Body<'_, 'a>, decls: &'a [VarDecl], role: FlowRole) {
    for decl in decls {
        let port = types::resolve_port_type(cx, &decl.ty);
        let role = if decl.is_const { FlowRole::Param } else { role };
        for name in &decl.names {
            // A constant port that decides sizes is a static parameter and has been declared.
            if decl.is_const && cx.statics.contains_key(&name.name) {
                continue;
            }
            let flow = locals::declare_flow(cx, name, &port, role);
            time_sums::record_unit(cx, flow, &decl.ty);
            cx.unit.inputs.push(flow);
            if let Some(default) = &decl.default {
                check_port_default(cx, flow, default);
            }
        }
    }
}

/// Checks that the default value of the in-port `flow` is a constant of the port's type.
fn check_port_default<'a>(cx: &mut Body<'_, 'a>, flow: FlowId, default: &'a rpi_syntax::ast::Expr) {
    let value = expr::check_expr(cx, default);
    let ty = cx.unit.flow(flow).ty.clone();
    let span = cx.unit.flow(flow).span;
    let text = format!("`{}` is `{ty}`", cx.unit.flow(flow).name);
    statement::expect_type(
        cx,
        value,
        &ty,
        &crate::check::diagnostics::report::ExpectationReason::Because(span, text),
    );
    cx.unit.flows[flow.0 as usize].default = Some(value);
    if frame_binding::is_identity_pose(cx, &ty, value) {
        cx.unit.identity_defaults.push(flow);
    }
}

fn declare_outputs<'a>(cx: &mut Body<'_, 'a>, decls: &'a [VarDecl]) {
    for decl in decls {
        let port = types::resolve_port_type(cx, &decl.ty);
        for name in &decl.names {
            let flow = locals::declare_flow(cx, name, &port, FlowRole::Output);
            time_sums::record_unit(cx, flow, &decl.ty);
            cx.unit.outputs.push(flow);
        }
    }
}
