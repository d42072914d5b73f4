//! Unused local flows.
//!
//! Flows of a net are checked on the net. Flows with a constant value leave no node in a net, and for a call with
//! several results the net only shows that the call is needed. These are checked here.

use crate::hash::FastSet;
use crate::program::Program;
use crate::typed::TypedKind;
use crate::typed::{Equation, Flow, FlowRole, TargetPlace, Unit, UnitKind};
use rpi_diag::{Diagnostic, Span};
use rpi_net::passes::mark_live::has_effect;
use rpi_net::passes::unused_flows::unused;
use std::collections::{BTreeMap, BTreeSet};
use std::rc::Rc;

/// Returns a warning for each local flow of the first module that nothing reads, in any instance of its unit. A leading
/// `_` in the name suppresses the warning.
pub(super) fn unread(program: &Program<'_>, units: &[Rc<Unit>]) -> Vec<Diagnostic> {
    let decls = program.root().decls.iter();
    let own: FastSet<Span> = decls.map(|id| program.decl(*id).span).collect();
    let of_tasks = |unit: &Unit| matches!(unit.kind, UnitKind::Task | UnitKind::Constant);
    let units = units.iter();
    let units = units.filter(|unit| own.contains(&unit.span) && !of_tasks(unit));
    let units: Vec<(&Unit, Vec<bool>)> = units.map(|unit| (&**unit, read(unit))).collect();
    let mut unread = local_flow_spans(&units, false).collect::<BTreeSet<Span>>();
    if unread.is_empty() {
        return Vec::new();
    }
    for read in local_flow_spans(&units, true) {
        unread.remove(&read);
    }
    let mut found = BTreeMap::new();
    for (unit, _) in &units {
        let equations = unit.blocks.iter().flat_map(|block| &block.equations);
        for (flow, equation) in equations.flat_map(|equation| defined(unit, equation)) {
            if unread.remove(&flow.span) && !may_have_side_effect(unit, equation) {
                found.insert(flow.span, diagnostic(unit, flow, equation));
            }
        }
    }
    found.into_values().collect()
}

/// Returns the locations of the local flows that are read (`wanted` is true) or not read in some instance of their
/// unit. `units` has each unit with whether each of its flows is read.
fn local_flow_spans<'u>(
    units: &'u [(&Unit, Vec<bool>)],
    wanted: bool,
) -> impl Iterator<Item = Span> + 'u {
    units.iter().flat_map(move |(unit, read)| {
        let flows = unit.flows.iter().zip(read);
        let flows =
            flows.filter(move |(flow, is_read)| **is_read == wanted && is_checked_local(flow));
        flows.map(|(flow, _)| flow.span)
    })
}

fn is_checked_local(flow: &Flow) -> bool {
    flow.role == FlowRole::Local && !flow.name.starts_with('_')
}

/// Returns for each flow of a unit, by index, whether an expression, a clock or an automaton reads it.
fn read(unit: &Unit) -> Vec<bool> {
    let mut read = vec![false; unit.flows.len()];
    for expr in &unit.exprs {
        match &expr.kind {
            TypedKind::Flow(flow) => read[flow.0 as usize] = true,
            TypedKind::When { clock, .. } => read[clock.flow.0 as usize] = true,
            _ => {}
        }
    }
    for clock in unit.flows.iter().filter_map(|flow| flow.clock) {
        read[clock.flow.0 as usize] = true;
    }
    let automata = unit.blocks.iter().flat_map(|block| &block.automata);
    for contribution in automata
        .flat_map(|a| &a.shared)
        .flat_map(|shared| shared.contributions())
    {
        read[contribution.0 as usize] = true;
    }
    read
}

/// Returns each flow that an equation defines, paired with the equation, for the check of unused flows.
fn defined<'u>(
    unit: &'u Unit,
    equation: &'u Equation,
) -> impl Iterator<Item = (&'u Flow, &'u Equation)> {
    let places = equation.targets.iter().map(|target| &target.place);
    places.filter_map(move |place| match place {
        TargetPlace::Flow { flow, .. } => Some((unit.flow(*flow), equation)),
        _ => None,
    })
}

/// Returns whether the value of an equation with one target may have a side effect, so that its flow need not be read.
/// Whether the flow is really unused is then decided after elaboration to a net.
fn may_have_side_effect(unit: &Unit, equation: &Equation) -> bool {
    let is_effect = |kind: &TypedKind| match kind {
        TypedKind::Call(_) => true,
        TypedKind::Prim(call) => has_effect(call.prim.desc()),
        _ => false,
    };
    if equation.targets.len() != 1 {
        return false;
    }
    let mut parts = unit.traverse(equation.value);
    while let Some((id, expr)) = parts.next() {
        if is_effect(&expr.kind) {
            return true;
        }
        parts.enter(id);
    }
    false
}

/// Returns the warning about an unused flow. If the equation defines several flows, the warning is at the name of the
/// flow, because the others may be needed; otherwise it is at the value.
fn diagnostic(unit: &Unit, flow: &Flow, equation: &Equation) -> Diagnostic {
    match &equation.targets[..] {
        [_] => unused(unit.expr(equation.value).span, &flow.name),
        _ => Diagnostic {
            help: vec![format!(
                "write `_` in its place, or rename it to `_{}`",
                flow.name
            )],
            ..unused(flow.span, &flow.name)
        },
    }
}
