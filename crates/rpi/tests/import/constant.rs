//! Constant folding, computed independently of the compiler.

use rpi_image::{Role, Value};
use rpi_net::{Input as Source, Net, NodeId};
use rpi_prims::fold;

/// Returns the outputs of all nodes whose inputs are constant.
pub(crate) fn constants(net: &Net) -> Vec<Option<Vec<Value>>> {
    let mut known: Vec<Option<Vec<Value>>> = vec![None; net.nodes.len()];
    let mut open: Vec<NodeId> = net.node_ids().collect();
    loop {
        let before = open.len();
        open.retain(|id| {
            known[id.index()] = constant(net, &known, *id);
            known[id.index()].is_none()
        });
        if open.len() == before {
            return known;
        }
    }
}

fn constant(net: &Net, known: &[Option<Vec<Value>>], id: NodeId) -> Option<Vec<Value>> {
    let node = net.node(id);
    if node.desc().role == Role::Constant {
        return Some(node.params.clone());
    }
    let value = |source: &Source| match source {
        Source::Const(value) => Some((**value).clone()),
        Source::Port(port) => known[port.node.index()]
            .as_ref()?
            .get(usize::from(port.port))
            .cloned(),
        Source::Unconnected => None,
    };
    let inputs: Vec<Value> = node.inputs.iter().map(value).collect::<Option<_>>()?;
    let inputs: Vec<&Value> = inputs.iter().collect();
    fold(node.prim, &inputs, &node.params, &node.outputs)?.ok()
}
