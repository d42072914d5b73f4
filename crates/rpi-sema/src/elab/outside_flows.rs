//! Flows that are read outside of the block or clock that defines them.

use crate::clocks::{ClockId, LeafClocks, Sampling};
use crate::elab::block;
use crate::elab::call;
use crate::elab::expr;
use crate::elab::flows;
use crate::elab::nodes;
use crate::elab::primitive_family::PrimitiveFamily;
use crate::elab::sampled_flows;
use crate::elab::scope::Scope;
use crate::elab::signal::{Signal, Wire};
use crate::elab::{Elaborator, Position};
use crate::facts::Facts;
use crate::typed::{Equation, ExprId, FlowId, TargetPlace};
use rpi_diag::Span;
use rpi_image::{Scalar, Value};
use rpi_net::prim;

/// Returns the signals of a flow for expressions that run in all cycles of its block: the flow is absent in cycles in
/// which its clock does not tick. `wire` has the signals of the flow on its own clock.
pub(super) fn off_clock_absent<'u>(
    elab: &mut Elaborator<'u>,
    scope: &mut Scope<'u>,
    flow: FlowId,
    wire: &Wire,
    span: Span,
) -> Wire {
    let Some(facts) = sampled_flows::clocked_facts(elab, scope) else {
        return wire.clone();
    };
    let scalars = crate::elab::expr::leaf_scalars(&scope.unit.flow(flow).ty);
    let row = facts.clocks.flow_clocks(flow);
    let clocks = |k: usize| (row.leaf(k), ClockId::BASE);
    on_reader_clock(elab, scope, (wire, &scalars), clocks, span)
}

/// Returns the signals of an equation's value on the clocks of the flows that it defines.
pub(super) fn value_for_targets<'u>(
    elab: &mut Elaborator<'u>,
    scope: &mut Scope<'u>,
    equation: &'u Equation,
    wire: Wire,
) -> Wire {
    let Some(facts) = sampled_flows::clocked_facts(elab, scope) else {
        return wire;
    };
    let clocks = &facts.clocks;
    let mut wanted = Vec::with_capacity(wire.len());
    for target in &equation.targets {
        let row = match target.place {
            TargetPlace::Flow { flow, at } => (clocks.flow_clocks(flow), at as usize),
            _ => (LeafClocks::Uniform(ClockId::BASE), 0),
        };
        let leaves = 0..target.ty.leaf_count();
        wanted.extend(leaves.map(|k| row.0.leaf(row.1 + k)));
    }
    let own = |k: usize| clocks.leaf(equation.value, k);
    let pair = |k: usize| (own(k), wanted.get(k).copied().unwrap_or(own(k)));
    let expr = scope.unit.expr(equation.value);
    let scalars = crate::elab::expr::leaf_scalars(&expr.ty);
    on_reader_clock(elab, scope, (&wire, &scalars), pair, expr.span)
}

/// Returns the signals of a value for an expression on another clock. `clocks` returns for each leaf (scalar part) its
/// own clock and that of the expression. A leaf with a slower clock is absent in cycles in which that clock does not
/// tick.
pub(super) fn on_reader_clock<'u>(
    elab: &mut Elaborator<'u>,
    scope: &mut Scope<'u>,
    (wire, scalars): (&Wire, &[Scalar]),
    clocks: impl Fn(usize) -> (ClockId, ClockId),
    span: Span,
) -> Wire {
    let Some(facts) = sampled_flows::clocked_facts(elab, scope) else {
        return wire.clone();
    };
    let is_slower = |k: usize| {
        let (own, reader) = clocks(k);
        facts.clocks.is_slower(own, reader)
    };
    if !(0..wire.len()).any(is_slower) {
        return wire.clone();
    }
    let mut leaves = Vec::with_capacity(wire.len());
    let mut off: Option<((ClockId, ClockId), Signal)> = None;
    for (k, signal) in wire.iter().enumerate() {
        if !is_slower(k) {
            leaves.push(signal.clone());
            continue;
        }
        let pair = clocks(k);
        let at = Position::in_fragment(sampled_flows::clock_fragment(elab, scope, pair.1));
        let known = off.take().filter(|(known, _)| *known == pair);
        let known = match known {
            Some((_, known)) => known,
            None => inactive_condition(
                elab,
                scope,
                facts.clocks.samplings_beyond(pair.0, pair.1),
                at,
                span,
            ),
        };
        let scalar = scalars.get(k).copied().unwrap_or(Scalar::Bool);
        let inputs = [signal.clone(), known.clone()];
        leaves.push(nodes::add_family_member(
            elab,
            PrimitiveFamily::SetNull,
            scalar,
            &inputs,
            at,
            span,
        ));
        off = Some((pair, known));
    }
    leaves.into()
}

