//! Runs a net cycle by cycle and compares its outputs.

use crate::bench::{Bench, Node, Out, PERIOD, Slot};
use crate::compare_outputs::{ComparisonContext, compare_outputs};
use crate::report::Report;
use crate::text;
use crate::trace::Trace;
use rpi_image::{CommandFlow, Presence, Role};
use rpi_prims::differences;
use rpi_prims::{Context, CycleTime, NoDevices, RunFn};

/// History of a node besides its state.
#[derive(Default)]
struct NodeHistory {
    /// Value slots and presence of the input of a delay in the last active cycle.
    delayed: Option<Vec<u64>>,
    /// Whether an input was absent in some cycle. From then on, the states of the total and the optional form may
    /// differ.
    had_absence: bool,
    /// Whether the fragment was active in the last cycle.
    was_active: bool,
    /// Whether a value of this cycle may be that of an object that has changed since.
    aliased: bool,
}

/// Compares all nodes in all cycles.
pub(crate) fn run(id: &str, bench: Bench, trace: &Trace, report: &mut Report) {
    let Bench { mut cells, nodes } = bench;
    let mut past: Vec<NodeHistory> = nodes.iter().map(|_| NodeHistory::default()).collect();
    for cycle in 1..=trace.cycles {
        for out in nodes.iter().flat_map(|n| &n.outs) {
            load(&mut cells, out, trace, cycle);
        }
        let clock = clock(trace, cycle);
        for k in 0..nodes.len() {
            let (node, active) = (&nodes[k], active(&nodes[k], &cells));
            let reads_aliased = node.reads.iter().flatten().any(|&k| past[k].aliased);
            past[k].aliased = reads_aliased && differences::outputs_alias(node.prim.desc.name);
            if active && evaluate(node, &mut past[k], &mut cells, clock) {
                let around = ComparisonContext {
                    id,
                    cycle,
                    nodes: &nodes,
                    after_pause: cycle > 1 && !past[k].was_active,
                    reads_aliased,
                };
                past[k].aliased |= compare_outputs(&around, node, &mut cells, report);
            }
            past[k].was_active = active;
        }
        for (node, past) in nodes.iter().zip(&mut past) {
            if active(node, &cells) && node.prim.desc.role == Role::Delay {
                past.delayed = value(&cells, node.inputs[0]).map(<[u64]>::to_vec);
            }
        }
    }
}

fn clock(trace: &Trace, cycle: usize) -> CycleTime {
    let ms = trace.start_ms + 25 * (cycle as i64 - 1);
    CycleTime {
        dt: PERIOD,
        tick_ns: 25_000_000,
        period_ticks: 1,
        cycle_index: cycle as u64 - 1,
        net_ns: ms * 1_000_000,
        wall_ns: ms * 1_000_000,
    }
}

/// Writes the recorded value of a cycle to its slot.
fn load(cells: &mut [u64], out: &Out, trace: &Trace, cycle: usize) {
    let text = trace
        .ports
        .get(&out.name)
        .and_then(|values| values[cycle - 1].as_deref());
    let value = text.and_then(|t| text::cells(out.recorded.ty, t));
    let opaque = matches!(out.recorded.ty, rpi_image::Type::Matrix(..));
    cells[out.recorded.presence] = u64::from(text.is_some() && (opaque || value.is_some()));
    cells[out.recorded.presence + 1] = u64::from(text.is_some() && !opaque && value.is_none());
    if let Some(value) = value {
        cells[out.recorded.range()].copy_from_slice(&value);
    }
}

pub(crate) fn value(cells: &[u64], slot: Slot) -> Option<&[u64]> {
    (cells[slot.presence] != 0).then(|| &cells[slot.range()])
}

/// Returns whether a node is active. In the reference system, only an explicit false deactivates a fragment.
fn active(node: &Node, cells: &[u64]) -> bool {
    node.gates
        .iter()
        .all(|gate| value(cells, *gate) != Some(&[0]))
}

/// Computes the outputs of a node. Returns false if they come from outside.
fn evaluate(node: &Node, past: &mut NodeHistory, cells: &mut [u64], clock: CycleTime) -> bool {
    match node.prim.desc.role {
        Role::Compute => compute(node, past, cells, clock),
        Role::Constant => put(cells, node, Some(node.params[0].slots().to_vec())),
        Role::Delay => put(cells, node, past.delayed.clone()),
        Role::IsAbsent => {
            let absent = value(cells, node.inputs[0]).is_none();
            put(cells, node, Some(vec![u64::from(absent)]));
        }
        Role::Flow(CommandFlow::Period) => put(cells, node, Some(vec![clock.dt.to_bits()])),
        Role::Flow(CommandFlow::NetTime) => {
            put(cells, node, Some(vec![clock.net_ns.cast_unsigned()]))
        }
        _ => return false,
    }
    true
}

fn put(cells: &mut [u64], node: &Node, value: Option<Vec<u64>>) {
    let slot = node.outs[0].ours;
    cells[slot.presence] = u64::from(value.is_some());
    if let Some(value) = value {
        cells[slot.range()].copy_from_slice(&value);
    }
}

fn compute(node: &Node, past: &mut NodeHistory, cells: &mut [u64], clock: CycleTime) {
    let absent = node.inputs.iter().any(|slot| cells[slot.presence] == 0);
    past.had_absence |= absent;
    let strict = node
        .prim
        .desc
        .outputs
        .iter()
        .all(|o| o.presence == Presence::Strict);
    if strict {
        set_presence(node, cells, !absent);
        if !absent {
            call(node.prim.total, &node.total, cells, clock);
        }
        return;
    }
    call(node.prim.optional, &node.optional, cells, clock);
    if node.prim.total.is_some() && !past.had_absence {
        let optional: Vec<_> = node
            .outs
            .iter()
            .map(|o| cells[o.ours.range()].to_vec())
            .collect();
        call(node.prim.total, &node.total, cells, clock);
        for (out, optional) in node.outs.iter().zip(optional) {
            let name = node.prim.desc.name;
            assert_eq!(
                cells[out.ours.presence], 1,
                "{name}.{} is present with all inputs",
                out.port
            );
            assert_eq!(
                cells[out.ours.range()],
                optional,
                "{name}.{}: both forms agree",
                out.port
            );
        }
    }
}

fn set_presence(node: &Node, cells: &mut [u64], present: bool) {
    for out in &node.outs {
        cells[out.ours.presence] = u64::from(present);
    }
}

fn call(form: Option<RunFn>, words: &[u32], cells: &mut [u64], clock: CycleTime) {
    let form = form.expect("a form for this presence");
    let mut cx = Context {
        slots: cells,
        time: clock,
        devices: &mut NoDevices,
        fault: None,
    };
    rpi_testkit::no_alloc(|| form(&mut cx, words));
}
