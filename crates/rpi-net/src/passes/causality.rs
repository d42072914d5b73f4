//! Causality check: no flow depends on itself within a cycle (M5).
//!
//! Each strongly connected component of a fragment's dependency graph gives one diagnostic. It shows the shortest
//! dependency cycle through the component step by step, with fixes that insert a `pre`.

use crate::fragment_tree::Item;
use crate::net::{Activation, Fragment, Input, Net, NodeId, PortRef, Restart, strip_unnamed_calls};
use crate::passes::dependencies::{Dependencies, Dependency, Graph, Reader};
use crate::passes::dependency_cycles::CyclicComponents;
use crate::prim;
use petgraph::graph::{EdgeIndex, NodeIndex};
use petgraph::visit::EdgeRef;
use rpi_diag::{Code, Diagnostic, Fix, Span};
use rpi_image::{Scalar, Type};
use std::cell::LazyCell;
use std::collections::BTreeMap;

/// Maximum number of steps of a dependency cycle that a diagnostic shows. Dependency cycles in programs are shorter;
/// those in damaged nets may be longer.
const SHOWN: usize = 40;

/// Returns a diagnostic for each dependency cycle of a net: a set of flows that depend on one another in the same
/// cycle.
#[must_use]
pub fn check(net: &Net, dependencies: &Dependencies) -> Vec<Diagnostic> {
    let mut diagnostics = Vec::new();
    let activated = LazyCell::new(|| activated(net));
    for fragment in net.fragment_ids() {
        let graph = dependencies.graph(fragment);
        let rings = CyclicComponents::new(graph);
        for component in 0..rings.components.len() {
            diagnostics.push(diagnostic_of(
                net,
                graph,
                &rings.shortest_cycle(component),
                &activated,
            ));
        }
    }
    diagnostics
}

/// Step of a dependency cycle as the diagnostic shows it: the flow `to` reads the flow `from` at the location `span`.
struct Step {
    from: String,
    to: String,
    reader: Reader,
    span: Span,
    /// Locations of all reads that make `to` depend on `from`; empty if a read is inside a fragment, where a `pre`
    /// would not break the dependency cycle.
    reads: Vec<Span>,
    /// Whether all reads are on the right side of a `->`, whose left side is the value in the first cycle.
    has_initial_value: bool,
    /// Whether the read is part of the condition under which `to` is active.
    decides_activation: bool,
    /// Whether `from` is a state of an automaton.
    is_from_state: bool,
}

/// Read of a flow by another flow in the same cycle, with the names and locations in the program.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Read {
    /// Name of the flow that is read.
    pub from: String,
    /// Name of the flow whose equation reads another flow.
    pub to: String,
    /// Location of the read.
    pub span: Span,
}

/// Returns the diagnostic for a dependency cycle of reads. Each read uses the flow that the previous one defines.
#[must_use]
pub fn dependency_cycle(reads: &[Read]) -> Diagnostic {
    let label = |read: &Read| format!("`{}` reads `{}` here", read.to, read.from);
    let steps = reads
        .iter()
        .map(|read| (read.from.as_str(), read.span, label(read)));
    let diagnostic = cycle_diagnostic(&steps.collect::<Vec<_>>());
    // Without a type, a fix has no first value: a `pre` alone would be the next error.
    match reads.first() {
        Some(Read { from, .. }) => diagnostic.help(format!(
            "delay one step: write `(... -> pre {from})` for `{from}`, with the value of the first cycle in place of `...`"
        )),
        None => diagnostic,
    }
}

const BREAK_HELP: &str =
    "delay one step: `pre` gives the value of the previous cycle, and `->` adds a first value";

