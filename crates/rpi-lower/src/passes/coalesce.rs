//! Coalescing: computes a value directly in the state of its delay, so that the copy at the end of the cycle is not
//! needed.
//!
//! A latch from x to s can be removed if x can be written to s at once. This is safe if all readers of the old content
//! of s run before the writer of x, and if x is computed in the scope of the latch.

use super::delays::read_late;
use super::order::Writers;
use super::rename::Renames;
use crate::access::Access;
use crate::flat::{Flat, Op, ScopeId, Work};
use crate::slots::{Region, Slot};
use rpi_prims::Clock;

pub(super) fn coalesce(flat: &mut Flat, _: Clock) {
    let facts = Facts::new(flat);
    let mut renames = Renames::new(flat);
    let mut moved = vec![false; flat.slots.len()];
    for k in 0..flat.scopes.len() {
        let scope = ScopeId(k as u32);
        let latches = std::mem::take(&mut flat.scopes[k].latches);
        let kept = latches.into_iter().filter(|&(from, to)| {
            let fits = !moved[from.index()] && facts.fits(flat, scope, from, to);
            if fits {
                moved[from.index()] = true;
                renames.set(from, to);
            }
            !fits
        });
        flat.scopes[k].latches = kept.collect();
    }
    if !moved.contains(&true) {
        return;
    }
    writes(flat, &renames);
    renames.apply(flat);
}

/// Redirects the writers of coalesced registers.
fn writes(flat: &mut Flat, renames: &Renames) {
    for number in 0..flat.ops.len() {
        let op = flat.ops[number];
        flat.replace(op, |a| a == Access::Write, |s| renames.get(s));
    }
}

/// Writer and last reader of each register, in execution order.
struct Facts {
    writers: Writers,
    /// For each register, the position of its last reader.
    last_read: Vec<u32>,
    read_late: Vec<bool>,
}

impl Facts {
    fn new(flat: &Flat) -> Self {
        let mut facts = Facts {
            writers: Writers::new(flat),
            last_read: vec![0; flat.slots.len()],
            read_late: read_late(flat),
        };
        for (place, (number, _)) in (0..).zip(&facts.writers.order) {
            for slot in flat.reads(flat.ops[*number as usize]) {
                facts.last_read[slot.index()] = place;
            }
        }
        facts
    }

    fn fits(&self, flat: &Flat, scope: ScopeId, from: Slot, to: Slot) -> bool {
        let Some((place, number, written_in)) = self.writers.of(from) else {
            return false;
        };
        flat.slots.region(from) == Region::Value
            && written_in == scope
            && self.last_read[to.index()] <= place
            && !self.read_late[to.index()]
            && writes_at_the_end(flat, flat.ops[number as usize])
    }
}

/// True if the operation reads all inputs before it writes and its faults are not identified by its output slot.
fn writes_at_the_end(flat: &Flat, op: Op) -> bool {
    match op.work {
        Work::Run(prim, _) => {
            let arrays = (0..op.len as usize).any(|k| flat.access(op, k) == Access::Number);
            !prim.desc().may_fault && !arrays
        }
        Work::Copy => true,
        Work::Actuate(..) | Work::Call(..) => false,
    }
}
