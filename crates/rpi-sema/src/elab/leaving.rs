//! Fragment outputs that only alias an outer flow or a constant. Outside, they are present only while the fragment is
//! active (M4, M6).
//!
//! Inside a fragment, a flow that is a constant or an alias of an outer flow needs no node. A reader outside sees an
//! absent flow in the cycles in which the fragment is inactive, so for such a reader a node is added to the fragment.

use crate::elab::expr::leaf_scalars;
use crate::elab::scope::Scope;
use crate::elab::signal::{Signal, Wire, alias_of};
use crate::elab::{At, Elab, Mode};
use crate::typed::{BlockId, FlowId};
use rpi_diag::Span;
use rpi_image::{Scalar, Type};
use rpi_net::{Activation, FragmentId, PortRef};

/// Leaf that is read outside a block whose fragment does not exist yet.
pub(in crate::elab) struct Leaving {
    alias: usize,
    block: BlockId,
    reader: FragmentId,
}

impl<'u> Elab<'u> {
    /// Returns the wire of a flow for a reader in its unit. A reader outside a block that may be inactive sees an
    /// optional flow.
    pub(in crate::elab) fn read_flow(
        &mut self,
        scope: &mut Scope<'u>,
        (flow, is_outside): (FlowId, bool),
        at: At,
        span: Span,
    ) -> Wire {
        let wire = match is_outside {
            true => self.flow_outside(scope, flow, span),
            false => self.flow(scope, flow, span),
        };
        let wire = self.wire_read(scope, flow, wire, at);
        if self.mode == Mode::Steps {
            return self.reads(scope, flow, &wire, at, span);
        }
        wire
    }

    /// Adds a node for each leaf that is read, at the position of the reader.
    fn reads(&mut self, scope: &Scope<'u>, flow: FlowId, wire: &Wire, at: At, span: Span) -> Wire {
        let scalars = leaf_scalars(&scope.unit.flow(flow).ty).into_iter();
        let leaves = scalars.zip(&**wire).map(|(scalar, signal)| match signal {
            Signal::Port(port) => self.passing_on(*port, scalar, at.fragment, span),
            other => other.clone(),
        });
        leaves.collect()
    }

    fn wire_read(&mut self, scope: &mut Scope<'u>, flow: FlowId, wire: Wire, at: At) -> Wire {
        let block = scope.unit.flow(flow).block;
        let wire = self.read_inside(scope, block, wire, at.fragment);
        if self.mode == Mode::Constant || block == BlockId::ROOT {
            return wire;
        }
        if let Some(from) = scope.fragment(block) {
            return self.leaving(&wire, from, at.fragment);
        }
        let mut leaf = |signal: &Signal| match self.gate(signal) {
            None => signal.clone(),
            Some((alias, outside)) => {
                scope.leaving.push(Leaving {
                    alias,
                    block,
                    reader: at.fragment,
                });
                outside
            }
        };
        wire.iter().map(&mut leaf).collect()
    }

    /// Returns the leaves of fragment `from` for a reader in fragment `reader`.
    pub(in crate::elab) fn leaving(
        &mut self,
        wire: &Wire,
        from: FragmentId,
        reader: FragmentId,
    ) -> Wire {
        if self.mode == Mode::Constant || !self.is_gated(from, reader) {
            return wire.clone();
        }
        let mut leaf = |signal: &Signal| match self.gate(signal) {
            None => signal.clone(),
            Some((alias, outside)) => {
                self.gates.insert(alias, from);
                outside
            }
        };
        wire.iter().map(&mut leaf).collect()
    }

    /// Assigns the pending leaves to their fragments, which all exist now.
    pub(in crate::elab) fn find_gates(&mut self, scope: &mut Scope<'u>) {
        for leaf in std::mem::take(&mut scope.leaving) {
            let from = scope.fragment(leaf.block);
            if let Some(from) = from.filter(|from| self.is_gated(*from, leaf.reader)) {
                self.gates.insert(leaf.alias, from);
            }
        }
    }

    /// Creates a gate alias for a leaf that may turn out not to be computed in its fragment.
    fn gate(&mut self, signal: &Signal) -> Option<(usize, Signal)> {
        let scalar = match signal {
            Signal::Const(value) => match value.ty()? {
                Type::One(scalar) => scalar,
                _ => return None,
            },
            Signal::Port(port) => match alias_of(*port) {
                Some(alias) => self.alias_types[alias],
                None => self.scalar_of(*port)?,
            },
            Signal::Element(..) | Signal::Absent => return None,
        };
        let port = self.new_alias(scalar);
        let alias = alias_of(port)?;
        self.aliases[alias] = Some(signal.clone());
        Some((alias, Signal::Port(port)))
    }

    /// Returns whether fragment `from` may be inactive while fragment `reader` is active.
    fn is_gated(&self, from: FragmentId, reader: FragmentId) -> bool {
        let inside = self.net.enclosing(from);
        let mut inside = inside.take_while(|f| self.net.enclosing(reader).all(|r| r != *f));
        inside.any(|f| matches!(self.net.fragment(f).activation, Activation::When { .. }))
    }

    /// Returns the signal of a resolved gate alias: a node in the fragment if the signal is a constant or computed
    /// elsewhere.
    pub(in crate::elab) fn behind_gate(&mut self, alias: usize, signal: Signal) -> Signal {
        let Some(&from) = self.gates.get(&alias) else {
            return signal;
        };
        let scalar = self.alias_types[alias];
        match signal {
            Signal::Const(_) => {
                let port = self.port_of(&signal, scalar, At::fragment(from), Span::NONE);
                port.map_or(signal, Signal::Port)
            }
            Signal::Port(port) if !self.is_made_in(port, from) => {
                self.passing_on(port, scalar, from, Span::NONE)
            }
            other => other,
        }
    }

    pub(in crate::elab) fn is_made_in(&self, port: PortRef, fragment: FragmentId) -> bool {
        let maker = self.net.node(port.node).fragment;
        self.net.enclosing(maker).any(|f| f == fragment)
    }

    /// Returns the machine type of a port with one leaf.
    fn scalar_of(&self, port: PortRef) -> Option<Scalar> {
        match self
            .net
            .node(port.node)
            .outputs
            .get(usize::from(port.port))?
        {
            Type::One(scalar) => Some(*scalar),
            _ => None,
        }
    }
}
