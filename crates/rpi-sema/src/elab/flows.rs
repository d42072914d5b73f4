//! Reads and definitions of flows.

use crate::elab::expr;
use crate::elab::expr::leaf_scalars;
use crate::elab::node_budget;
use crate::elab::nodes;
use crate::elab::sampled_flows;
use crate::elab::scope::{FlowState, Scope};
use crate::elab::signal::{Signal, Wire, alias_of, empty_wire};
use crate::elab::subrange;
use crate::elab::{ElabMode, Elaborator, NotConstantError, Position};
use crate::ty::Ty;
use crate::typed::{Equation, FlowId, FlowRole, Target, TargetPlace};
use rpi_diag::Span;
use rpi_net::PortRef;

/// Returns the signals of a flow. They are placeholder ports if the equation of the flow has not been elaborated yet.
pub(super) fn elab_flow<'u>(
    elab: &mut Elaborator<'u>,
    scope: &mut Scope<'u>,
    flow: FlowId,
    span: Span,
) -> Wire {
    match scope.state(flow) {
        FlowState::Done(wire) => return wire.clone(),
        FlowState::InProgress => return elab.fail(NotConstantError::RunTime(span)),
        FlowState::Unvisited => {}
    }
    match elab.mode {
        ElabMode::Net | ElabMode::Dependencies | ElabMode::DependencySteps => {
            let wire = alias_wire(elab, &scope.unit.flow(flow).ty, span);
            *scope.state(flow) = FlowState::Done(wire.clone());
            wire
        }
        ElabMode::Constant => constant_flow(elab, scope, flow, span),
    }
}

pub(super) fn alias_wire(elab: &mut Elaborator<'_>, ty: &Ty, span: Span) -> Wire {
    if !node_budget::charge_leaves(elab, ty.leaf_count(), span) {
        return empty_wire();
    }
    let scalars = leaf_scalars(ty);
    scalars
        .into_iter()
        .map(|scalar| Signal::Port(nodes::new_alias(elab, scalar)))
        .collect()
}

/// Returns the signals of a flow whose value is needed for a constant, by evaluating its equation. A flow without an
/// equation has no constant value.
fn constant_flow<'u>(
    elab: &mut Elaborator<'u>,
    scope: &mut Scope<'u>,
    flow: FlowId,
    span: Span,
) -> Wire {
    let role = scope.unit.flow(flow).role;
    let unit = scope.unit;
    let equations = unit.blocks.iter().flat_map(|block| &block.equations);
    let defines = |equation: &&Equation| equation.targets.iter().any(|t| is_whole(t, flow));
    let found = equations.into_iter().find(|equation| defines(equation));
    let Some(equation) = found.filter(|_| !matches!(role, FlowRole::Input | FlowRole::Param))
    else {
        return elab.fail(NotConstantError::RunTime(span));
    };
    *scope.state(flow) = FlowState::InProgress;
    let wire = expr::elab_expr(elab, scope, equation.value, Position::ROOT);
    let wire = subrange::check_targets(elab, scope, equation, wire, Position::ROOT);
    define_all(elab, scope, equation, &wire);
    match scope.state(flow) {
        FlowState::Done(wire) => wire.clone(),
        _ => elab.fail(NotConstantError::RunTime(span)),
    }
}

/// Defines the flows on the left side of an equation by the signals of its value.
pub(super) fn define_all<'u>(
    elab: &mut Elaborator<'u>,
    scope: &mut Scope<'u>,
    equation: &Equation,
    wire: &Wire,
) {
    let mut at = 0;
    for target in &equation.targets {
        let count = target.ty.leaf_count();
        let end = (at + count).min(wire.len());
        let part: Wire = match (at, end) == (0, wire.len()) {
            true => wire.clone(),
            false => wire[at.min(end)..end].into(),
        };
        if let TargetPlace::Flow { flow, at: offset } = target.place {
            define(elab, scope, flow, offset as usize, &part);
        }
        at += count;
    }
}

/// Defines a part of a flow, from the leaf (scalar part) `at` on, by the given signals. Placeholder ports by which the
/// flow was read before are connected.
pub(super) fn define<'u>(
    elab: &mut Elaborator<'u>,
    scope: &mut Scope<'u>,
    flow: FlowId,
    at: usize,
    part: &Wire,
) {
    let whole = scope.unit.flow(flow).ty.leaf_count();
    if part.len() == whole
        && at == 0
        && let state @ (FlowState::Unvisited | FlowState::InProgress) = scope.state(flow)
    {
        *state = FlowState::Done(part.clone());
        return;
    }
    let wire = elab_flow(elab, scope, flow, scope.unit.flow(flow).span);
    let has_clocks =
        sampled_flows::facts_of(elab, scope).is_some_and(|facts| facts.clocks.has_samplings());
    for (k, signal) in part.iter().enumerate() {
        if let Some(Signal::Port(port)) = wire.get(at + k) {
            bind_statics(elab, *port, signal);
            if let (Signal::Port(name), true) = (signal, has_clocks) {
                elab.aliases.names_before.entry(*name).or_insert(*port);
            }
        }
    }
    if part.len() == whole {
        *scope.state(flow) = FlowState::Done(part.clone());
    }
}

fn bind_statics(elab: &mut Elaborator<'_>, port: PortRef, signal: &Signal) {
    if let Some(alias) = alias_of(port) {
        elab.aliases.signals[alias].get_or_insert_with(|| signal.clone());
    }
}

fn is_whole(target: &Target, flow: FlowId) -> bool {
    matches!(target.place, TargetPlace::Flow { flow: f, at: 0 } if f == flow)
}
