//! Fusion of two primitives if one feeds only the other, which saves one dispatch and one intermediate value.

use super::order::Writers;
use super::rename::drop_ops;
use crate::access::Access;
use crate::flat::{Flat, Op, ScopeId, Work, index};
use crate::slots::{Region, Slot};
use rpi_image::image::{End, Form, Signal};
use rpi_prims::{Clock, PrimId};
use rustc_hash::FxHashMap;
use std::sync::LazyLock;

/// Table of fusions: inner primitive, outer primitive, in-port of the outer one, fused primitive. The inputs of the
/// fused primitive are those of the outer one, with the inputs of the inner one in place of the connected in-port.
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

/// The table by outer primitive, in-port and inner primitive.
static BY_PARTS: LazyLock<FxHashMap<(PrimId, usize, PrimId), PrimId>> = LazyLock::new(|| {
    let row = |&(inner, outer, port, both): &(&str, &str, usize, &str)| {
        let id = PrimId::of;
        Some(((id(outer)?, port, id(inner)?), id(both)?))
    };
    FUSED.iter().filter_map(row).collect()
});

pub(super) fn fuse(flat: &mut Flat, _: Clock) {
    let writers = Writers::new(flat);
    let uses = uses(flat, &writers.order);
    let mut dropped = vec![false; flat.ops.len()];
    for &(number, scope) in &writers.order {
        let found = (0..2).find_map(|port| {
            let op = flat.ops[number as usize];
            let fed = fed(flat, op, port)?;
            let (_, inner, place) = writers.of(fed)?;
            let alone = uses[fed.index()] == 1 && place == scope && !dropped[inner as usize];
            let both = || both(flat, op, port, flat.ops[inner as usize]);
            Some((port, inner, alone.then(both)??))
        });
        if let Some((port, inner, both)) = found {
            join(flat, number, port, inner, both);
            dropped[inner as usize] = true;
        }
    }
    drop_ops(flat, &dropped);
}

/// The value at an in-port of an operation, if another operation computes it.
fn fed(flat: &Flat, op: Op, port: usize) -> Option<Slot> {
    let Work::Run(_, Form::Total) = op.work else {
        return None;
    };
    let slot = Slot(*flat.words(op).get(port)?);
    let value = flat.access(op, port) == Access::Read && flat.slots.region(slot) == Region::Value;
    value.then_some(slot)
}

fn both(flat: &Flat, outer: Op, port: usize, inner: Op) -> Option<PrimId> {
    let (Work::Run(outer, _), Work::Run(prim, Form::Total)) = (outer.work, inner.work) else {
        return None;
    };
    // All primitives in the table have one out-port, so the only written word of the inner one is the connected value.
    debug_assert!(flat.writes(inner).count() >= 1);
    BY_PARTS.get(&(outer, port, prim)).copied()
}

/// Replaces the outer operation by the fused one.
fn join(flat: &mut Flat, number: u32, port: usize, inner: u32, both: PrimId) {
    let (outer, inner) = (flat.ops[number as usize], flat.ops[inner as usize]);
    let inputs = flat.words(inner);
    let mut words = flat.words(outer).to_vec();
    words.splice(port..=port, inputs[..inputs.len() - 1].iter().copied());
    flat.shapes.of(both, Form::Total);
    let op = &mut flat.ops[number as usize];
    op.work = Work::Run(both, Form::Total);
    op.at = index(flat.words.len());
    op.len = index(words.len());
    flat.words.extend(words);
}

/// Number of readers of each register, of any kind.
fn uses(flat: &Flat, order: &[(u32, ScopeId)]) -> Vec<u32> {
    let mut uses = vec![0; flat.slots.len()];
    let mut count = |slot: Slot| uses[slot.index()] += 1;
    for (number, _) in order {
        flat.reads(flat.ops[*number as usize]).for_each(&mut count);
    }
    for scope in &flat.scopes {
        count(scope.guard);
        scope.reset.iter().for_each(|r| count(r.0));
        scope.latches.iter().for_each(|l| count(l.0));
    }
    let mut signal = |s: Signal| {
        count(Slot(s.at));
        count(Slot(s.present));
    };
    flat.tables.exports.iter().for_each(|e| signal(e.value));
    match &flat.tables.end {
        End::Results(results) => results.iter().for_each(|r| signal(r.condition)),
        End::Ports { terminate, fail } => terminate.iter().chain(fail).for_each(|s| signal(*s)),
    }
    uses
}
