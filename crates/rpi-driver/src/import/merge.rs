//! Merging of several writers of one port into one that takes the first present value (M9).
//!
//! In a program an actuator is defined once, and alternatives are merged with `??`. A net of the reference system has
//! one writer in each fragment that may move an arm; writers that are not proved mutually exclusive are merged. The
//! response to a writer stays present for its readers exactly in the cycles in which its value is present. Writers
//! cannot be merged if the response is needed within the cycle to compute the values.

use std::collections::{BTreeMap, BTreeSet};

use rpi_diag::Span;
use rpi_image::{PortType, Scalar, Type, Value};
use rpi_net::fragment_tree::FragmentTree;
use rpi_net::passes::writers::Resource;
use rpi_net::passes::{Analysis, analyse};
use rpi_net::{FragmentId, Input, Inputs, Net, Node, NodeId, Origin, PortRef};
use rpi_prims::{PrimId, registry};

use super::links;

/// Imported net in which each actuator port has one writer: several writers of the original net are merged into one
/// that takes the first present value.
pub(super) struct MergedNet {
    pub(super) net: Net,
    /// For each node of the merged net the corresponding node of the original net; `None` for a new node.
    pub(super) original: Vec<Option<NodeId>>,
    /// Nodes that were added by the merge and select the first present value of several writers.
    pub(super) selectors: BTreeSet<NodeId>,
}

/// Nodes that write the same actuator port and may be active in the same cycle, with the flows that they write.
struct WriterGroup {
    resource: Resource,
    writers: Vec<NodeId>,
    scalar: Scalar,
    values: Vec<PortRef>,
}

/// Returns the net with its writers merged where several may write an actuator in the same cycle and merging is
/// possible. If merging all groups causes a dependency cycle, only the groups that can be merged alone are merged.
pub(super) fn merge_writers(net: &Net) -> MergedNet {
    let Ok(analysis) = analyse(net.clone(), |_| false) else {
        return unchanged(net);
    };
    let groups = groups(&analysis);
    let all = merge(net, &analysis.tree, &groups);
    if is_sound(&all.net) {
        return all;
    }
    let alone = |group: &WriterGroup| {
        let merged = merge(net, &analysis.tree, std::slice::from_ref(group));
        is_sound(&merged.net)
    };
    let sound: Vec<WriterGroup> = groups.into_iter().filter(|group| alone(group)).collect();
    let some = merge(net, &analysis.tree, &sound);
    match is_sound(&some.net) {
        true => some,
        false => unchanged(net),
    }
}

fn is_sound(net: &Net) -> bool {
    analyse(net.clone(), |_| false).is_ok_and(|analysis| analysis.schedule.is_some())
}

fn unchanged(net: &Net) -> MergedNet {
    MergedNet {
        net: net.clone(),
        original: net.node_ids().map(Some).collect(),
        selectors: BTreeSet::new(),
    }
}

fn groups(analysis: &Analysis) -> Vec<WriterGroup> {
    let meeting: BTreeSet<NodeId> = analysis.writers.unproved().flatten().collect();
    let several = analysis.writers.by_resource.iter().filter(|(_, writers)| {
        let meet = writers.iter().filter(|w| meeting.contains(w));
        meet.count() > 1
    });
    several
        .filter_map(|(resource, writers)| group(&analysis.net, resource, writers))
        .collect()
}

/// Returns the writers of an actuator port as a group; `None` if they differ in more than the written flow, or do not
/// write a flow of a scalar type.
fn group(net: &Net, resource: &Resource, writers: &[NodeId]) -> Option<WriterGroup> {
    let first = net.node(*writers.first()?);
    let [port] = first.desc().inputs else {
        return None;
    };
    let PortType::Scalar(scalar) = port.ty else {
        return None;
    };
    let same =
        |id: &NodeId| (net.node(*id).prim, &net.node(*id).params) == (first.prim, &first.params);
    let values = writers.iter().map(|id| net.node(*id).inputs[0].port());
    Some(WriterGroup {
        resource: resource.clone(),
        scalar,
        values: values.collect::<Option<Vec<PortRef>>>()?,
        writers: writers.iter().copied().filter(same).collect(),
    })
    .filter(|group| group.writers.len() == group.values.len())
}

fn merge(net: &Net, tree: &FragmentTree, groups: &[WriterGroup]) -> MergedNet {
    let count = net.nodes.len();
    let mut merger = Merger {
        net: net.clone(),
        choices: BTreeSet::new(),
        answers: BTreeMap::new(),
    };
    let mut read = BTreeSet::new();
    links::for_each_link(&mut merger.net, &mut |port, _| {
        read.insert(*port);
    });
    for group in groups {
        merger.group(tree, group, &read);
    }
    let Merger {
        mut net,
        choices,
        answers,
    } = merger;
    links::for_each_link(&mut net, &mut |port, _| {
        *port = answers.get(port).copied().unwrap_or(*port);
    });
    let dead = groups.iter().flat_map(|group| &group.writers).copied();
    let mut merged = remove_nodes(net, &dead.collect(), choices);
    let is_old = |id: &NodeId| id.index() < count;
    merged
        .original
        .iter_mut()
        .for_each(|id| *id = id.filter(is_old));
    merged
}

