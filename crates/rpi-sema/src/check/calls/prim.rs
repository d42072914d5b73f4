//! Calls of registered primitives: arguments are matched to ports and parameters by position or name.

use crate::check::bodies::body::Body;
use crate::check::calls::arg_tuples;
use crate::check::calls::args;
use crate::check::calls::args::Given;
use crate::check::calls::prim_ports;
use crate::check::diagnostics::report;
use crate::check::diagnostics::report::listed;
use crate::check::exprs::expr;
use crate::check::exprs::names;
use crate::check::types::consts;
use crate::ty::Ty;
use crate::typed::ExprId;
use crate::typed::{Kind, PrimCall};
use rpi_diag::counted;
use rpi_diag::{Code, Finding, Span};
use rpi_image::{Need, PortType, PrimDesc, Role, Scalar, State};
use rpi_prims::PrimId;
use rpi_syntax::ast::{self, Ident, PrimitiveDecl};

/// Arguments of a primitive call, by port and parameter.
pub(crate) struct Slots {
    pub(crate) inputs: Vec<Option<ExprId>>,
    pub(crate) params: Vec<Option<ExprId>>,
    /// Reals that together replace an in-port: index of the port, index among its reals, value.
    pub(crate) pieces: Vec<(usize, usize, ExprId)>,
}

/// Port or parameter that an argument of a primitive call is for.
enum Slot {
    /// In-port of this index.
    Input(usize),
    /// Parameter of this index.
    Param(usize),
    /// Real that replaces a part of an in-port: index of the port, index among its reals.
    Piece(usize, usize),
}

/// Checks a call of a primitive by its registered name.
pub(crate) fn check_prim_call<'a>(
    cx: &mut Body<'_, 'a>,
    prim: PrimId,
    call: &'a ast::Call,
    span: Span,
) -> ExprId {
    let mut given = args::check_args(cx, &call.args);
    for arg in &call.callee.statics {
        let ast::StaticValue::Expr(expr) = &arg.value else {
            let finding =
                Finding::new(Code::RPI1010, "a value is expected here").at(arg.span, "not a value");
            report::report_diagnostic(cx, finding);
            continue;
        };
        let value = expr::check_expr(cx, expr);
        given.push(Given {
            name: arg.name.as_ref(),
            value,
            is_static: true,
        });
    }
    prim_call_with(cx, prim, &given, span)
}

/// Checks a call of a primitive with checked arguments.
pub(crate) fn prim_call_with<'a>(
    cx: &mut Body<'_, 'a>,
    prim: PrimId,
    given: &[Given<'a>],
    span: Span,
) -> ExprId {
    let desc = prim.desc();
    let given = arg_tuples::flatten_tuple_args(cx, given.to_vec());
    let Some(slots) = match_prim_args(cx, desc, &given, span) else {
        return cx.fault(span);
    };
    finish_prim(cx, prim, slots, span)
}

/// Checks a call of a primitive whose in-ports are given by position.
pub(crate) fn prim_by_position<'a>(
    cx: &mut Body<'_, 'a>,
    name: &str,
    inputs: &[ExprId],
    span: Span,
) -> ExprId {
    let Some(prim) = PrimId::of(name) else {
        return cx.fault(span);
    };
    let given: Vec<Given<'a>> = inputs.iter().map(|id| Given::plain(*id)).collect();
    prim_call_with(cx, prim, &given, span)
}

/// Adds a primitive call whose operands are known to fit, with a known result type.
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
    cx.add(Kind::Prim(Box::new(call)), ty, span)
}

/// Adds a call of a primitive without in-ports.
pub(crate) fn add_nullary_prim(cx: &mut Body<'_, '_>, prim: PrimId, ty: Ty, span: Span) -> ExprId {
    add_prim(cx, prim, &[], ty, span)
}

