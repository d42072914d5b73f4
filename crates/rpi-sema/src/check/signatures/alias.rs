//! Aliases of callables, `node f = g<<3>>;`. An alias is also a unit of its own, so that it can be run or named where a
//! unit is needed. A call of an alias is a call of its target.

use crate::check::Checker;
use crate::check::bodies::body::Body;
use crate::check::bodies::locals;
use crate::check::calls::args::Given;
use crate::check::calls::call;
use crate::check::calls::callable::Callable;
use crate::check::calls::callable::Fixed;
use crate::check::calls::callee;
use crate::check::exprs::names;
use crate::check::signatures::header;
use crate::check::signatures::header::Header;
use crate::check::signatures::header::Port;
use crate::check::signatures::static_args::Statics;
use crate::check::signatures::static_args::missing;
use crate::check::signatures::static_params;
use crate::check::signatures::static_params::Param;
use crate::check::signatures::unit;
use crate::check::types::PortTy;
use crate::check::types::type_decls;
use crate::program::DeclId;
use crate::ty::Ty;
use crate::typed::Activation;
use crate::typed::{ClockOn, Equation, FlowId, FlowRole, Place, Target};
use rpi_diag::{Severity, Span};
use rpi_syntax::Name;
use rpi_syntax::ast::{Callee, Ident};
use std::rc::Rc;

/// Ports of a callable.
pub(crate) struct Ports {
    pub(crate) inputs: Vec<Named>,
    pub(crate) outputs: Vec<Named>,
}

/// Port of a callable, without its role and default.
pub(crate) struct Named {
    pub(crate) name: Name,
    pub(crate) ty: Ty,
    /// Port that decides the clock, and the value for which this port is present.
    clock: Option<(Name, u32)>,
    optional: bool,
    span: Span,
}

impl Named {
    fn new(name: String, ty: Ty, span: Span) -> Named {
        Named {
            name: name.into(),
            ty,
            clock: None,
            optional: false,
            span,
        }
    }
}

impl From<&Port> for Named {
    fn from(port: &Port) -> Named {
        Named {
            name: port.name.clone(),
            ty: port.ty.clone(),
            clock: port.clock.clone(),
            optional: port.optional,
            span: port.span,
        }
    }
}

/// Returns the header of a callable although the static arguments `open` are missing. Returns `None` if the ports
/// or the body depend on these arguments.
pub(crate) fn header_with_open_statics(
    checker: &mut Checker<'_>,
    id: DeclId,
    statics: Rc<Statics>,
    open: &[Name],
    span: Span,
) -> Option<Rc<Header>> {
    let before = checker.findings.len();
    let header = header::check_header(checker, id, statics);
    if open.is_empty() {
        return header;
    }
    let sound = !checker.findings[before..]
        .iter()
        .any(|finding| finding.severity() == Severity::Error);
    checker.findings.truncate(before);
    let header = header.filter(|_| sound)?;
    let ports = header.inputs.iter().enumerate();
    let lacking = ports.filter(|(_, port)| open.contains(&port.name));
    let lacking: Vec<(usize, &Port)> = lacking.collect();
    let unread =
        lacking.len() == open.len() && unit::reads_no_ports(checker, &header, &lacking, span);
    unread.then(|| header.clone())
}

/// Whether an alias is defined by itself, directly or through other aliases. Each such dependency cycle is reported
/// once.
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

/// Declares the ports of the alias: those of its target that no static argument fixes.
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

fn declare_port_like(cx: &mut Body<'_, '_>, port: &Named, role: FlowRole) -> FlowId {
    let name = Ident {
        name: port.name.clone(),
        span: port.span,
    };
    let ty = PortTy {
        ty: port.ty.clone(),
        optional: port.optional,
    };
    locals::declare_flow(cx, &name, &ty, role)
}

/// Gives the declared flows the clocks of the target's ports.
fn copy_clocks(cx: &mut Body<'_, '_>, ports: &Ports) {
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
            cx.unit.flows[flow.0 as usize].clock = Some(ClockOn {
                flow: deciding,
                value,
            });
        }
    }
}

