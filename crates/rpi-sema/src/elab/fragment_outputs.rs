//! Fragment outputs that only alias an outer flow or a constant. Outside, they are present only while the fragment is
//! active (M4, M6).
//!
//! Inside a fragment, a flow that is a constant or an alias of an outer flow needs no node. A reader outside sees an
//! absent flow in the cycles in which the fragment is inactive, so for such a reader a node is added to the fragment.

use crate::elab::arrays;
use crate::elab::expr::leaf_scalars;
use crate::elab::flows;
use crate::elab::fragment_inputs;
use crate::elab::nodes;
use crate::elab::outside_flows;
use crate::elab::scope::Scope;
use crate::elab::signal::{Signal, Wire, alias_of};
use crate::elab::{ElabMode, Elaborator, Position};
use crate::typed::{BlockId, FlowId};
use rpi_diag::Span;
use rpi_image::{Scalar, Type};
use rpi_net::{Activation, FragmentId, PortRef};

/// Leaf (scalar part) of a flow that is read outside of its block before the fragment of the block has been added to
/// the net.
pub(super) struct PendingGate {
    alias: usize,
    block: BlockId,
    reader: FragmentId,
}

/// Returns the signals of a flow for an expression at the position `at`. `is_outside` is whether the expression is
/// outside of a block that contains the flow and may be inactive; the flow is then optional.
pub(super) fn read_flow<'u>(
    elab: &mut Elaborator<'u>,
    scope: &mut Scope<'u>,
    (flow, is_outside): (FlowId, bool),
    at: Position,
    span: Span,
) -> Wire {
    let wire = match is_outside {
        true => outside_flows::flow_outside_block(elab, scope, flow, span),
        false => flows::elab_flow(elab, scope, flow, span),
    };
    let wire = flow_for_reader(elab, scope, flow, wire, at);
    if elab.mode == ElabMode::DependencySteps {
        return insert_reads(elab, scope, flow, &wire, at, span);
    }
    wire
}

/// Adds a net node for each leaf (scalar part) of a flow that is read, at the position of the read, and returns their
/// signals. The nodes make the read visible in messages about dependency cycles.
fn insert_reads<'u>(
    elab: &mut Elaborator<'u>,
    scope: &Scope<'u>,
    flow: FlowId,
    wire: &Wire,
    at: Position,
    span: Span,
) -> Wire {
    let scalars = leaf_scalars(&scope.unit.flow(flow).ty).into_iter();
    let leaves = scalars.zip(&**wire).map(|(scalar, signal)| match signal {
        Signal::Port(port) => nodes::add_copy(elab, *port, scalar, at.fragment, span),
        other => other.clone(),
    });
    leaves.collect()
}

fn flow_for_reader<'u>(
    elab: &mut Elaborator<'u>,
    scope: &mut Scope<'u>,
    flow: FlowId,
    wire: Wire,
    at: Position,
) -> Wire {
    let block = scope.unit.flow(flow).block;
    let wire = fragment_inputs::read_inside(elab, scope, block, wire, at.fragment);
    if elab.mode == ElabMode::Constant || block == BlockId::ROOT {
        return wire;
    }
    if let Some(from) = scope.fragment(block) {
        return gate_wire(elab, &wire, from, at.fragment);
    }
    let mut leaf = |signal: &Signal| match new_gate(elab, signal) {
        None => signal.clone(),
        Some((alias, outside)) => {
            scope.pending_gates.push(PendingGate {
                alias,
                block,
                reader: at.fragment,
            });
            outside
        }
    };
    wire.iter().map(&mut leaf).collect()
}

/// Returns the signals of a value that is computed in the fragment `from`, for expressions in the fragment `reader`.
/// They are absent while `from` is inactive.
pub(super) fn gate_wire(
    elab: &mut Elaborator<'_>,
    wire: &Wire,
    from: FragmentId,
    reader: FragmentId,
) -> Wire {
    if elab.mode == ElabMode::Constant || !is_gated(elab, from, reader) {
        return wire.clone();
    }
    let mut leaf = |signal: &Signal| match new_gate(elab, signal) {
        None => signal.clone(),
        Some((alias, outside)) => {
            elab.aliases.gates.insert(alias, from);
            outside
        }
    };
    wire.iter().map(&mut leaf).collect()
}

/// Records the fragments of the leaves (scalar parts) that were read before the fragments were added to the net. All
/// these fragments exist now.
pub(super) fn assign_pending_gates<'u>(elab: &mut Elaborator<'u>, scope: &mut Scope<'u>) {
    for leaf in std::mem::take(&mut scope.pending_gates) {
        let from = scope.fragment(leaf.block);
        if let Some(from) = from.filter(|from| is_gated(elab, *from, leaf.reader)) {
            elab.aliases.gates.insert(leaf.alias, from);
        }
    }
}

/// Adds a placeholder port for a signal that leaves a fragment and may turn out not to be computed in that fragment.
/// Returns the index of the placeholder and its signal; `None` if the signal needs no placeholder.
fn new_gate(elab: &mut Elaborator<'_>, signal: &Signal) -> Option<(usize, Signal)> {
    let scalar = match signal {
        Signal::Const(value) => match value.ty()? {
            Type::Scalar(scalar) => scalar,
            _ => return None,
        },
        Signal::Port(port) => match alias_of(*port) {
            Some(alias) => elab.aliases.types[alias],
            None => scalar_of(elab, *port)?,
        },
        Signal::Element(..) | Signal::Absent => return None,
    };
    let port = nodes::new_alias(elab, scalar);
    let alias = alias_of(port)?;
    elab.aliases.signals[alias] = Some(signal.clone());
    Some((alias, Signal::Port(port)))
}

/// Returns whether the fragment `from` may be inactive while the fragment `reader` is active.
fn is_gated(elab: &Elaborator<'_>, from: FragmentId, reader: FragmentId) -> bool {
    let inside = elab.net.ancestors(from);
    let mut inside = inside.take_while(|f| elab.net.ancestors(reader).all(|r| r != *f));
    inside.any(|f| matches!(elab.net.fragment(f).activation, Activation::When { .. }))
}

/// Returns the signal to which a placeholder port of a fragment output is connected. A constant or a signal that is
/// computed elsewhere becomes the output of a net node in the fragment, so that it is absent while the fragment is
/// inactive.
pub(super) fn resolve_gate(elab: &mut Elaborator<'_>, alias: usize, signal: Signal) -> Signal {
    let Some(&from) = elab.aliases.gates.get(&alias) else {
        return signal;
    };
    let scalar = elab.aliases.types[alias];
    match signal {
        Signal::Const(_) => {
            let port = arrays::port_of(
                elab,
                &signal,
                scalar,
                Position::in_fragment(from),
                Span::NONE,
            );
            port.map_or(signal, Signal::Port)
        }
        Signal::Port(port) if !is_computed_in(elab, port, from) => {
            nodes::add_copy(elab, port, scalar, from, Span::NONE)
        }
        other => other,
    }
}

pub(super) fn is_computed_in(elab: &Elaborator<'_>, port: PortRef, fragment: FragmentId) -> bool {
    let maker = elab.net.node(port.node).fragment;
    elab.net.ancestors(maker).any(|f| f == fragment)
}

/// Returns the machine type of a port that carries one leaf (scalar part); `None` for arrays.
fn scalar_of(elab: &Elaborator<'_>, port: PortRef) -> Option<Scalar> {
    match elab
        .net
        .node(port.node)
        .outputs
        .get(usize::from(port.port))?
    {
        Type::Scalar(scalar) => Some(*scalar),
        _ => None,
    }
}
