//! Elaborates bodies: equations, claims, automata and blocks in place.

use crate::elab::automaton;
use crate::elab::call;
use crate::elab::claims;
use crate::elab::device;
use crate::elab::elementwise;
use crate::elab::expr;
use crate::elab::expr::leaf_scalars;
use crate::elab::flows;
use crate::elab::fragment_outputs;
use crate::elab::nodes;
use crate::elab::outside_flows;
use crate::elab::scope::Scope;
use crate::elab::signal::{Signal, Wire, alias_of};
use crate::elab::subrange;
use crate::elab::{ClaimPolicy, ElabMode, Elaborator, Position};
use crate::ty::Ty;
use crate::typed::Expr;
use crate::typed::{BlockId, Equation, Flow, Target, TargetPlace, Unit};
use rpi_net::{self as net, PortRef, Restart};

/// Returns whether an equation needs a net node of its own although nothing reads its value: all its targets are flows
/// with names that begin with `_`.
fn must_keep_node(unit: &Unit, equation: &Equation) -> bool {
    equation.targets.iter().all(|target| match target.place {
        TargetPlace::Flow { flow, .. } => unit.flow(flow).name.starts_with('_'),
        _ => false,
    })
}

/// Elaborates all blocks of a unit, each after its parent block, at the position `at` of the net.
pub(super) fn body<'u>(elab: &mut Elaborator<'u>, scope: &mut Scope<'u>, at: Position) {
    scope.fragments[0] = Some(at.fragment);
    for block in (0..scope.unit.blocks.len())
        .filter_map(|k| u32::try_from(k).ok())
        .map(BlockId)
    {
        let at = match block {
            BlockId::ROOT => at,
            _ if scope.unit.block(block).is_contract => {
                let Some(at) = contract_position(elab, scope, block, at) else {
                    continue;
                };
                at
            }
            _ => Position::in_fragment(block_fragment(elab, scope, block)),
        };
        elab_block_content(elab, scope, block, at);
    }
    outside_flows::bind_outside_flows(elab, scope);
    fragment_outputs::assign_pending_gates(elab, scope);
}

/// Returns the position for elaborating a contract, which is in the fragment of its parent block. `None` if claims are
/// left out.
fn contract_position<'u>(
    elab: &Elaborator<'u>,
    scope: &mut Scope<'u>,
    block: BlockId,
    at: Position,
) -> Option<Position> {
    let parent = scope.unit.block(block).parent.unwrap_or(BlockId::ROOT);
    let fragment = scope.fragment(parent)?;
    scope.fragments[block.0 as usize] = Some(fragment);
    let place = match parent {
        BlockId::ROOT => at,
        _ => Position::in_fragment(fragment),
    };
    (elab.claim_policy != ClaimPolicy::Off).then_some(place)
}

fn block_fragment<'u>(
    elab: &mut Elaborator<'u>,
    scope: &mut Scope<'u>,
    block: BlockId,
) -> rpi_net::FragmentId {
    if let Some(fragment) = scope.fragment(block) {
        return fragment;
    }
    let content = scope.unit.block(block);
    let parent = content.parent.and_then(|parent| scope.fragment(parent));
    let outer = Position::in_fragment(parent.unwrap_or(net::FragmentId::ROOT));
    let path = format!("{}{}", scope.prefix, content.name);
    set_node_name(elab, &path);
    let activation = match content.when {
        Some(when) => {
            let around = std::mem::replace(&mut scope.base, outer.fragment);
            let condition = expr::elab_condition(elab, scope, when, outer);
            scope.base = around;
            call::elab_activation(elab, &condition, outer, content.span)
        }
        None => net::Activation::Always,
    };
    let restart = if content.restart {
        Restart::OnActivation
    } else {
        Restart::Never
    };
    let fragment = call::elab_fragment(
        elab,
        &path,
        outer.fragment,
        activation,
        restart,
        content.span,
    );
    elab.net.fragments[fragment.0 as usize].budget_ns = content.budget_ns;
    scope.fragments[block.0 as usize] = Some(fragment);
    elab.in_place.insert(fragment);
    fragment
}

fn elab_block_content<'u>(
    elab: &mut Elaborator<'u>,
    scope: &mut Scope<'u>,
    block: BlockId,
    at: Position,
) {
    let unit = scope.unit;
    let content = unit.block(block);
    let around = std::mem::replace(&mut scope.base, at.fragment);
    for equation in &content.equations {
        elab_equation(elab, scope, equation, at);
    }
    for claim in &content.claims {
        claims::elab_claim(elab, scope, block, claim, at);
    }
    for automaton in &content.automata {
        automaton::elab_automaton(elab, scope, automaton, at);
    }
    scope.base = around;
}

/// Sets the flow name from which the names of the following net nodes are formed.
pub(super) fn set_node_name(elab: &mut Elaborator<'_>, name: &str) {
    name.clone_into(&mut elab.naming.name);
    elab.naming.serial = 0;
    elab.naming.top_expr = None;
}

fn elab_equation<'u>(
    elab: &mut Elaborator<'u>,
    scope: &mut Scope<'u>,
    equation: &'u Equation,
    at: Position,
) {
    set_node_name(elab, &scope.prefix);
    push_target_name(&mut elab.naming.name, scope.unit, equation);
    elab.naming.top_expr = Some(equation.value);
    let before = elab.net.nodes.len();
    let taken = equation.targets.iter().map(|t| t.ty.leaf_count());
    let taken = taken.sum::<usize>().max(1);
    let wire = elementwise::expr_leaves(elab, scope, equation.value, taken, at);
    let wire = outside_flows::value_for_targets(elab, scope, equation, wire);
    let mut wire = subrange::check_targets(elab, scope, equation, wire, at);
    if elab.mode == ElabMode::DependencySteps
        || elab.mode == ElabMode::Net && must_keep_node(scope.unit, equation)
    {
        wire = insert_copies(elab, &wire, scope.unit.expr(equation.value), at);
    }
    let path = std::mem::take(&mut elab.naming.name);
    name_results(elab, &path, equation, &wire, before);
    elab.naming.name = path;
    flows::define_all(elab, scope, equation, &wire);
    write_ports(elab, scope, equation, &wire, at);
}

