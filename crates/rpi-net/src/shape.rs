//! The types of all out-ports: lengths of arrays and shapes of matrices follow from inputs and parameters.

use crate::net::{Input, Net, NodeId, Types};
use rpi_diag::{Code, Finding};
use rpi_image::{PortType, PrimDesc, Shape, ShapeArgs, Type};

/// Largest number of cells of one flow.
pub const MAX_CELLS: u32 = 1 << 20;

/// Sets the types of all out-ports; a finding per node whose sizes do not fit.
#[must_use]
pub fn infer_shapes(net: &mut Net) -> Vec<Finding> {
    let mut findings = Vec::new();
    let mut states = vec![State::Unseen; net.nodes.len()];
    for id in net.node_ids() {
        infer_from(net, id, &mut states, &mut findings);
    }
    findings
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum State {
    Unseen,
    /// Its sources are being worked out.
    Open,
    Done,
}

/// Works out a node after the sources that its shape depends on, by a stack of its own: chains may be long.
fn infer_from(net: &mut Net, first: NodeId, states: &mut [State], findings: &mut Vec<Finding>) {
    let mut stack = vec![first];
    while let Some(&id) = stack.last() {
        if states[id.index()] == State::Unseen && !is_plain(net.node(id).desc()) {
            states[id.index()] = State::Open;
            let waiting = sources(net, id).filter(|s| states[s.index()] == State::Unseen);
            stack.extend(waiting.collect::<Vec<_>>());
            continue;
        }
        stack.pop();
        if states[id.index()] != State::Done {
            findings.extend(infer(net, id, states));
            states[id.index()] = State::Done;
        }
    }
}

/// Whether the types stand in the declaration.
fn is_plain(desc: &PrimDesc) -> bool {
    let single = |ty| matches!(ty, PortType::One(_));
    !matches!(desc.shape, Shape::Of(_)) && desc.outputs.iter().all(|o| single(o.ty))
}

fn sources(net: &Net, id: NodeId) -> impl Iterator<Item = NodeId> + '_ {
    let inputs = net.node(id).inputs.iter();
    inputs.filter_map(|i| Some(i.port()?.node))
}

fn infer(net: &mut Net, id: NodeId, states: &[State]) -> Option<Finding> {
    let node = net.node(id);
    let desc = node.desc();
    if !is_plain(desc) && sources(net, id).any(|s| failed(net, s, states)) {
        return None;
    }
    let inputs: Vec<Option<Type>> = match is_plain(desc) {
        true => Vec::new(),
        false => node.inputs.iter().map(|i| input_type(net, i)).collect(),
    };
    let args = ShapeArgs {
        inputs: &inputs,
        params: &node.params,
    };
    let types = (0..desc.outputs.len()).map(|k| desc.out_type(k, &args));
    let types: Option<Types> = types
        .map(|t| t.filter(|t| t.cells() <= MAX_CELLS))
        .collect();
    match types {
        Some(types) => {
            net.nodes[id.index()].outputs = types;
            None
        }
        None => Some(misfit(net, id)),
    }
}

/// Whether a source has no types, for a reason already reported.
fn failed(net: &Net, source: NodeId, states: &[State]) -> bool {
    let source_node = net.node(source);
    let missing = source_node.outputs.len() < source_node.desc().outputs.len();
    missing && states[source.index()] == State::Done
}

fn input_type(net: &Net, input: &Input) -> Option<Type> {
    match input {
        Input::Open => None,
        Input::Const(value) => value.ty(),
        Input::Port(port) => {
            let outputs = &net.node(port.node).outputs;
            outputs.get(usize::from(port.port)).copied()
        }
    }
}

fn misfit(net: &Net, id: NodeId) -> Finding {
    let node = net.node(id);
    let path = net.path(node.fragment, &node.name);
    let message = format!(
        "sizes or indices of `{path}` ({}) do not fit",
        node.desc().name
    );
    Finding::new(Code::RPI2104, message)
        .at(node.origin.span, "no such element, or no such size")
        .help("indices count from 0 and stay below the size of the array that is connected")
}
