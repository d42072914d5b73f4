//! Comparison plan of a replay: for every out-port of the net, its memory location and its port in the trace.

use std::collections::{BTreeMap, BTreeSet};

use rpi_image::Image;
use rpi_image::Type;
use rpi_image::image::Signal;
use rpi_net::{Input, Net, NodeId, PortRef};

use super::angles::{AngleKind, angle_kind};
use super::inputs::{is_input, is_latched};
use super::names::PortNames;
use rpi_record::trace::{Trace, TracePortId};

/// Out-port of a node, with all data for the comparison of its values with a trace.
pub(super) struct OutPort {
    pub(super) signal: Signal,
    /// Index in the image of the fragment to which the port belongs.
    pub(super) fragment: u32,
    /// Index of the port in the trace; `None` if the trace has no value of it.
    pub(super) recorded: Option<TracePortId>,
    pub(super) measure: AngleKind,
}

/// Node of a net, with all data for the comparison of its out-ports with a trace.
pub(super) struct ComparedNode {
    /// Path of the node in the net, `outer/inner/name`.
    pub(super) path: String,
    /// Out-ports of the node, in the order of the primitive's declaration.
    pub(super) out_ports: Vec<OutPort>,
    /// Whether the values of the out-ports are taken from the trace instead of being computed.
    pub(super) is_input: bool,
}

/// Port that shows the value of an out-port or a constant under another name, such as an out-port of a fragment. Its
/// recorded value is compared as well.
pub(super) struct Alias {
    pub(super) name: String,
    pub(super) ty: Type,
    pub(super) source: Input,
    pub(super) place: AliasKind,
}

/// Kind of a port that only shows the value of another port.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum AliasKind {
    /// Out-port of a fragment, recorded like the out-ports of nodes, with its index in the trace; `None` if the trace
    /// has no value of it.
    FragmentOutput(Option<TracePortId>),
    /// In-port of a node that was selected for recording, with its index in the trace.
    InPort(TracePortId),
}

/// Plan for the comparison of a net with a trace: all ports that are compared, and the order of comparison.
pub(super) struct ComparisonPlan {
    /// Nodes of the net, by index.
    pub(super) nodes: Vec<ComparedNode>,
    pub(super) aliases: Vec<Alias>,
    /// Nodes whose out-ports have their values before the first step of a cycle, such as sensors.
    pub(super) latched: Vec<NodeId>,
    /// For each step of the image, the nodes whose last step it is, and which are compared after it.
    pub(super) completed_after: Vec<Vec<NodeId>>,
    /// Nodes without a step in the image, such as constants.
    pub(super) stepless: Vec<NodeId>,
    /// Names of the trace's ports that do not exist in the net.
    pub(super) unmatched: Vec<String>,
    /// Offset that was added to the numbers in the generated names of the trace so that they match the names of the
    /// net.
    pub(super) shift: i64,
}

impl ComparisonPlan {
    /// Creates the plan for a net, its image (lowered with observable ports) and a trace.
    pub(super) fn new(net: &Net, image: &Image, trace: &Trace) -> ComparisonPlan {
        let in_ports = in_ports(net);
        let known = all_port_names(net, &in_ports);
        let names = PortNames::new(trace, &known);
        let nodes = compared_nodes(net, image, &names);
        let mut aliases = fragment_output_aliases(net, &names);
        aliases.extend(recorded_in_ports(&in_ports, &names));
        let unmatched = names.iter().filter(|(name, _)| !known.contains(*name));
        let (latched, others): (Vec<NodeId>, Vec<NodeId>) = net
            .node_ids()
            .partition(|id| is_latched(net.node(*id).desc()));
        let (done, stepless) = completed_after(image, &nodes, &others);
        ComparisonPlan {
            latched,
            completed_after: done,
            stepless,
            unmatched: unmatched.map(|(name, _)| name.to_owned()).collect(),
            shift: names.shift,
            nodes,
            aliases,
        }
    }

