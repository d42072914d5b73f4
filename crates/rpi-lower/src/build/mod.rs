//! Translation of a net into operations with guards and presences.
//!
//! The rules (M4, M5, M6): A fragment is a scope that is skipped as a whole. Presence is data: one Boolean register per
//! flow that may be absent. A strict primitive whose inputs may be absent runs on stale values, and only the presence
//! of its output is false. If that would be wrong or expensive (state, faults, much work), the primitive gets a scope
//! of its own.

mod compute;
mod devices;
mod flows;
mod fragments;
mod inputs;
mod outputs;
mod port_names;
mod roles;

use crate::boolean_ops::BooleanOps;
use crate::flat_net::{FlatNet, ScopeId};
use crate::options::{LowerOptions, Observe};
use crate::plan::Plan;
use crate::registers::{Region, Register};
use compute::OperandLayouts;
use flows::{Flow, FlowTable, InputFlow};
use fragments::{FragmentScopes, fragment_table};
use rpi_image::{PrimDesc, Role};
use rpi_net::passes::Item;
use rpi_net::{FragmentId, Net, NodeId, PortRef};
use smallvec::SmallVec;
use std::collections::BTreeMap;

/// Translates a net into operations on registers in nested scopes, without optimisation.
pub(crate) fn build(net: &Net, plan: &Plan<'_>, options: &LowerOptions<'_>) -> FlatNet {
    let mut builder = Builder::new(net, plan, options);
    builder.flat.tables.fragments = fragment_table(net);
    builder.items(FragmentId::ROOT);
    builder.latches();
    outputs::exports_and_results(&mut builder);
    if options.observe == Observe::All {
        outputs::probes(&mut builder);
    }
    builder.flat
}

/// Flows that the in-ports of one node read, by index of the in-port.
type InputFlows = SmallVec<[InputFlow; 4]>;
/// Flows at the out-ports of one node, by index of the out-port.
type Flows = SmallVec<[Flow; 2]>;

struct Builder<'a> {
    net: &'a Net,
    plan: &'a Plan<'a>,
    options: &'a LowerOptions<'a>,
    flat: FlatNet,
    logic: BooleanOps,
    flows: FlowTable,
    fragments: FragmentScopes,
    /// For each fragment that uses the flow `first`, the register that is true in the first cycle after each reset of
    /// the fragment.
    first_flows: BTreeMap<FragmentId, Register>,
    /// Delays, each with the state registers in which its value and presence wait for the next cycle.
    delays: Vec<(NodeId, Flow)>,
    layouts: OperandLayouts,
}

impl<'a> Builder<'a> {
    fn new(net: &'a Net, plan: &'a Plan<'a>, options: &'a LowerOptions<'a>) -> Self {
        Builder {
            net,
            plan,
            options,
            flat: FlatNet::new(net.nodes.len()),
            logic: BooleanOps::default(),
            flows: FlowTable::new(net),
            fragments: FragmentScopes::new(net.fragments.len()),
            first_flows: BTreeMap::new(),
            delays: Vec::new(),
            layouts: OperandLayouts::default(),
        }
    }

    /// Builds the next part of a fragment: the nodes and nested fragments that the schedule runs at one entry into the
    /// fragment, in their order.
    fn items(&mut self, fragment: FragmentId) {
        let plan = self.plan;
        let entry = self.fragments.count_entry(fragment);
        for item in plan.schedule.run(fragment, entry) {
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
            Role::Sensor(device) => devices::sensor(self, id, device),
            Role::Actuator(device) => devices::actuator(self, id, device),
            Role::DeviceFunction(device) => devices::function(self, id, device),
            Role::ExternalFunction(signature) => devices::external(self, id, signature),
            Role::Input => self.input_port(id),
            Role::Export => self.export(id),
            Role::Flow(flow) => self.flow(id, flow),
        }
    }

    fn desc(&self, id: NodeId) -> &'static PrimDesc {
        self.net.node(id).desc()
    }

    /// Returns the scope in which the fragment of a node runs.
    fn scope_of(&self, id: NodeId) -> ScopeId {
        self.fragments.scope(self.net.node(id).fragment)
    }

    /// Adds a register for the value of an out-port and enters it, with `present` as presence, as the flow of the port.
    fn output(&mut self, port: PortRef, present: Register) -> Flow {
        let ty = self.net.output_type(port);
        let value = self.flat.registers.add(Region::Value, ty.slots());
        let flow = Flow { value, present };
        self.flows.set(port, flow);
        flow
    }

    /// Returns the presence register of an out-port. A port that a replay may force to be absent gets a register of its
    /// own, which receives a copy of `present` before the node runs; every other port shares `present`.
    fn forcible_presence(&mut self, scope: ScopeId, port: PortRef, present: Register) -> Register {
        if !(self.options.may_be_absent)(port) {
            return present;
        }
        let own = self.flat.registers.add(Region::Value, 1);
        self.flat
            .copy(scope, present, own, crate::flat_net::NO_NODE);
        own
    }
}
