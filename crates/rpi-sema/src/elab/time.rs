//! Durations. Constants are kept in seconds, because the length of a cycle is known only to the core. In a net
//! durations are numbers of ticks. Everything outside a command uses seconds.

use crate::elab::expr;
use crate::elab::nodes;
use crate::elab::scope::Scope;
use crate::elab::signal::{Signal, Wire};
use crate::elab::{ElabMode, Elaborator, NotConstantError, Position};
use crate::ty::Ty;
use crate::typed::PrimCall;
use crate::typed::{ExprId, Leaf};
use rpi_diag::Span;
use rpi_image::Scalar;
use rpi_net::prim;
use rpi_prims::PrimId;

/// Primitives that convert durations between seconds and ticks.
const CONVERSIONS: [PrimId; 3] = [
    prim!("Rpi::WholeTicks"),
    prim!("Rpi::TicksFromSeconds"),
    prim!("Rpi::SecondsFromTicks"),
];

/// Returns the signals of a constant, leaf by leaf (scalar part). Durations are converted from seconds to ticks.
pub(super) fn constants(
    elab: &mut Elaborator<'_>,
    leaves: &[Leaf],
    ty: &Ty,
    at: Position,
    span: Span,
) -> Wire {
    let mut times = Vec::new();
    if elab.mode != ElabMode::Constant {
        ty.for_each_leaf(&mut |_, leaf| times.push(*leaf == Ty::Duration));
    }
    let leaves = leaves.iter().cloned().enumerate();
    let signals = leaves.map(|(k, leaf)| match times.get(k) {
        Some(true) => fixed_ticks(elab, leaf, at, span),
        _ => Signal::Const(leaf),
    });
    signals.collect()
}

fn fixed_ticks(elab: &mut Elaborator<'_>, seconds: Leaf, at: Position, span: Span) -> Signal {
    nodes::add_simple(
        elab,
        prim!("Rpi::WholeTicks"),
        &[Signal::Const(seconds)],
        at,
        span,
    )
}

/// Evaluates a primitive that works on durations, in a constant. Durations are in seconds there, so that a conversion
/// to or from ticks changes nothing, and other operations on ticks have no value. Returns `None` for primitives without
/// durations.
pub(super) fn constant_duration<'u>(
    elab: &mut Elaborator<'u>,
    scope: &mut Scope<'u>,
    call: &'u PrimCall,
    at: Position,
    span: Span,
) -> Option<Wire> {
    let is_time = |id: &ExprId| scope.unit.expr(*id).ty == Ty::Duration;
    let inputs = call.inputs.iter().flatten();
    if CONVERSIONS.contains(&call.prim) {
        let first = *call.inputs.first()?.as_ref()?;
        return Some(expr::elab_expr(elab, scope, first, at));
    }
    let mut times = inputs.filter(|id| is_time(id));
    times.next()?;
    Some(elab.fail(NotConstantError::RunTime(span)))
}

/// Converts a leaf (scalar part) with a value from outside of the program: a duration from seconds to ticks. Other
/// values remain unchanged.
pub(super) fn convert_to_ticks(
    elab: &mut Elaborator<'_>,
    signal: Signal,
    ty: &Ty,
    at: Position,
    span: Span,
) -> Signal {
    match ty {
        Ty::Duration => {
            nodes::add_simple(elab, prim!("Rpi::TicksFromSeconds"), &[signal], at, span)
        }
        _ => signal,
    }
}

/// Converts a leaf (scalar part) with a value for the outside of the program: a duration from ticks to seconds. Other
/// values remain unchanged.
pub(super) fn convert_to_seconds(
    elab: &mut Elaborator<'_>,
    signal: &Signal,
    ty: &Ty,
    at: Position,
    span: Span,
) -> Signal {
    let is_known = matches!(signal, Signal::Absent);
    match ty {
        Ty::Duration if !is_known => {
            let inputs = std::slice::from_ref(signal);
            nodes::add_simple(elab, prim!("Rpi::SecondsFromTicks"), inputs, at, span)
        }
        _ => signal.clone(),
    }
}

/// Returns the machine type that a leaf (scalar part) has outside of the program, where a duration is a real in
/// seconds.
pub(super) fn external_scalar(ty: &Ty) -> Scalar {
    crate::ty::machine_types::external_type(ty).1
}
