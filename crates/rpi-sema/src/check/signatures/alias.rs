//! Aliases of callables, `node f = g<<3>>;`. An alias is also a unit of its own, so that it can be run or named where a
//! unit is needed. A call of an alias is a call of its target.

use crate::check::Checker;
use crate::check::bodies::body::Body;
use crate::check::bodies::locals;
use crate::check::calls::args::CallArgument;
use crate::check::calls::call;
use crate::check::calls::callable::Callable;
use crate::check::calls::callable::FixedPortValue;
use crate::check::calls::callee;
use crate::check::exprs::names;
use crate::check::signatures::header;
use crate::check::signatures::header::Header;
use crate::check::signatures::header::Port;
use crate::check::signatures::static_args::StaticBindings;
use crate::check::signatures::static_args::missing_static_args;
use crate::check::signatures::static_params;
use crate::check::signatures::static_params::StaticParamDecl;
use crate::check::signatures::unit;
use crate::check::types::DeclaredType;
use crate::check::types::type_decls;
use crate::program::DeclId;
use crate::ty::Ty;
use crate::typed::Activation;
use crate::typed::{DeclaredClock, Equation, FlowId, FlowRole, Target, TargetPlace};
use rpi_diag::{Code, Severity, Span};
use rpi_syntax::Name;
use rpi_syntax::ast::{Callee, Ident};
use std::rc::Rc;

/// In-ports and out-ports of a callable, with their clocks.
pub(crate) struct PortSignatures {
    pub(crate) inputs: Vec<PortSignature>,
    pub(crate) outputs: Vec<PortSignature>,
}

/// Port of a callable, without its role and default.
pub(crate) struct PortSignature {
    pub(crate) name: Name,
    pub(crate) ty: Ty,
    /// Clock of the port: the name of the port that is its condition, and the value of that port for which the clock
    /// ticks. `None` if the port has a value in every cycle.
    clock: Option<(Name, u32)>,
    optional: bool,
    span: Span,
}

impl PortSignature {
    fn new(name: String, ty: Ty, span: Span) -> PortSignature {
        PortSignature {
            name: name.into(),
            ty,
            clock: None,
            optional: false,
            span,
        }
    }
}

impl From<&Port> for PortSignature {
    fn from(port: &Port) -> PortSignature {
        PortSignature {
            name: port.name.clone(),
            ty: port.ty.clone(),
            clock: port.clock.clone(),
            optional: port.optional,
            span: port.span,
        }
    }
}

/// Returns the ports of a callable although the static arguments `open` are missing. Returns `None` if the ports or the
/// body depend on these arguments.
pub(crate) fn header_with_open_statics(
    checker: &mut Checker<'_>,
    id: DeclId,
    statics: Rc<StaticBindings>,
    open: &[Name],
    span: Span,
) -> Option<Rc<Header>> {
    let before = checker.diagnostics.len();
    let header = header::check_header(checker, id, statics);
    if open.is_empty() {
        return header;
    }
    let sound = !checker.diagnostics[before..]
        .iter()
        .any(|diagnostic| diagnostic.severity() == Severity::Error);
    checker.diagnostics.truncate(before);
    let header = header.filter(|_| sound)?;
    let ports = header.inputs.iter().enumerate();
    let lacking = ports.filter(|(_, port)| open.contains(&port.name));
    let lacking: Vec<(usize, &Port)> = lacking.collect();
    let unread =
        lacking.len() == open.len() && unit::reads_no_ports(checker, &header, &lacking, span);
    unread.then(|| header.clone())
}

/// Whether the alias `id` is defined by itself, directly or through other aliases. Each such dependency cycle is
/// reported once.
pub(crate) fn is_cyclic_alias(checker: &mut Checker<'_>, id: DeclId) -> bool {
    if checker.cyclic_aliases.contains(&id) {
        return true;
    }
    let is_ring = checker.aliases.contains(&id);
    if is_ring {
        checker.cyclic_aliases.extend(&checker.aliases);
        type_decls::report_dependency_cycle(checker, "node", id);
    }
    is_ring
}

/// Declares the ports of an alias (`node f = g<<3>>;`). They are the ports of its target `callee` that no static
/// argument fixes.
pub(crate) fn declare_alias_ports<'a>(cx: &mut Body<'_, 'a>, callee: &'a Callee) {
    let callable = callee::resolve_callable(cx, &callee.name.name, &callee.statics, callee.span);
    let ports = callable.and_then(|callable| callable_ports(cx, &callable, callee.span));
    let Some(ports) = ports else {
        return;
    };
    for port in &ports.inputs {
        let flow = declare_port_like(cx, port, FlowRole::Input);
        cx.unit.inputs.push(flow);
    }
    for port in &ports.outputs {
        let flow = declare_port_like(cx, port, FlowRole::Output);
        cx.unit.outputs.push(flow);
    }
    copy_clocks(cx, &ports);
}

fn declare_port_like(cx: &mut Body<'_, '_>, port: &PortSignature, role: FlowRole) -> FlowId {
    let name = Ident {
        name: port.name.clone(),
        span: port.span,
    };
    let ty = DeclaredType {
        ty: port.ty.clone(),
        optional: port.optional,
    };
    locals::declare_flow(cx, &name, &ty, role)
}

