//! Equal expressions are computed once.
//!
//! Two operations without state are equal if they do the same on the same slots. The earlier one serves for both if it
//! runs whenever the later one does: if its scope encloses that of the later.

use super::order::{encloses, ops};
use super::rename::{Renames, drop_ops};
use crate::access::Access;
use crate::flat::{Flat, Op, ScopeId, Work};
use rpi_image::State;
use std::collections::HashMap;

/// What is computed from what.
type Key = (Work, Vec<u32>);

pub(super) fn share(flat: &mut Flat, _: f64) {
    let mut renames = Renames::new(flat);
    let mut dropped = vec![false; flat.ops.len()];
    let mut known: HashMap<Key, Vec<(u32, ScopeId)>> = HashMap::new();
    for (number, scope) in ops(flat) {
        renames.reads(flat, number);
        let op = flat.ops[number as usize];
        if !is_pure(op) {
            continue;
        }
        let same = known.entry((op.work, inputs(flat, op))).or_default();
        let earlier = same.iter().find(|(_, at)| encloses(flat, *at, scope));
        if let Some(&(earlier, _)) = earlier {
            let given: Vec<_> = flat.writes(flat.ops[earlier as usize]).collect();
            for (mine, other) in flat.writes(op).zip(given) {
                renames.set(mine, other);
            }
            dropped[number as usize] = true;
        } else {
            same.push((number, scope));
        }
    }
    renames.apply(flat);
    drop_ops(flat, &dropped);
}

/// Words that tell what comes out: all but those that are written.
fn inputs(flat: &Flat, op: Op) -> Vec<u32> {
    let words = flat.words(op).iter().enumerate();
    let read = words.filter(|(k, _)| flat.access(op, *k) != Access::Write);
    read.map(|(_, word)| *word).collect()
}

/// No state, no device; the same inputs give the same outputs within a cycle, faults included.
fn is_pure(op: Op) -> bool {
    match op.work {
        Work::Run(prim, _) => matches!(prim.desc().state, State::None),
        Work::Copy => true,
        Work::Actuate(..) | Work::Call(..) => false,
    }
}
