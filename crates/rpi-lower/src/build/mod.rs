//! Translation of a net into operations with guards and presences.
//!
//! The rules (M4, M5, M6): A fragment is a scope that is skipped as a whole. Presence is data: one Boolean register per
//! flow that may be absent. A strict primitive whose inputs may be absent runs on stale values, and only the presence
//! of its output is false. If that would be wrong or expensive (state, faults, much work), the primitive gets a scope
//! of its own.

mod compute;
mod fragments;
mod inputs;
mod outputs;
mod roles;

use crate::boolean_ops::BooleanOps;
use crate::flat_net::{FlatNet, OpKind, ScopeId};
use crate::options::{LowerOptions, Observe};
use crate::plan::Plan;
use crate::registers::{Region, Register};
use inputs::{Flow, InputFlow};
use rpi_image::image::Form;
use rpi_image::operands::{Operand, operand_layout};
use rpi_image::{PrimDesc, Role};
use rpi_net::passes::Item;
use rpi_net::{FragmentId, Net, NodeId, PortRef};
use rpi_prims::PrimId;
use rustc_hash::FxHashMap;
use smallvec::SmallVec;
use std::collections::BTreeMap;
use std::rc::Rc;

/// Translates a net into the flat representation.
pub(crate) fn build(net: &Net, plan: &Plan<'_>, options: &LowerOptions<'_>) -> FlatNet {
    let mut builder = Builder::new(net, plan, options);
    builder.fragments_table();
    builder.items(FragmentId::ROOT);
    builder.latches();
    builder.exports_and_results();
    if options.observe == Observe::All {
        builder.probes();
    }
    builder.flat
}

/// Flows at the in-ports of one node.
type InputFlows = SmallVec<[InputFlow; 4]>;
/// Flows at the out-ports of one node.
type Flows = SmallVec<[Flow; 2]>;

struct Builder<'a> {
    net: &'a Net,
    plan: &'a Plan<'a>,
    options: &'a LowerOptions<'a>,
    flat: FlatNet,
    logic: BooleanOps,
    /// For each node, the index of its first out-port in `flows`.
    first_output: Vec<u32>,
    /// The flow of every out-port; [`Flow::NONE`] until it is built.
    flows: Vec<Flow>,
    /// The scope of each fragment.
    scope: Vec<ScopeId>,
    /// For each fragment, whether it is active, given that its parent is.
    active: Vec<Register>,
    /// Number of entries into each fragment so far.
    entry_counts: Vec<u32>,
    /// The flow `first` of each fragment that uses it.
    first_flows: BTreeMap<FragmentId, Register>,
    /// Delays, with the registers that keep value and presence.
    delays: Vec<(NodeId, Flow)>,
    fields: FxHashMap<(PrimId, Form), Rc<[Operand]>>,
}

impl<'a> Builder<'a> {
    fn new(net: &'a Net, plan: &'a Plan<'a>, options: &'a LowerOptions<'a>) -> Self {
        let mut first = Vec::with_capacity(net.nodes.len());
        let mut ports = 0;
        for node in &net.nodes {
            first.push(ports);
            ports += u32::try_from(node.outputs.len()).unwrap_or(u32::MAX);
        }
        Builder {
            net,
            plan,
            options,
            flat: FlatNet::new(net.nodes.len()),
            logic: BooleanOps::default(),
            first_output: first,
            flows: vec![Flow::NONE; ports as usize],
            scope: vec![ScopeId::ROOT; net.fragments.len()],
            active: vec![Register::TRUE; net.fragments.len()],
            entry_counts: vec![0; net.fragments.len()],
            first_flows: BTreeMap::new(),
            delays: Vec::new(),
            fields: FxHashMap::default(),
        }
    }

    /// Builds the items of a fragment that run at its next entry, in schedule order.
    fn items(&mut self, fragment: FragmentId) {
        let plan = self.plan;
        let time = self.entry_counts[fragment.index()];
        self.entry_counts[fragment.index()] += 1;
        for item in plan.schedule.run(fragment, time as usize) {
            match item {
                Item::Node(id) => self.node(*id),
                Item::Fragment(child) => self.fragment(*child),
            }
        }
    }

    fn node(&mut self, id: NodeId) {
        match self.net.node(id).desc().role {
            Role::Compute => self.compute(id),
            Role::Constant => self.constant(id),
            Role::Delay => self.delay(id),
            Role::IsAbsent => self.is_absent(id),
            Role::First => self.first(id),
            Role::Sensor(device) => self.sensor(id, device),
            Role::Actuator(device) => self.actuator(id, device),
            Role::DeviceFunction(device) => self.function(id, device),
            Role::Input => self.input_port(id),
            Role::Export => self.export(id),
            Role::Flow(flow) => self.flow(id, flow),
        }
    }

    fn desc(&self, id: NodeId) -> &'static PrimDesc {
        self.net.node(id).desc()
    }

    /// The scope of a node.
    fn scope_of(&self, id: NodeId) -> ScopeId {
        self.scope[self.net.node(id).fragment.index()]
    }

    fn fields(&mut self, prim: PrimId, form: Form) -> Rc<[Operand]> {
        let found = self.fields.entry((prim, form));
        let made = found.or_insert_with(|| operand_layout(prim.desc(), form).into());
        Rc::clone(made)
    }

    /// Adds a copy of a value that runs whenever `scope` is active.
    fn copy(&mut self, scope: ScopeId, from: Register, to: Register, node: u32) {
        self.flat.push(scope, OpKind::Copy, &[from.0, to.0], node);
    }

    /// New registers for an out-port.
    fn output(&mut self, port: PortRef, present: Register) -> Flow {
        let ty = self.net.node(port.node).outputs[usize::from(port.port)];
        let value = self.flat.registers.add(Region::Value, ty.slots());
        let flow = Flow { value, present };
        self.set(port, flow);
        flow
    }

    fn set(&mut self, port: PortRef, flow: Flow) {
        let at = self.first_output[port.node.index()] as usize + usize::from(port.port);
        self.flows[at] = flow;
    }

    /// A separate presence register for a port that may be forced to be absent, set to `present` before the node runs.
    fn forcible_presence(&mut self, scope: ScopeId, port: PortRef, present: Register) -> Register {
        if !(self.options.may_be_absent)(port) {
            return present;
        }
        let own = self.flat.registers.add(Region::Value, 1);
        self.copy(scope, present, own, crate::flat_net::NO_NODE);
        own
    }
}
