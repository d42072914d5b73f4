//! Flows of a net as registers.

use crate::registers::{Register, Registers};
use rpi_image::image::Signal;
use rpi_image::{Type, Value};
use rpi_net::{Net, PortRef};

/// Registers of the value and the presence of a flow.
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

    /// A flow that is always present.
    pub(super) const fn total(value: Register) -> Self {
        Flow {
            value,
            present: Register::TRUE,
        }
    }

    /// The flow as a signal of the image.
    pub(super) fn to_signal(self, ty: Type) -> Signal {
        Signal {
            start: self.value.0,
            present: self.present.0,
            ty,
        }
    }
}

/// The flow that an in-port of a node reads, with its type.
#[derive(Clone, Copy, Debug)]
pub(super) struct InputFlow {
    pub(super) flow: Flow,
    pub(super) ty: Type,
    /// Whether the input has neither a connection nor a default.
    pub(super) is_open: bool,
}

impl InputFlow {
    /// An input flow that is never present.
    pub(super) fn absent(registers: &mut Registers, ty: Type, is_open: bool) -> Self {
        let value = registers.value(&Value::neutral(ty));
        let present = Register::FALSE;
        InputFlow {
            flow: Flow { value, present },
            ty,
            is_open,
        }
    }

    /// The input flow for a connection to `flow`.
    pub(super) const fn connected(flow: Flow, ty: Type) -> Self {
        InputFlow {
            flow,
            ty,
            is_open: false,
        }
    }
}

/// The flow of every out-port of a net; [`Flow::NONE`] until it is built.
pub(super) struct FlowTable {
    /// For each node, the index of its first out-port.
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
