//! Diagnostics for flows whose types cannot be inferred, because their equations only refer to one another.
//!
//! `a = b; b = a` is reported as a dependency cycle; `z = pre z` may run, but its type is unknown. Flows that only
//! depend on such flows are not reported.

use crate::check::bodies::body::Body;
use crate::check::bodies::type_inference;
use crate::check::bodies::type_inference::EquationState;
use crate::check::bodies::type_inference::GuessPolicy;
use crate::check::diagnostics::report;
use crate::typed::{Flow, FlowId, FlowPresence};
use petgraph::graph::{DiGraph, NodeIndex};
use rpi_diag::{Code, Diagnostic, Span};
use rpi_net::passes::causality::{self, Read};
use rpi_net::passes::dependency_cycles::CyclicComponents;
use std::collections::BTreeMap;

/// Read of a flow whose type could not be inferred, in an equation whose own type could not be inferred.
#[derive(Clone, Copy)]
struct UnknownFlowRead {
    /// Index in `pending` of the equation that defines the flow.
    from: usize,
    /// Index in `pending` of the equation that reads the flow.
    to: usize,
    span: Span,
    /// Whether the flow is read in the current cycle, rather than through a delay such as `pre`.
    in_same_cycle: bool,
}

/// Reports flows whose types cannot be inferred. Flows that depend on one another in the same cycle are reported first,
/// because no guess determines their types.
pub(crate) fn report_unknown_types(cx: &mut Body<'_, '_>) {
    report_uninferred_cycles(cx, true);
    type_inference::guess_from_numbers(cx, GuessPolicy::Factors);
    report_uninferred_cycles(cx, false);
}

/// Reports groups of equations of unknown type that depend on one another. With `only_now`, only dependencies in the
/// same cycle count, and the shortest dependency cycle of each group is reported; otherwise one flow of each group is
/// reported.
fn report_uninferred_cycles(cx: &mut Body<'_, '_>, only_now: bool) {
    let equations = 0..cx.pending.len();
    let open: Vec<usize> = equations
        .filter(|index| is_uninferred(cx, *index))
        .collect();
    let links: Vec<UnknownFlowRead> = open
        .iter()
        .flat_map(|index| unknown_reads(cx, *index))
        .collect();
    let mut graph: DiGraph<usize, UnknownFlowRead> = DiGraph::new();
    let vertices: BTreeMap<usize, NodeIndex> =
        (open.iter().map(|index| (*index, graph.add_node(*index)))).collect();
    for link in links.iter().filter(|link| link.in_same_cycle || !only_now) {
        let ends = [link.from, link.to].map(|end| vertices.get(&end));
        if let [Some(from), Some(to)] = ends {
            graph.add_edge(*from, *to, *link);
        }
    }
    let rings = CyclicComponents::new(&graph);
    for (k, component) in rings.components.iter().enumerate() {
        for vertex in component {
            cx.pending[graph[*vertex]].state = EquationState::Reported;
        }
        match only_now {
            true => {
                let ring = rings.shortest_cycle(k);
                let ring: Vec<UnknownFlowRead> = ring.into_iter().map(|edge| graph[edge]).collect();
                report_type_cycle(cx, &ring);
            }
            false => cannot_infer_type(cx, graph[component[0]]),
        }
    }
}

fn is_uninferred(cx: &Body<'_, '_>, index: usize) -> bool {
    let pending = &cx.pending[index];
    let is_open = |flow: &FlowId| {
        let flow = cx.unit.flow(*flow);
        flow.ty.has_unknown() && flow.optional == FlowPresence::Inferred
    };
    pending.state == EquationState::Guessed && pending.inferred_flows.iter().flatten().any(is_open)
}

/// Returns the reads of flows of unknown type in the pending equation with this index.
fn unknown_reads(cx: &mut Body<'_, '_>, index: usize) -> Vec<UnknownFlowRead> {
    let mark = type_inference::checkpoint(cx);
    cx.inference.unknown_reads.clear();
    cx.inference.is_running = true;
    type_inference::check_value(cx, index);
    cx.inference.is_running = false;
    type_inference::rollback(cx, mark);
    let missing = std::mem::take(&mut cx.inference.unknown_reads);
    let reads = missing
        .iter()
        .filter(|read| is_uninferred(cx, read.equation))
        .map(|read| UnknownFlowRead {
            from: read.equation,
            to: index,
            span: read.span,
            in_same_cycle: read.in_same_cycle,
        });
    reads.collect()
}

fn report_type_cycle(cx: &mut Body<'_, '_>, ring: &[UnknownFlowRead]) {
    let read = |link: &UnknownFlowRead| Read {
        from: first_flow_name(cx, link.from),
        to: first_flow_name(cx, link.to),
        span: link.span,
    };
    let reads: Vec<Read> = ring.iter().map(read).collect();
    report::report_diagnostic(cx, causality::dependency_cycle(&reads));
}

/// Returns the name of the first flow whose type the pending equation with this index decides; empty if there is none.
fn first_flow_name(cx: &Body<'_, '_>, index: usize) -> String {
    let flow = cx.pending[index].inferred_flows.iter().flatten().next();
    flow.map_or_else(String::new, |flow| cx.unit.flow(*flow).name.to_string())
}

fn cannot_infer_type(cx: &mut Body<'_, '_>, index: usize) {
    let flows = cx.pending[index].inferred_flows.iter().flatten();
    let Some(flow) = flows
        .map(|id| cx.unit.flow(*id))
        .find(|flow| flow.ty.has_unknown())
    else {
        return;
    };
    let diagnostic = report_uninferred(flow, "its equation only refers to earlier values", "...");
    report::report_diagnostic(cx, diagnostic);
}

/// Returns the diagnostic for a flow whose type cannot be inferred. `why` is the label at the flow, and `ty` is the
/// type in the suggested declaration.
pub(crate) fn report_uninferred(flow: &Flow, why: &str, ty: &str) -> Diagnostic {
    let name = &flow.name;
    Diagnostic::new(Code::RPI2007, format!("cannot infer the type of `{name}`"))
        .primary(flow.span, why)
        .help(format!("declare it: `var {name}: {ty};` before `let`"))
}