    /// Returns the comparison data of an out-port.
    pub(super) fn out_port(&self, port: PortRef) -> &OutPort {
        &self.nodes[port.node.0 as usize].out_ports[usize::from(port.port)]
    }
}

fn compared_nodes(net: &Net, image: &Image, names: &PortNames) -> Vec<ComparedNode> {
    let probes: BTreeMap<String, usize> = image
        .debug
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
            let probe = &image.debug.probes[*probes.get(&name)?];
            Some(OutPort {
                signal: probe.value,
                fragment: probe.fragment,
                recorded: names.find(&name),
                measure: angle_kind(desc, k),
            })
        });
        ComparedNode {
            out_ports: outs.collect(),
            is_input: is_input(desc),
            path,
        }
    };
    net.node_ids().map(node).collect()
}

/// Iterates over the out-ports of all fragments except the root: the path of each, and its source.
fn fragment_outputs(net: &Net) -> impl Iterator<Item = (String, &Input)> {
    let inner = net.fragments.iter().filter_map(|f| Some((f.parent?, f)));
    inner.flat_map(|(parent, fragment)| {
        let path = net.path(parent, &fragment.name);
        let ports = fragment.outputs.iter();
        ports.map(move |port| (format!("{path}.{}", port.name), &port.source))
    })
}

fn fragment_output_aliases(net: &Net, names: &PortNames) -> Vec<Alias> {
    let alias = |(name, source): (String, &Input)| {
        Some(Alias {
            ty: type_of(net, source)?,
            source: source.clone(),
            place: AliasKind::FragmentOutput(names.find(&name)),
            name,
        })
    };
    fragment_outputs(net).filter_map(alias).collect()
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

/// Returns the type of the value at an input; `None` if the input is not connected.
pub(super) fn type_of(net: &Net, input: &Input) -> Option<Type> {
    match input {
        Input::Unconnected => None,
        Input::Const(value) => value.ty(),
        Input::Port(port) => net
            .node(port.node)
            .outputs
            .get(usize::from(port.port))
            .copied(),
    }
}

/// Returns the in-ports of the net that the trace contains, because they were selected for recording. `in_ports` has
/// the type and the source of each in-port by name.
fn recorded_in_ports(in_ports: &BTreeMap<String, (Type, &Input)>, names: &PortNames) -> Vec<Alias> {
    let chosen = names
        .iter()
        .filter_map(|(name, id)| Some((name, id, in_ports.get(name)?)));
    chosen
        .map(|(name, id, (ty, source))| Alias {
            name: name.to_owned(),
            ty: *ty,
            source: (*source).clone(),
            place: AliasKind::InPort(id),
        })
        .collect()
}

/// Returns the names of all ports that a trace can contain for a net: the out-ports of nodes and fragments, and the
/// in-ports of nodes.
fn all_port_names(net: &Net, in_ports: &BTreeMap<String, (Type, &Input)>) -> BTreeSet<String> {
    let outs = net.nodes.iter().flat_map(|node| {
        let path = net.path(node.fragment, &node.name);
        let outs = node.desc().outputs.iter();
        outs.map(move |out| format!("{path}.{}", out.name))
    });
    let borders = fragment_outputs(net).map(|(name, _)| name);
    outs.chain(borders)
        .chain(in_ports.keys().cloned())
        .collect()
}

/// Returns two lists: for each step of the image the nodes in `ids` whose last step it is, and the nodes in `ids`
/// without a step.
fn completed_after(
    image: &Image,
    nodes: &[ComparedNode],
    ids: &[NodeId],
) -> (Vec<Vec<NodeId>>, Vec<NodeId>) {
    let mut last: BTreeMap<&str, usize> = BTreeMap::new();
    for (pc, &place) in image.debug.step_locations.iter().enumerate() {
        if let Some(place) = image.debug.locations.get(place as usize) {
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