/// Returns the signals of the operand of `when` in the cycles in which both its clock and the clock of the condition
/// tick. A leaf (scalar part) with a further sampling is absent in cycles in which it has no value.
pub(super) fn sampled_value<'u>(
    elab: &mut Elaborator<'u>,
    scope: &mut Scope<'u>,
    [id, value]: [ExprId; 2],
    at: Position,
) -> Wire {
    let wire = expr::elab_expr(elab, scope, value, at);
    let Some(facts) = sampled_flows::clocked_facts(elab, scope) else {
        return wire;
    };
    let expr = scope.unit.expr(value);
    let scalars = crate::elab::expr::leaf_scalars(&expr.ty);
    let mut leaves = Vec::with_capacity(wire.len());
    for (k, (signal, scalar)) in wire.iter().zip(scalars).enumerate() {
        let (common, beyond) = facts.clocks.split_operand_samplings(value, k, id);
        if beyond.is_empty() {
            leaves.push(signal.clone());
            continue;
        }
        let mut fragment = scope.base;
        for tick in common {
            fragment = sampled_flows::sampling_fragment(elab, scope, *tick, fragment);
        }
        let at = Position::in_fragment(fragment);
        let off = inactive_condition(elab, scope, beyond, at, expr.span);
        let inputs = [signal.clone(), off];
        leaves.push(nodes::add_family_member(
            elab,
            PrimitiveFamily::SetNull,
            scalar,
            &inputs,
            at,
            expr.span,
        ));
    }
    leaves.into()
}

/// Returns the signal that is true in cycles in which at least one of the nested samplings `path` does not tick.
fn inactive_condition<'u>(
    elab: &mut Elaborator<'u>,
    scope: &mut Scope<'u>,
    path: &[Sampling],
    at: Position,
    span: Span,
) -> Signal {
    let mut active = Signal::Const(Value::bool(true));
    for tick in path.iter().rev() {
        let ticks = sampled_flows::tick_condition(elab, scope, *tick, at, span);
        let no = Signal::Const(Value::bool(false));
        let inputs = [ticks, active, no];
        active = nodes::add_family_member(
            elab,
            PrimitiveFamily::Conditional,
            Scalar::Bool,
            &inputs,
            at,
            span,
        );
    }
    nodes::add_simple(elab, prim!("Core::BooleanNot"), &[active], at, span)
}

/// Returns the signals of a flow for expressions outside of its block. The flow has a signal in all cycles of the block
/// and is absent in cycles in which its clock does not tick. The signals are placeholder ports, which are connected
/// when the fragment of the block exists.
pub(super) fn flow_outside_block<'u>(
    elab: &mut Elaborator<'u>,
    scope: &mut Scope<'u>,
    flow: FlowId,
    span: Span,
) -> Wire {
    let facts = sampled_flows::clocked_facts(elab, scope);
    let is_base =
        |facts: &Facts| facts.clocks.flow_clocks(flow) == LeafClocks::Uniform(ClockId::BASE);
    if facts.is_none_or(is_base) {
        return flows::elab_flow(elab, scope, flow, span);
    }
    if let Some((_, known)) = scope.outside_reads.iter().find(|(known, _)| *known == flow) {
        return known.clone();
    }
    let wire = flows::alias_wire(elab, &scope.unit.flow(flow).ty, span);
    scope.outside_reads.push((flow, wire.clone()));
    wire
}

/// Connects the placeholder ports of flows that were read outside of their blocks before the fragments of these blocks
/// were added to the net.
pub(super) fn bind_outside_flows<'u>(elab: &mut Elaborator<'u>, scope: &mut Scope<'u>) {
    let around = scope.base;
    for (flow, aliases) in std::mem::take(&mut scope.outside_reads) {
        let declared = scope.unit.flow(flow);
        let Some(fragment) = scope.fragment(declared.block) else {
            continue;
        };
        scope.base = fragment;
        block::set_node_name(elab, &format!("{}{}", scope.prefix, declared.name));
        let wire = flows::elab_flow(elab, scope, flow, declared.span);
        let wire = off_clock_absent(elab, scope, flow, &wire, declared.span);
        for (alias, signal) in aliases.iter().zip(wire.iter()) {
            if let Signal::Port(alias) = alias {
                call::bind_alias(elab, *alias, signal);
            }
        }
    }
    scope.base = around;
}
