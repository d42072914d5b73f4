//! Nothing may depend on itself within a cycle (M5): one finding per ring of items that wait for each other.
//!
//! Each strongly connected component of a fragment's graph gives one finding. It draws the shortest ring through the
//! component step by step and says where a `pre` would break it.

use crate::net::{Net, NodeId, PortRef};
use crate::passes::dependencies::{Dependence, Dependencies, Graph, Reader};
use crate::passes::rings::Rings;
use crate::tree::Item;
use petgraph::graph::EdgeIndex;
use rpi_diag::{Code, Finding, Fix, Span};
use rpi_image::{Scalar, Type};

/// Steps that are drawn at most; a program's rings are shorter, those of damaged nets need not be.
const SHOWN: usize = 40;

/// All rings of a net.
#[must_use]
pub fn check(net: &Net, dependencies: &Dependencies) -> Vec<Finding> {
    let mut findings = Vec::new();
    for fragment in net.fragment_ids() {
        let graph = dependencies.graph(fragment);
        let rings = Rings::new(graph);
        for component in 0..rings.components.len() {
            findings.push(finding(net, graph, &rings.shortest(component)));
        }
    }
    findings
}

/// A step of a ring as it is told: `to` reads `from`, seen at `span`.
struct Step {
    from: String,
    to: String,
    reader: Reader,
    span: Span,
}

fn finding(net: &Net, graph: &Graph, ring: &[EdgeIndex]) -> Finding {
    let steps = steps(net, graph, ring);
    let mut names: Vec<String> = steps
        .iter()
        .take(SHOWN)
        .map(|s| format!("`{}`", s.from))
        .collect();
    if steps.len() > SHOWN {
        names.push(format!("{} more", steps.len() - SHOWN));
    }
    names.extend(names.first().cloned());
    let first = names.first().cloned().unwrap_or_default();
    let ring = names.join(" -> ");
    let message = format!("{first} depends on itself in the same cycle: {ring}");
    let mut finding = Finding::new(Code::RPI4001, message);
    for (k, step) in steps.iter().take(SHOWN).enumerate() {
        if !step.span.is_none() {
            let text = told(step);
            finding = match k {
                0 => finding.at(step.span, text),
                _ => finding.also(step.span, text),
            };
        }
    }
    let fixes = steps.iter().filter_map(|s| fix(net, s));
    finding.fixes.extend(fixes);
    let help = match is_program(net) {
        true => {
            "delay one step: `pre` gives the value of the cycle before, and with `->` a first one"
        }
        false => "delay one step by a `Pre`; one inside a fragment breaks only rings inside it",
    };
    finding.help(help)
}

fn told(step: &Step) -> String {
    let Step {
        from, to, reader, ..
    } = step;
    match reader {
        Reader::Input(..) | Reader::InPort(..) => format!("`{to}` reads `{from}` here"),
        Reader::Activation(_) => format!("`{from}` activates `{to}` here"),
        Reader::Restart(_) => format!("`{from}` restarts `{to}` here"),
    }
}

/// The steps from one named item to the next. Parts of an expression have no names of their own; in a net without a
/// program every item is named.
fn steps(net: &Net, graph: &Graph, ring: &[EdgeIndex]) -> Vec<Step> {
    let all = !ring.iter().any(|e| flow_name(net, graph, *e).is_some());
    let is_named = |e: &EdgeIndex| all || flow_name(net, graph, *e).is_some();
    let Some(start) = ring.iter().position(is_named) else {
        return Vec::new();
    };
    let mut edges = ring[start..].iter().chain(&ring[..start]).peekable();
    let mut steps: Vec<Step> = Vec::new();
    while let Some(edge) = edges.next() {
        let Dependence { source, reader } = graph[*edge];
        while edges.next_if(|e| !is_named(e)).is_some() {}
        steps.push(Step {
            from: name(net, graph, *edge, source),
            to: String::new(),
            reader,
            span: span(net, reader),
        });
    }
    let names: Vec<String> = steps.iter().map(|s| s.from.clone()).collect();
    for (k, step) in steps.iter_mut().enumerate() {
        step.to.clone_from(&names[(k + 1) % names.len()]);
    }
    steps
}

/// The name under which its author knows the source of an edge.
fn flow_name<'n>(net: &'n Net, graph: &Graph, edge: EdgeIndex) -> Option<&'n str> {
    let origin = match item(graph, edge)? {
        Item::Node(id) => &net.node(id).origin,
        Item::Fragment(id) => &net.fragment(id).origin,
    };
    origin.flow.as_deref()
}

fn name(net: &Net, graph: &Graph, edge: EdgeIndex, source: PortRef) -> String {
    if let Some(flow) = flow_name(net, graph, edge) {
        return flow.to_owned();
    }
    match item(graph, edge) {
        Some(Item::Fragment(id)) => net.fragment(id).name.clone(),
        Some(Item::Node(id)) => net.node(id).name.clone(),
        None => net.node(source.node).name.clone(),
    }
}

/// What the edge begins at.
fn item(graph: &Graph, edge: EdgeIndex) -> Option<Item> {
    let (from, _) = graph.edge_endpoints(edge)?;
    graph.node_weight(from).copied()
}

fn span(net: &Net, reader: Reader) -> Span {
    match reader {
        Reader::Input(id, _) => net.node(id).origin.span,
        Reader::Activation(id) | Reader::Restart(id) | Reader::InPort(id, _) => {
            net.fragment(id).origin.span
        }
    }
}

/// Whether the net comes from a program, whose flows have names.
fn is_program(net: &Net) -> bool {
    net.nodes.iter().any(|n| n.origin.flow.is_some())
}

/// A `pre` before the expression that reads.
fn fix(net: &Net, step: &Step) -> Option<Fix> {
    let Reader::Input(id, _) = step.reader else {
        return None;
    };
    if step.span.is_none() || !is_program(net) {
        return None;
    }
    let (before, after) = match first_value(net, id) {
        Some(first) => (format!("({first} -> pre ("), "))"),
        None => ("pre (".to_owned(), ")"),
    };
    let title = format!("let `{}` read `{}` of the cycle before", step.to, step.from);
    Some(
        Fix::maybe(title)
            .insert_before(step.span, before)
            .insert_after(step.span, after),
    )
}

/// What a delay of a node's output could give in the first cycle.
fn first_value(net: &Net, id: NodeId) -> Option<&'static str> {
    match net.node(id).outputs.first()? {
        Type::One(Scalar::Bool) => Some("false"),
        Type::One(Scalar::Int) => Some("0"),
        Type::One(Scalar::Real) => Some("0.0"),
        _ => None,
    }
}
