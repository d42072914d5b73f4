//! Decides whether a flow without a declared type is an exact time or a real in seconds, where its equations allow
//! both: `t = 0[s]` in one state and `t = last t + dt` in another, or `a = 5[s] -> pre b; b = a + dt`.
//!
//! A fixed duration in seconds can be either. A flow is a time if a time reaches it, through any number of flows, and
//! no value that is only in seconds does; otherwise it is in seconds. If the result differs from the inferred type,
//! types are inferred again with this one fixed. The order of the text therefore does not matter.

use crate::check::bodies::automaton;
use crate::check::bodies::body::Body;
use crate::check::bodies::type_inference;
use crate::check::bodies::type_inference::EquationState;
use crate::check::types::exact_time;
use crate::check::types::exact_time::is_load_time_constant;
use crate::hash::FastMap;
use crate::ty::Ty;
use crate::ty::machine_types::SECONDS;
use crate::typed::{ElementwiseOp, Expr, PrimCall, TypedKind};
use crate::typed::{ExprId, FlowId, FlowRole, Unit};
use std::collections::BTreeMap;

/// Maximum number of rounds of type inference for times. After the first round, types can only change from exact times
/// to seconds.
const MAX_ROUNDS: u32 = 4;

/// Sources of the value of a flow whose type may be an exact time or seconds, and its dependencies on other such flows.
#[derive(Default)]
struct TimeSources {
    /// Whether an exact time contributes to the value of the flow, directly or through other flows.
    time: bool,
    /// Whether seconds that change at run time, and so cannot be converted to ticks at compile time, contribute to the
    /// value of the flow.
    seconds: bool,
    /// Flows with an inferred type whose definitions read the flow.
    readers: Vec<FlowId>,
    /// Flows with an inferred type that the definition of the flow reads.
    reads: Vec<FlowId>,
    /// Whether the flow, or its version in a state of an automaton, was inferred as an exact time (first entry), and
    /// whether as seconds (second entry).
    inferred_as: [bool; 2],
}

/// Infers the types of all flows without a declared type, and decides for each time whether it is exact (whole ticks)
/// or in seconds.
pub(crate) fn infer_with_times(cx: &mut Body<'_, '_>) {
    let is_open = |k: &usize| {
        cx.pending[*k].state == EquationState::Unchecked && cx.pending[*k].infers_type()
    };
    let open: Vec<usize> = (0..cx.pending.len()).filter(is_open).collect();
    let mut settled: FastMap<FlowId, Ty> = FastMap::default();
    for _ in 0..MAX_ROUNDS {
        let mark = type_inference::checkpoint(cx);
        type_inference::infer_types(cx);
        if !cx.times.are_used || !fix_wrong_types(cx, &open, &mut settled) {
            return;
        }
        type_inference::rollback(cx, mark);
        reset_inferred_types(cx, &open, &settled);
    }
    type_inference::infer_types(cx);
}

/// Adds the correct type of each flow that the last round of inference got wrong to `settled`. Returns whether there is
/// any such flow. `open` are the indices of the equations that infer types.
fn fix_wrong_types(cx: &Body<'_, '_>, open: &[usize], settled: &mut FastMap<FlowId, Ty>) -> bool {
    let mut all = time_sources(cx, open, settled);
    propagate_seconds(&mut all);
    propagate_times(&mut all);
    let mut changed = false;
    for (flow, sources) in all {
        let is_time = sources.time && !sources.seconds && settled.get(&flow) != Some(&SECONDS);
        let ty = if is_time { Ty::Duration } else { SECONDS };
        if sources.inferred_as[usize::from(is_time)] {
            changed |= settled.insert(flow, ty.clone()) != Some(ty);
        }
    }
    changed
}