/// Gives the flows declared for the ports of an alias the clocks of the ports of its target. `ports` are the ports of
/// the target, in the same order.
fn copy_clocks(cx: &mut Body<'_, '_>, ports: &PortSignatures) {
    let flows = cx.unit.inputs.iter().chain(&cx.unit.outputs);
    let flows: Vec<FlowId> = flows.copied().collect();
    for (flow, port) in flows.iter().zip(ports.inputs.iter().chain(&ports.outputs)) {
        let Some((name, value)) = &port.clock else {
            continue;
        };
        let is_called = |id: &&FlowId| cx.unit.flow(**id).name == *name;
        if let Some(deciding) = flows.iter().find(is_called).copied() {
            let value = *value;
            cx.unit.has_clocks = true;
            cx.unit.flows[flow.0 as usize].clock = Some(DeclaredClock {
                flow: deciding,
                value,
            });
        }
    }
}

/// Returns the ports of a callable; `None` if they depend on the arguments of the call, as for an operator.
pub(crate) fn callable_ports(
    cx: &mut Body<'_, '_>,
    callable: &Callable,
    span: Span,
) -> Option<PortSignatures> {
    match callable {
        Callable::Unit(id, statics, fixed) => unit_ports(cx, *id, statics, fixed, span),
        Callable::Predefined(predef) => {
            let (takes, gives) = predef.signature()?;
            let inputs = takes.into_iter().zip(1..);
            let inputs = inputs.map(|(ty, k)| PortSignature::new(format!("i{k}"), ty, span));
            Some(PortSignatures {
                inputs: inputs.collect(),
                outputs: vec![PortSignature::new("out".to_owned(), gives, span)],
            })
        }
        Callable::Iteration(iteration) => {
            let mut ports = callable_ports(cx, iteration.resolve_callee()?, span)?;
            for ports in [&mut ports.inputs, &mut ports.outputs] {
                for (place, port) in ports.iter_mut().enumerate() {
                    port.ty = iteration.port_type(place, &port.ty);
                }
            }
            Some(ports)
        }
        Callable::NodeParam(header) => Some(PortSignatures {
            inputs: header.inputs.iter().map(PortSignature::from).collect(),
            outputs: header.outputs.iter().map(PortSignature::from).collect(),
        }),
        Callable::Prim(_) | Callable::Op(_) | Callable::Intrinsic(_) => None,
    }
}

fn unit_ports(
    cx: &mut Body<'_, '_>,
    id: DeclId,
    statics: &StaticBindings,
    fixed: &[(Name, FixedPortValue)],
    span: Span,
) -> Option<PortSignatures> {
    let mut statics = statics.clone();
    let is_fixed = |name: &Name| fixed.iter().any(|(fixed, _)| fixed == name);
    let mut open = static_params::add_default_statics(cx.checker, id, &mut statics);
    open.retain(|name| !is_fixed(name));
    let params = static_params::static_params_of_decl(cx.checker, id);
    let is_type = |name: &Name| {
        let mut params = params.iter();
        params.any(|param| matches!(param, StaticParamDecl::Type(..)) && param.name().name == *name)
    };
    if open.iter().any(is_type) {
        // The types are inferred from the arguments of a call.
        return None;
    }
    let header = header_with_open_statics(cx.checker, id, Rc::new(statics), &open, span);
    let Some(header) = header else {
        let decl = cx.checker.program.decl(id);
        let diagnostic = missing_static_args(&decl.name, &open, span, decl.span);
        cx.diagnostics
            .extend((!open.is_empty()).then_some(diagnostic));
        return None;
    };
    let is_given = |port: &&Port| !is_fixed(&port.name) && !open.contains(&port.name);
    Some(PortSignatures {
        inputs: header
            .inputs
            .iter()
            .filter(is_given)
            .map(PortSignature::from)
            .collect(),
        outputs: header.outputs.iter().map(PortSignature::from).collect(),
    })
}

/// Checks the body of an alias: adds an equation with one call of the target `callee` that connects all in-ports and
/// out-ports.
pub(crate) fn check_alias<'a>(cx: &mut Body<'_, 'a>, callee: &'a Callee) {
    let span = callee.span;
    let callable = callee::resolve_callable(cx, &callee.name.name, &callee.statics, span);
    let Some(callable) = callable.filter(|_| !cx.unit.outputs.is_empty()) else {
        return;
    };
    let args = cx.unit.inputs.clone().into_iter();
    let given = args.map(|flow| CallArgument::positional(names::flow_expr(cx, flow, span)));
    let given = given.collect();
    let before = cx.diagnostics.len();
    let value = call::call_callable(cx, &callable, given, Activation::Always, span);
    label_passed_ports(cx, before);
    let targets = cx.unit.outputs.iter().map(|id| Target {
        place: TargetPlace::Flow { flow: *id, at: 0 },
        ty: cx.unit.flow(*id).ty.clone(),
        span,
    });
    let equation = Equation {
        targets: targets.collect(),
        value,
        span,
    };
    cx.current_block().equations.push(equation);
}

/// Adds to the diagnostics about the call of an alias's target that the alias passes its own in-ports on.
fn label_passed_ports(cx: &mut Body<'_, '_>, before: usize) {
    let (alias, declared) = (cx.unit.name.clone(), cx.unit.span);
    let new = cx.diagnostics.iter_mut().skip(before);
    for diagnostic in new.filter(|diagnostic| diagnostic.code == Code::RPI1010) {
        let text = format!("`{alias}` passes only its own in-ports on");
        diagnostic.add_secondary(declared, text);
        diagnostic.help.push(format!(
            "declare the same in-ports for `{alias}`, or give it a body that calls the node"
        ));
    }
}
