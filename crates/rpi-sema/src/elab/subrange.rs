//! Run-time checks of subranges. A flow with a subrange type is checked where it is defined, passed as an argument or
//! stored in a struct. The check passes the value on, so that all readers depend on the check.

use crate::elab::nodes;
use crate::elab::sampled_flows;
use crate::elab::scope::{FlowState, Scope};
use crate::elab::signal::{Signal, Wire, alias_of};
use crate::elab::{ElabMode, Elaborator, NotConstantError, Position};
use crate::ty::subrange::outside_subrange;
use crate::ty::{Subrange, Ty};
use crate::typed::{Equation, ExprId, FlowId, TargetPlace};
use rpi_diag::Span;
use rpi_image::Value;
use rpi_net::{Input, prim};

/// Circumstances of a check that a value is in the subrange of its declared type: position in the net and locations for
/// the message.
#[derive(Clone, Copy)]
struct SubrangeCheck {
    at: Position,
    /// Location of the value, for the error message.
    span: Span,
    /// Location of the declaration with the subrange; `None` if it is not shown.
    declaration: Option<Span>,
    /// Whether the value is an argument or input from outside of the unit.
    is_input: bool,
}

/// Returns the signals of an equation's value, each checked against the subrange of the flow that it defines.
pub(super) fn check_targets<'u>(
    elab: &mut Elaborator<'u>,
    scope: &mut Scope<'u>,
    equation: &Equation,
    wire: Wire,
    at: Position,
) -> Wire {
    let mut targets = equation.targets.iter();
    if !targets.any(|target| target.ty.has_subrange(false)) {
        return wire;
    }
    let span = scope.unit.expr(equation.value).span;
    let mut signals = wire.to_vec();
    let mut first = 0;
    for target in &equation.targets {
        let flow = match target.place {
            TargetPlace::Flow { flow, at } => Some((flow, at as usize)),
            _ => None,
        };
        for (leaf, range) in target.ty.subranges(false) {
            let at = match flow {
                Some((flow, offset)) => leaf_position(elab, scope, (flow, offset + leaf), at),
                None => at,
            };
            let how = SubrangeCheck {
                at,
                span,
                declaration: flow.map(|(flow, _)| scope.unit.flow(flow).span),
                is_input: false,
            };
            elab_check(elab, &mut signals, first + leaf, range, how);
        }
        first += target.ty.leaf_count();
    }
    signals.into()
}

/// Checks the inputs of a called unit against their subranges. `spans` are the locations of the caller's arguments, at
/// which an error is reported.
pub(super) fn check_inputs<'u>(
    elab: &mut Elaborator<'u>,
    scope: &mut Scope<'u>,
    spans: &[Option<Span>],
    at: Position,
) {
    let unit = scope.unit;
    for (k, flow) in unit.inputs.iter().enumerate() {
        let declared = unit.flow(*flow);
        if !declared.ty.has_subrange(false) {
            continue;
        }
        let default = declared.default.map(|id| unit.expr(id).span);
        let span = spans.get(k).copied().flatten().or(default);
        let span = span.or(scope.call_span).unwrap_or(declared.span);
        check_input(elab, scope, *flow, false, at, span);
    }
}

/// Checks an input that is set from outside of the program against its subrange.
pub(super) fn check_external_input<'u>(
    elab: &mut Elaborator<'u>,
    scope: &mut Scope<'u>,
    flow: FlowId,
) {
    let span = scope.unit.flow(flow).span;
    check_input(elab, scope, flow, true, Position::ROOT, span);
}

fn check_input<'u>(
    elab: &mut Elaborator<'u>,
    scope: &mut Scope<'u>,
    flow: FlowId,
    from_outside: bool,
    at: Position,
    span: Span,
) {
    let declared = scope.unit.flow(flow);
    let ranges = declared.ty.subranges(from_outside);
    let FlowState::Done(wire) = scope.state(flow).clone() else {
        return;
    };
    if ranges.is_empty() {
        return;
    }
    let mut signals = wire.to_vec();
    for (leaf, range) in ranges {
        let how = SubrangeCheck {
            at: leaf_position(elab, scope, (flow, leaf), at),
            span,
            declaration: (span != declared.span).then_some(declared.span),
            is_input: true,
        };
        elab_check(elab, &mut signals, leaf, range, how);
    }
    *scope.state(flow) = FlowState::Done(signals.into());
}

/// Returns the signals of the value of a field in a struct literal, checked against the subrange of the field. `of` is
/// the struct type, and `field` is the index of the field.
pub(super) fn check_field(
    elab: &mut Elaborator<'_>,
    wire: Wire,
    (of, field): (&Ty, usize),
    at: Position,
    span: Span,
) -> Wire {
    match of {
        Ty::Struct(of) => match of.fields.get(field) {
            Some(field) if field.ty.has_subrange(false) => {
                let count = wire.len();
                check_leaves(elab, wire, &field.ty, 0..count, (at, span))
            }
            _ => wire,
        },
        _ => wire,
    }
}

