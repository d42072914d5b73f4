//! The named flows of a command, in the order of their evaluation.

use std::collections::BTreeMap;
use std::sync::Arc;

use crate::debugger::Debugger;
use rpi_diag::Span;
use rpi_driver::AnalysedNet;
use rpi_image::Type;
use rpi_image::image::{Image, Signal};
use rpi_net::{ExportPort, FragmentId, Net, strip_unnamed_calls};

/// Named flow of a command, or a scalar part of one.
#[derive(Clone, PartialEq, Debug)]
pub struct Flow {
    /// Name with the command, fragments and calls around it: `Main.Late.way.travelled`.
    pub path: String,
    /// Index of the innermost fragment around it in [`FlowTable::fragments`].
    pub fragment: usize,
    /// Type of the value.
    pub ty: Type,
    /// Memory slots of the value and its presence.
    pub(crate) signal: Signal,
    /// Index of the fragment of the value in the image.
    pub(crate) image_fragment: u32,
    /// Place of the flow in the program.
    pub span: Span,
    /// Index of the step of the image that computes it.
    order: usize,
}

/// Fragment that has a name in the program, or the whole command.
#[derive(Clone, PartialEq, Debug)]
pub struct NamedFragment {
    /// Names from the command to the fragment: `Main.Late`.
    pub path: String,
    /// Number of named fragments around it.
    pub depth: usize,
    /// Place of the declaration.
    pub span: Span,
    /// Index in the image; `None` if nothing is evaluated in it.
    pub(crate) image_fragment: Option<u32>,
}

/// The named flows and the fragments of a command.
#[derive(Clone, Debug)]
pub struct FlowTable {
    /// Image whose instances have these flows.
    image: Arc<Image>,
    /// Name of the command.
    pub command: String,
    /// Flows in the order in which they are evaluated.
    pub flows: Vec<Flow>,
    /// The command itself, then its named fragments in the order of the program.
    pub fragments: Vec<NamedFragment>,
}

impl FlowTable {
    /// Collects the flows of a command whose flows are all exported. The image must have been made of the net, with all ports
    /// observable.
    #[must_use]
    pub fn new(net: &AnalysedNet, image: Arc<Image>) -> FlowTable {
        let fragments = named_fragments(net, &image);
        let order = evaluation_order(net, &image);
        let steps = first_steps(&image);
        let probes: BTreeMap<(u32, &str), usize> = (0..)
            .zip(&image.debug.probes)
            .map(|(k, probe)| ((probe.location, probe.port.as_str()), k))
            .collect();
        let flow = |export: &ExportPort| {
            let node = net.node(export.source.node);
            let port = node.desc().outputs.get(usize::from(export.source.port))?;
            let probe = probes.get(&(export.source.node.0, port.name))?;
            let probe = &image.debug.probes[*probe];
            let path = format!("{}.{}", net.name, export.key);
            let equation = order.get(&path);
            Some(Flow {
                fragment: innermost(&fragments, &path),
                order: match equation {
                    Some((step, _)) => *step,
                    // Another name of a flow, or an input.
                    None => steps.get(&probe.location).copied().unwrap_or(0),
                },
                path,
                ty: probe.value.ty,
                signal: probe.value,
                image_fragment: probe.fragment,
                span: equation.map_or(export.origin.span, |(_, span)| *span),
            })
        };
        let mut flows: Vec<Flow> = net.exports.iter().filter_map(flow).collect();
        flows.sort_by_key(|flow| flow.order);
        flows.dedup_by(|a, b| a.path == b.path);
        FlowTable {
            command: net.name.clone(),
            flows,
            fragments,
            image,
        }
    }

    /// Returns whether the flows are those of the instances of an image.
    #[must_use]
    pub fn is_of(&self, image: &Arc<Image>) -> bool {
        Arc::ptr_eq(&self.image, image)
    }

