//! External functions: which ones can be called in C, and the body that stands for the call.
//!
//! The body is one call of the primitive `Rpi::ExternalFunction`, so that clocks, presence and causality are those of any
//! primitive. Its ports group the values by kind, because a primitive has a fixed number of ports.

use crate::check::bodies::body::Body;
use crate::check::diagnostics::report;
use crate::check::exprs::names;
use crate::check::signatures::header::{Header, Port};
use crate::program::DeclKind;
use crate::ty::Ty;
use crate::typed::{Equation, ExprId, FlowId, FlowPresence, PrimCall, Target, TargetPlace};
use crate::typed::{Leaf, TypedKind};
use rpi_diag::{Code, Diagnostic, Span};
use rpi_image::Scalar;
use rpi_image::external::{EXTERNAL_KINDS, ExternalFunction, ExternalPort, is_c_name};
use rpi_prims::PrimId;
use rpi_syntax::ast::{Modifier, NodeDecl, NodeDef, NodeKind};
use std::rc::Rc;

/// Reports the call of a node or function without a body if it cannot be a call of C.
pub(crate) fn check_external_call(cx: &mut Body<'_, '_>, header: &Header, span: Span) {
    let DeclKind::Node(node) = cx.checker.program.decl(header.decl).kind else {
        return;
    };
    if !matches!(node.definition, NodeDef::Extern) {
        return;
    }
    let name = &header.name;
    let diagnostic = match (node.kind, node.modifier) {
        (NodeKind::Function, Modifier::Unsafe) => {
            let message = format!("`{name}` has side effects");
            Diagnostic::new(Code::RPI1012, message)
                .primary(span, "an external function that is called must be pure")
                .secondary(header.span, "declared as `unsafe`")
                .help("remove `unsafe` if it has none, or pass its results in as in-ports")
        }
        (NodeKind::Function, _) => match uncallable_port(header) {
            Some((port, reason)) => port_diagnostic(name, port, reason, span),
            None => return check_c_name(cx, node, span),
        },
        _ => Diagnostic::new(Code::RPI1012, format!("`{name}` has no body"))
            .primary(span, "an external node cannot be executed")
            .secondary(header.span, "declared without a body")
            .help("write a body `let ... tel` for it, declare it as a function in C, `extern function`, or pass its results in as in-ports"),
    };
    report::report_diagnostic(cx, diagnostic);
}

fn port_diagnostic(name: &str, port: &Port, reason: &str, span: Span) -> Diagnostic {
    let message = format!("`{name}` cannot be called in C: {reason}");
    Diagnostic::new(Code::RPI1012, message)
        .primary(port.span, format!("`{}` cannot be passed to C", port.name))
        .secondary(span, "called here")
        .help("pass reals, integers and Booleans, or arrays of one of them, for example each field as a port of its own")
}

/// Reports a name in C that is not an identifier.
fn check_c_name(cx: &mut Body<'_, '_>, node: &NodeDecl, span: Span) {
    let name = node.c_name.as_ref().unwrap_or(&node.signature.name);
    if is_c_name(&name.name) {
        return;
    }
    let message = format!("`{}` is not the name of a function in C", name.name);
    let diagnostic = Diagnostic::new(Code::RPI1012, message)
        .primary(name.span, "letters, digits and `_`, not a digit first")
        .secondary(span, "called here")
        .help("state the name in C after the out-ports: `= \"c_name\";`");
    report::report_diagnostic(cx, diagnostic);
}

/// Returns the first port that cannot be passed to C, with the reason.
fn uncallable_port(header: &Header) -> Option<(&Port, &'static str)> {
    let reason = |port: &Port, is_output: bool| match port {
        _ if port.is_static => None,
        _ if port.optional => Some("a port is optional"),
        _ if port.clock.is_some() => Some("a port has a clock of its own"),
        _ => unpassable(&port.ty, is_output),
    };
    let inputs = header.inputs.iter().map(|port| (port, false));
    let outputs = header.outputs.iter().map(|port| (port, true));
    let mut ports = inputs.chain(outputs);
    ports.find_map(|(port, is_output)| Some((port, reason(port, is_output)?)))
}

/// Returns the reason why a value of a type cannot be passed to C; `None` if it can.
fn unpassable(ty: &Ty, is_output: bool) -> Option<&'static str> {
    match ty {
        Ty::Array(_, 0) => Some("an array is empty"),
        Ty::Array(element, _) => unpassable(element, is_output),
        Ty::Unknown | Ty::Bool | Ty::Int | Ty::Subrange(_) | Ty::Real(_) => None,
        Ty::Machine(_) if !is_output => None,
        Ty::Machine(_) => Some("a result has a machine integer type"),
        Ty::Struct(_) | Ty::Tuple(_) => Some("a port is a struct"),
        Ty::Spatial(..) => Some("a port is a spatial value"),
        Ty::Enum(_) => Some("a port has an enum type"),
        _ => Some("C has no such type"),
    }
}

