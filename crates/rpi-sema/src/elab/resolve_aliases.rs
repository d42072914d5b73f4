//! End of an elaboration: resolves the aliases.

use crate::elab::arrays;
use crate::elab::block;
use crate::elab::deferred_arrays;
use crate::elab::fragment_inputs;
use crate::elab::fragment_outputs;
use crate::elab::nodes;
use crate::elab::signal::{Signal, alias_of};
use crate::elab::{Elaborator, Position};
use rpi_diag::Span;
use rpi_image::Value;
use rpi_net::{Activation, FragmentId, Input, PortRef, Restart, Termination};
use smallvec::{SmallVec, smallvec};

/// Replaces all placeholder ports in the net by the signals for which they stand.
pub(super) fn resolve_aliases(elab: &mut Elaborator<'_>) {
    block::set_node_name(elab, "constant");
    for alias in 0..elab.aliases.signals.len() {
        resolve_alias(elab, alias);
    }
    deferred_arrays::pack_deferred_arrays(elab);
    for node in 0..elab.net.nodes.len() {
        resolve_node(elab, node);
    }
    for fragment in 0..elab.net.fragments.len() {
        resolve_fragment(elab, fragment);
    }
    for export in 0..elab.net.exports.len() {
        let source = elab.net.exports[export].source;
        let (at, span) = (Position::ROOT, elab.net.exports[export].origin.span);
        elab.net.exports[export].source = resolved_port(elab, source, at, span);
    }
    for watched in 0..elab.kept_exports.len() {
        let (source, span) = (
            elab.kept_exports[watched].source,
            elab.kept_exports[watched].origin.span,
        );
        elab.kept_exports[watched].source = resolved_port(elab, source, Position::ROOT, span);
    }
    resolve_driver(elab);
    resolve_coverage_points(elab);
}

/// Finds the signal for which a placeholder port stands, through a chain of placeholders. Placeholders that stand for
/// one another are a dependency cycle without any net node; a node that copies its input is added so that the net
/// contains the cycle.
fn resolve_alias(elab: &mut Elaborator<'_>, alias: usize) {
    let mut chain: SmallVec<[usize; 4]> = smallvec![alias];
    elab.aliases.in_progress[alias] = true;
    let end = loop {
        let last = chain[chain.len() - 1];
        match &elab.aliases.signals[last] {
            Some(Signal::Port(port)) => match alias_of(*port) {
                Some(next) if elab.aliases.in_progress[next] => {
                    break dependency_cycle_node(elab, last, *port);
                }
                Some(next) => {
                    elab.aliases.in_progress[next] = true;
                    chain.push(next);
                }
                None => break Signal::Port(*port),
            },
            Some(other) => break other.clone(),
            None => break undefined_value(elab, last),
        }
    };
    let mut seen = end;
    for alias in chain.into_iter().rev() {
        elab.aliases.in_progress[alias] = false;
        seen = fragment_outputs::resolve_gate(elab, alias, seen);
        seen = fragment_inputs::resolve_entry(elab, alias, seen);
        elab.aliases.signals[alias] = Some(seen.clone());
    }
}

/// Adds a net node that copies a placeholder port standing for the node's own output, and returns the output.
fn dependency_cycle_node(elab: &mut Elaborator<'_>, alias: usize, port: PortRef) -> Signal {
    let scalar = elab.aliases.types[alias];
    match nodes::add_copy(elab, port, scalar, FragmentId::ROOT, Span::NONE) {
        Signal::Port(port) if alias_of(port).is_some() => {
            Signal::Const(Value::neutral(scalar.into()))
        }
        cycle => cycle,
    }
}

/// Returns a neutral value for a flow that is never defined. The missing definition has been reported.
fn undefined_value(elab: &mut Elaborator<'_>, alias: usize) -> Signal {
    Signal::Const(Value::neutral(elab.aliases.types[alias].into()))
}

fn resolve_node(elab: &mut Elaborator<'_>, node: usize) {
    for k in 0..elab.net.nodes[node].inputs.len() {
        let Input::Port(port) = elab.net.nodes[node].inputs[k] else {
            continue;
        };
        let at = Position::in_fragment(elab.net.nodes[node].fragment);
        let span = elab.net.nodes[node].origin.span;
        if let Some(input) = resolved_input(elab, port, at, span) {
            elab.net.nodes[node].inputs[k] = input;
        }
    }
}

/// Returns the input of a net node that replaces a placeholder port; `None` if the port is not a placeholder.
fn resolved_input(
    elab: &mut Elaborator<'_>,
    port: PortRef,
    at: Position,
    span: Span,
) -> Option<Input> {
    let alias = alias_of(port)?;
    let signal = elab.aliases.signals[alias]
        .clone()
        .unwrap_or(Signal::Absent);
    Some(arrays::one_input(
        elab,
        &signal,
        elab.aliases.types[alias],
        at,
        span,
    ))
}

fn resolve_coverage_points(elab: &mut Elaborator<'_>) {
    let mut all = std::mem::take(&mut elab.net.coverage_points);
    let exits = all.state_transitions.iter_mut().flat_map(|exits| {
        let conditions = exits.transitions.iter_mut().map(|exit| &mut exit.condition);
        conditions.chain([&mut exits.is_active])
    });
    let choices = all.decisions.iter_mut().map(|choice| &mut choice.condition);
    for input in exits.chain(choices) {
        if let Input::Port(port) = *input
            && let Some(settled) = resolved_input(elab, port, Position::ROOT, Span::NONE)
        {
            *input = settled;
        }
    }
    elab.net.coverage_points = all;
}

fn resolved_port(elab: &mut Elaborator<'_>, port: PortRef, at: Position, span: Span) -> PortRef {
    let Some(alias) = alias_of(port) else {
        return port;
    };
    let signal = elab.aliases.signals[alias]
        .clone()
        .unwrap_or(Signal::Absent);
    arrays::port_of(elab, &signal, elab.aliases.types[alias], at, span).unwrap_or(port)
}

fn resolve_fragment(elab: &mut Elaborator<'_>, fragment: usize) {
    let parent = elab.net.fragments[fragment]
        .parent
        .unwrap_or(FragmentId::ROOT);
    let (at, span) = (
        Position::in_fragment(parent),
        elab.net.fragments[fragment].origin.span,
    );
    if let Activation::When {
        condition,
        if_absent: absent,
    } = elab.net.fragments[fragment].activation
    {
        let condition = resolved_port(elab, condition, at, span);
        elab.net.fragments[fragment].activation = Activation::When {
            condition,
            if_absent: absent,
        };
    }
    if let Restart::Every(condition) = elab.net.fragments[fragment].restart {
        let condition = resolved_port(elab, condition, at, span);
        elab.net.fragments[fragment].restart = Restart::Every(condition);
    }
}

fn resolve_driver(elab: &mut Elaborator<'_>) {
    let Termination::Results(results) = &mut elab.net.termination else {
        return;
    };
    let mut results = std::mem::take(results);
    for result in &mut results {
        if let Input::Port(port) = result.condition {
            let port = resolved_port(elab, port, Position::ROOT, result.origin.span);
            result.condition = Input::Port(port);
        }
    }
    elab.net.termination = Termination::Results(results);
}
