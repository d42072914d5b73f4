//! Local flows that nothing reads.
//!
//! A net tells of those that it computes. What a constant comes to leaves nothing in a net, and of the results of one call
//! it knows only that the call is needed.

use crate::hash::Set;
use crate::program::Program;
use crate::typed::{Equation, Flow, FlowRole, Kind, Place, Unit, UnitKind};
use rpi_diag::{Finding, Span};
use std::collections::BTreeMap;

/// A warning for each local flow that nothing reads, in any instance of what it stands in. A name that begins with `_` is
/// meant so.
pub(super) fn unread(program: &Program<'_>, units: &[Unit]) -> Vec<Finding> {
    let own: Set<Span> = program
        .root()
        .decls
        .iter()
        .map(|id| program.decl(*id).span)
        .collect();
    let of_tasks = |unit: &Unit| matches!(unit.kind, UnitKind::Task | UnitKind::Constant);
    let mut found: BTreeMap<Span, Option<Finding>> = BTreeMap::new();
    for unit in units
        .iter()
        .filter(|unit| own.contains(&unit.span) && !of_tasks(unit))
    {
        let read = read(unit);
        let equations = unit.blocks.iter().flat_map(|block| &block.equations);
        for (flow, is_read, equation) in equations.flat_map(|e| locals(unit, &read, e)) {
            let told = found
                .entry(flow.span)
                .or_insert_with(|| Some(finding(unit, flow, equation)));
            if is_read {
                *told = None;
            }
        }
    }
    found.into_values().flatten().collect()
}

/// For each flow whether something reads it: an expression, a clock, or what is around a state.
fn read(unit: &Unit) -> Vec<bool> {
    let mut read = vec![false; unit.flows.len()];
    for expr in &unit.exprs {
        match &expr.kind {
            Kind::Flow(flow) => read[flow.0 as usize] = true,
            Kind::When { clock, .. } => read[clock.flow.0 as usize] = true,
            _ => {}
        }
    }
    for clock in unit.flows.iter().filter_map(|flow| flow.clock) {
        read[clock.flow.0 as usize] = true;
    }
    let automata = unit.blocks.iter().flat_map(|block| &block.automata);
    for state in automata
        .flat_map(|a| &a.shared)
        .flat_map(|shared| &shared.states)
    {
        read[state.0 as usize] = true;
    }
    read
}

/// The local flows that an equation defines, and whether they are read.
fn locals<'u>(
    unit: &'u Unit,
    read: &[bool],
    equation: &'u Equation,
) -> impl Iterator<Item = (&'u Flow, bool, &'u Equation)> {
    let flows = equation
        .targets
        .iter()
        .filter_map(|target| match target.place {
            Place::Flow { flow, .. } => Some((unit.flow(flow), read[flow.0 as usize])),
            _ => None,
        });
    let flows =
        flows.filter(|(flow, _)| flow.role == FlowRole::Local && !flow.name.starts_with('_'));
    flows.map(move |(flow, is_read)| (flow, is_read, equation))
}

/// One of several results is told where it gets its name, for the others may be needed.
fn finding(unit: &Unit, flow: &Flow, equation: &Equation) -> Finding {
    let at = match &equation.targets[..] {
        [_] => unit.expr(equation.value).span,
        _ => flow.span,
    };
    rpi_net::passes::live::unused(at, &flow.name)
}