/// Returns the signals of a value of the type `ty`, of which the leaves (scalar parts) in the range `leaves` are
/// checked against their subranges. It is used for values from outside of the program and for new parts of structs.
pub(super) fn check_leaves(
    elab: &mut Elaborator<'_>,
    wire: Wire,
    ty: &Ty,
    leaves: std::ops::Range<usize>,
    (at, span): (Position, Span),
) -> Wire {
    if !ty.has_subrange(true) {
        return wire;
    }
    let mut signals = wire.to_vec();
    let how = SubrangeCheck {
        at,
        span,
        declaration: None,
        is_input: false,
    };
    let ranges = ty.subranges(true).into_iter();
    for (leaf, range) in ranges.filter(|(leaf, _)| leaves.contains(leaf)) {
        elab_check(elab, &mut signals, leaf, range, how);
    }
    signals.into()
}

fn elab_check(
    elab: &mut Elaborator<'_>,
    signals: &mut [Signal],
    leaf: usize,
    range: Subrange,
    how: SubrangeCheck,
) {
    if let Some(signal) = signals.get_mut(leaf) {
        *signal = check_signal(elab, signal, range, how);
    }
}

/// Returns the output of a net node that checks whether a signal is in a subrange; the signal itself if it is known to
/// be in the range. Reports a constant that is outside.
fn check_signal(
    elab: &mut Elaborator<'_>,
    signal: &Signal,
    range: Subrange,
    how: SubrangeCheck,
) -> Signal {
    match signal {
        Signal::Absent => return signal.clone(),
        Signal::Const(value) => match value.as_int() {
            Some(value) if !range.contains(value) => {
                // A wrong constant is an error even if the call around it is not always needed.
                let is_sure = !how.is_input && how.at.guard == elab.inlining.guard;
                if how.at.guard.is_none() || is_sure {
                    report_out_of_subrange(elab, value, range, how);
                    return signal.clone();
                }
            }
            _ => return signal.clone(),
        },
        _ if is_checked(elab, signal, range) => return signal.clone(),
        _ => {}
    }
    let active = how.at.guard.map(Signal::Port);
    let active = active.unwrap_or(Signal::Const(Value::bool(true)));
    let [from, to] = range.bounds().map(|end| Signal::Const(Value::int(end)));
    let inputs = [active, signal.clone(), from, to];
    nodes::add_simple(elab, prim!("Rpi::IntWithin"), &inputs, how.at, how.span)
}

/// Returns whether a signal is the output of a check of this subrange or of a narrower one.
fn is_checked(elab: &Elaborator<'_>, signal: &Signal, range: Subrange) -> bool {
    let Signal::Port(port) = signal else {
        return false;
    };
    if alias_of(*port).is_some() {
        return false;
    }
    let node = elab.net.node(port.node);
    let end = |k: usize| match node.inputs.get(k) {
        Some(Input::Const(value)) => value.as_int(),
        _ => None,
    };
    let known = Subrange {
        from: end(2),
        to: end(3),
    };
    let is_always = matches!(node.inputs.first(), Some(Input::Const(_)));
    node.prim == prim!("Rpi::IntWithin") && is_always && known.is_subset_of(range)
}

fn report_out_of_subrange(
    elab: &mut Elaborator<'_>,
    value: i64,
    range: Subrange,
    how: SubrangeCheck,
) {
    let diagnostic =
        outside_subrange(value, range).primary(how.span, format!("this is {value} in every cycle"));
    if elab.mode == ElabMode::Constant {
        elab.fail(NotConstantError::Fault(how.span, diagnostic.message));
        return;
    }
    elab.diagnostics.push(match how.declaration {
        Some(declared) => diagnostic.secondary(declared, "declared here"),
        None => diagnostic,
    });
}

/// Returns the position at which a leaf (scalar part) of a flow is computed, in the fragment of its clock.
fn leaf_position<'u>(
    elab: &mut Elaborator<'u>,
    scope: &mut Scope<'u>,
    (flow, leaf): (FlowId, usize),
    at: Position,
) -> Position {
    match sampled_flows::clocked_facts(elab, scope) {
        Some(facts) => sampled_flows::clock_position(
            elab,
            scope,
            facts.clocks.flow_clocks(flow).leaf(leaf),
            at,
        ),
        None => at,
    }
}

/// Returns the signals of an update `x with .n = y`, with the replaced fields checked against their subranges. `wire`
/// has the signals of the result, in which the new value starts at leaf `offset`.
pub(super) fn check_replaced<'u>(
    elab: &mut Elaborator<'u>,
    scope: &Scope<'u>,
    wire: Wire,
    [id, value]: [ExprId; 2],
    offset: u32,
    at: Position,
) -> Wire {
    let unit = scope.unit;
    let first = offset as usize;
    let leaves = first..first + unit.expr(value).ty.leaf_count();
    let place = (at, unit.expr(value).span);
    check_leaves(elab, wire, &unit.expr(id).ty, leaves, place)
}
