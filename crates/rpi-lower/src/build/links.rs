//! What an in-port reads: a value and a presence, as seen from where the reader stands.

use super::Builder;
use crate::slots::Slot;
use rpi_image::{PortType, Scalar, Type, Value};
use rpi_net::passes::Sureness;
use rpi_net::{FragmentId, Input, NodeId, PortRef};

/// A flow in slots.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) struct Flow {
    pub(super) value: Slot,
    pub(super) present: Slot,
}

impl Flow {
    /// A flow of which nothing is known yet.
    pub(super) const NONE: Flow = Flow {
        value: Slot::FALSE,
        present: Slot::FALSE,
    };
}

/// A flow with its type.
#[derive(Clone, Copy, Debug)]
pub(super) struct Link {
    pub(super) flow: Flow,
    pub(super) ty: Type,
    /// Nothing is connected, and nothing stands in.
    pub(super) open: bool,
}

impl Builder<'_> {
    /// What the in-port `k` of a node reads.
    pub(super) fn link(&mut self, id: NodeId, k: usize) -> Link {
        let net = self.net;
        let node = net.node(id);
        let port = node.desc().inputs[k].ty;
        match &node.inputs[k] {
            Input::Open => self.never(neutral_type(port), true),
            input => self.read(input, node.fragment),
        }
    }

    /// What a reader in `reader` sees of an input that is connected.
    pub(super) fn read(&mut self, input: &Input, reader: FragmentId) -> Link {
        match input {
            Input::Open => self.never(Type::One(Scalar::Bool), true),
            Input::Port(port) => self.view(*port, reader),
            Input::Const(value) => {
                let flow = Flow {
                    value: self.flat.slots.value(value),
                    present: Slot::TRUE,
                };
                let ty = value.ty().unwrap_or(Type::One(Scalar::Bool));
                Link {
                    flow,
                    ty,
                    open: false,
                }
            }
        }
    }

    /// A flow as a reader in `reader` sees it.
    pub(super) fn view(&mut self, port: PortRef, reader: FragmentId) -> Link {
        let ty = self.net.node(port.node).outputs[usize::from(port.port)];
        if self.plan.presences.own(port) == Sureness::Never {
            return self.never(ty, false);
        }
        let view = self
            .plan
            .presences
            .view(self.net, self.plan.tree, reader, port);
        let own = self.flows[self.first[port.node.index()] as usize + usize::from(port.port)];
        let origin = self.net.node(port.node).fragment;
        let scope = self.scope[self.plan.tree.common(reader, origin).index()];
        // Outermost first: the same chains get the same slots.
        let through = view.through.iter().rev();
        let active = through.fold(Slot::TRUE, |all, f| {
            self.logic
                .and(&mut self.flat, scope, all, self.active[f.index()])
        });
        let present = self.logic.and(&mut self.flat, scope, active, own.present);
        let flow = Flow {
            value: own.value,
            present,
        };
        Link {
            flow,
            ty,
            open: false,
        }
    }

    fn never(&mut self, ty: Type, open: bool) -> Link {
        let value = self.flat.slots.value(&Value::neutral(ty));
        let flow = Flow {
            value,
            present: Slot::FALSE,
        };
        Link { flow, ty, open }
    }
}

/// The type of a port to which nothing is connected; arrays are empty.
fn neutral_type(port: PortType) -> Type {
    match port {
        PortType::One(s) => Type::One(s),
        PortType::Array(s) => Type::Array(s, 0),
        PortType::Matrix => Type::Matrix(0, 0),
    }
}
