//! Order of the equations: sources before readers, otherwise as declared. The order does not matter to the compiler,
//! but to readers of the program. An array that is known when it is read is not split into elements.

use rpi_image::Role;
use rpi_net::{FragmentId, Input, Net, NodeId};

#[derive(Clone, Copy, PartialEq)]
enum Visit {
    Open,
    Entered,
    Done,
}

/// Returns the nodes directly in a fragment in an order in which each follows the nodes that it reads. A delay does not
/// count as a reader of its input.
pub(super) fn topological_order(net: &Net, fragment: FragmentId) -> Vec<NodeId> {
    let mut visits = vec![Visit::Open; net.nodes.len()];
    let mut order = Vec::new();
    let is_here = |id: &NodeId| net.node(*id).fragment == fragment;
    for first in net.node_ids().filter(is_here) {
        let mut stack = vec![first];
        // Depth-first search with an explicit stack: a long chain of equations must not overflow the call stack.
        while let Some(&top) = stack.last() {
            let visit = &mut visits[top.index()];
            if *visit == Visit::Open {
                *visit = Visit::Entered;
                let sources = sources(net, top).filter(is_here);
                stack.extend(sources.filter(|id| visits[id.index()] == Visit::Open));
                continue;
            }
            stack.pop();
            if visits[top.index()] == Visit::Entered {
                visits[top.index()] = Visit::Done;
                order.push(top);
            }
        }
    }
    order
}

fn sources(net: &Net, id: NodeId) -> impl Iterator<Item = NodeId> + '_ {
    let node = net.node(id);
    let inputs = match node.desc().role {
        Role::Delay => &[],
        _ => &node.inputs[..],
    };
    inputs.iter().rev().filter_map(|input| match input {
        Input::Port(port) => Some(port.node),
        _ => None,
    })
}