/// Adds the body of an external function: the call of the function in C. Has no effect if it cannot be called in C.
pub(crate) fn add_external_body(cx: &mut Body<'_, '_>, node: &NodeDecl) {
    let prim = PrimId::from_name("Rpi::ExternalFunction");
    let (Some(prim), Some(signature)) = (prim, signature(cx, node)) else {
        return;
    };
    let (inputs, outputs) = (cx.unit.inputs.clone(), cx.unit.outputs.clone());
    let span = node.signature.name.span;
    let call = PrimCall {
        prim,
        inputs: arguments(cx, &signature, &inputs, span),
        params: parameters(cx, &signature, span),
    };
    let (targets, groups) = results(cx, &signature, &outputs, span);
    let value = cx.add(TypedKind::Prim(Box::new(call)), Ty::tuple(groups), span);
    cx.current_block().equations.push(Equation {
        targets,
        value,
        span,
    });
}

/// Returns the signature of an external function in C; `None` if it cannot be called in C.
fn signature(cx: &Body<'_, '_>, node: &NodeDecl) -> Option<ExternalFunction> {
    let ports = |flows: &[FlowId]| -> Option<Vec<ExternalPort>> {
        flows.iter().map(|flow| external_port(cx, *flow)).collect()
    };
    let c_name = node.c_name.as_ref().unwrap_or(&node.signature.name);
    let signature = ExternalFunction {
        symbol: c_name.name.to_string(),
        name: node.signature.name.name.to_string(),
        inputs: ports(&cx.unit.inputs)?,
        outputs: ports(&cx.unit.outputs)?,
    };
    signature.is_valid().then_some(signature)
}

/// Describes a port for C; `None` if it cannot be passed.
fn external_port(cx: &Body<'_, '_>, flow: FlowId) -> Option<ExternalPort> {
    let flow = cx.unit.flow(flow);
    let mut element = &flow.ty;
    while let Ty::Array(inner, _) = element {
        element = inner;
    }
    let is_plain = flow.optional != FlowPresence::Declared(true) && flow.clock.is_none();
    let kind = element
        .scalar()
        .filter(|kind| EXTERNAL_KINDS.contains(kind));
    Some(ExternalPort {
        name: flow.name.to_string(),
        kind: kind.filter(|_| is_plain && unpassable(&flow.ty, false).is_none())?,
        len: u32::try_from(flow.ty.leaf_count()).ok()?,
        is_array: matches!(flow.ty, Ty::Array(..)),
        ty: flow.ty.to_string(),
    })
}

/// Returns the type of the values of one kind among ports.
fn group_type(ports: &[ExternalPort], kind: Scalar) -> Ty {
    let element = crate::ty::machine_types::scalar_ty(kind);
    Ty::Array(Rc::new(element), ExternalFunction::group_len(ports, kind))
}

/// Adds the arguments of the primitive: the in-ports of each kind, one after the other.
fn arguments(
    cx: &mut Body<'_, '_>,
    signature: &ExternalFunction,
    inputs: &[FlowId],
    span: Span,
) -> Box<[Option<ExprId>]> {
    let mut arguments = Vec::with_capacity(EXTERNAL_KINDS.len());
    for kind in EXTERNAL_KINDS {
        let group = ExternalFunction::group(&signature.inputs, kind);
        let parts: Vec<ExprId> = group
            .map(|(index, ..)| names::flow_expr(cx, inputs[index], span))
            .collect();
        let ty = group_type(&signature.inputs, kind);
        arguments.push(Some(cx.add(TypedKind::Build(parts.into()), ty, span)));
    }
    arguments.into()
}

/// Adds the parameters of the primitive: the signature, and the numbers of results of each kind.
fn parameters(
    cx: &mut Body<'_, '_>,
    signature: &ExternalFunction,
    span: Span,
) -> Box<[Option<ExprId>]> {
    let text = Leaf::Str(signature.to_string());
    let mut all = vec![Some(cx.add(TypedKind::Literal(text), Ty::Text, span))];
    for kind in EXTERNAL_KINDS {
        let count = Leaf::int(ExternalFunction::group_len(&signature.outputs, kind).into());
        all.push(Some(cx.add(TypedKind::Literal(count), Ty::Int, span)));
    }
    all.into()
}

/// Returns the out-ports in the order in which the primitive has their values, and the types of its out-ports.
fn results(
    cx: &Body<'_, '_>,
    signature: &ExternalFunction,
    outputs: &[FlowId],
    span: Span,
) -> (Vec<Target>, Vec<Ty>) {
    let target = |index: usize| Target {
        place: TargetPlace::Flow {
            flow: outputs[index],
            at: 0,
        },
        ty: cx.unit.flow(outputs[index]).ty.clone(),
        span,
    };
    let kinds = EXTERNAL_KINDS.iter();
    let targets = kinds.flat_map(|kind| ExternalFunction::group(&signature.outputs, *kind));
    let groups = EXTERNAL_KINDS.iter();
    let groups = groups.map(|kind| group_type(&signature.outputs, *kind));
    (
        targets.map(|(index, ..)| target(index)).collect(),
        groups.collect(),
    )
}
