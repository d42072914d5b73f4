//! Calls of registered primitives: arguments are matched to ports and parameters by position or name.

use crate::check::bodies::body::Body;
use crate::check::calls::arg_tuples;
use crate::check::calls::args;
use crate::check::calls::args::CallArgument;
use crate::check::calls::prim_ports;
use crate::check::diagnostics::report;
use crate::check::diagnostics::report::{join_names, members_help};
use crate::check::exprs::expr;
use crate::check::exprs::names;
use crate::check::types::consts;
use crate::ty::Ty;
use crate::typed::{Equation, ExprId, FlowId, PrimCall, Target, TargetPlace, TypedKind};
use rpi_diag::with_noun;
use rpi_diag::{Code, Diagnostic, Span};
use rpi_image::{Fallback, PortType, PrimDesc, Role, Scalar, StateSize};
use rpi_prims::PrimId;
use rpi_syntax::ast::{self, Ident, PrimitiveDecl};

/// Arguments of a call of a primitive, by index of the in-port and of the parameter; `None` where no argument is given.
pub(crate) struct PrimArgs {
    pub(crate) inputs: Vec<Option<ExprId>>,
    pub(crate) params: Vec<Option<ExprId>>,
    /// Constant reals that are given as parameters in place of one in-port, such as the coordinates of a pose: index of
    /// the in-port, index of the real within the in-port, and value.
    pub(crate) components: Vec<(usize, usize, ExprId)>,
}

/// Port or parameter of a primitive to which an argument belongs.
enum PrimArgTarget {
    /// The in-port with this index.
    Input(usize),
    /// The parameter with this index.
    Param(usize),
    /// Real that is given as a parameter in place of a part of an in-port: index of the in-port, and index of the real
    /// within it.
    Component(usize, usize),
}

/// Checks a call of a primitive by the primitive's registered name, and returns its typed expression.
pub(crate) fn check_prim_call<'a>(
    cx: &mut Body<'_, 'a>,
    prim: PrimId,
    call: &'a ast::Call,
    span: Span,
) -> ExprId {
    let mut given = args::check_args(cx, &call.args);
    for arg in &call.callee.statics {
        let ast::StaticValue::Expr(expr) = &arg.value else {
            let diagnostic = Diagnostic::new(Code::RPI1010, "a value is expected here")
                .primary(arg.span, "not a value");
            report::report_diagnostic(cx, diagnostic);
            continue;
        };
        let value = expr::check_expr(cx, expr);
        given.push(CallArgument {
            name: arg.name.as_ref(),
            value,
            is_static: true,
        });
    }
    prim_call_with(cx, prim, &given, span)
}

/// Checks the application of a primitive to arguments that have been checked, and returns its typed expression.
pub(crate) fn prim_call_with<'a>(
    cx: &mut Body<'_, 'a>,
    prim: PrimId,
    given: &[CallArgument<'a>],
    span: Span,
) -> ExprId {
    let desc = prim.desc();
    let given = arg_tuples::flatten_tuple_args(cx, given.to_vec());
    let Some(slots) = match_prim_args(cx, desc, &given, span) else {
        return cx.error_expr(span);
    };
    finish_prim(cx, prim, slots, span)
}

/// Checks the application of the primitive `name` to `inputs`, the values of its in-ports in their order, and returns
/// its typed expression.
pub(crate) fn prim_by_position<'a>(
    cx: &mut Body<'_, 'a>,
    name: &str,
    inputs: &[ExprId],
    span: Span,
) -> ExprId {
    let Some(prim) = PrimId::from_name(name) else {
        return cx.error_expr(span);
    };
    let given: Vec<CallArgument<'a>> = inputs
        .iter()
        .map(|id| CallArgument::positional(*id))
        .collect();
    prim_call_with(cx, prim, &given, span)
}

/// Adds a call of a primitive whose operands are known to fit its in-ports, with the known result type `ty`, and
/// returns it.
pub(crate) fn add_prim(
    cx: &mut Body<'_, '_>,
    prim: PrimId,
    inputs: &[ExprId],
    ty: Ty,
    span: Span,
) -> ExprId {
    let mut all = vec![None; prim.desc().inputs.len()];
    for (slot, input) in all.iter_mut().zip(inputs) {
        *slot = Some(*input);
    }
    let call = PrimCall {
        prim,
        inputs: all.into(),
        params: vec![None; prim.desc().params.len()].into(),
    };
    cx.add(TypedKind::Prim(Box::new(call)), ty, span)
}

/// Adds a call of a primitive without in-ports, with the known result type `ty`, and returns it.
pub(crate) fn add_nullary_prim(cx: &mut Body<'_, '_>, prim: PrimId, ty: Ty, span: Span) -> ExprId {
    add_prim(cx, prim, &[], ty, span)
}

