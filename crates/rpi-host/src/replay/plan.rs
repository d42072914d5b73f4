//! What is looked at in each cycle: for every out-port of the net where it lies in memory and what the trace calls it.

use std::collections::BTreeMap;

use rpi_image::Image;
use rpi_image::Type;
use rpi_image::image::Signal;
use rpi_net::{Input, Net, NodeId, PortRef};

use super::angles::{Measure, measure};
use super::inputs::{is_input, is_latched};
use crate::trace::{PortId, Trace};

/// An out-port of a node.
pub(super) struct Out {
    pub(super) signal: Signal,
    /// The fragment in the image that it stands in.
    pub(super) fragment: u32,
    /// Its name in the trace, if it has a row there.
    pub(super) recorded: Option<PortId>,
    pub(super) measure: Measure,
}

/// A node.
pub(super) struct Watched {
    /// `outer/inner/name`.
    pub(super) path: String,
    /// Its out-ports.
    pub(super) outs: Vec<Out>,
    /// True if its out-ports are taken from the trace.
    pub(super) is_input: bool,
}

/// A named port that only passes on what an out-port or a constant gives.
pub(super) struct Alias {
    pub(super) name: String,
    pub(super) ty: Type,
    pub(super) source: Input,
    pub(super) place: AliasPlace,
}

/// What kind of alias.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum AliasPlace {
    /// An out-port of a fragment: recorded like other out-ports.
    Border(Option<PortId>),
    /// An in-port of a node, chosen by the recording.
    InPort(PortId),
}

/// All that is looked at.
pub(super) struct Plan {
    /// By node index.
    pub(super) nodes: Vec<Watched>,
    pub(super) aliases: Vec<Alias>,
    /// Nodes whose out-ports are there before the first step.
    pub(super) latched: Vec<NodeId>,
    /// For each step the nodes that are done after it.
    pub(super) done: Vec<Vec<NodeId>>,
    /// Nodes without a step, constants.
    pub(super) stepless: Vec<NodeId>,
    /// Ports of the trace that the net does not have.
    pub(super) unmatched: Vec<String>,
}

impl Plan {
    /// Lays a net, its image (lowered to be observed) and a trace side by side.
    pub(super) fn new(net: &Net, image: &Image, trace: &Trace) -> Plan {
        let nodes = watched(net, image, trace);
        let mut aliases = borders(net, trace);
        let mut unmatched = Vec::new();
        let in_ports = in_ports(net);
        let known = known(&nodes, net, &aliases);
        for (id, name) in trace.ports().filter(|(_, name)| !known.contains_key(*name)) {
            match in_ports.get(name) {
                Some((ty, source)) => aliases.push(Alias {
                    name: name.to_owned(),
                    ty: *ty,
                    source: (*source).clone(),
                    place: AliasPlace::InPort(id),
                }),
                None => unmatched.push(name.to_owned()),
            }
        }
        let (latched, others): (Vec<NodeId>, Vec<NodeId>) = net
            .node_ids()
            .partition(|id| is_latched(net.node(*id).desc()));
        let (done, stepless) = done(image, &nodes, &others);
        Plan {
            latched,
            done,
            stepless,
            nodes,
            aliases,
            unmatched,
        }
    }

    /// The out-port.
    pub(super) fn out(&self, port: PortRef) -> &Out {
        &self.nodes[port.node.0 as usize].outs[usize::from(port.port)]
    }
}

fn watched(net: &Net, image: &Image, trace: &Trace) -> Vec<Watched> {
    let probes: BTreeMap<String, usize> = image
        .probes
        .iter()
        .enumerate()
        .map(|(k, probe)| (image.probe_name(probe), k))
        .collect();
    let node = |id: NodeId| {
        let node = net.node(id);
        let (desc, path) = (node.desc(), net.path(node.fragment, &node.name));
        let outs = desc.outputs.iter().enumerate().filter_map(|(k, out)| {
            let name = format!("{path}.{}", out.name);
            let probe = &image.probes[*probes.get(&name)?];
            Some(Out {
                signal: probe.value,
                fragment: probe.fragment,
                recorded: trace.find(&name),
                measure: measure(desc, k),
            })
        });
        Watched {
            outs: outs.collect(),
            is_input: is_input(desc),
            path,
        }
    };
    net.node_ids().map(node).collect()
}

/// Out-ports of fragments below the root.
fn borders(net: &Net, trace: &Trace) -> Vec<Alias> {
    let inner = net.fragments.iter().filter_map(|f| Some((f.parent?, f)));
    let ports = inner.flat_map(|(parent, fragment)| {
        let path = net.path(parent, &fragment.name);
        fragment
            .outputs
            .iter()
            .map(move |port| (format!("{path}.{}", port.name), &port.source))
    });
    let alias = |(name, source): (String, &Input)| {
        Some(Alias {
            ty: type_of(net, source)?,
            source: source.clone(),
            place: AliasPlace::Border(trace.find(&name)),
            name,
        })
    };
    ports.filter_map(alias).collect()
}

fn in_ports(net: &Net) -> BTreeMap<String, (Type, &Input)> {
    let nodes = net.nodes.iter();
    let ports = nodes.flat_map(|node| {
        let path = net.path(node.fragment, &node.name);
        let ports = node.desc().inputs.iter().zip(&node.inputs);
        ports.map(move |(port, source)| (format!("{path}.{}", port.name), source))
    });
    ports
        .filter_map(|(name, source)| Some((name, (type_of(net, source)?, source))))
        .collect()
}

/// The type of what runs through an input; none if nothing is connected.
pub(super) fn type_of(net: &Net, input: &Input) -> Option<Type> {
    match input {
        Input::Open => None,
        Input::Const(value) => value.ty(),
        Input::Port(port) => net
            .node(port.node)
            .outputs
            .get(usize::from(port.port))
            .copied(),
    }
}

fn known<'a>(nodes: &'a [Watched], net: &'a Net, aliases: &'a [Alias]) -> BTreeMap<String, ()> {
    let outs = nodes.iter().zip(&net.nodes).flat_map(|(watched, node)| {
        let outs = node.desc().outputs.iter();
        outs.map(move |out| format!("{}.{}", watched.path, out.name))
    });
    let borders = aliases.iter().map(|alias| alias.name.clone());
    outs.chain(borders).map(|name| (name, ())).collect()
}

/// For each step the nodes that are done after it, their last one; and the nodes that have none.
fn done(image: &Image, nodes: &[Watched], ids: &[NodeId]) -> (Vec<Vec<NodeId>>, Vec<NodeId>) {
    let mut last: BTreeMap<&str, usize> = BTreeMap::new();
    for (pc, &place) in image.trace.iter().enumerate() {
        if let Some(place) = image.places.get(place as usize) {
            last.insert(&place.path, pc);
        }
    }
    let mut done = vec![Vec::new(); image.steps.len()];
    let mut stepless = Vec::new();
    for &id in ids {
        match last.get(nodes[id.index()].path.as_str()) {
            Some(&pc) => done[pc].push(id),
            None => stepless.push(id),
        }
    }
    (done, stepless)
}