/// Adds the writes of an equation's value to the actuator ports among its targets. `wire` has the signals of the value.
fn write_ports<'u>(
    elab: &mut Elaborator<'u>,
    scope: &mut Scope<'u>,
    equation: &'u Equation,
    wire: &Wire,
    at: Position,
) {
    let mut first = 0;
    for target in &equation.targets {
        let count = target.ty.leaf_count();
        if let TargetPlace::Port { device, port } = target.place {
            let part = crate::elab::expr::sub_wire(wire, first, count);
            device::write(elab, scope, device, port, target, &part, at);
        }
        first += count;
    }
}

/// Adds a net node for each leaf (scalar part) of an equation's value that is only a copy of another flow, and returns
/// the signals of the copies. The nodes make the copy visible in messages.
fn insert_copies(elab: &mut Elaborator<'_>, wire: &Wire, value: &Expr, at: Position) -> Wire {
    let leaves = leaf_scalars(&value.ty).into_iter().zip(&**wire);
    leaves
        .map(|(scalar, signal)| match signal {
            Signal::Port(port) if is_of_another_flow(elab, *port) => {
                nodes::add_copy(elab, *port, scalar, at.fragment, value.span)
            }
            other => other.clone(),
        })
        .collect()
}

fn is_of_another_flow(elab: &Elaborator<'_>, port: PortRef) -> bool {
    alias_of(port).is_some() || elab.net.node(port.node).origin.flow.is_some()
}

/// Names the net nodes that compute the value of an equation after its target. `path` is the name of the target, `wire`
/// has the signals of the value, and `before` is the number of nodes before the equation.
fn name_results(
    elab: &mut Elaborator<'_>,
    path: &str,
    equation: &Equation,
    wire: &Wire,
    before: usize,
) {
    if let [Target { ty, .. }] = &equation.targets[..]
        && ty.leaf_count() == wire.len()
    {
        name_leaves(elab, path, ty, wire, before);
    }
    if let ([_], Some(node)) = (&equation.targets[..], whole_node(elab, wire))
        && node.index() >= before
    {
        let node = &mut elab.net.nodes[node.index()];
        path.clone_into(&mut node.name);
        node.origin.flow.get_or_insert_with(|| path.to_owned());
    }
}

/// Names the net nodes that compute the leaves (scalar parts) of a value after the path of each leaf. Nodes with an
/// index below `before` retain their names.
pub(super) fn name_leaves(
    elab: &mut Elaborator<'_>,
    path: &str,
    ty: &Ty,
    wire: &Wire,
    before: usize,
) {
    let mut leaves = wire.iter();
    ty.for_each_leaf(&mut |suffix, _| {
        if let Some(Signal::Port(port)) = leaves.next() {
            name_result(elab, *port, path, suffix, before);
        }
    });
}

/// Names the net node that computes a leaf (scalar part) `path` + `suffix`, if its index is `before` or greater and it
/// has no name yet.
fn name_result(elab: &mut Elaborator<'_>, port: PortRef, path: &str, suffix: &str, before: usize) {
    if alias_of(port).is_some() || port.node.index() < before {
        return;
    }
    let node = &mut elab.net.nodes[port.node.index()];
    if node.origin.flow.is_none() && node.outputs.len() == 1 {
        path.clone_into(&mut node.name);
        node.name.push_str(suffix);
        node.origin.flow = Some(node.name.clone());
    }
}

/// Returns the net node whose outputs are exactly the signals of `wire`, in order; `None` if there is none. If `wire`
/// is empty, the last node is returned if it has no outputs.
fn whole_node(elab: &Elaborator<'_>, wire: &Wire) -> Option<rpi_net::NodeId> {
    let node = match wire.first() {
        None => elab.net.node_ids().next_back()?,
        Some(Signal::Port(port) | Signal::Element(port, _)) if alias_of(*port).is_none() => {
            port.node
        }
        _ => return None,
    };
    (nodes::out_wire(elab, node) == *wire).then_some(node)
}

/// Appends the name of a flow to `text`, followed by the path of a part if `count` leaves (scalar parts) from `at` on
/// are not the whole flow.
fn push_flow_name(text: &mut String, flow: &Flow, at: usize, count: usize) {
    text.push_str(&flow.name);
    if at != 0 || count != flow.ty.leaf_count() {
        text.push_str(&flow.ty.part_path(at, count));
    }
}

/// Appends the name of the first target of an equation that has a name; `_` if none has.
fn push_target_name(text: &mut String, unit: &Unit, equation: &Equation) {
    let (start, targets) = (text.len(), equation.targets.iter());
    for target in targets {
        match &target.place {
            TargetPlace::Flow { flow, at } => {
                let flow = unit.flow(*flow);
                return push_flow_name(text, flow, *at as usize, target.ty.leaf_count());
            }
            TargetPlace::Port { device, port } => {
                let ports = unit
                    .device_type_instance(*device)
                    .map(|device| &device.ports);
                if let Some(port) = ports.and_then(|ports| ports.get(*port as usize)) {
                    for part in [&unit.flow(*device).name, ".", &port.name] {
                        text.push_str(part);
                    }
                    return;
                }
            }
            TargetPlace::Nowhere => {}
        }
    }
    if text.len() == start {
        text.push('_');
    }
}
