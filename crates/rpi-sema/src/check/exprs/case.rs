//! Activations in cases of a `merge`. In Kind 2, the case `(activate f every c)(x)` means `f(x when c)`.

use crate::check::bodies::body::Body;
use crate::facts::literal;
use crate::typed::{Activation, Call, TypedKind};
use crate::typed::{DeclaredClock, ExprId};

/// Samples the arguments of a call that is a case of a `merge` with the clock of the case, if the call is activated by
/// the same condition, and returns the changed call. Returns any other case unchanged. `on` is the flow of the `merge`,
/// and `value` is the value of the flow for which the case applies.
pub(crate) fn sample_activated_case(
    cx: &mut Body<'_, '_>,
    on: ExprId,
    value: u32,
    case: ExprId,
) -> ExprId {
    let Some((clock, call, restart)) = case_activation(cx, on, value, case) else {
        return case;
    };
    let args = call
        .args
        .iter()
        .map(|arg| arg.map(|arg| add_when(cx, arg, clock)));
    let args = args.collect();
    let activation = match restart {
        Some(every) => Activation::Restart {
            every: add_when(cx, every, clock),
        },
        None => Activation::Always,
    };
    let call = Call {
        unit: call.unit,
        args,
        activation,
    };
    let (ty, span) = (cx.ty_of(case).clone(), cx.span_of(case));
    cx.add(TypedKind::Call(Box::new(call)), ty, span)
}

/// Returns the clock of a case of a `merge`, the call in the case, and the restart condition of the call. `None` unless
/// the case is a call that is activated exactly when the case applies.
fn case_activation(
    cx: &Body<'_, '_>,
    on: ExprId,
    value: u32,
    case: ExprId,
) -> Option<(DeclaredClock, Call, Option<ExprId>)> {
    let (TypedKind::Flow(flow), TypedKind::Call(call)) =
        (&cx.unit.expr(on).kind, &cx.unit.expr(case).kind)
    else {
        return None;
    };
    let Activation::Condact {
        every,
        default: None,
        restart,
    } = call.activation
    else {
        return None;
    };
    let decides = literal(&cx.unit, every, true) == Some((flow.0, value == 1));
    let clock = DeclaredClock { flow: *flow, value };
    decides.then(|| (clock, (**call).clone(), restart))
}

fn add_when(cx: &mut Body<'_, '_>, value: ExprId, clock: DeclaredClock) -> ExprId {
    let (ty, span) = (cx.ty_of(value).clone(), cx.span_of(value));
    cx.add(TypedKind::When { value, clock }, ty, span)
}
