//! Inputs of nodes: value and presence of a flow as seen from the fragment of the reader.

use super::Builder;
use super::flows::{Flow, InputFlow};
use crate::registers::Register;
use rpi_image::{PortType, Scalar, Type};
use rpi_net::passes::FlowPresence;
use rpi_net::{FragmentId, Input, NodeId, PortRef};

impl Builder<'_> {
    /// Returns the flow at the in-port with index `k` of a node. An unconnected in-port has a flow that is never
    /// present.
    pub(super) fn link(&mut self, id: NodeId, k: usize) -> InputFlow {
        let net = self.net;
        let node = net.node(id);
        let port = node.desc().inputs[k].ty;
        match &node.inputs[k] {
            Input::Unconnected => {
                InputFlow::absent(&mut self.flat.registers, neutral_type(port), true)
            }
            input => self.read(input, node.fragment),
        }
    }

    /// Returns the flow of an input as seen from the fragment `reader`: absent while the fragment that computes it is
    /// inactive.
    pub(super) fn read(&mut self, input: &Input, reader: FragmentId) -> InputFlow {
        match input {
            Input::Unconnected => {
                InputFlow::absent(&mut self.flat.registers, Type::Scalar(Scalar::Bool), true)
            }
            Input::Port(port) => self.seen_from(*port, reader),
            Input::Const(value) => {
                let flow = Flow::total(self.flat.registers.value(value));
                let ty = value.ty().unwrap_or(Type::Scalar(Scalar::Bool));
                InputFlow::connected(flow, ty)
            }
        }
    }

    /// Returns the flow of an out-port as seen from the fragment `reader`: absent while the fragment of the port is
    /// inactive.
    pub(super) fn seen_from(&mut self, port: PortRef, reader: FragmentId) -> InputFlow {
        let ty = self.net.output_type(port);
        if self.plan.presences.own(port) == FlowPresence::Never {
            return InputFlow::absent(&mut self.flat.registers, ty, false);
        }
        let view = self
            .plan
            .presences
            .view(self.net, self.plan.tree, reader, port);
        let own = self.flows.get(port);
        let origin = self.net.node(port.node).fragment;
        let scope = self
            .fragments
            .scope(self.plan.tree.common_ancestor(reader, origin));
        // From the outermost fragment inwards, so that equal prefixes share registers.
        let through = view.through.iter().rev();
        let active = through.fold(Register::TRUE, |all, f| {
            self.logic
                .and(&mut self.flat, scope, all, self.fragments.active(*f))
        });
        let present = self.logic.and(&mut self.flat, scope, active, own.present);
        let value = own.value;
        InputFlow::connected(Flow { value, present }, ty)
    }
}

/// Returns the type that a port without a connection gets; arrays and matrices are empty.
fn neutral_type(port: PortType) -> Type {
    match port {
        PortType::Scalar(s) => Type::Scalar(s),
        PortType::Array(s) => Type::Array(s, 0),
        PortType::Matrix => Type::Matrix(0, 0),
    }
}