/// Returns, for each flow whose type is an exact time or seconds, which of the two contribute to its value.
fn time_sources(
    cx: &Body<'_, '_>,
    open: &[usize],
    settled: &FastMap<FlowId, Ty>,
) -> BTreeMap<FlowId, TimeSources> {
    let mut all: BTreeMap<FlowId, TimeSources> = BTreeMap::new();
    let mut values: Vec<(FlowId, ExprId)> = Vec::new();
    for index in open {
        let pending = &cx.pending[*index];
        let (EquationState::Done(value), [Some(flow)]) =
            (pending.state, &pending.inferred_flows[..])
        else {
            continue;
        };
        let outer = outermost_shared_flow(cx, *flow);
        let types = [*flow, outer].map(|flow| &cx.unit.flow(flow).ty);
        if types.into_iter().all(is_time_or_seconds) {
            let sources = all.entry(outer).or_default();
            sources.inferred_as[0] |= types.contains(&&Ty::Duration);
            sources.inferred_as[1] |= types.contains(&&SECONDS);
            // It was fixed as a time, but its value is still in seconds.
            sources.seconds |= settled.get(&outer) == Some(&Ty::Duration)
                && *cx.ty_of(value) == SECONDS
                && exact_time::fixed_alternatives(cx, value).is_none();
            values.push((outer, value));
        }
    }
    for (flow, value) in values {
        add_sources(cx, flow, value, &mut all);
    }
    all
}

/// Returns the outermost flow that a flow local to a state of an automaton defines; the flow itself if it is not local
/// to a state.
fn outermost_shared_flow(cx: &Body<'_, '_>, flow: FlowId) -> FlowId {
    automaton::enclosing_shared_flows(cx, flow)
        .last()
        .unwrap_or(flow)
}

/// Adds to the entry of `flow` in `all` the exact times, seconds and other flows that `value`, the expression that
/// defines the flow, depends on.
fn add_sources(
    cx: &Body<'_, '_>,
    flow: FlowId,
    value: ExprId,
    all: &mut BTreeMap<FlowId, TimeSources>,
) {
    let mut open = vec![value];
    while let Some(id) = open.pop() {
        let expr = cx.unit.expr(id);
        match &expr.kind {
            TypedKind::Flow(read) if all.contains_key(&outermost_shared_flow(cx, *read)) => {
                let read = outermost_shared_flow(cx, *read);
                all.entry(read).or_default().readers.push(flow);
                all.entry(flow).or_default().reads.push(read);
                continue;
            }
            _ if push_same_type_operands(&cx.unit, expr, &mut open) => continue,
            _ => {}
        }
        let sources = all.entry(flow).or_default();
        match expr.ty {
            Ty::Duration => sources.time = true,
            _ if is_converted_time(&expr.kind) => sources.time = true,
            _ => sources.seconds |= !may_be_ticks(&cx.unit, expr),
        }
    }
}

/// Resets the inferred types before another round of inference. Flows in `settled` get the type given there.
fn reset_inferred_types(cx: &mut Body<'_, '_>, open: &[usize], settled: &FastMap<FlowId, Ty>) {
    for index in open {
        cx.pending[*index].state = EquationState::Unchecked;
        for flow in cx.pending[*index]
            .inferred_flows
            .clone()
            .into_iter()
            .flatten()
        {
            let around: Vec<FlowId> = automaton::enclosing_shared_flows(cx, flow).collect();
            let outer = around.last().copied().unwrap_or(flow);
            let ty = settled.get(&outer).cloned().unwrap_or(Ty::Unknown);
            for flow in std::iter::once(flow).chain(around) {
                cx.unit.flows[flow.0 as usize].ty = ty.clone();
            }
        }
    }
}

/// Marks each flow that depends on a flow in seconds, directly or indirectly, as having seconds as a source, because a
/// sum of a time and seconds is in seconds.
fn propagate_seconds(all: &mut BTreeMap<FlowId, TimeSources>) {
    let mut open = flows_with(all, |sources| sources.seconds);
    while let Some(flow) = open.pop() {
        for reader in neighbours(all, flow, |sources| &sources.readers) {
            if let Some(sources) = all.get_mut(&reader)
                && !std::mem::replace(&mut sources.seconds, true)
            {
                open.push(reader);
            }
        }
    }
}

