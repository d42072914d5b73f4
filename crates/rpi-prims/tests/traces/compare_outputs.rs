//! Comparison of the outputs of a node with the recorded ones.

use crate::bench::{Node, Out, PERIOD, Slot};
use crate::compare;
use crate::report::Report;
use crate::run::value;
use rpi_prims::differences::{self, Condition, Difference, DifferenceCase, Recorded};

/// Context of a comparison.
pub(crate) struct ComparisonContext<'a> {
    pub(crate) id: &'a str,
    pub(crate) cycle: usize,
    pub(crate) nodes: &'a [Node],
    pub(crate) after_pause: bool,
    pub(crate) reads_aliased: bool,
}

/// Compares the outputs of a node with the recorded ones and counts the results. Returns whether an output is explained
/// by an aliased object.
pub(crate) fn compare_outputs(
    around: &ComparisonContext<'_>,
    node: &Node,
    cells: &mut [u64],
    report: &mut Report,
) -> bool {
    let name = node.prim.desc.name;
    let mut aliased = false;
    for (port, out) in node.outs.iter().enumerate() {
        if matches!(out.ours.ty, rpi_image::Type::Matrix(..)) {
            let ours = cells[out.ours.range()].to_vec();
            cells[out.recorded.range()].copy_from_slice(&ours);
        }
        let same = equal(node, out, cells);
        let why = if same {
            None
        } else {
            explain(around, node, port, cells)
        };
        aliased |= why.is_some_and(|d| matches!(d.condition, Condition::AliasedSource));
        if let Some(why) = why {
            report.explain(why.name);
        }
        let count = report.count(name, out.port);
        count.compared += 1;
        count.explained += u64::from(why.is_some());
        if !same && why.is_none() {
            count.differing += 1;
            count
                .first
                .get_or_insert_with(|| message(around, out, cells));
        }
    }
    aliased
}

fn message(around: &ComparisonContext<'_>, out: &Out, cells: &[u64]) -> String {
    let (ours, theirs) = (value(cells, out.ours), value(cells, out.recorded));
    let (id, cycle) = (around.id, around.cycle);
    format!(
        "{id} {} cycle {cycle}: ours {} recorded {}",
        out.name,
        show(ours),
        show(theirs)
    )
}

fn equal(node: &Node, out: &Out, cells: &[u64]) -> bool {
    match (value(cells, out.ours), recorded(cells, out.recorded)) {
        (None, Recorded::Absent) => true,
        (Some(a), Recorded::Value(b)) => compare::equal(out.ours.ty, a, b) || angles(node, cells),
        _ => false,
    }
}

fn recorded(cells: &[u64], slot: Slot) -> Recorded<'_> {
    match value(cells, slot) {
        Some(value) => Recorded::Value(value),
        None if cells[slot.presence + 1] != 0 => Recorded::Other,
        None => Recorded::Absent,
    }
}

fn explain(
    around: &ComparisonContext<'_>,
    node: &Node,
    port: usize,
    cells: &[u64],
) -> Option<&'static Difference> {
    let out = &node.outs[port];
    let inputs: Vec<_> = node.inputs.iter().map(|slot| value(cells, *slot)).collect();
    let name = |k: &Option<usize>| k.map(|k| around.nodes[k].prim.desc.name);
    let sources: Vec<_> = node.reads.iter().map(name).collect();
    let origins: Vec<_> = node
        .origins
        .iter()
        .filter_map(|slot| value(cells, *slot))
        .collect();
    let case = DifferenceCase {
        desc: &node.prim.desc,
        port,
        dt: PERIOD,
        inputs: &inputs,
        sources: &sources,
        origins: &origins,
        params: &node.params,
        computed: value(cells, out.ours),
        recorded: recorded(cells, out.recorded),
        after_pause: around.after_pause,
        reads_aliased: around.reads_aliased,
    };
    differences::explain(&case, |a, b| compare::equal(out.ours.ty, a, b))
}

/// Returns whether Euler angles are equal modulo full turns.
fn angles(node: &Node, cells: &[u64]) -> bool {
    if node.prim.desc.name != "World::RotationToABC" {
        return false;
    }
    let read =
        |slot: fn(&Out) -> Slot| [0, 1, 2].map(|k| f64::from_bits(cells[slot(&node.outs[k]).at]));
    compare::euler(read(|o| o.ours), read(|o| o.recorded))
}

fn show(value: Option<&[u64]>) -> String {
    value.map_or_else(
        || "absent".into(),
        |cells| {
            cells
                .iter()
                .map(|c| {
                    if *c < 1 << 20 {
                        c.to_string()
                    } else {
                        f64::from_bits(*c).to_string()
                    }
                })
                .collect::<Vec<_>>()
                .join(" ")
        },
    )
}