    /// Returns the index of the flow for which a name stands in a fragment: of the flow there, else in a fragment around it, else of the
    /// flow with this whole path.
    #[must_use]
    pub fn find(&self, fragment: usize, name: &str) -> Option<usize> {
        let mut path = self.fragments.get(fragment)?.path.as_str();
        loop {
            if let Some(found) = self.position(&format!("{path}.{name}")) {
                return Some(found);
            }
            match path.rsplit_once('.') {
                Some((around, _)) => path = around,
                None => return self.position(name),
            }
        }
    }

    fn position(&self, path: &str) -> Option<usize> {
        self.flows.iter().position(|flow| flow.path == path)
    }

    /// Returns the name of a flow in its fragment, with the calls around it.
    #[must_use]
    pub fn short_name<'f>(&'f self, flow: &'f Flow) -> &'f str {
        let path = &self.fragments[flow.fragment].path;
        flow.path.get(path.len() + 1..).unwrap_or(&flow.path)
    }

    /// Returns the index of the innermost fragment whose declaration is around a place.
    #[must_use]
    pub fn fragment_at(&self, place: Span) -> Option<usize> {
        let around = self.fragments.iter().enumerate();
        let around = around.filter(|(_, fragment)| fragment.span.contains(place));
        around
            .max_by_key(|(_, fragment)| fragment.depth)
            .map(|(k, _)| k)
    }
}

/// Returns for each node the index of the first step that belongs to it.
fn first_steps(image: &Image) -> BTreeMap<u32, usize> {
    let mut steps = BTreeMap::new();
    for (step, location) in image.debug.step_locations.iter().enumerate() {
        steps.entry(*location).or_insert(step);
    }
    steps
}

/// Returns for each flow that a node of the net computes, by its path, the index of the last step for it and the place of its equation.
/// Flows that are other names of such flows, and inputs, are not in the table.
fn evaluation_order(net: &Net, image: &Image) -> BTreeMap<String, (usize, Span)> {
    let mut order = BTreeMap::new();
    for (step, location) in image.debug.step_locations.iter().enumerate() {
        let Some(node) = net.nodes.get(*location as usize) else {
            continue;
        };
        if let Some(flow) = &node.origin.flow {
            let mut names = path(net, node.fragment);
            let flow = strip_unnamed_calls(flow);
            names.push(&flow);
            order.insert(names.join("."), (step, node.origin.span));
        }
    }
    order
}

/// Returns the index of the fragment with the longest path around a flow; 0, the command, if there is none.
fn innermost(fragments: &[NamedFragment], flow: &str) -> usize {
    let around = |fragment: &NamedFragment| {
        let rest = flow.strip_prefix(&fragment.path);
        rest.is_some_and(|rest| rest.starts_with('.'))
    };
    let found = fragments.iter().enumerate().filter(|(_, f)| around(f));
    let found = found.max_by_key(|(_, fragment)| fragment.path.len());
    found.map_or(0, |(k, _)| k)
}

fn named_fragments(net: &Net, image: &Image) -> Vec<NamedFragment> {
    let nodes = image.debug.probes.iter();
    let in_image: BTreeMap<u32, u32> = nodes
        .map(|probe| {
            let node = net.node(rpi_net::NodeId(probe.location));
            (node.fragment.0, probe.fragment)
        })
        .collect();
    let ids = (0..).take(net.fragments.len()).map(FragmentId);
    let is_shown = |id: &FragmentId| *id == FragmentId::ROOT || net.fragment(*id).is_named();
    let named = ids.filter(is_shown).map(|id| {
        let names = path(net, id);
        NamedFragment {
            depth: names.len() - 1,
            path: names.join("."),
            span: net.fragment(id).origin.span,
            image_fragment: in_image.get(&id.0).copied(),
        }
    });
    // Those of expressions are not shown, so that the others keep their indices.
    named
        .filter(|fragment| !Debugger::is_added(&fragment.path))
        .collect()
}

/// Returns the names of the command and of the named fragments from the outermost to this one.
fn path(net: &Net, id: FragmentId) -> Vec<&str> {
    let mut names = vec![net.name.as_str()];
    names.extend(net.fragment_names(id));
    names
}
