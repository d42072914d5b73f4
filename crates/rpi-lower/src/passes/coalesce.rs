//! Coalescing: computes a value directly in the state of its delay, so that the copy at the end of the cycle is not
//! needed.
//!
//! A latch from x to s can be removed if x can be written to s at once. This is safe if all readers of the old content
//! of s run before the writer of x, and if x is computed in the scope of the latch.

use super::delays::read_outside_ops;
use super::substitution::Substitution;
use super::traversal::Writers;
use crate::access::Access;
use crate::flat_net::{FlatNet, Op, OpKind, ScopeId};
use crate::registers::{Region, Register};
use rpi_prims::CycleTime;

pub(super) fn coalesce(flat: &mut FlatNet, _: CycleTime) {
    let facts = AccessOrder::new(flat);
    let mut renames = Substitution::new(flat);
    let mut moved = vec![false; flat.registers.len()];
    for k in 0..flat.scopes.len() {
        let scope = ScopeId(k as u32);
        let latches = std::mem::take(&mut flat.scopes[k].latches);
        let kept = latches.into_iter().filter(|&(from, to)| {
            let is_merged = !moved[from.index()] && facts.can_coalesce(flat, scope, from, to);
            if is_merged {
                moved[from.index()] = true;
                renames.set(from, to);
            }
            !is_merged
        });
        flat.scopes[k].latches = kept.collect();
    }
    if !moved.contains(&true) {
        return;
    }
    redirect_writers(flat, &renames);
    renames.apply(flat);
}

/// Replaces the registers that operations write, so that an operation whose result a delay stores writes the state of
/// the delay directly.
fn redirect_writers(flat: &mut FlatNet, renames: &Substitution) {
    for number in 0..flat.ops.len() {
        let op = flat.ops[number];
        flat.replace(op, |a| a == Access::Write, |s| renames.get(s));
    }
}

/// Writer and last reader of each register, as positions in the order in which the operations run.
struct AccessOrder {
    writers: Writers,
    /// For each register, the position of the last operation that reads it; 0 if none does.
    last_read: Vec<u32>,
    read_late: Vec<bool>,
}

impl AccessOrder {
    fn new(flat: &FlatNet) -> Self {
        let mut facts = AccessOrder {
            writers: Writers::new(flat),
            last_read: vec![0; flat.registers.len()],
            read_late: read_outside_ops(flat),
        };
        for (place, (number, _)) in (0..).zip(&facts.writers.order) {
            for slot in flat.reads(flat.ops[*number as usize]) {
                facts.last_read[slot.index()] = place;
            }
        }
        facts
    }

    fn can_coalesce(&self, flat: &FlatNet, scope: ScopeId, from: Register, to: Register) -> bool {
        let Some((place, number, written_in)) = self.writers.writer_of(from) else {
            return false;
        };
        flat.registers.region(from) == Region::Value
            && written_in == scope
            && self.last_read[to.index()] <= place
            && !self.read_late[to.index()]
            && reads_before_writing(flat, flat.ops[number as usize])
    }
}

/// Returns true if the operation reads all inputs before it writes its output, and no fault is reported under its
/// output slot. Only then may it write a register that it also reads.
fn reads_before_writing(flat: &FlatNet, op: Op) -> bool {
    match op.kind {
        OpKind::Run(prim, _) => {
            let arrays = (0..op.len as usize).any(|k| flat.access(op, k) == Access::Number);
            !prim.desc().may_fault && !arrays
        }
        OpKind::Copy => true,
        OpKind::Actuate(..) | OpKind::Call(..) => false,
    }
}
