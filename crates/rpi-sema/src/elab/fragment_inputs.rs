//! Fragment inputs that may depend on the fragment's own outputs. To its surroundings a fragment is one vertex: each
//! output depends on all inputs (M6).
//!
//! An outer flow may be an alias of a flow computed in the fragment: `y = F(y)`, where `F` delays its input. Read
//! inside, such a flow would not be a link across the border. A copy node is therefore inserted beside the fragment. It
//! depends on the fragment, and the fragment depends on it, so that the dependency cycle is found.

use crate::elab::fragment_outputs;
use crate::elab::nodes;
use crate::elab::scope::{FlowState, Scope};
use crate::elab::signal::{Signal, Wire, alias_of};
use crate::elab::{ElabMode, Elaborator};
use crate::typed::BlockId;
use rpi_diag::Span;
use rpi_net::FragmentId;

/// Puts a placeholder port before each input of a called fragment that may depend on an output of the fragment.
pub(super) fn add_input_entries<'u>(
    elab: &mut Elaborator<'u>,
    scope: &mut Scope<'u>,
    fragment: FragmentId,
) {
    for port in &scope.unit.inputs {
        if let FlowState::Done(wire) = scope.state(*port).clone() {
            let wire = entry_wire(elab, &wire, fragment);
            *scope.state(*port) = FlowState::Done(wire);
        }
    }
}

/// Returns the signals of a flow of an enclosing block for an expression in the fragment `reader` of the same unit.
/// `block` is the block of the flow, and `wire` has its signals.
pub(super) fn read_inside<'u>(
    elab: &mut Elaborator<'u>,
    scope: &Scope<'u>,
    block: BlockId,
    wire: Wire,
    reader: FragmentId,
) -> Wire {
    if elab.in_place.is_empty() || elab.mode == ElabMode::Constant {
        return wire;
    }
    let Some(around) = scope.fragment(block).filter(|around| *around != reader) else {
        return wire;
    };
    // A flow shared by states lies beside its reader, not around it.
    if !elab.net.ancestors(reader).any(|f| f == around) {
        return wire;
    }
    let between = elab.net.ancestors(reader).take_while(|f| *f != around);
    match between.filter(|f| elab.in_place.contains(f)).last() {
        Some(fragment) => entry_wire(elab, &wire, fragment),
        None => wire,
    }
}

fn entry_wire(elab: &mut Elaborator<'_>, wire: &Wire, fragment: FragmentId) -> Wire {
    let mut leaf = |signal: &Signal| match signal {
        Signal::Port(port) => match alias_of(*port) {
            Some(known) => new_entry(elab, known, signal, fragment),
            None => signal.clone(),
        },
        other => other.clone(),
    };
    wire.iter().map(&mut leaf).collect()
}

/// Adds a placeholder port for a signal that enters a fragment. The signal is itself a placeholder and may turn out to
/// be an output of that fragment.
fn new_entry(
    elab: &mut Elaborator<'_>,
    known: usize,
    signal: &Signal,
    fragment: FragmentId,
) -> Signal {
    let port = nodes::new_alias(elab, elab.aliases.types[known]);
    if let Some(alias) = alias_of(port) {
        elab.aliases.signals[alias] = Some(signal.clone());
        elab.aliases.entries.insert(alias, fragment);
    }
    Signal::Port(port)
}

/// Returns the signal to which a placeholder port of a fragment input is connected. If the fragment itself computes the
/// signal, it is copied by a net node outside of the fragment, so that the dependency cycle is visible.
pub(super) fn resolve_entry(elab: &mut Elaborator<'_>, alias: usize, signal: Signal) -> Signal {
    let Some(&fragment) = elab.aliases.entries.get(&alias) else {
        return signal;
    };
    match (signal, elab.net.fragment(fragment).parent) {
        (Signal::Port(port), Some(around))
            if fragment_outputs::is_computed_in(elab, port, fragment) =>
        {
            nodes::add_copy(elab, port, elab.aliases.types[alias], around, Span::NONE)
        }
        (other, _) => other,
    }
}