fn diagnostic_of(
    net: &Net,
    graph: &Graph,
    ring: &[EdgeIndex],
    activated: &BTreeMap<Span, bool>,
) -> Diagnostic {
    let steps = steps(net, graph, ring);
    let mut diagnostic = cycle_diagnostic(
        &steps
            .iter()
            .map(|s| (s.from.as_str(), s.span, step_label(s)))
            .collect::<Vec<_>>(),
    );
    let fixes = steps
        .iter()
        .take(SHOWN)
        .filter_map(|s| fix(net, s, activated));
    diagnostic.fixes = fixes.collect();
    let is_fragment = |e: &EdgeIndex| match item(graph, *e) {
        Some(Item::Fragment(id)) => !net.fragment(id).is_clock,
        _ => false,
    };
    diagnostic.help(match is_program(net) {
        true if ring.iter().any(is_fragment) => {
            "delay one step with `pre`; a fragment or state counts as one step, regardless of delays inside it"
        }
        true => BREAK_HELP,
        false => "delay one step with a `Pre`; inside a fragment it breaks only dependency cycles there",
    })
}

/// Returns the diagnostic for a dependency cycle without fixes. Each step consists of the name of the flow that is
/// read, the location of the read, and the text of its label.
fn cycle_diagnostic(steps: &[(&str, Span, String)]) -> Diagnostic {
    let mut names: Vec<String> = steps
        .iter()
        .take(SHOWN)
        .map(|s| format!("`{}`", s.0))
        .collect();
    if steps.len() > SHOWN {
        names.push(format!("{} more", steps.len() - SHOWN));
    }
    names.extend(names.first().cloned());
    let first = names.first().cloned().unwrap_or_default();
    let ring = names.join(" -> ");
    let message = format!("{first} depends on itself in the same cycle: {ring}");
    let mut diagnostic = Diagnostic::new(Code::RPI4001, message);
    let places = steps.iter().take(SHOWN).filter(|step| !step.1.is_none());
    for (k, (_, span, text)) in places.enumerate() {
        diagnostic = match k {
            0 => diagnostic.primary(*span, text),
            _ => diagnostic.secondary(*span, text),
        };
    }
    diagnostic
}

fn step_label(step: &Step) -> String {
    let Step {
        from, to, reader, ..
    } = step;
    match reader {
        Reader::Input(..) if step.decides_activation => {
            format!("`{from}` decides here whether `{to}` is active")
        }
        Reader::Input(..) if step.is_from_state => {
            format!("`{to}` gets its value in `{from}` here")
        }
        Reader::Input(..) | Reader::InPort(..) => format!("`{to}` reads `{from}` here"),
        Reader::Activation(_) => format!("`{from}` activates `{to}` here"),
        Reader::Restart(_) => format!("`{from}` restarts `{to}` here"),
    }
}

/// Returns the steps of a dependency cycle from each flow with a name to the next. Subexpressions have no names. If
/// nothing on the cycle has a name, as in an imported net, each node and fragment is a step.
///
/// `ring` holds the edges of the cycle in order.
fn steps(net: &Net, graph: &Graph, ring: &[EdgeIndex]) -> Vec<Step> {
    let all = !ring.iter().any(|e| flow_name(net, graph, *e).is_some());
    let is_named = |e: &EdgeIndex| all || flow_name(net, graph, *e).is_some();
    let Some(start) = ring.iter().position(is_named) else {
        return Vec::new();
    };
    let mut edges = ring[start..].iter().chain(&ring[..start]).peekable();
    let mut steps: Vec<Step> = Vec::new();
    while let Some(edge) = edges.next() {
        let Dependency { source, reader } = graph[*edge];
        let mut last = reader;
        while let Some(inner) = edges.next_if(|e| !is_named(e)) {
            last = graph[*inner].reader;
        }
        let end = edges.peek().copied().or(ring.get(start)).copied();
        let end = end
            .and_then(|next| graph.edge_endpoints(next))
            .map(|(from, _)| from);
        steps.push(Step {
            from: name(net, graph, *edge, source),
            to: String::new(),
            reader,
            span: span(net, reader),
            reads: end.map_or_else(Vec::new, |end| reads(net, graph, *edge, end)),
            has_initial_value: end.is_some_and(|end| has_first(net, graph, *edge, end)),
            decides_activation: matches!(last, Reader::Activation(_) | Reader::Restart(_)),
            is_from_state: starts_at_state(net, graph, *edge),
        });
    }
    merge_call_outputs(&mut steps);
    close_ring(&mut steps);
    steps
}

