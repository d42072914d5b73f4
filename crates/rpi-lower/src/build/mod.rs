//! Translation of a net into operations with guards and presences.
//!
//! The rules (M4, M5, M6): A fragment is a scope that is skipped as a whole. Presence is data: one Boolean register per
//! flow that may be absent. A strict primitive whose inputs may be absent runs on stale values, and only the presence
//! of its output is false. If that would be wrong or expensive (state, faults, much work), the primitive gets a scope
//! of its own.

mod compute;
mod ends;
mod fragments;
mod links;
mod roles;

use crate::flat::{Flat, ScopeId, Work};
use crate::logic::Logic;
use crate::options::{LowerOptions, Observe};
use crate::plan::Plan;
use crate::slots::{Region, Slot};
use links::{Flow, Link};
use rpi_image::image::Form;
use rpi_image::operands::{Field, fields};
use rpi_image::{PrimDesc, Role};
use rpi_net::passes::Item;
use rpi_net::{FragmentId, Net, NodeId, PortRef};
use rpi_prims::PrimId;
use rustc_hash::FxHashMap;
use smallvec::SmallVec;
use std::collections::BTreeMap;
use std::rc::Rc;

/// Translates a net into the flat representation.
pub(crate) fn build(net: &Net, plan: &Plan<'_>, options: &LowerOptions<'_>) -> Flat {
    let mut builder = Builder::new(net, plan, options);
    builder.fragments_table();
    builder.items(FragmentId::ROOT);
    builder.latches();
    builder.ends();
    if options.observe == Observe::All {
        builder.probes();
    }
    builder.flat
}

/// Flows at the in-ports of one node.
type Links = SmallVec<[Link; 4]>;
/// Flows at the out-ports of one node.
type Flows = SmallVec<[Flow; 2]>;

struct Builder<'a> {
    net: &'a Net,
    plan: &'a Plan<'a>,
    options: &'a LowerOptions<'a>,
    flat: Flat,
    logic: Logic,
    /// For each node, the index of its first out-port in `flows`.
    first: Vec<u32>,
    /// The flow of every out-port; [`Flow::NONE`] until it is built.
    flows: Vec<Flow>,
    /// The scope of each fragment.
    scope: Vec<ScopeId>,
    /// For each fragment, whether it is active, given that its parent is.
    active: Vec<Slot>,
    /// Number of entries into each fragment so far.
    times: Vec<u32>,
    /// The flow `first` of each fragment that uses it.
    firsts: BTreeMap<FragmentId, Slot>,
    /// Delays, with the registers that keep value and presence.
    delays: Vec<(NodeId, Flow)>,
    fields: FxHashMap<(PrimId, Form), Rc<[Field]>>,
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
            flat: Flat::new(net.nodes.len()),
            logic: Logic::default(),
            first,
            flows: vec![Flow::NONE; ports as usize],
            scope: vec![ScopeId::ROOT; net.fragments.len()],
            active: vec![Slot::TRUE; net.fragments.len()],
            times: vec![0; net.fragments.len()],
            firsts: BTreeMap::new(),
            delays: Vec::new(),
            fields: FxHashMap::default(),
        }
    }

    /// Builds the items of a fragment that run at its next entry, in schedule order.
    fn items(&mut self, fragment: FragmentId) {
        let plan = self.plan;
        let time = self.times[fragment.index()];
        self.times[fragment.index()] += 1;
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

    fn fields(&mut self, prim: PrimId, form: Form) -> Rc<[Field]> {
        let found = self.fields.entry((prim, form));
        let made = found.or_insert_with(|| fields(prim.desc(), form).into());
        Rc::clone(made)
    }

    /// Adds a copy of a value that runs whenever `scope` is active.
    fn copy(&mut self, scope: ScopeId, from: Slot, to: Slot, node: u32) {
        self.flat.push(scope, Work::Copy, &[from.0, to.0], node);
    }

    /// New registers for an out-port.
    fn output(&mut self, port: PortRef, present: Slot) -> Flow {
        let ty = self.net.node(port.node).outputs[usize::from(port.port)];
        let value = self.flat.slots.add(Region::Value, ty.cells());
        let flow = Flow { value, present };
        self.set(port, flow);
        flow
    }

    fn set(&mut self, port: PortRef, flow: Flow) {
        let at = self.first[port.node.index()] as usize + usize::from(port.port);
        self.flows[at] = flow;
    }

    /// A separate presence register for a port that may be forced to be absent, set to `present` before the node runs.
    fn forcible(&mut self, scope: ScopeId, port: PortRef, present: Slot) -> Slot {
        if !(self.options.may_be_absent)(port) {
            return present;
        }
        let own = self.flat.slots.add(Region::Value, 1);
        self.copy(scope, present, own, crate::flat::NO_NODE);
        own
    }
}