/// Returns the ports of a callable; `None` if they depend on the arguments of the call.
pub(crate) fn callable_ports(
    cx: &mut Body<'_, '_>,
    callable: &Callable,
    span: Span,
) -> Option<Ports> {
    match callable {
        Callable::Unit(id, statics, fixed) => unit_ports(cx, *id, statics, fixed, span),
        Callable::Predef(predef) => {
            let (takes, gives) = predef.signature()?;
            let inputs = takes.into_iter().zip(1..);
            let inputs = inputs.map(|(ty, k)| Named::new(format!("i{k}"), ty, span));
            Some(Ports {
                inputs: inputs.collect(),
                outputs: vec![Named::new("out".to_owned(), gives, span)],
            })
        }
        Callable::Iteration(iteration) => {
            let mut ports = callable_ports(cx, iteration.callee()?, span)?;
            for ports in [&mut ports.inputs, &mut ports.outputs] {
                for (place, port) in ports.iter_mut().enumerate() {
                    port.ty = iteration.port_type(place, &port.ty);
                }
            }
            Some(ports)
        }
        Callable::Open(header) => Some(Ports {
            inputs: header.inputs.iter().map(Named::from).collect(),
            outputs: header.outputs.iter().map(Named::from).collect(),
        }),
        Callable::Prim(_) | Callable::Op(_) | Callable::Special(_) => None,
    }
}

fn unit_ports(
    cx: &mut Body<'_, '_>,
    id: DeclId,
    statics: &Statics,
    fixed: &[(Name, Fixed)],
    span: Span,
) -> Option<Ports> {
    let mut statics = statics.clone();
    let is_fixed = |name: &Name| fixed.iter().any(|(fixed, _)| fixed == name);
    let mut open = static_params::add_default_statics(cx.checker, id, &mut statics);
    open.retain(|name| !is_fixed(name));
    let params = static_params::static_params_of(cx.checker, id);
    let is_type = |name: &Name| {
        let mut params = params.iter();
        params.any(|param| matches!(param, Param::Type(..)) && param.name().name == *name)
    };
    if open.iter().any(is_type) {
        // The types are inferred from the arguments of a call.
        return None;
    }
    let header = header_with_open_statics(cx.checker, id, Rc::new(statics), &open, span);
    let Some(header) = header else {
        let decl = cx.checker.program.decl(id);
        let finding = missing(&decl.name, &open, span, decl.span);
        cx.findings.extend((!open.is_empty()).then_some(finding));
        return None;
    };
    let is_given = |port: &&Port| !is_fixed(&port.name) && !open.contains(&port.name);
    Some(Ports {
        inputs: header
            .inputs
            .iter()
            .filter(is_given)
            .map(Named::from)
            .collect(),
        outputs: header.outputs.iter().map(Named::from).collect(),
    })
}

/// Checks the body of an alias: one call of the target that connects all in-ports and out-ports.
pub(crate) fn check_alias<'a>(cx: &mut Body<'_, 'a>, callee: &'a Callee) {
    let span = callee.span;
    let callable = callee::resolve_callable(cx, &callee.name.name, &callee.statics, span);
    let Some(callable) = callable.filter(|_| !cx.unit.outputs.is_empty()) else {
        return;
    };
    let args = cx.unit.inputs.clone().into_iter();
    let given = args.map(|flow| Given::plain(names::flow_expr(cx, flow, span)));
    let given = given.collect();
    let value = call::call_callable(cx, &callable, given, Activation::Always, span);
    let targets = cx.unit.outputs.iter().map(|id| Target {
        place: Place::Flow { flow: *id, at: 0 },
        ty: cx.unit.flow(*id).ty.clone(),
        span,
    });
    let equation = Equation {
        targets: targets.collect(),
        value,
        span,
    };
    cx.current().equations.push(equation);
}
