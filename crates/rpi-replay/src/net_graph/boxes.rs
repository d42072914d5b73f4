//! Boxes of a graph: one for each flow, inside of those of the fragments and calls around it.

use std::collections::{BTreeMap, BTreeSet};

use rpi_diag::Span;
use rpi_graph::{BoxKind, GraphBox, Place, Scene};
use rpi_image::Role;
use rpi_net::{FragmentId, Net, Node, NodeId};

/// Index of a scene, and of a box in it.
pub(super) type BoxId = (usize, usize);

/// What a box of a scene stands for; its name alone is not unique.
#[derive(Clone, PartialEq, Eq, PartialOrd, Ord)]
enum Key {
    Fragment(u32),
    Call(String),
    Flow(String),
    Device(String),
    Result(String),
}

/// Boxes with the scenes inside.
#[derive(Default)]
pub(super) struct BoxTree {
    pub(super) scenes: Vec<Scene>,
    /// For each scene, the box around it; `None` for the first one.
    pub(super) around: Vec<Option<BoxId>>,
    /// Box of each fragment that has one.
    pub(super) fragments: BTreeMap<u32, BoxId>,
}

/// Builder of the boxes of a net.
pub(super) struct Boxes<'n> {
    net: &'n Net,
    place: &'n dyn Fn(Span) -> Option<Place>,
    tree: BoxTree,
    known: BTreeMap<(usize, Key), usize>,
    /// Scene of each fragment.
    scenes: Vec<usize>,
    /// Names of flows with other flows inside, by the scene of their fragment.
    calls: BTreeSet<(usize, String)>,
}

/// Beginning of the names of constants that are flows, such as `speed` in `speed = 1`. Each is a box of its own.
const CONSTANT: &str = "constant#";

/// Returns whether a node is a constant that is a flow.
pub(super) fn is_constant_flow(node: &Node) -> bool {
    node.origin.flow.is_none() && node.name.starts_with(CONSTANT)
}

/// Returns the name in its fragment of the flow to whose expression a node belongs, without the indices of its elements, and whether the
/// node is only a part of the expression.
pub(super) fn shown_name<'n>(net: &'n Net, node: &'n Node) -> (&'n str, bool) {
    if is_constant_flow(node) {
        return (&node.name, true);
    }
    let full = node.origin.flow.as_deref().unwrap_or(&node.name);
    let full = without_fragments(net, node.fragment, full);
    let named = full.split('#').next().unwrap_or(full);
    let last = node.name.rsplit('.').next().unwrap_or_default();
    let is_part = node.origin.flow.is_none() || named.len() < full.len() || last.contains('#');
    let without_index = named.split('[').next().unwrap_or(named);
    (without_index.trim_end_matches('.'), is_part)
}

/// Returns the name of a flow in its fragment. The names of flows that are only observed begin with those of the fragments.
fn without_fragments<'n>(net: &Net, fragment: FragmentId, full: &'n str) -> &'n str {
    let mut names = net.fragment_names(fragment).into_iter();
    let inside = names.try_fold(full, |rest, name| {
        rest.strip_prefix(name)?.strip_prefix('.')
    });
    inside.unwrap_or(full)
}

