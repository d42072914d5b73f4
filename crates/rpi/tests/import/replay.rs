//! Programs of nets, replayed against the traces of the nets.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use rpi_image::Value;
use rpi_net::{FragmentId, FragmentPort, Input, Net, NodeId, PortRef};
use rpi_record::trace::Trace;
use rpi_replay::trace_compare::{CompareReport, Options, replay};

use crate::constant::constants;
use crate::nets;
use crate::round_trip::RoundTrip;

/// Marker of added nodes in names; no name in a net has it.
const ADDED: char = '#';

/// A net of the corpus is imported as a program that agrees with its trace.
pub(crate) fn agrees(path: &Path) -> Result<(), String> {
    let trip = RoundTrip::from_file(path)?;
    let text = trace_of(path);
    let before = run(&trip.old, &text)?;
    let lost = lost(&trip)?;
    let text = without(&text, &lost, before.renumbered);
    let report = run(&with_original_names(&trip), &text)?;
    // Added nodes have no rows in the trace, so the replay takes them as recorded absent.
    let differing = report.ports.iter().any(|port| !port.port.contains(ADDED));
    match differing || !report.unmatched.is_empty() {
        false => Ok(()),
        true => Err(report.to_string()),
    }
}

fn run(net: &Net, trace: &str) -> Result<CompareReport, String> {
    let trace = Trace::parse(trace).map_err(|e| e.to_string())?;
    replay(net, &trace, &Options::default()).map_err(|e| e.to_string())
}

fn trace_of(path: &Path) -> String {
    let name = nets::name(path);
    let name = name.trim_end_matches(".rpinet.gz");
    let folder = path
        .parent()
        .and_then(Path::parent)
        .expect("a folder of folders");
    let path = folder.join(format!("traces/{name}.trace.gz"));
    rpi_testkit::read_maybe_gz(&path).unwrap_or_else(|e| panic!("{}: {e}", path.display()))
}

/// Returns the paths of nodes that the program's net lacks because they are constants, now inlined, and of fragments
/// with nothing else in them. Anything else missing is an error.
fn lost(trip: &RoundTrip) -> Result<BTreeSet<String>, String> {
    let constants = constants(&trip.old);
    let mut lost = BTreeSet::new();
    for id in trip
        .old
        .node_ids()
        .filter(|id| !trip.nodes.contains_key(id))
    {
        let node = trip.old.node(id);
        let path = trip.old.path(node.fragment, &node.name);
        if constants[id.index()].is_none() {
            return Err(format!("{path} is lost, a {}", node.desc().name));
        }
        lost.insert(path);
    }
    for id in trip
        .old
        .fragment_ids()
        .skip(1)
        .filter(|id| !trip.fragments.contains_key(id))
    {
        let fragment = trip.old.fragment(id);
        let path = trip
            .old
            .path(fragment.parent.unwrap_or(FragmentId::ROOT), &fragment.name);
        let gives = |port: &FragmentPort| map_input(&port.source, trip, &constants);
        if !fragment
            .outputs
            .iter()
            .all(|port| matches!(gives(port), Some(Input::Const(_))))
        {
            return Err(format!("the fragment {path} is lost"));
        }
        lost.insert(path);
    }
    Ok(lost)
}

/// Returns a trace without the ports of some nodes, with the names of the net.
fn without(trace: &str, lost: &BTreeSet<String>, shift: i64) -> String {
    let mut kept = String::with_capacity(trace.len());
    for line in trace.lines() {
        let mut fields = line.splitn(3, '\t');
        let (Some(cycle), Some(name)) = (fields.next(), fields.next()) else {
            continue;
        };
        let name = shifted(name, shift);
        let node = name.rsplit_once('.').map_or("", |(node, _)| node);
        if !lost.contains(node) {
            let value = fields.next().unwrap_or_default();
            kept.extend([cycle, "\t", &name, "\t", value, "\n"]);
        }
    }
    kept
}

/// Returns a path with `shift` added to the numbers at the ends of its names.
fn shifted(name: &str, shift: i64) -> String {
    if shift == 0 || name.starts_with('#') {
        return name.to_owned();
    }
    let (path, port) = name.rsplit_once('.').unwrap_or((name, ""));
    let parts = path.split('/').map(|part| {
        let stem = part.trim_end_matches(|c: char| c.is_ascii_digit());
        let number: i64 = part[stem.len()..].parse().expect("names end in numbers");
        format!("{stem}{}", number + shift)
    });
    format!("{}.{port}", parts.collect::<Vec<String>>().join("/"))
}

/// Returns the program's net with the names of the original net, and with its ports at the borders of fragments.
fn with_original_names(trip: &RoundTrip) -> Net {
    let mut net = (*trip.new).clone();
    let back: BTreeMap<NodeId, NodeId> = trip.nodes.iter().map(|(a, b)| (*b, *a)).collect();
    for id in trip.new.node_ids() {
        let name = &mut net.nodes[id.index()].name;
        match back.get(&id) {
            Some(old) => name.clone_from(&trip.old.node(*old).name),
            None => name.insert(0, ADDED),
        }
    }
    let constants = constants(&trip.old);
    let inside = |id: &&FragmentId| **id != FragmentId::ROOT;
    for (old, new) in trip.fragments.iter().filter(|(_, new)| inside(new)) {
        let (old, new) = (trip.old.fragment(*old), &mut net.fragments[new.index()]);
        new.name.clone_from(&old.name);
        let ports = old.outputs.iter().filter_map(|port| {
            Some(FragmentPort {
                name: port.name.clone(),
                source: map_input(&port.source, trip, &constants)?,
            })
        });
        new.outputs = ports.collect();
    }
    net
}

/// Maps a link of the original net to the new one.
fn map_input(source: &Input, trip: &RoundTrip, constants: &[Option<Vec<Value>>]) -> Option<Input> {
    let Input::Port(port) = source else {
        return Some(source.clone());
    };
    match (trip.nodes.get(&port.node), &constants[port.node.index()]) {
        (Some(node), _) => Some(Input::Port(PortRef {
            node: *node,
            ..*port
        })),
        (None, Some(values)) => Some(Input::constant(values[usize::from(port.port)].clone())),
        (None, None) => None,
    }
}