/// Marks each flow that depends on an exact time, directly or indirectly, as having a time as a source. Flows with
/// fixed durations that such a flow reads are marked as well.
fn propagate_times(all: &mut BTreeMap<FlowId, TimeSources>) {
    let mut open = flows_with(all, |sources| sources.time && !sources.seconds);
    while let Some(flow) = open.pop() {
        let readers = neighbours(all, flow, |sources| &sources.readers);
        let read = neighbours(all, flow, |sources| &sources.reads);
        for other in readers.into_iter().chain(read) {
            if let Some(sources) = all.get_mut(&other)
                && !sources.seconds
                && !std::mem::replace(&mut sources.time, true)
            {
                open.push(other);
            }
        }
    }
}

fn flows_with(all: &BTreeMap<FlowId, TimeSources>, holds: fn(&TimeSources) -> bool) -> Vec<FlowId> {
    let found = all.iter().filter(|(_, sources)| holds(sources));
    found.map(|(flow, _)| *flow).collect()
}

fn neighbours(
    all: &BTreeMap<FlowId, TimeSources>,
    flow: FlowId,
    which: fn(&TimeSources) -> &Vec<FlowId>,
) -> Vec<FlowId> {
    all.get(&flow).map(which).cloned().unwrap_or_default()
}

/// Adds to `open` the operands of an expression that have its type, such as the branches of `if`. Returns `false` if
/// the expression has another form.
fn push_same_type_operands(unit: &Unit, expr: &Expr, open: &mut Vec<ExprId>) -> bool {
    match &expr.kind {
        TypedKind::Part { base, .. } if is_time_or_seconds(&unit.expr(*base).ty) => {
            open.push(*base)
        }
        TypedKind::Each(ElementwiseOp::If, parts) => open.extend(parts.iter().skip(1)),
        TypedKind::Each(_, parts) => open.extend(parts),
        TypedKind::When { value, .. } | TypedKind::Current(value) => open.push(*value),
        TypedKind::Merge { cases, .. } => open.extend(cases.iter().map(|case| case.1)),
        TypedKind::Prim(call) if UNIT_PRESERVING.contains(&call.prim.desc().name) => {
            let inputs = call.inputs.iter().flatten();
            open.extend(inputs.filter(|id| is_time_or_seconds(&unit.expr(**id).ty)));
        }
        _ => return false,
    }
    true
}

/// Names of primitives whose operands and result are either all exact times or all in seconds.
const UNIT_PRESERVING: &[&str] = &[
    "Core::IntAdd",
    "Rpi::IntSubtract",
    "Rpi::IntModulo",
    "Rpi::IntNegate",
    "Core::IntMultiply",
    "Core::IntDivide",
    "Core::DoubleAdd",
    "Rpi::DoubleSubtract",
    "Core::DoubleModulo",
    "Rpi::DoubleNegate",
    "Rpi::SecondsFromTicks",
];

/// Whether an expression in seconds is a time that the core provides in ticks, converted to seconds.
fn is_converted_time(kind: &TypedKind) -> bool {
    let name = |call: &PrimCall| call.prim.desc().name;
    matches!(kind, TypedKind::Prim(call) if matches!(name(call), "Core::CycleTime" | "Rpi::Time"))
}

/// Whether an expression in seconds can also be computed in ticks, because it is fixed when the command is loaded, or
/// its type is unknown.
fn may_be_ticks(unit: &Unit, expr: &Expr) -> bool {
    match &expr.kind {
        TypedKind::Literal(_) | TypedKind::Const(_) | TypedKind::Error | TypedKind::None => true,
        TypedKind::Flow(flow) => unit.flow(*flow).role == FlowRole::Param || expr.ty.is_unknown(),
        TypedKind::Prim(call) => {
            call.prim.desc().name == "Rpi::WholeTicks" || is_load_time_constant(unit, &expr.kind)
        }
        _ => expr.ty.is_unknown(),
    }
}

/// Whether a type is an exact time or a real in seconds.
fn is_time_or_seconds(ty: &Ty) -> bool {
    *ty == Ty::Duration || *ty == SECONDS
}