impl<'n> Boxes<'n> {
    pub(super) fn new(net: &'n Net, place: &'n dyn Fn(Span) -> Option<Place>) -> Boxes<'n> {
        let mut boxes = Boxes {
            net,
            place,
            tree: BoxTree {
                scenes: vec![Scene::default()],
                around: vec![None],
                fragments: BTreeMap::new(),
            },
            known: BTreeMap::new(),
            scenes: Vec::new(),
            calls: BTreeSet::new(),
        };
        // Parents come before their children.
        for id in net.fragment_ids() {
            let scene = boxes.fragment(id);
            boxes.scenes.push(scene);
        }
        for node in &net.nodes {
            let (name, _) = shown_name(net, node);
            let scene = boxes.scenes[node.fragment.index()];
            for (at, _) in name.match_indices('.').filter(|_| device(node).is_none()) {
                boxes.calls.insert((scene, name[..at].to_owned()));
            }
        }
        boxes
    }

    /// Adds the box of a fragment, if it has a name. Returns the scene of its flows.
    fn fragment(&mut self, id: FragmentId) -> usize {
        let fragment = self.net.fragment(id);
        let Some(parent) = fragment.parent else {
            return 0;
        };
        let scene = self.scenes[parent.index()];
        if !fragment.is_named() {
            return scene;
        }
        let made = GraphBox {
            fragment: Some(self.net.path(parent, &fragment.name)),
            place: (self.place)(fragment.origin.span),
            ..new_box(&fragment.name, BoxKind::Fragment)
        };
        let shape = self.get_or_add(scene, Key::Fragment(id.0), made);
        self.tree.fragments.insert(id.0, (scene, shape));
        self.inside((scene, shape))
    }

    fn get_or_add(&mut self, scene: usize, key: Key, made: GraphBox) -> usize {
        let boxes = &mut self.tree.scenes[scene].boxes;
        *self.known.entry((scene, key)).or_insert_with(|| {
            boxes.push(made);
            boxes.len() - 1
        })
    }

    /// Returns the scene inside a box, which is added if there is none.
    fn inside(&mut self, (scene, shape): BoxId) -> usize {
        let next = self.tree.scenes.len();
        let inner = *self.tree.scenes[scene].boxes[shape]
            .inner
            .get_or_insert(next);
        if inner == next {
            self.tree.scenes.push(Scene::default());
            self.tree.around.push(Some((scene, shape)));
        }
        inner
    }

    /// Returns the box of the flow to whose expression a node belongs.
    pub(super) fn leaf(&mut self, id: NodeId) -> BoxId {
        let node = self.net.node(id);
        let mut scene = self.scenes[node.fragment.index()];
        if let Some((name, kind)) = device(node) {
            let made = GraphBox {
                place: (self.place)(node.origin.span),
                ..new_box(&name, kind)
            };
            return (scene, self.get_or_add(scene, Key::Device(name), made));
        }
        let (name, is_part) = shown_name(self.net, node);
        let outer = scene;
        let mut start = 0;
        let ends = name.match_indices('.').map(|(at, _)| at);
        let ends: Vec<usize> = ends.chain([name.len()]).collect();
        for end in ends {
            let segment = name.get(start..end).unwrap_or(name);
            if self.calls.contains(&(outer, name[..end].to_owned())) {
                let made = GraphBox {
                    place: (self.place)(node.origin.span),
                    ..new_box(segment, BoxKind::Call)
                };
                let shape = self.get_or_add(scene, Key::Call(segment.to_owned()), made);
                scene = self.inside((scene, shape));
            }
            start = end + 1;
        }
        let last = name.rsplit('.').next().unwrap_or(name);
        let shape = self.get_or_add(
            scene,
            Key::Flow(last.to_owned()),
            new_box(last, BoxKind::Flow),
        );
        self.describe((scene, shape), node, (name, is_part));
        (scene, shape)
    }

    /// Sets flow and place of a box: those of the node that computes the flow, or of a part of its expression as long as no other is known.
    fn describe(&mut self, (scene, shape): BoxId, node: &Node, (name, is_part): (&str, bool)) {
        let place = self.place;
        let shown = &mut self.tree.scenes[scene].boxes[shape];
        if shown.place.is_none() || !is_part {
            shown.place = place(node.origin.span);
        }
        if !is_part {
            let names = self.net.fragment_names(node.fragment).into_iter();
            let names: Vec<&str> = names.chain([name]).collect();
            shown.flow = Some(names.join("."));
        }
    }

    /// Adds the box of a result, which is the one of its condition if this has no other name.
    pub(super) fn result(&mut self, fragment: FragmentId, name: &str, span: Span) -> BoxId {
        let scene = self.scenes[fragment.index()];
        let condition = self.known.get(&(scene, Key::Flow(name.to_owned())));
        let own = condition.copied().filter(|shape| {
            let shown = &self.tree.scenes[scene].boxes[*shape];
            shown.flow.is_none()
        });
        let made = new_box(name, BoxKind::Result);
        let key = Key::Result(name.to_owned());
        let shape = own.unwrap_or_else(|| self.get_or_add(scene, key, made));
        let place = (self.place)(span);
        let shown = &mut self.tree.scenes[scene].boxes[shape];
        shown.kind = BoxKind::Result;
        if place.is_some() {
            shown.place = place;
        }
        (scene, shape)
    }

    /// Adds the flows that a watched net exports to the boxes with their values. A box without a flow gets that of its name: primitives
    /// with several outputs have no flow of their own.
    pub(super) fn name_exports(&mut self, leaves: &[BoxId]) {
        for export in &self.net.exports {
            let Some(&(scene, shape)) = leaves.get(export.source.node.index()) else {
                continue;
            };
            // Flows inside of an unnamed call belong to the expression of another flow.
            if export.key.contains('#') {
                continue;
            }
            let place = self.place;
            let key = export.key.split('[').next().unwrap_or_default();
            let last = key.rsplit('.').next().unwrap_or(key);
            let shown = &mut self.tree.scenes[scene].boxes[shape];
            let is_own = last == shown.name || shown.name.starts_with(CONSTANT);
            if shown.flow.is_none() && shown.kind == BoxKind::Flow && is_own {
                shown.name = last.to_owned();
                shown.flow = Some(key.to_owned());
                shown.place = shown.place.take().or_else(|| place(export.origin.span));
            } else if shown.flow.as_deref() != Some(key)
                && !shown.other_flows.iter().any(|known| known == key)
                && !self.calls.contains(&(scene, key.to_owned()))
            {
                shown.other_flows.push(key.to_owned());
            }
        }
        for shown in self.tree.scenes.iter_mut().flat_map(|s| &mut s.boxes) {
            if shown.name.starts_with(CONSTANT) {
                shown.name = "constant".to_owned();
            }
        }
    }

    /// Marks the boxes that are only the condition of a fragment: they have the name of the fragment beside them.
    pub(super) fn name_conditions(&mut self) {
        for scene in &mut self.tree.scenes {
            let fragments: BTreeSet<String> = scene
                .boxes
                .iter()
                .filter(|b| b.kind == BoxKind::Fragment)
                .map(|b| b.name.clone())
                .collect();
            let boxes = scene.boxes.iter_mut();
            let unnamed = boxes.filter(|b| b.kind == BoxKind::Flow && b.flow.is_none());
            for shown in unnamed.filter(|b| fragments.contains(&b.name)) {
                shown.kind = BoxKind::Condition;
                shown.name = format!("when {}", shown.name);
            }
        }
    }

    pub(super) fn finish(self) -> BoxTree {
        self.tree
    }
}

/// Returns a box without a place.
pub(super) fn new_box(name: &str, kind: BoxKind) -> GraphBox {
    GraphBox {
        name: name.to_owned(),
        kind,
        flow: None,
        other_flows: Vec::new(),
        fragment: None,
        place: None,
        inner: None,
    }
}

/// Returns the name of the port of a device that a node reads or drives.
fn device(node: &Node) -> Option<(String, BoxKind)> {
    let kind = match node.desc().role {
        Role::Sensor(_) => BoxKind::Sensor,
        Role::Actuator(_) => BoxKind::Actuator,
        _ => return None,
    };
    let texts = node.params.iter().filter_map(|value| value.as_str());
    let texts: Vec<&str> = texts.filter(|text| !text.is_empty()).collect();
    Some((texts.join("."), kind))
}
