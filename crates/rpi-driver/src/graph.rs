//! Drawings of nets: fragments as clusters, primitives as boxes, links as arrows.

use rpi_net::{Activation, FragmentId, Input, Net, NodeId};
use std::fmt::Write as _;

/// Returns a drawing of a net in the language of Graphviz: fragments as clusters, primitives as boxes, links as arrows.
#[must_use]
pub fn dot(net: &Net) -> String {
    let mut out = String::from(
        "digraph net {\n  rankdir=LR;\n  node [shape=box, fontname=\"sans-serif\", fontsize=10];\n  edge [arrowsize=0.6];\n",
    );
    let cluster = GraphSyntax {
        open: |f, title| {
            format!(
                "subgraph cluster_{} {{ label=\"{}\"; style=rounded;",
                f.0,
                escaped(title)
            )
        },
        close: "}",
        node: |n, label| format!("n{} [label=\"{}\"];", n.0, escaped(label)),
    };
    write_fragment(net, FragmentId::ROOT, &cluster, &mut out);
    for (from, to, label) in links(net) {
        let _ = writeln!(
            out,
            "  n{} -> n{} [tooltip=\"{}\"];",
            from.0,
            to.0,
            escaped(label)
        );
    }
    // Graphviz has no edges to clusters: the edge leads to a node inside, and `lhead` clips it at the border.
    for (condition, fragment) in activations(net) {
        if let Some(first) = first_node(net, fragment) {
            let _ = writeln!(
                out,
                "  n{} -> n{} [lhead=cluster_{}, style=dashed];",
                condition.0, first.0, fragment.0
            );
        }
    }
    out.push_str("  compound=true;\n}\n");
    out
}

/// Returns a drawing of a net in the language of Mermaid: fragments as subgraphs, primitives as boxes, links as arrows.
#[must_use]
pub fn mermaid(net: &Net) -> String {
    let mut out = String::from("flowchart LR\n");
    let cluster = GraphSyntax {
        open: |f, title| format!("subgraph f{}[\"{}\"]", f.0, escaped(title)),
        close: "end",
        node: |n, label| format!("n{}[\"{}\"]", n.0, escaped(label).replace("\\n", "<br/>")),
    };
    write_fragment(net, FragmentId::ROOT, &cluster, &mut out);
    for (from, to, _) in links(net) {
        let _ = writeln!(out, "  n{} --> n{}", from.0, to.0);
    }
    for (condition, fragment) in activations(net) {
        let _ = writeln!(out, "  n{} -.-> f{}", condition.0, fragment.0);
    }
    out
}

/// Notation of a drawing language (Graphviz or Mermaid): functions that write the beginning of a fragment and a
/// primitive.
struct GraphSyntax {
    open: fn(FragmentId, &str) -> String,
    close: &'static str,
    node: fn(NodeId, &str) -> String,
}

fn write_fragment(net: &Net, fragment: FragmentId, cluster: &GraphSyntax, out: &mut String) {
    let indent = "  ".repeat(net.ancestors(fragment).count());
    for id in net
        .node_ids()
        .filter(|id| net.node(*id).fragment == fragment)
    {
        let node = net.node(id);
        let kind = node.desc().name.rsplit("::").next().unwrap_or_default();
        let label = format!(
            "{}\\n{kind}",
            node.origin.flow.as_deref().unwrap_or(&node.name)
        );
        let _ = writeln!(out, "{indent}{}", (cluster.node)(id, &label));
    }
    for child in net
        .fragment_ids()
        .filter(|f| net.fragment(*f).parent == Some(fragment))
    {
        let _ = writeln!(
            out,
            "{indent}{}",
            (cluster.open)(child, &net.fragment(child).name)
        );
        write_fragment(net, child, cluster, out);
        let _ = writeln!(out, "{indent}{}", cluster.close);
    }
}

fn links(net: &Net) -> impl Iterator<Item = (NodeId, NodeId, &'static str)> + '_ {
    net.node_ids().flat_map(move |to| {
        let node = net.node(to);
        let ports = node.inputs.iter().zip(node.desc().inputs);
        ports.filter_map(move |(input, port)| match input {
            Input::Port(from) => Some((from.node, to, port.name)),
            _ => None,
        })
    })
}

fn activations(net: &Net) -> impl Iterator<Item = (NodeId, FragmentId)> + '_ {
    net.fragment_ids()
        .filter_map(|f| match &net.fragment(f).activation {
            Activation::When { condition, .. } => Some((condition.node, f)),
            Activation::Always => None,
        })
}

fn first_node(net: &Net, fragment: FragmentId) -> Option<NodeId> {
    net.node_ids()
        .find(|id| net.ancestors(net.node(*id).fragment).any(|f| f == fragment))
}

fn escaped(text: &str) -> String {
    text.replace('"', "'")
}
