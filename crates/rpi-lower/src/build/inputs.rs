//! Inputs of nodes: value and presence of a flow as seen from the fragment of the reader.

use super::Builder;
use crate::registers::Register;
use rpi_image::{PortType, Scalar, Type, Value};
use rpi_net::passes::FlowPresence;
use rpi_net::{FragmentId, Input, NodeId, PortRef};

/// Value and presence of a flow.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) struct Flow {
    pub(super) value: Register,
    pub(super) present: Register,
}

impl Flow {
    /// Placeholder for a flow that is not built yet.
    pub(super) const NONE: Flow = Flow {
        value: Register::FALSE,
        present: Register::FALSE,
    };
}

/// A flow with its type.
#[derive(Clone, Copy, Debug)]
pub(super) struct InputFlow {
    pub(super) flow: Flow,
    pub(super) ty: Type,
    /// The input is neither connected nor has a default.
    pub(super) is_open: bool,
}

impl Builder<'_> {
    /// The flow at in-port `k` of a node.
    pub(super) fn link(&mut self, id: NodeId, k: usize) -> InputFlow {
        let net = self.net;
        let node = net.node(id);
        let port = node.desc().inputs[k].ty;
        match &node.inputs[k] {
            Input::Unconnected => self.absent_flow(neutral_type(port), true),
            input => self.read(input, node.fragment),
        }
    }

    /// The flow of an input as seen from the fragment `reader`.
    pub(super) fn read(&mut self, input: &Input, reader: FragmentId) -> InputFlow {
        match input {
            Input::Unconnected => self.absent_flow(Type::Scalar(Scalar::Bool), true),
            Input::Port(port) => self.seen_from(*port, reader),
            Input::Const(value) => {
                let flow = Flow {
                    value: self.flat.registers.value(value),
                    present: Register::TRUE,
                };
                let ty = value.ty().unwrap_or(Type::Scalar(Scalar::Bool));
                InputFlow {
                    flow,
                    ty,
                    is_open: false,
                }
            }
        }
    }

    /// The flow of an out-port as seen from the fragment `reader`.
    pub(super) fn seen_from(&mut self, port: PortRef, reader: FragmentId) -> InputFlow {
        let ty = self.net.node(port.node).outputs[usize::from(port.port)];
        if self.plan.presences.own(port) == FlowPresence::Never {
            return self.absent_flow(ty, false);
        }
        let view = self
            .plan
            .presences
            .view(self.net, self.plan.tree, reader, port);
        let own =
            self.flows[self.first_output[port.node.index()] as usize + usize::from(port.port)];
        let origin = self.net.node(port.node).fragment;
        let scope = self.scope[self.plan.tree.common_ancestor(reader, origin).index()];
        // From the outermost fragment inwards, so that equal prefixes share registers.
        let through = view.through.iter().rev();
        let active = through.fold(Register::TRUE, |all, f| {
            self.logic
                .and(&mut self.flat, scope, all, self.active[f.index()])
        });
        let present = self.logic.and(&mut self.flat, scope, active, own.present);
        let flow = Flow {
            value: own.value,
            present,
        };
        InputFlow {
            flow,
            ty,
            is_open: false,
        }
    }

    fn absent_flow(&mut self, ty: Type, open: bool) -> InputFlow {
        let value = self.flat.registers.value(&Value::neutral(ty));
        let flow = Flow {
            value,
            present: Register::FALSE,
        };
        InputFlow {
            flow,
            ty,
            is_open: open,
        }
    }
}

/// Type of an open port; arrays are empty.
fn neutral_type(port: PortType) -> Type {
    match port {
        PortType::Scalar(s) => Type::Scalar(s),
        PortType::Array(s) => Type::Array(s, 0),
        PortType::Matrix => Type::Matrix(0, 0),
    }
}