fn match_prim_args<'a>(
    cx: &mut Body<'_, 'a>,
    desc: &'static PrimDesc,
    given: &[Given<'a>],
    span: Span,
) -> Option<Slots> {
    let mut slots = Slots {
        inputs: vec![None; desc.inputs.len()],
        params: vec![None; desc.params.len()],
        pieces: Vec::new(),
    };
    let mut place = 0;
    let mut sound = true;
    for arg in given {
        let slot = match arg.name {
            Some(name) => slot(desc, &name.name),
            None => {
                place += 1;
                (place <= desc.inputs.len()).then_some(Slot::Input(place - 1))
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
    slots: &mut Slots,
    slot: &Slot,
    arg: &Given<'a>,
) -> bool {
    if arg.is_static && !args::is_load_time_constant(cx, arg.value) {
        let finding = Finding::new(
            Code::RPI2008,
            "a parameter must be known when the command is loaded",
        )
        .at(cx.span_of(arg.value), "this changes while the command runs");
        report::report_diagnostic(cx, finding);
        return false;
    }
    match *slot {
        Slot::Input(k) => {
            slots.inputs[k] = Some(arg.value);
            prim_ports::fits_port(cx, arg.value, desc.inputs[k].ty, desc.inputs[k].name)
        }
        Slot::Param(k) => {
            slots.params[k] = Some(arg.value);
            prim_ports::fits_param(cx, arg.value, desc.params[k].ty, desc.params[k].name)
        }
        Slot::Piece(port, k) => {
            slots.pieces.push((port, k, arg.value));
            prim_ports::fits_port(
                cx,
                arg.value,
                PortType::One(Scalar::Real),
                "a part of a value",
            )
        }
    }
}

fn unexpected_prim_arg<'a>(cx: &mut Body<'_, 'a>, desc: &'static PrimDesc, arg: &Given<'a>) {
    let finding = match arg.name {
        Some(name) => no_name(desc, name),
        None => Finding::new(
            Code::RPI1010,
            format!(
                "too many arguments: `{}` has {}",
                desc.name,
                counted(desc.inputs.len(), "in-port")
            ),
        )
        .at(cx.span_of(arg.value), "unexpected argument"),
    };
    report::report_diagnostic(cx, finding);
}

fn check_required_args(
    cx: &mut Body<'_, '_>,
    desc: &'static PrimDesc,
    slots: &Slots,
    span: Span,
) -> bool {
    let open = desc.inputs.iter().zip(&slots.inputs);
    let open = open.filter(|(port, given)| given.is_none() && matches!(port.need, Need::Required));
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
    let finding = Finding::new(
        Code::RPI1010,
        format!("missing {} of `{}`", listed(open), desc.name),
    )
    .at(span, "required argument missing");
    report::report_diagnostic(cx, finding);
    false
}

fn finish_prim(cx: &mut Body<'_, '_>, prim: PrimId, mut slots: Slots, span: Span) -> ExprId {
    let desc = prim.desc();
    if !matches!(desc.state, State::None) || !matches!(desc.role, Role::Compute | Role::Constant) {
        cx.has_state(span);
    }
    if compose_inputs(cx, desc, &mut slots, span).is_none() {
        return cx.fault(span);
    }
    let ty = prim_ports::prim_type(cx, desc, &slots, span);
    let call = PrimCall {
        prim,
        inputs: slots.inputs.into(),
        params: slots.params.into(),
    };
    cx.add(Kind::Prim(Box::new(call)), ty, span)
}

/// Composes the reals that replace an in-port into one constant.
fn compose_inputs(
    cx: &mut Body<'_, '_>,
    desc: &'static PrimDesc,
    slots: &mut Slots,
    span: Span,
) -> Option<()> {
    for (k, port) in desc.inputs.iter().enumerate() {
        let Need::Params(names, make) = port.need else {
            continue;
        };
        let mut reals: Vec<f64> = names.iter().map(|(_, default)| *default).collect();
        let pieces: Vec<(usize, ExprId)> = slots
            .pieces
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
        let ty = prim_ports::port_ty(port.ty);
        slots.inputs[k] = Some(cx.add(Kind::Literal(make(&reals)), ty, span));
    }
    Some(())
}

/// Checks the body of a declared primitive: the registered primitive between typed ports.
pub(crate) fn check_primitive<'a>(cx: &mut Body<'_, 'a>, decl: &'a PrimitiveDecl) {
    if let Some(budget) = &decl.budget {
        cx.current().budget_ns = consts::const_nanoseconds(cx, budget);
    }
    let name = &decl.signature.name;
    let Some(prim) = PrimId::of(&name.name) else {
        let finding = Finding::new(
            Code::RPI1001,
            format!("undefined primitive `{}`", name.name),
        )
        .at(name.span, "not in the registry of primitives");
        report::report_diagnostic(cx, finding);
        return;
    };
    let mut given = Vec::new();
    for flow in cx.unit.inputs.clone() {
        let (name, span) = (cx.unit.flow(flow).name.clone(), cx.unit.flow(flow).span);
        let value = names::flow_expr(cx, flow, span);
        given.push((name, value));
    }
    let desc = prim.desc();
    let mut slots = Slots {
        inputs: vec![None; desc.inputs.len()],
        params: vec![None; desc.params.len()],
        pieces: Vec::new(),
    };
    for (port, value) in given {
        let arg = Given::plain(value);
        match slot(desc, &port) {
            Some(slot) => {
                set_prim_arg(cx, desc, &mut slots, &slot, &arg);
            }
            None => {
                let span = cx.span_of(value);
                let ident = Ident { name: port, span };
                report::report_diagnostic(cx, no_name(desc, &ident));
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
            report::report_diagnostic(cx, no_name(desc, &ident));
            continue;
        };
        let target = crate::typed::Target {
            place: crate::typed::Place::Flow { flow, at: 0 },
            ty,
            span,
        };
        cx.current().equations.push(crate::typed::Equation {
            targets: vec![target],
            value: part,
            span,
        });
    }
}

/// Returns the port or parameter that a name refers to: an in-port, the parameter that replaces one, or a parameter.
fn slot(desc: &PrimDesc, name: &str) -> Option<Slot> {
    let input = desc.input(name).or_else(|| desc.fallback(name));
    if let Some(k) = input {
        return Some(Slot::Input(k));
    }
    if let Some(k) = desc.param(name) {
        return Some(Slot::Param(k));
    }
    desc.inputs
        .iter()
        .enumerate()
        .find_map(|(port, input)| match input.need {
            Need::Params(names, _) => {
                let place = names.iter().position(|(n, _)| *n == name)?;
                Some(Slot::Piece(port, place))
            }
            _ => None,
        })
}

/// Returns the diagnostic for a name that is neither a port nor a parameter of a primitive.
fn no_name(desc: &PrimDesc, name: &Ident) -> Finding {
    let stand_ins = desc.inputs.iter().filter_map(|port| match port.need {
        Need::Param(name, _) => Some(name),
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
    .help(format!("its ports and parameters are {}", listed(names)))
}
