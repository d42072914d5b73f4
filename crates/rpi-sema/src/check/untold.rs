//! Diagnostics for flows whose types cannot be inferred, because their equations only refer to one another.
//!
//! `a = b; b = a` is reported as a dependency cycle; `z = pre z` may run, but its type is unknown. Flows that only
//! depend on such flows are not reported.

use super::body::Body;
use super::order::{Guess, State};
use crate::typed::{Flow, FlowId, Optional};
use petgraph::graph::{DiGraph, NodeIndex};
use rpi_diag::{Code, Finding, Span};
use rpi_net::passes::causality::{self, Read};
use rpi_net::passes::rings::Rings;
use std::collections::BTreeMap;

/// A read of a flow of unknown type by the equation of another flow.
#[derive(Clone, Copy)]
struct Link {
    /// Index of the equation that defines the flow.
    from: usize,
    /// Index of the equation that reads the flow.
    to: usize,
    span: Span,
    /// Whether the flow is read in the current cycle, not through `pre`.
    now: bool,
}

impl Body<'_, '_> {
    /// Reports flows whose types cannot be inferred. Dependency cycles within one cycle come first, because no guess
    /// resolves them.
    pub(super) fn report_unknown_types(&mut self) {
        self.report_rings(true);
        self.guess_by(Guess::Factors);
        self.report_rings(false);
    }

    /// Reports strongly connected components of flows of unknown type: with `only_now` those within one cycle, each by
    /// its shortest dependency cycle; otherwise one flow of each component.
    fn report_rings(&mut self, only_now: bool) {
        let equations = 0..self.pending.len();
        let open: Vec<usize> = equations.filter(|index| self.is_untold(*index)).collect();
        let links: Vec<Link> = open.iter().flat_map(|index| self.links(*index)).collect();
        let mut places: BTreeMap<(usize, usize), Vec<Span>> = BTreeMap::new();
        for link in links.iter().filter(|link| link.now) {
            places
                .entry((link.from, link.to))
                .or_default()
                .push(link.span);
        }
        let mut graph: DiGraph<usize, Link> = DiGraph::new();
        let vertices: BTreeMap<usize, NodeIndex> =
            (open.iter().map(|index| (*index, graph.add_node(*index)))).collect();
        for link in links.iter().filter(|link| link.now || !only_now) {
            let ends = [link.from, link.to].map(|end| vertices.get(&end));
            if let [Some(from), Some(to)] = ends {
                graph.add_edge(*from, *to, *link);
            }
        }
        let rings = Rings::new(&graph);
        for (k, component) in rings.components.iter().enumerate() {
            for vertex in component {
                self.pending[graph[*vertex]].state = State::Told;
            }
            match only_now {
                true => {
                    let ring = rings.shortest(k);
                    let ring: Vec<Link> = ring.into_iter().map(|edge| graph[edge]).collect();
                    self.waits_for_itself(&ring, &places);
                }
                false => self.untold(graph[component[0]]),
            }
        }
    }

    fn is_untold(&self, index: usize) -> bool {
        let pending = &self.pending[index];
        let is_open = |flow: &FlowId| {
            let flow = self.unit.flow(*flow);
            flow.ty.has_unknown() && flow.optional == Optional::Inferred
        };
        pending.state == State::Guessed && pending.introduces.iter().flatten().any(is_open)
    }

    /// Returns the reads of flows of unknown type in an equation.
    fn links(&mut self, index: usize) -> Vec<Link> {
        let mark = self.mark();
        self.missing.clear();
        self.inferring = true;
        self.value_at(index);
        self.inferring = false;
        self.put_back(mark);
        let missing = std::mem::take(&mut self.missing);
        let reads = missing
            .iter()
            .filter(|read| self.is_untold(read.equation))
            .map(|read| Link {
                from: read.equation,
                to: index,
                span: read.span,
                now: read.now,
            });
        reads.collect()
    }

    fn waits_for_itself(&mut self, ring: &[Link], places: &BTreeMap<(usize, usize), Vec<Span>>) {
        let read = |link: &Link| {
            let all = places.get(&(link.from, link.to)).into_iter().flatten();
            Read {
                from: self.name_of(link.from),
                to: self.name_of(link.to),
                span: link.span,
                more: all.copied().filter(|span| *span != link.span).collect(),
            }
        };
        let reads: Vec<Read> = ring.iter().map(read).collect();
        self.report(causality::ring(&reads));
    }

    /// Returns the name of the first flow that an equation introduces.
    fn name_of(&self, index: usize) -> String {
        let flow = self.pending[index].introduces.iter().flatten().next();
        flow.map_or_else(String::new, |flow| self.unit.flow(*flow).name.to_string())
    }

    fn untold(&mut self, index: usize) {
        let flows = self.pending[index].introduces.iter().flatten();
        let Some(flow) = flows
            .map(|id| self.unit.flow(*id))
            .find(|flow| flow.ty.has_unknown())
        else {
            return;
        };
        let finding = untold(flow, "its equation only refers to earlier values", "...");
        self.report(finding);
    }
}

/// Returns the diagnostic for a flow whose type cannot be inferred; `why` is the label, `ty` the type in the suggested
/// declaration.
pub(super) fn untold(flow: &Flow, why: &str, ty: &str) -> Finding {
    let name = &flow.name;
    Finding::new(Code::RPI2007, format!("cannot infer the type of `{name}`"))
        .at(flow.span, why)
        .help(format!("declare it: `var {name}: {ty};` before `let`"))
}
