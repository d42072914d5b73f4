//! Flows of a net as registers.

use crate::registers::{Register, Registers};
use rpi_image::image::Signal;
use rpi_image::{Type, Value};
use rpi_net::{Net, PortRef};

/// Registers of one flow of a net: its value, and its presence, which is true in the cycles in which the flow has a
/// value.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) struct Flow {
    pub(super) value: Register,
    pub(super) present: Register,
}

impl Flow {
    /// Entry for a flow that is not built yet: never present, with the register of the constant 0 as value.
    pub(super) const NONE: Flow = Flow {
        value: Register::FALSE,
        present: Register::FALSE,
    };

    /// Returns a flow with this value register that is present in every cycle.
    pub(super) const fn total(value: Register) -> Self {
        Flow {
            value,
            present: Register::TRUE,
        }
    }

    /// Returns the flow as a signal of the image, with register numbers in place of memory slots.
    pub(super) fn to_signal(self, ty: Type) -> Signal {
        Signal {
            start: self.value.0,
            present: self.present.0,
            ty,
        }
    }
}

/// The flow that an in-port of a node reads, as seen from the fragment of the node, with its type.
#[derive(Clone, Copy, Debug)]
pub(super) struct InputFlow {
    pub(super) flow: Flow,
    pub(super) ty: Type,
    /// Whether the in-port has neither a connection nor a constant. Such a port does not count in the decision whether
    /// all inputs are present.
    pub(super) is_open: bool,
}

impl InputFlow {
    /// Returns an input flow that is never present, with the neutral value of the type. `is_open` is true if the
    /// in-port is unconnected.
    pub(super) fn absent(registers: &mut Registers, ty: Type, is_open: bool) -> Self {
        let value = registers.value(&Value::neutral(ty));
        let present = Register::FALSE;
        InputFlow {
            flow: Flow { value, present },
            ty,
            is_open,
        }
    }

    /// Returns the input flow of an in-port that is connected to `flow`.
    pub(super) const fn connected(flow: Flow, ty: Type) -> Self {
        InputFlow {
            flow,
            ty,
            is_open: false,
        }
    }
}

/// Registers of the flows at all out-ports of a net. The entry of a flow that is not built yet is [`Flow::NONE`].
pub(super) struct FlowTable {
    /// For each node, the index in `flows` of its first out-port.
    first_output: Vec<u32>,
    flows: Vec<Flow>,
}

impl FlowTable {
    pub(super) fn new(net: &Net) -> Self {
        let mut first_output = Vec::with_capacity(net.nodes.len());
        let mut ports = 0;
        for node in &net.nodes {
            first_output.push(ports);
            ports += u32::try_from(node.outputs.len()).unwrap_or(u32::MAX);
        }
        FlowTable {
            first_output,
            flows: vec![Flow::NONE; ports as usize],
        }
    }

    pub(super) fn get(&self, port: PortRef) -> Flow {
        self.flows[self.index(port)]
    }

    pub(super) fn set(&mut self, port: PortRef, flow: Flow) {
        let index = self.index(port);
        self.flows[index] = flow;
    }

    fn index(&self, port: PortRef) -> usize {
        self.first_output[port.node.index()] as usize + usize::from(port.port)
    }
}
