//! Inference of the types of all out-ports: array lengths and matrix shapes follow from inputs and parameters.

use crate::net::{Input, Net, NodeId, Types};
use rpi_diag::{Code, Diagnostic};
use rpi_image::{PortType, PrimDesc, ShapeArgs, ShapeRule, Type};

/// Maximal number of memory slots of one flow.
pub const MAX_CELLS: u32 = 1 << 20;

/// Sets the types of all out-ports. Returns a diagnostic for each node with incompatible sizes.
#[must_use]
pub fn infer_shapes(net: &mut Net) -> Vec<Diagnostic> {
    let mut diagnostics = Vec::new();
    let mut states = vec![InferenceState::Unvisited; net.nodes.len()];
    for id in net.node_ids() {
        infer_from(net, id, &mut states, &mut diagnostics);
    }
    diagnostics
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum InferenceState {
    Unvisited,
    /// The types of the node's sources are being inferred; reaching the node again means that it depends on itself.
    InProgress,
    Done,
}

/// Infers the types of a node after those of the sources that its shape depends on. Uses an explicit stack, because
/// chains of nodes may be long.
fn infer_from(
    net: &mut Net,
    first: NodeId,
    states: &mut [InferenceState],
    diagnostics: &mut Vec<Diagnostic>,
) {
    let mut stack = vec![first];
    while let Some(&id) = stack.last() {
        if states[id.index()] == InferenceState::Unvisited
            && !has_declared_types(net.node(id).desc())
        {
            states[id.index()] = InferenceState::InProgress;
            let waiting =
                sources(net, id).filter(|s| states[s.index()] == InferenceState::Unvisited);
            stack.extend(waiting.collect::<Vec<_>>());
            continue;
        }
        stack.pop();
        if states[id.index()] != InferenceState::Done {
            diagnostics.extend(infer(net, id, states));
            states[id.index()] = InferenceState::Done;
        }
    }
}

/// Whether the descriptor alone determines the types of all outputs.
fn has_declared_types(desc: &PrimDesc) -> bool {
    let single = |ty| matches!(ty, PortType::Scalar(_));
    !matches!(desc.shape, ShapeRule::Computed(_)) && desc.outputs.iter().all(|o| single(o.ty))
}

fn sources(net: &Net, id: NodeId) -> impl Iterator<Item = NodeId> + '_ {
    let inputs = net.node(id).inputs.iter();
    inputs.filter_map(|i| Some(i.port()?.node))
}

fn infer(net: &mut Net, id: NodeId, states: &[InferenceState]) -> Option<Diagnostic> {
    let node = net.node(id);
    let desc = node.desc();
    if !has_declared_types(desc) && sources(net, id).any(|s| has_failed(net, s, states)) {
        return None;
    }
    let inputs: Vec<Option<Type>> = match has_declared_types(desc) {
        true => Vec::new(),
        false => node.inputs.iter().map(|i| input_type(net, i)).collect(),
    };
    let args = ShapeArgs {
        inputs: &inputs,
        params: &node.params,
    };
    let types = (0..desc.outputs.len()).map(|k| desc.out_type(k, &args));
    let types: Option<Types> = types
        .map(|t| t.filter(|t| t.slots() <= MAX_CELLS))
        .collect();
    match types {
        Some(types) => {
            net.nodes[id.index()].outputs = types;
            None
        }
        None => Some(shape_mismatch(net, id)),
    }
}

/// Whether a source has no types because of an error that was already reported.
fn has_failed(net: &Net, source: NodeId, states: &[InferenceState]) -> bool {
    let source_node = net.node(source);
    let missing = source_node.outputs.len() < source_node.desc().outputs.len();
    missing && states[source.index()] == InferenceState::Done
}

fn input_type(net: &Net, input: &Input) -> Option<Type> {
    match input {
        Input::Unconnected => None,
        Input::Const(value) => value.ty(),
        Input::Port(port) => {
            let outputs = &net.node(port.node).outputs;
            outputs.get(usize::from(port.port)).copied()
        }
    }
}

fn shape_mismatch(net: &Net, id: NodeId) -> Diagnostic {
    let node = net.node(id);
    let path = net.path(node.fragment, &node.name);
    let message = format!(
        "size mismatch or index out of range in `{path}` ({})",
        node.desc().name
    );
    Diagnostic::new(Code::RPI2104, message)
        .primary(node.origin.span, "index out of range, or incompatible size")
        .help("indices start at 0 and must be below the size of the connected array")
}