fn match_prim_args<'a>(
    cx: &mut Body<'_, 'a>,
    desc: &'static PrimDesc,
    given: &[CallArgument<'a>],
    span: Span,
) -> Option<PrimArgs> {
    let mut slots = PrimArgs {
        inputs: vec![None; desc.inputs.len()],
        params: vec![None; desc.params.len()],
        components: Vec::new(),
    };
    let mut place = 0;
    let mut sound = true;
    for arg in given {
        let slot = match arg.name {
            Some(name) => prim_arg_target(desc, &name.name),
            None => {
                place += 1;
                (place <= desc.inputs.len()).then_some(PrimArgTarget::Input(place - 1))
            }
        };
        match slot {
            Some(slot) => sound &= set_prim_arg(cx, desc, &mut slots, &slot, arg),
            None => {
                unexpected_prim_arg(cx, desc, arg);
                sound = false;
            }
        }
    }
    // `&`, not `&&`: missing arguments are reported after other errors, too.
    (sound & check_required_args(cx, desc, &slots, span)).then_some(slots)
}

fn set_prim_arg<'a>(
    cx: &mut Body<'_, 'a>,
    desc: &'static PrimDesc,
    slots: &mut PrimArgs,
    slot: &PrimArgTarget,
    arg: &CallArgument<'a>,
) -> bool {
    if arg.is_static && !args::is_load_time_constant(cx, arg.value) {
        let diagnostic = Diagnostic::new(
            Code::RPI2008,
            "a parameter must be known when the command is loaded",
        )
        .primary(cx.span_of(arg.value), "this changes while the command runs");
        report::report_diagnostic(cx, diagnostic);
        return false;
    }
    match *slot {
        PrimArgTarget::Input(k) => {
            slots.inputs[k] = Some(arg.value);
            prim_ports::fits_port(cx, arg.value, desc.inputs[k].ty, desc.inputs[k].name)
        }
        PrimArgTarget::Param(k) => {
            slots.params[k] = Some(arg.value);
            prim_ports::fits_param(cx, arg.value, desc.params[k].ty, desc.params[k].name)
        }
        PrimArgTarget::Component(port, k) => {
            slots.components.push((port, k, arg.value));
            prim_ports::fits_port(
                cx,
                arg.value,
                PortType::Scalar(Scalar::Real),
                "a part of a value",
            )
        }
    }
}

fn unexpected_prim_arg<'a>(cx: &mut Body<'_, 'a>, desc: &'static PrimDesc, arg: &CallArgument<'a>) {
    let diagnostic = match arg.name {
        Some(name) => unknown_port(desc, name),
        None => Diagnostic::new(
            Code::RPI1010,
            format!(
                "too many arguments: `{}` has {}",
                desc.name,
                with_noun(desc.inputs.len(), "in-port")
            ),
        )
        .primary(cx.span_of(arg.value), "unexpected argument"),
    };
    report::report_diagnostic(cx, diagnostic);
}

fn check_required_args(
    cx: &mut Body<'_, '_>,
    desc: &'static PrimDesc,
    slots: &PrimArgs,
    span: Span,
) -> bool {
    let open = desc.inputs.iter().zip(&slots.inputs);
    let open =
        open.filter(|(port, given)| given.is_none() && matches!(port.fallback, Fallback::Required));
    let open: Vec<&str> = open.map(|(port, _)| port.name).collect();
    let params = desc.params.iter().zip(&slots.params);
    let params = params.filter(|(p, given)| {
        given.is_none() && matches!(p.default, rpi_image::PortDefault::Required)
    });
    let open: Vec<&str> = open
        .into_iter()
        .chain(params.map(|(p, _)| p.name))
        .collect();
    if open.is_empty() {
        return true;
    }
    let diagnostic = Diagnostic::new(
        Code::RPI1010,
        format!("missing {} of `{}`", join_names(open), desc.name),
    )
    .primary(span, "required argument missing");
    report::report_diagnostic(cx, diagnostic);
    false
}

fn finish_prim(cx: &mut Body<'_, '_>, prim: PrimId, mut slots: PrimArgs, span: Span) -> ExprId {
    let desc = prim.desc();
    if !matches!(desc.state, StateSize::None)
        || !matches!(desc.role, Role::Compute | Role::Constant)
    {
        cx.record_state(span);
    }
    if compose_inputs(cx, desc, &mut slots, span).is_none() {
        return cx.error_expr(span);
    }
    let ty = prim_ports::prim_type(cx, desc, &slots, span);
    let call = PrimCall {
        prim,
        inputs: slots.inputs.into(),
        params: slots.params.into(),
    };
    cx.add(TypedKind::Prim(Box::new(call)), ty, span)
}

/// Computes the constant value of each in-port for which constant reals are given as parameters. `None` after an error
/// about a value that is not constant.
fn compose_inputs(
    cx: &mut Body<'_, '_>,
    desc: &'static PrimDesc,
    slots: &mut PrimArgs,
    span: Span,
) -> Option<()> {
    for (k, port) in desc.inputs.iter().enumerate() {
        let Fallback::ComposedOfParams(names, make) = port.fallback else {
            continue;
        };
        let mut reals: Vec<f64> = names.iter().map(|(_, default)| *default).collect();
        let pieces: Vec<(usize, ExprId)> = slots
            .components
            .iter()
            .filter(|p| p.0 == k)
            .map(|p| (p.1, p.2))
            .collect();
        if pieces.is_empty() {
            continue;
        }
        for (place, value) in pieces {
            reals[place] = consts::fold(cx, value)?.first()?.as_real()?;
        }
        let ty = prim_ports::resolve_port_type(port.ty);
        slots.inputs[k] = Some(cx.add(TypedKind::Literal(make(&reals)), ty, span));
    }
    Some(())
}

