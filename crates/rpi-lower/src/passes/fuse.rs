//! Fusion of two primitives if one feeds only the other, which saves one dispatch and one intermediate value.

use super::substitution::drop_ops;
use super::traversal::Writers;
use crate::access::Access;
use crate::flat_net::{FlatNet, Op, OpKind, ScopeId, index};
use crate::registers::{Region, Register};
use rpi_image::image::{CommandEnd, Form, Signal};
use rpi_prims::{CycleTime, PrimId};
use rustc_hash::FxHashMap;
use std::sync::LazyLock;

/// Pairs of primitives that can be fused: inner primitive, outer primitive, index of the outer one's in-port that reads
/// the inner one's result, fused primitive. The inputs of the fused primitive are those of the outer one, with the
/// inputs of the inner one in place of that in-port.
const FUSED: &[(&str, &str, usize, &str)] = &[
    (
        "Core::DoubleMultiply",
        "Core::DoubleAdd",
        0,
        "Rpi::FusedProductPlus",
    ),
    (
        "Core::DoubleMultiply",
        "Core::DoubleAdd",
        1,
        "Rpi::FusedPlusProduct",
    ),
    (
        "Core::DoubleMultiply",
        "Rpi::DoubleSubtract",
        0,
        "Rpi::FusedProductMinus",
    ),
    (
        "Core::DoubleMultiply",
        "Rpi::DoubleSubtract",
        1,
        "Rpi::FusedMinusProduct",
    ),
    (
        "Core::DoubleGreater",
        "Core::DoubleConditional",
        0,
        "Rpi::FusedGreaterChoice",
    ),
    (
        "Core::DoubleAdd",
        "Core::DoubleMultiply",
        0,
        "Rpi::FusedSumTimes",
    ),
    (
        "Core::DoubleAdd",
        "Core::DoubleMultiply",
        1,
        "Rpi::FusedTimesSum",
    ),
];

/// Map from (outer primitive, in-port, inner primitive) to the fused primitive, with the rows of [`FUSED`].
static BY_PARTS: LazyLock<FxHashMap<(PrimId, usize, PrimId), PrimId>> = LazyLock::new(|| {
    let row = |&(inner, outer, port, both): &(&str, &str, usize, &str)| {
        let id = PrimId::from_name;
        Some(((id(outer)?, port, id(inner)?), id(both)?))
    };
    FUSED.iter().filter_map(row).collect()
});

pub(super) fn fuse(flat: &mut FlatNet, _: CycleTime) {
    let writers = Writers::new(flat);
    let uses = read_counts(flat, &writers.order);
    let mut dropped = vec![false; flat.ops.len()];
    for &(number, scope) in &writers.order {
        let found = (0..2).find_map(|port| {
            let op = flat.ops[number as usize];
            let fed = computed_input(flat, op, port)?;
            let (_, inner, place) = writers.writer_of(fed)?;
            let alone = uses[fed.index()] == 1 && place == scope && !dropped[inner as usize];
            let both = || fused_primitive(flat, op, port, flat.ops[inner as usize]);
            Some((port, inner, alone.then(both)??))
        });
        if let Some((port, inner, both)) = found {
            replace_by_fused(flat, number, port, inner, both);
            dropped[inner as usize] = true;
        }
    }
    drop_ops(flat, &dropped);
}

/// Returns the register at an in-port of an operation, if it is neither a constant nor state nor set from outside, so
/// that another operation computes it; else `None`.
fn computed_input(flat: &FlatNet, op: Op, port: usize) -> Option<Register> {
    let OpKind::Run(_, Form::Total) = op.kind else {
        return None;
    };
    let slot = Register(*flat.words(op).get(port)?);
    let value =
        flat.access(op, port) == Access::Read && flat.registers.region(slot) == Region::Value;
    value.then_some(slot)
}

fn fused_primitive(flat: &FlatNet, outer: Op, port: usize, inner: Op) -> Option<PrimId> {
    let (OpKind::Run(outer, _), OpKind::Run(prim, Form::Total)) = (outer.kind, inner.kind) else {
        return None;
    };
    // All primitives in the table have one out-port, so the only written word of the inner one is the connected value.
    debug_assert!(flat.writes(inner).count() >= 1);
    BY_PARTS.get(&(outer, port, prim)).copied()
}

/// Replaces the operation with index `number` by the fused primitive `both`, which also computes the operation with
/// index `inner`, whose result was read at in-port `port`.
fn replace_by_fused(flat: &mut FlatNet, number: u32, port: usize, inner: u32, both: PrimId) {
    let (outer, inner) = (flat.ops[number as usize], flat.ops[inner as usize]);
    let inputs = flat.words(inner);
    let mut words = flat.words(outer).to_vec();
    words.splice(port..=port, inputs[..inputs.len() - 1].iter().copied());
    flat.accesses.get_or_compute(both, Form::Total);
    let op = &mut flat.ops[number as usize];
    op.kind = OpKind::Run(both, Form::Total);
    op.at = index(flat.words.len());
    op.len = index(words.len());
    flat.words.extend(words);
}

/// Returns the number of readers of each register: operations in `order`, guards, resets, copies for the next cycle,
/// exports and end conditions.
fn read_counts(flat: &FlatNet, order: &[(u32, ScopeId)]) -> Vec<u32> {
    let mut uses = vec![0; flat.registers.len()];
    let mut count = |slot: Register| uses[slot.index()] += 1;
    for (number, _) in order {
        flat.reads(flat.ops[*number as usize]).for_each(&mut count);
    }
    for scope in &flat.scopes {
        count(scope.guard);
        scope.reset.iter().for_each(|r| count(r.0));
        scope.latches.iter().for_each(|l| count(l.0));
    }
    let mut signal = |s: Signal| {
        count(Register(s.start));
        count(Register(s.present));
    };
    flat.tables.exports.iter().for_each(|e| signal(e.value));
    match &flat.tables.end {
        CommandEnd::Results(results) => results.iter().for_each(|r| signal(r.condition)),
        CommandEnd::Ports { terminate, fail } => {
            terminate.iter().chain(fail).for_each(|s| signal(*s))
        }
    }
    uses
}
