//! The order in which equations tell the clocks of their flows: each behind those whose flows it reads.
//!
//! What another clock makes of an operand can only be told when both are known, so that a flow without declaration has to
//! have the clock of its equation before it is read. In a ring, which goes through a `pre`, the order is that of the text.

use crate::typed::{Equation, FlowId, Kind, Place, Unit};
use petgraph::algo::kosaraju_scc;
use petgraph::graph::{DiGraph, NodeIndex};

/// The equations of a unit, those of a ring together; `is_told` says of which flows the clock is known from the start.
pub(super) fn equations(unit: &Unit, is_told: impl Fn(FlowId) -> bool) -> Vec<Vec<&Equation>> {
    let equations: Vec<&Equation> = unit
        .blocks
        .iter()
        .flat_map(|block| &block.equations)
        .collect();
    let mut graph: DiGraph<(), ()> = DiGraph::with_capacity(equations.len(), equations.len());
    let nodes: Vec<NodeIndex> = equations.iter().map(|_| graph.add_node(())).collect();
    let mut of_flow: Vec<Vec<NodeIndex>> = vec![Vec::new(); unit.flows.len()];
    for (equation, node) in equations.iter().zip(&nodes) {
        for target in &equation.targets {
            match target.place {
                Place::Flow { flow, .. } if !is_told(flow) => {
                    of_flow[flow.0 as usize].push(*node);
                }
                _ => {}
            }
        }
    }
    for (equation, node) in equations.iter().zip(&nodes) {
        let mut parts = unit.parts(equation.value);
        while let Some((id, expr)) = parts.next() {
            let read = match &expr.kind {
                Kind::Flow(flow) => Some(*flow),
                Kind::When { clock, .. } => Some(clock.flow),
                _ => None,
            };
            for read in read.iter().flat_map(|flow| &of_flow[flow.0 as usize]) {
                graph.add_edge(*node, *read, ());
            }
            parts.enter(id);
        }
    }
    // The components come in the order in which their vertices do not need later ones.
    let mut components = kosaraju_scc(&graph);
    components.iter_mut().for_each(|ring| ring.sort_unstable());
    let equation = |node: NodeIndex| equations[node.index()];
    components
        .into_iter()
        .map(|ring| ring.into_iter().map(equation).collect())
        .collect()
}
