//! Inputs of nodes: value and presence of a flow as seen from the fragment of the reader.

use super::Builder;
use crate::slots::Slot;
use rpi_image::{PortType, Scalar, Type, Value};
use rpi_net::passes::Sureness;
use rpi_net::{FragmentId, Input, NodeId, PortRef};

/// Value and presence of a flow.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) struct Flow {
    pub(super) value: Slot,
    pub(super) present: Slot,
}

impl Flow {
    /// Placeholder for a flow that is not built yet.
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
    /// The input is neither connected nor has a default.
    pub(super) open: bool,
}

impl Builder<'_> {
    /// The flow at in-port `k` of a node.
    pub(super) fn link(&mut self, id: NodeId, k: usize) -> Link {
        let net = self.net;
        let node = net.node(id);
        let port = node.desc().inputs[k].ty;
        match &node.inputs[k] {
            Input::Open => self.never(neutral_type(port), true),
            input => self.read(input, node.fragment),
        }
    }

    /// The flow of an input as seen from the fragment `reader`.
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

    /// The flow of an out-port as seen from the fragment `reader`.
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
        // From the outermost fragment inwards, so that equal prefixes share registers.
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

/// Type of an open port; arrays are empty.
fn neutral_type(port: PortType) -> Type {
    match port {
        PortType::One(s) => Type::One(s),
        PortType::Array(s) => Type::Array(s, 0),
        PortType::Matrix => Type::Matrix(0, 0),
    }
}
