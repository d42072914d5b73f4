//! Canonical names of deciding flows. A flow that only copies another flow, or a part of one, is named after that flow.

use crate::clocks::clock::ClockCondition;
use crate::clocks::solve::Solver;
use crate::typed::{Activation, TypedKind};
use crate::typed::{ExprId, FlowId, TargetPlace, Unit};

/// Returns the clock condition that a flow stands for: the flow or call result of which it is a copy, followed through
/// all copies, or else the flow itself.
pub(super) fn condition_of(solver: &mut Solver<'_>, flow: FlowId) -> ClockCondition {
    if let Some(known) = solver.canonical.get(&flow) {
        return *known;
    }
    let name = source(solver, flow, 0).unwrap_or(ClockCondition::Flow(flow));
    solver.canonical.insert(flow, name);
    name
}

/// Returns the clock condition of which leaf `k` (scalar part) of an expression is a copy; `None` if the expression
/// computes a new value.
pub(super) fn condition(solver: &mut Solver<'_>, id: ExprId, k: usize) -> Option<ClockCondition> {
    match copied_source(solver, id, k)? {
        CopySource::Leaf(flow, 0) if is_scalar(solver.unit, flow) => {
            Some(condition_of(solver, flow))
        }
        CopySource::Leaf(flow, k) => source(solver, flow, k),
        CopySource::CallResult(by) => Some(by),
    }
}

/// Returns the flow or call result of which leaf `k` (scalar part) of a flow is a copy, followed through all copies;
/// `None` if it is not a copy.
fn source(solver: &Solver<'_>, flow: FlowId, k: usize) -> Option<ClockCondition> {
    let (mut at, mut best) = ((flow, k), None);
    for _ in 0..solver.unit.flows.len() {
        let Some((value, k)) = single_definition(solver, at.0, at.1) else {
            break;
        };
        match copied_source(solver, value, k) {
            Some(CopySource::CallResult(by)) => return Some(by),
            // In Lustre each name is a clock of its own, so copies are not followed.
            Some(CopySource::Leaf(flow, k)) if !solver.unit.is_lustre => {
                at = (flow, k);
                if is_scalar(solver.unit, flow) {
                    best = Some(ClockCondition::Flow(flow));
                }
            }
            _ => break,
        }
    }
    best
}

/// Returns the expression that defines leaf `k` (scalar part) of a flow, and the index of the leaf in this expression.
/// `None` unless exactly one equation defines parts of the flow.
fn single_definition(solver: &Solver<'_>, flow: FlowId, k: usize) -> Option<(ExprId, usize)> {
    let [definition] = solver.definitions_of[flow.0 as usize][..] else {
        return None;
    };
    let equation = solver.equation(definition)?;
    let mut first = 0;
    for target in &equation.targets {
        let count = target.ty.leaf_count();
        match target.place {
            TargetPlace::Flow { flow: defined, at }
                if defined == flow && (at as usize..at as usize + count).contains(&k) =>
            {
                return Some((equation.value, first + k - at as usize));
            }
            _ => first += count,
        }
    }
    None
}

/// Returns the flow or call result that leaf `k` (scalar part) of an expression passes on unchanged; `None` if the
/// expression computes a new value.
fn copied_source(solver: &Solver<'_>, id: ExprId, k: usize) -> Option<CopySource> {
    let (mut id, mut k) = (id, k);
    loop {
        match &solver.unit.expr(id).kind {
            TypedKind::Flow(flow) => {
                return (!solver.reads_inactive[id.0 as usize])
                    .then_some(CopySource::Leaf(*flow, k));
            }
            TypedKind::Part { base, at } => (id, k) = (*base, *at as usize + k),
            TypedKind::Build(parts) => {
                let mut parts = parts.iter();
                id = *parts.find(|part| {
                    let count = solver.unit.expr(**part).ty.leaf_count();
                    let is_here = k < count;
                    if !is_here {
                        k -= count;
                    }
                    is_here
                })?;
            }
            TypedKind::Call(call) if matches!(call.activation, Activation::Always) => {
                let callee = &solver.units[call.unit.0 as usize];
                let port = port_of(callee, k)?;
                let exposed = solver.facts[call.unit.0 as usize].clocks.exposed();
                let mut exposed = exposed.iter();
                let number = exposed.position(|(by, _)| *by == ClockCondition::Flow(port))?;
                let by = ClockCondition::CallInternal(id, u32::try_from(number).ok()?);
                return Some(CopySource::CallResult(by));
            }
            _ => return None,
        }
    }
}

/// Whether a call without a clock of its own runs in all cycles. It does if the callee has state and the last round of
/// inference has begun, in which only constants have no clock.
pub(super) fn runs_always(solver: &Solver<'_>, callee: &Unit) -> bool {
    solver.is_last_round() && !solver.unit.is_lustre && callee.has_state
}

/// Source from which an expression passes on a leaf (scalar part) unchanged.
enum CopySource {
    /// Leaf (scalar part) of a flow: the flow, and the index of the leaf in it.
    Leaf(FlowId, usize),
    /// Output of a called unit that is a clock condition.
    CallResult(ClockCondition),
}

fn is_scalar(unit: &Unit, flow: FlowId) -> bool {
    unit.flow(flow).ty.leaf_count() == 1
}

/// Returns the output of which leaf `k` (scalar part) of a callee's results is a part; `None` if that output has
/// several leaves.
fn port_of(callee: &Unit, mut k: usize) -> Option<FlowId> {
    for output in &callee.outputs {
        let count = callee.flow(*output).ty.leaf_count();
        if k < count {
            return (count == 1).then_some(*output);
        }
        k -= count;
    }
    None
}
