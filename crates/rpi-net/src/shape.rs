//! Inference of the types of all out-ports: array lengths and matrix shapes follow from inputs and parameters.

use crate::net::{Input, Net, NodeId, Types};
use rpi_diag::{Code, Diagnostic, with_noun};
use rpi_image::{PortType, PrimDesc, ShapeArgs, ShapeRule, Type};

/// Maximum number of memory slots of one flow. A slot has 64 bits.
pub const MAX_CELLS: u32 = 1 << 20;

/// Infers the types of all out-ports of a net, including the sizes of arrays and matrices. Returns a diagnostic for
/// each node with incompatible sizes.
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
    /// The types of the node's sources are being inferred. If the node is reached again, it depends on itself.
    InProgress,
    Done,
}

/// Infers the types of a node, after those of the sources on which they depend. Uses an explicit stack, because chains
/// of nodes may be long.
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

/// Returns whether the declaration of a primitive alone determines the types of all its outputs.
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

/// Returns whether the types of a node could not be inferred because of an error that has been reported.
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

/// Returns the size of the array or matrix at an in-port as text, such as "3 elements"; `None` for a single value.
fn size(net: &Net, input: &Input) -> Option<String> {
    match input_type(net, input)? {
        Type::Scalar(_) => None,
        Type::Array(_, n) => Some(with_noun(n as usize, "element")),
        Type::Matrix(rows, columns) => Some(format!(
            "{} and {}",
            with_noun(rows as usize, "row"),
            with_noun(columns as usize, "column")
        )),
    }
}

fn shape_mismatch(net: &Net, id: NodeId) -> Diagnostic {
    let node = net.node(id);
    let path = net.path(node.fragment, &node.name);
    let place = format!("`{path}` ({})", node.desc().name);
    if let Some((index, length)) = index_out_of_range(net, id) {
        let message = format!("index {index} is out of range in {place}");
        let diagnostic = Diagnostic::new(Code::RPI2104, message).primary(
            node.origin.span,
            format!(
                "the array has {}, counted from 0",
                with_noun(length as usize, "element")
            ),
        );
        return match length.checked_sub(1) {
            Some(last) => diagnostic.help(format!("use an `Index` from 0 to {last}")),
            None => diagnostic.help("connect an array with elements"),
        };
    }
    let message = format!("size mismatch in {place}");
    let sizes = node.desc().inputs.iter().zip(&node.inputs);
    let sizes: Vec<String> = sizes
        .filter_map(|(port, input)| Some(format!("`{}` has {}", port.name, size(net, input)?)))
        .collect();
    let label = match sizes.is_empty() {
        true => "the sizes in its parameters do not fit".to_owned(),
        false => format!(
            "{}, which does not fit the parameters or each other",
            sizes.join(", ")
        ),
    };
    Diagnostic::new(Code::RPI2104, message)
        .primary(node.origin.span, label)
        .help("connect arrays or matrices of sizes that fit, or correct the parameters")
}

/// Returns the parameter `Index` of a node and the length of the array to which it applies, if there is no such element.
fn index_out_of_range(net: &Net, id: NodeId) -> Option<(i64, u32)> {
    let node = net.node(id);
    let index = node.params.get(node.desc().param("Index")?)?.as_int()?;
    let lengths = node
        .inputs
        .iter()
        .filter_map(|input| match input_type(net, input)? {
            Type::Array(_, length) => Some(length),
            _ => None,
        });
    let length = lengths.into_iter().next()?;
    let is_inside = u32::try_from(index).is_ok_and(|index| index < length);
    (!is_inside).then_some((index, length))
}
