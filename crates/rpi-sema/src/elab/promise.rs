//! Deferred arrays: arrays that are read before all their leaves are known, packed at the end of the elaboration.
//!
//! An array read from a block that is elaborated later, or along a dependency cycle, would otherwise be unpacked and
//! packed again element by element, although it is only passed on.

use crate::elab::signal::{Signal, Wire, alias_of};
use crate::elab::{At, Elab};
use rpi_diag::Span;
use rpi_image::{Scalar, Type};
use rpi_net::{Input, PortRef};

/// Array that is packed at the end of the elaboration.
pub(in crate::elab) struct Promise {
    alias: PortRef,
    wire: Wire,
    ty: Type,
    at: At,
    span: Span,
}

impl Elab<'_> {
    /// Defers an array of these leaves and returns the alias of the whole array.
    pub(in crate::elab) fn promise(&mut self, wire: Wire, ty: Type, at: At, span: Span) -> PortRef {
        // The alias refers to a whole array, so its type as a leaf is never used.
        let alias = self.new_alias(Scalar::Bool);
        self.promises.push(Promise {
            alias,
            wire,
            ty,
            at,
            span,
        });
        alias
    }

    /// Returns the type of a deferred array.
    pub(in crate::elab) fn promised_type(&self, alias: PortRef) -> Option<Type> {
        let at = self.promises.binary_search_by_key(&alias, |p| p.alias);
        at.ok().map(|at| self.promises[at].ty)
    }

    /// Packs all deferred arrays. The aliases of their leaves must be resolved.
    pub(in crate::elab) fn keep_promises(&mut self) {
        for promise in std::mem::take(&mut self.promises) {
            let leaf = |signal: &Signal| self.settled_leaf(signal);
            let wire: Wire = promise.wire.iter().map(leaf).collect();
            let input = self.settled_array(&wire, promise.ty, promise.at, promise.span);
            if let Some(alias) = alias_of(promise.alias) {
                self.aliases[alias] = match input {
                    Input::Port(port) => Some(Signal::Port(port)),
                    Input::Const(value) => Some(Signal::Const(*value)),
                    Input::Open => None,
                };
            }
        }
    }

    fn settled_leaf(&self, signal: &Signal) -> Signal {
        let alias = match signal {
            Signal::Port(port) => alias_of(*port),
            _ => None,
        };
        let known = alias.and_then(|alias| self.aliases[alias].clone());
        known.unwrap_or_else(|| signal.clone())
    }
}