/// Removes steps from an output of a call to the flow with the name of the call. For `c = half(e)`, it is the step from
/// `c.y` to `c`, as the program has no name `c.y`.
fn merge_call_outputs(steps: &mut Vec<Step>) {
    let names: Vec<String> = steps.iter().map(|step| step.from.clone()).collect();
    let mut next = (1..names.len()).chain([0]);
    steps.retain(|step| {
        let reader = next.next().and_then(|at| names.get(at));
        let output = reader.and_then(|reader| step.from.strip_prefix(reader.as_str()));
        !output.is_some_and(|output| output.starts_with('.'))
    });
}

/// Sets the end of each step to the start of the next one, and that of the last step to the start of the first.
fn close_ring(steps: &mut [Step]) {
    let names: Vec<String> = steps.iter().map(|s| s.from.clone()).collect();
    for (k, step) in steps.iter_mut().enumerate() {
        step.to.clone_from(&names[(k + 1) % names.len()]);
    }
}

/// Returns the locations at which the flow at the source of an edge is read on paths to the vertex `end` without other
/// named flows. Empty if one of these reads is inside a fragment.
fn reads(net: &Net, graph: &Graph, edge: EdgeIndex, end: NodeIndex) -> Vec<Span> {
    let Some((from, _)) = graph.edge_endpoints(edge) else {
        return Vec::new();
    };
    // A state's part in a shared flow has no read in the text.
    if starts_at_state(net, graph, edge) {
        return Vec::new();
    }
    let mut places = Vec::new();
    for edge in graph.edges(from) {
        if !leads_to(net, graph, edge.target(), end) {
            continue;
        }
        match edge.weight().reader {
            Reader::Input(id, _) if graph.node_weight(edge.target()) == Some(&Item::Node(id)) => {
                places.push(net.node(id).origin.span);
            }
            _ => return Vec::new(),
        }
    }
    places.sort_unstable();
    places.dedup();
    places
}

/// Whether an edge begins at a state of an automaton.
fn starts_at_state(net: &Net, graph: &Graph, edge: EdgeIndex) -> bool {
    matches!(item(graph, edge), Some(Item::Fragment(id)) if is_state(net.fragment(id)))
}

/// Returns whether every path from the source of an edge to the vertex `end` without other named flows passes through
/// the right side of a `->`.
fn has_first(net: &Net, graph: &Graph, edge: EdgeIndex, end: NodeIndex) -> bool {
    let Some((from, _)) = graph.edge_endpoints(edge) else {
        return false;
    };
    let always = |edge: &Dependency| !is_after_first(net, edge.reader);
    let mut ways = graph.edges(from).filter(|edge| always(edge.weight()));
    !ways.any(|edge| leads_along(net, graph, (edge.target(), end), always))
}

/// Returns whether a reader uses its source in all cycles but the first, as the right side of a `->` does.
fn is_after_first(net: &Net, reader: Reader) -> bool {
    let Reader::Input(id, port) = reader else {
        return false;
    };
    let node = net.node(id);
    let is_choice = node.prim.desc().name.ends_with("Conditional");
    match node.inputs.first() {
        Some(Input::Port(condition)) if is_choice && port == 2 => {
            net.node(condition.node).prim == prim!("Rpi::First")
        }
        _ => false,
    }
}

/// Returns whether a path from the vertex `start` leads to the vertex `end` without passing through other named flows.
fn leads_to(net: &Net, graph: &Graph, start: NodeIndex, end: NodeIndex) -> bool {
    leads_along(net, graph, (start, end), |_| true)
}

/// Returns whether a path along edges that `along` accepts leads from the vertex `start` to the vertex `end` without
/// passing through other named flows.
fn leads_along(
    net: &Net,
    graph: &Graph,
    (start, end): (NodeIndex, NodeIndex),
    along: impl Fn(&Dependency) -> bool,
) -> bool {
    let mut seen = vec![start];
    let mut next = 0;
    while let Some(at) = seen.get(next).copied() {
        next += 1;
        if at == end {
            return true;
        }
        if item_name(net, graph.node_weight(at)).is_some() {
            continue;
        }
        let edges = graph.edges(at).filter(|edge| along(edge.weight()));
        for to in edges.map(|edge| edge.target()) {
            if !seen.contains(&to) {
                seen.push(to);
            }
        }
    }
    false
}