/// Checks the declaration of a typed primitive: its ports must fit those of the registered primitive with the same
/// name. Adds a call of the registered primitive that connects these ports.
pub(crate) fn check_primitive<'a>(cx: &mut Body<'_, 'a>, decl: &'a PrimitiveDecl) {
    if let Some(budget) = &decl.budget {
        cx.current_block().budget_ns = consts::const_nanoseconds(cx, budget);
    }
    let name = &decl.signature.name;
    let Some(prim) = PrimId::from_name(&name.name) else {
        let diagnostic = Diagnostic::new(
            Code::RPI1001,
            format!("undefined primitive `{}`", name.name),
        )
        .primary(name.span, "not in the registry of primitives");
        report::report_diagnostic(cx, diagnostic);
        return;
    };
    let mut given = Vec::new();
    for flow in cx.unit.inputs.clone() {
        let (name, span) = (cx.unit.flow(flow).name.clone(), cx.unit.flow(flow).span);
        let value = names::flow_expr(cx, flow, span);
        given.push((name, value));
    }
    let desc = prim.desc();
    let mut slots = PrimArgs {
        inputs: vec![None; desc.inputs.len()],
        params: vec![None; desc.params.len()],
        components: Vec::new(),
    };
    for (port, value) in given {
        let arg = CallArgument::positional(value);
        match prim_arg_target(desc, &port) {
            Some(slot) => {
                set_prim_arg(cx, desc, &mut slots, &slot, &arg);
            }
            None => {
                let span = cx.span_of(value);
                let ident = Ident { name: port, span };
                report::report_diagnostic(cx, unknown_port(desc, &ident));
            }
        }
    }
    let value = finish_prim(cx, prim, slots, name.span);
    define_outputs(cx, value, desc);
}

fn define_outputs(cx: &mut Body<'_, '_>, value: ExprId, desc: &'static PrimDesc) {
    let span = cx.span_of(value);
    let parts = match desc.outputs.len() {
        1 => vec![value],
        _ => arg_tuples::tuple_elements(cx, value),
    };
    for flow in cx.unit.outputs.clone() {
        let declared = cx.unit.flow(flow);
        let (ty, place) = (declared.ty.clone(), desc.output(&declared.name));
        let Some(part) = place.and_then(|k| parts.get(k).copied()) else {
            let ident = Ident {
                name: declared.name.clone(),
                span: declared.span,
            };
            report::report_diagnostic(cx, unknown_port(desc, &ident));
            continue;
        };
        let equation = Equation {
            targets: vec![whole_flow(flow, ty, span)],
            value: part,
            span,
        };
        cx.current_block().equations.push(equation);
    }
}

/// Returns the target of an equation that defines the whole flow.
fn whole_flow(flow: FlowId, ty: Ty, span: Span) -> Target {
    Target {
        place: TargetPlace::Flow { flow, at: 0 },
        ty,
        span,
    }
}

/// Returns the in-port or parameter of a primitive to which a name refers; `None` if there is none. The name of a
/// parameter that can replace an in-port refers to that in-port.
fn prim_arg_target(desc: &PrimDesc, name: &str) -> Option<PrimArgTarget> {
    let input = desc.input(name).or_else(|| desc.in_port_of_param(name));
    if let Some(k) = input {
        return Some(PrimArgTarget::Input(k));
    }
    if let Some(k) = desc.param(name) {
        return Some(PrimArgTarget::Param(k));
    }
    desc.inputs
        .iter()
        .enumerate()
        .find_map(|(port, input)| match input.fallback {
            Fallback::ComposedOfParams(names, _) => {
                let place = names.iter().position(|(n, _)| *n == name)?;
                Some(PrimArgTarget::Component(port, place))
            }
            _ => None,
        })
}

/// Returns the diagnostic for a name that is neither a port nor a parameter of a primitive.
fn unknown_port(desc: &PrimDesc, name: &Ident) -> Diagnostic {
    let stand_ins = desc.inputs.iter().filter_map(|port| match port.fallback {
        Fallback::Param(name, _) => Some(name),
        _ => None,
    });
    let names: Vec<&str> = desc
        .inputs
        .iter()
        .map(|port| port.name)
        .chain(stand_ins)
        .chain(desc.params.iter().map(|param| param.name))
        .collect();
    let near = rpi_diag::suggest(&name.name, names.iter().copied());
    crate::check::diagnostics::report::no_member(
        &format!("`{}`", desc.name),
        &name.name,
        name.span,
        near,
    )
    .help(members_help("port or parameter", names))
}