struct Merger {
    net: Net,
    choices: BTreeSet<NodeId>,
    /// New source for each response port of a replaced writer (such as an error code), from which its readers read.
    answers: BTreeMap<PortRef, PortRef>,
}

impl Merger {
    fn group(
        &mut self,
        tree: &FragmentTree,
        group: &WriterGroup,
        read: &BTreeSet<PortRef>,
    ) -> Option<()> {
        let places = group.writers.iter().map(|id| self.net.node(*id).fragment);
        let at = places.reduce(|a, b| tree.common_ancestor(a, b))?;
        let writer = self.net.node(*group.writers.first()?).clone();
        let value = self.select_first(group, at)?;
        let Resource {
            device,
            port,
            index,
        } = &group.resource;
        let node = self.net.add_node(Node {
            name: format!("{device}_{port}_{index}"),
            fragment: at,
            inputs: Inputs::from_iter([Input::Port(value)]),
            ..writer
        });
        for (writer, value) in group.writers.iter().zip(&group.values) {
            self.redirect_responses(*writer, *value, (node, at), group.scalar, read)?;
        }
        Some(())
    }

    /// Adds nodes to the fragment `at` that select the first present value of a group of writers, and returns their
    /// output.
    fn select_first(&mut self, group: &WriterGroup, at: FragmentId) -> Option<PortRef> {
        let coalesce = primitive_for("Coalesce", group.scalar)?;
        let mut values = group.values.iter().rev();
        let mut chosen = *values.next()?;
        for value in values {
            let inputs = [*value, chosen].map(Input::Port);
            chosen = self.add("first", coalesce, inputs.into(), at, group.scalar);
            self.choices.insert(chosen.node);
        }
        Some(chosen)
    }

    /// Replaces the responses to one writer by those of the merged writer `common`. They are present in the cycles in
    /// which the value of the original writer is present. Returns `None` if a primitive for this is missing.
    fn redirect_responses(
        &mut self,
        writer: NodeId,
        value: PortRef,
        (common, at): (NodeId, FragmentId),
        scalar: Scalar,
        read: &BTreeSet<PortRef>,
    ) -> Option<()> {
        let (name, desc) = (
            self.net.node(writer).name.clone(),
            self.net.node(writer).desc(),
        );
        let mut absent = None;
        for (port, out) in (0..).zip(desc.outputs) {
            let old = PortRef { node: writer, port };
            let PortType::Scalar(ty) = out.ty else {
                continue;
            };
            if !read.contains(&old) {
                continue;
            }
            let absent = match absent {
                Some(absent) => absent,
                None => {
                    let prim = primitive_for("IsNull", scalar)?;
                    let name = format!("{name}_off");
                    *absent.insert(self.add(
                        &name,
                        prim,
                        vec![Input::Port(value)],
                        at,
                        Scalar::Bool,
                    ))
                }
            };
            let answer = PortRef { node: common, port };
            let inputs = [answer, absent].map(Input::Port).into();
            let name = format!("{name}_{}", out.name.trim_start_matches("out"));
            let guarded = self.add(&name, primitive_for("SetNull", ty)?, inputs, at, ty);
            self.answers.insert(old, guarded);
        }
        Some(())
    }

    fn add(
        &mut self,
        name: &str,
        prim: PrimId,
        inputs: Vec<Input>,
        at: FragmentId,
        ty: Scalar,
    ) -> PortRef {
        let defaults = prim.desc().params.iter();
        let defaults = defaults.filter_map(|p| p.default.value(Type::Scalar(Scalar::Bool)));
        let node = self.net.add_node(Node {
            name: name.to_owned(),
            prim,
            fragment: at,
            inputs: inputs.into(),
            params: defaults.collect::<Vec<Value>>(),
            outputs: [Type::Scalar(ty)].into_iter().collect(),
            origin: Origin {
                span: Span::NONE,
                flow: None,
            },
        });
        PortRef { node, port: 0 }
    }
}

/// Returns the primitive with a name that ends in `operation` for values of a scalar type; `None` if there is none.
fn primitive_for(operation: &str, scalar: Scalar) -> Option<PrimId> {
    let takes = |port: &rpi_image::InPort| port.ty == PortType::Scalar(scalar);
    let mut prims = registry().iter();
    let prim = prims.find(|prim| {
        prim.desc.name.ends_with(operation) && prim.desc.inputs.first().is_some_and(takes)
    })?;
    PrimId::from_name(prim.desc.name)
}

/// Removes the nodes `dead`, which nothing reads any more, and renumbers the others. `choices` are the nodes that
/// select the first present value.
fn remove_nodes(mut net: Net, dead: &BTreeSet<NodeId>, choices: BTreeSet<NodeId>) -> MergedNet {
    let kept: Vec<NodeId> = net.node_ids().filter(|id| !dead.contains(id)).collect();
    let mut now = vec![NodeId(u32::MAX); net.nodes.len()];
    for (new, old) in (0..).zip(&kept) {
        now[old.index()] = NodeId(new);
    }
    links::for_each_link(&mut net, &mut |port, _| port.node = now[port.node.index()]);
    let mut ids = net.node_ids();
    net.nodes
        .retain(|_| ids.next().is_some_and(|id| !dead.contains(&id)));
    MergedNet {
        net,
        original: kept.into_iter().map(Some).collect(),
        selectors: choices.into_iter().map(|id| now[id.index()]).collect(),
    }
}