fn item_name<'n>(net: &'n Net, item: Option<&Item>) -> Option<&'n str> {
    let origin = match *item? {
        Item::Node(id) => &net.node(id).origin,
        Item::Fragment(id) => &net.fragment(id).origin,
    };
    origin.flow.as_deref()
}

/// Returns the name, in the program, of the flow at which an edge begins; `None` if it has none.
fn flow_name<'n>(net: &'n Net, graph: &Graph, edge: EdgeIndex) -> Option<&'n str> {
    item_name(net, item(graph, edge).as_ref())
}

fn name(net: &Net, graph: &Graph, edge: EdgeIndex, source: PortRef) -> String {
    if let Some(flow) = flow_name(net, graph, edge) {
        return strip_unnamed_calls(flow);
    }
    match item(graph, edge) {
        Some(Item::Fragment(id)) => net.fragment(id).name.clone(),
        Some(Item::Node(id)) => net.node(id).name.clone(),
        None => net.node(source.node).name.clone(),
    }
}

/// Returns the node or fragment at which an edge begins.
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

/// Returns the locations of the fragments that are not always active, each with whether the fragment is a state of an
/// automaton.
fn activated(net: &Net) -> BTreeMap<Span, bool> {
    let fragments = net.fragments.iter().skip(1);
    let sometimes = fragments.filter(|f| f.activation != Activation::Always && !f.is_clock);
    sometimes.map(|f| (f.origin.span, is_state(f))).collect()
}

/// Returns whether a fragment is a state of an automaton, or is activated and restarted in the same way.
fn is_state(fragment: &Fragment) -> bool {
    fragment.activation != Activation::Always && matches!(fragment.restart, Restart::Every(_))
}

/// Returns whether the net was compiled from a program. Only then do flows have names.
fn is_program(net: &Net) -> bool {
    net.nodes.iter().any(|n| n.origin.flow.is_some())
}

/// Returns a fix that inserts a `pre` before the reads of a step; `None` if a `pre` would not be valid there.
/// `activated` are the locations of fragments that are not always active, each with whether it is a state of an
/// automaton.
fn fix(net: &Net, step: &Step, activated: &BTreeMap<Span, bool>) -> Option<Fix> {
    let Reader::Input(id, _) = step.reader else {
        return None;
    };
    if step.span.is_none() || !is_program(net) || step.reads.is_empty() {
        return None;
    }
    // An activated call must stay a call, and the automaton around a state is not an expression.
    let is_whole = |place: &Span| {
        let inside = activated.range(*place..).next();
        let inside = inside.filter(|(of, _)| of.file == place.file && of.start < place.end);
        inside.is_some_and(|(of, is_state)| of == place || *is_state)
    };
    if step.reads.iter().any(is_whole) {
        return None;
    }
    Some(delay_fix(
        &step.from,
        &step.to,
        &step.reads,
        first_value(net, id).filter(|_| !step.has_initial_value),
    ))
}

/// Returns a fix that delays the reads of the flow `from` by `to` at `places` by one cycle. `first` is the value in the
/// first cycle, if one is needed.
fn delay_fix(from: &str, to: &str, places: &[Span], first: Option<&str>) -> Fix {
    let (before, after) = match first {
        Some(first) => (format!("({first} -> pre ("), "))"),
        None => ("pre (".to_owned(), ")"),
    };
    let fix = Fix::maybe(format!("let `{to}` read `{from}` of the previous cycle"));
    places.iter().fold(fix, |fix, place| {
        fix.insert_before(*place, before.clone())
            .insert_after(*place, after)
    })
}

/// Returns the literal for the first value of a delayed output of a node, such as `0`; `None` for types without an
/// obvious one.
fn first_value(net: &Net, id: NodeId) -> Option<&'static str> {
    match net.node(id).outputs.first()? {
        Type::Scalar(Scalar::Bool) => Some("false"),
        Type::Scalar(Scalar::Int) => Some("0"),
        Type::Scalar(Scalar::Real) => Some("0.0"),
        _ => None,
    }
}
