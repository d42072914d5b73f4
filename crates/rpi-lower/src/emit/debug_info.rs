//! Debug information: source locations, origins of faults, probes, and the node of each step.

use super::layout::MemoryLayout;
use crate::flat_net::{FlatNet, NO_NODE, Op, OpKind};
use crate::options::{LowerOptions, Observe};
use crate::registers::Register;
use rpi_diag::Span;
use rpi_image::Image;
use rpi_image::image::{Probe, Signal, SourceLocation, TextRange};
use rpi_net::{Net, NodeId};
use rustc_hash::FxHashMap;
use std::collections::BTreeMap;

pub(super) fn write(
    net: &Net,
    flat: &FlatNet,
    layouts: &MemoryLayout,
    options: &LowerOptions<'_>,
    image: &mut Image,
) {
    let observed = options.observe == Observe::All;
    let mut places = LocationTable {
        net,
        known: FxHashMap::default(),
        places: Vec::new(),
    };
    if observed {
        net.node_ids().for_each(|id| _ = places.location_of(id));
        probes(net, flat, layouts, image);
    } else {
        image.debug.step_locations.clear();
    }
    origins(flat, layouts, &mut places, options, image);
    image.debug.locations = places.places;
}

/// Source locations of the nodes that the image refers to, one entry per node.
struct LocationTable<'a> {
    net: &'a Net,
    known: FxHashMap<NodeId, u32>,
    places: Vec<SourceLocation>,
}

impl LocationTable<'_> {
    fn location_of(&mut self, id: NodeId) -> u32 {
        let (net, places) = (self.net, &mut self.places);
        *self.known.entry(id).or_insert_with(|| {
            places.push(location(net, id));
            places.len() as u32 - 1
        })
    }
}

fn location(net: &Net, id: NodeId) -> SourceLocation {
    let node = net.node(id);
    let span = node.origin.span;
    SourceLocation {
        path: net.path(node.fragment, &node.name),
        flow: node.origin.flow.clone(),
        range: (span != Span::NONE).then_some(TextRange {
            file: span.file.0,
            start: span.start,
            end: span.end,
        }),
    }
}

/// Adds the probes, the ports that observers can read, to the image. If every port is observable, the source location
/// with index `k` belongs to the node with index `k`.
fn probes(net: &Net, flat: &FlatNet, layouts: &MemoryLayout, image: &mut Image) {
    for &(place, port, signal) in &flat.tables.probes {
        let node = net.node(NodeId(place));
        image.debug.probes.push(Probe {
            location: place,
            port: node.desc().outputs[usize::from(port)].name.to_owned(),
            value: Signal {
                start: layouts.slot(Register(signal.start)),
                present: layouts.slot(Register(signal.present)),
                ty: signal.ty,
            },
            fragment: node.fragment.0,
        });
    }
}

/// Adds to the image, for every operation and sensor that may raise a fault (or for all), the source location of its node under the
/// first memory slot that it writes.
fn origins(
    flat: &FlatNet,
    layouts: &MemoryLayout,
    places: &mut LocationTable<'_>,
    options: &LowerOptions<'_>,
    image: &mut Image,
) {
    let mut found = BTreeMap::new();
    for op in flat.ops.iter().filter(|op| op.node != NO_NODE) {
        let first_write = || flat.writes(*op).next().filter(|_| options.locates_all);
        if let Some(slot) = fault_slot(flat, *op).or_else(first_write) {
            found.entry(layouts.slot(slot)).or_insert(op.node);
        }
    }
    for (sensor, node) in &flat.tables.sensors {
        let cell = layouts.slot(Register(sensor.value.start));
        found.entry(cell).or_insert(*node);
    }
    let place = |(cell, node)| (cell, places.location_of(NodeId(node)));
    image.debug.origins = found.into_iter().map(place).collect();
}

/// Returns the register by which the core identifies an operation that raised a fault: the first that it writes, or
/// else the first that it reads. `None` if the operation cannot fault.
fn fault_slot(flat: &FlatNet, op: Op) -> Option<Register> {
    match op.kind {
        OpKind::Run(prim, _) if prim.desc().may_fault => flat.writes(op).next(),
        OpKind::Actuate(..) => flat.writes(op).next().or(flat.reads(op).next()),
        OpKind::Run(..) | OpKind::Copy | OpKind::Call(..) => None,
    }
}
