//! Deferred arrays: arrays that are read before all their leaves are known, packed at the end of the elaboration.
//!
//! An array read from a block that is elaborated later, or along a dependency cycle, would otherwise be unpacked and
//! packed again element by element, although it is only passed on.

use crate::elab::arrays;
use crate::elab::nodes;
use crate::elab::signal::{Signal, Wire, alias_of};
use crate::elab::{Elaborator, Position};
use rpi_diag::Span;
use rpi_image::{Scalar, Type};
use rpi_net::{Input, PortRef};

/// Array with leaves (scalar parts) that are placeholders for signals not known yet. It is packed at the end of the
/// elaboration.
pub(super) struct DeferredArray {
    alias: PortRef,
    wire: Wire,
    ty: Type,
    at: Position,
    span: Span,
}

/// Records an array whose leaves (scalar parts) are not all known, to be packed at the end of the elaboration. Returns
/// a placeholder port for the whole array.
pub(super) fn defer_array(
    elab: &mut Elaborator<'_>,
    wire: Wire,
    ty: Type,
    at: Position,
    span: Span,
) -> PortRef {
    // The alias refers to a whole array, so its type as a leaf is never used.
    let alias = nodes::new_alias(elab, Scalar::Bool);
    elab.aliases.deferred_arrays.push(DeferredArray {
        alias,
        wire,
        ty,
        at,
        span,
    });
    alias
}

/// Returns the type of the array for which a placeholder port stands; `None` if it stands for another value.
pub(super) fn deferred_type(elab: &Elaborator<'_>, alias: PortRef) -> Option<Type> {
    let at = elab
        .aliases
        .deferred_arrays
        .binary_search_by_key(&alias, |p| p.alias);
    at.ok().map(|at| elab.aliases.deferred_arrays[at].ty)
}

/// Packs all arrays that have been deferred, and connects their placeholder ports. The placeholders of their leaves
/// (scalar parts) must be connected.
pub(super) fn pack_deferred_arrays(elab: &mut Elaborator<'_>) {
    for promise in std::mem::take(&mut elab.aliases.deferred_arrays) {
        let leaf = |signal: &Signal| resolved_leaf(elab, signal);
        let wire: Wire = promise.wire.iter().map(leaf).collect();
        let input = arrays::resolved_array(elab, &wire, promise.ty, promise.at, promise.span);
        if let Some(alias) = alias_of(promise.alias) {
            elab.aliases.signals[alias] = match input {
                Input::Port(port) => Some(Signal::Port(port)),
                Input::Const(value) => Some(Signal::Const(*value)),
                Input::Unconnected => None,
            };
        }
    }
}

fn resolved_leaf(elab: &Elaborator<'_>, signal: &Signal) -> Signal {
    let alias = match signal {
        Signal::Port(port) => alias_of(*port),
        _ => None,
    };
    let known = alias.and_then(|alias| elab.aliases.signals[alias].clone());
    known.unwrap_or_else(|| signal.clone())
}
