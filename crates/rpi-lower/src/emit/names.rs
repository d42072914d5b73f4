//! Debug information: source locations, origins of faults, probes, and the node of each step.

use super::cells::Layouts;
use crate::flat::{Flat, NO_NODE, Op, Work};
use crate::options::{LowerOptions, Observe};
use crate::slots::Slot;
use rpi_diag::Span;
use rpi_image::Image;
use rpi_image::image::{Place, Probe, Signal, TextRange};
use rpi_net::{Net, NodeId};
use rustc_hash::FxHashMap;
use std::collections::BTreeMap;

pub(super) fn write(
    net: &Net,
    flat: &Flat,
    layouts: &Layouts,
    options: &LowerOptions<'_>,
    image: &mut Image,
) {
    let observed = options.observe == Observe::All;
    let mut places = Places {
        net,
        known: FxHashMap::default(),
        places: Vec::new(),
    };
    if observed {
        net.node_ids().for_each(|id| _ = places.of(id));
        probes(net, flat, layouts, image);
    } else {
        image.trace.clear();
    }
    origins(flat, layouts, &mut places, image);
    image.places = places.places;
}

/// Locations that are referenced by the image.
struct Places<'a> {
    net: &'a Net,
    known: FxHashMap<NodeId, u32>,
    places: Vec<Place>,
}

impl Places<'_> {
    fn of(&mut self, id: NodeId) -> u32 {
        let (net, places) = (self.net, &mut self.places);
        *self.known.entry(id).or_insert_with(|| {
            places.push(place(net, id));
            places.len() as u32 - 1
        })
    }
}

fn place(net: &Net, id: NodeId) -> Place {
    let node = net.node(id);
    let span = node.origin.span;
    Place {
        path: net.path(node.fragment, &node.name),
        flow: node.origin.flow.clone(),
        text: (span != Span::NONE).then_some(TextRange {
            file: span.file.0,
            start: span.start,
            end: span.end,
        }),
    }
}

/// Emits the probes. With everything observed, location `k` belongs to node `k`.
fn probes(net: &Net, flat: &Flat, layouts: &Layouts, image: &mut Image) {
    for &(place, port, signal) in &flat.tables.probes {
        let node = net.node(NodeId(place));
        image.probes.push(Probe {
            place,
            port: node.desc().outputs[usize::from(port)].name.to_owned(),
            value: Signal {
                at: layouts.cell(Slot(signal.at)),
                present: layouts.cell(Slot(signal.present)),
                ty: signal.ty,
            },
            fragment: node.fragment.0,
        });
    }
}

/// Emits the node of every operation and sensor that may fault, by its first output slot.
fn origins(flat: &Flat, layouts: &Layouts, places: &mut Places<'_>, image: &mut Image) {
    let mut found = BTreeMap::new();
    for op in flat.ops.iter().filter(|op| op.node != NO_NODE) {
        if let Some(slot) = fault_slot(flat, *op) {
            found.entry(layouts.cell(slot)).or_insert(op.node);
        }
    }
    for (sensor, node) in &flat.tables.sensors {
        let cell = layouts.cell(Slot(sensor.value.at));
        found.entry(cell).or_insert(*node);
    }
    let place = |(cell, node)| (cell, places.of(NodeId(node)));
    image.origins = found.into_iter().map(place).collect();
}

/// The register that identifies a fault of an operation: the first that it writes, or else the first that it reads.
fn fault_slot(flat: &Flat, op: Op) -> Option<Slot> {
    match op.work {
        Work::Run(prim, _) if prim.desc().may_fault => flat.writes(op).next(),
        Work::Actuate(..) => flat.writes(op).next().or(flat.reads(op).next()),
        Work::Run(..) | Work::Copy | Work::Call(..) => None,
    }
}
