//! Dependencies between nodes: order of evaluation, and sources behind an in-port.

use crate::bench::{Node, Slot};
use crate::net;
use rpi_prims::differences;
use std::collections::{HashMap, HashSet};

/// Returns the primitives with sources before their readers. The source of a delay may come later.
pub(crate) fn in_order(prims: &[net::Prim]) -> Vec<&net::Prim> {
    let index: HashMap<&str, &net::Prim> = prims.iter().map(|p| (p.path.as_str(), p)).collect();
    let mut order = Vec::new();
    let mut seen = HashSet::new();
    for prim in prims {
        visit(prim, &index, &mut seen, &mut order);
    }
    order
}

fn visit<'a>(
    prim: &'a net::Prim,
    index: &HashMap<&str, &'a net::Prim>,
    seen: &mut HashSet<&'a str>,
    order: &mut Vec<&'a net::Prim>,
) {
    if !seen.insert(&prim.path) {
        return;
    }
    let sources = prim
        .inputs
        .iter()
        .map(|(_, source)| source)
        .chain(&prim.gates);
    for source in sources {
        let path = source.rsplit_once('.').map_or("", |(path, _)| path);
        let delayed = prim.ty.ends_with("Pre");
        if let Some(before) = index.get(path).filter(|_| !delayed) {
            visit(before, index, seen, order);
        }
    }
    order.push(prim);
}

/// Determines the node that each in-port reads.
pub(crate) fn connect_reads(nodes: &mut [Node]) {
    let ports = nodes
        .iter()
        .enumerate()
        .flat_map(|(k, n)| n.outs.iter().map(move |o| (o.name.clone(), k)));
    let owner: HashMap<String, usize> = ports.collect();
    for node in nodes {
        let reads = node.sources.iter().map(|s| s.as_ref().map(|s| owner[s]));
        node.reads = reads.collect();
    }
}

/// Returns the recorded out-ports behind the first in-port of a node.
pub(crate) fn origins(nodes: &[Node], node: usize) -> Vec<Slot> {
    let Some(first) = nodes[node].outs.first() else {
        return Vec::new();
    };
    let mut found = Vec::new();
    let mut seen = vec![false; nodes.len()];
    let mut open: Vec<(usize, usize)> = vec![(node, 0)];
    while let Some((reader, port)) = open.pop() {
        let (Some(Some(source)), Some(Some(name))) = (
            nodes[reader].reads.get(port),
            nodes[reader].sources.get(port),
        ) else {
            continue;
        };
        let out = nodes[*source]
            .outs
            .iter()
            .find(|o| o.name == *name)
            .expect("a port of it");
        if out.recorded.ty == first.recorded.ty {
            found.push(out.recorded);
        }
        if differences::outputs_alias(nodes[*source].prim.desc.name)
            && !std::mem::replace(&mut seen[*source], true)
        {
            open.extend((0..nodes[*source].reads.len()).map(|port| (*source, port)));
        }
    }
    found
}
