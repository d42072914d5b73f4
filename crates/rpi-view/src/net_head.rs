//! Graphs of nets in the head of a document, as lists of numbers and names, because a net may have many boxes.

use rpi_graph::{End, GraphBox, Line, NetGraph, Scene};
use serde_json::{Value, json};

/// Number that stands for nothing where an index is expected.
const NONE: i64 = -1;

/// Returns the graph of a net. A box is `[name, kind, flow, fragment, file, line, inner, other flows]`, a line
/// `[box, port, box, port, bits]` with 1 for a delay and 2 for a condition, and a chain the vertices between its ends; `null` for a line
/// without a chain.
pub(crate) fn net_head(net: &NetGraph) -> Value {
    json!({
        "command": net.command,
        "scenes": net.scenes.iter().map(scene).collect::<Vec<_>>(),
    })
}

fn scene(scene: &Scene) -> Value {
    let chains = scene.layers.chains.iter().map(|chain| match chain.len() {
        0 | 1 => Value::Null,
        len => json!(chain[1..len - 1]),
    });
    json!({
        "boxes": scene.boxes.iter().map(graph_box).collect::<Vec<_>>(),
        "lines": scene.lines.iter().map(line).collect::<Vec<_>>(),
        "columns": scene.layers.columns,
        "chains": chains.collect::<Vec<_>>(),
    })
}

fn graph_box(shown: &GraphBox) -> Value {
    json!([
        shown.name,
        shown.kind.name(),
        shown.flow,
        shown.fragment,
        shown.place.as_ref().map(|place| &place.file),
        shown.place.as_ref().map(|place| place.line),
        shown.inner.map_or(NONE, index),
        shown.other_flows,
    ])
}

fn line(line: &Line) -> Value {
    let port = |end: End| end.port.map_or(NONE, index);
    let bits = i64::from(line.is_delayed) + 2 * i64::from(line.is_condition);
    json!([
        line.from.shape,
        port(line.from),
        line.to.shape,
        port(line.to),
        bits
    ])
}

/// Indices are far below 2⁶³.
fn index(index: usize) -> i64 {
    i64::try_from(index).unwrap_or(NONE)
}
