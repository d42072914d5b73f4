//! Arrays that are read before all their leaves are known: promised now, put together at the end.
//!
//! An array read from a fragment that the text has not come to yet, or along a circle, would otherwise be taken apart
//! and put together again, element by element, although it only passes.

use super::signal::{Signal, Wire, alias_of};
use super::{At, Elab};
use rpi_diag::Span;
use rpi_image::{Scalar, Type};
use rpi_net::{Input, PortRef};

/// An array that is to be.
pub(super) struct Promise {
    alias: PortRef,
    wire: Wire,
    ty: Type,
    at: At,
    span: Span,
}

impl Elab<'_> {
    /// Promises an array of these leaves.
    pub(super) fn promise(&mut self, wire: Wire, ty: Type, at: At, span: Span) -> PortRef {
        // The alias stands for a whole array; the type that it has as a leaf is never asked for.
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

    /// The type of a promised array.
    pub(super) fn promised_type(&self, alias: PortRef) -> Option<Type> {
        let at = self.promises.binary_search_by_key(&alias, |p| p.alias);
        at.ok().map(|at| self.promises[at].ty)
    }

    /// Keeps all promises; the leaves' aliases are settled.
    pub(super) fn keep_promises(&mut self) {
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
