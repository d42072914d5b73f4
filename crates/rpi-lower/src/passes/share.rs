//! Common subexpression elimination.
//!
//! Two stateless operations are equal if they do the same with the same registers. The earlier one replaces the later
//! one if it runs whenever the later one does, which holds if its scope encloses that of the later one.

use super::order::{encloses, ops};
use super::rename::{Renames, drop_ops};
use crate::access::Access;
use crate::flat::{Flat, Op, ScopeId, Work};
use hashbrown::hash_table::{Entry, HashTable};
use rpi_image::State;
use rpi_prims::Clock;
use rustc_hash::FxHasher;
use std::hash::{Hash, Hasher};

pub(super) fn share(flat: &mut Flat, _: Clock) {
    let mut renames = Renames::new(flat);
    let mut dropped = vec![false; flat.ops.len()];
    let mut known = Known::new(flat);
    for (number, scope) in ops(flat) {
        renames.reads(flat, number);
        let op = flat.ops[number as usize];
        if !is_pure(op) {
            continue;
        }
        if let Some(earlier) = known.earlier(flat, number, scope) {
            let given = flat.writes(flat.ops[earlier as usize]);
            for (mine, other) in flat.writes(op).zip(given) {
                renames.set(mine, other);
            }
            dropped[number as usize] = true;
        }
    }
    // Operations run after those whose results they read, so their own reads are already renamed.
    renames.apply_outside(flat);
    drop_ops(flat, &dropped);
}

const NONE: u32 = u32::MAX;

/// Operations visited so far, hashed by kind and inputs. Equal operations in scopes that do not enclose each other form
/// a chain.
struct Known {
    first: HashTable<u32>,
    next: Vec<u32>,
    scope: Vec<ScopeId>,
}

impl Known {
    fn new(flat: &Flat) -> Self {
        Known {
            first: HashTable::with_capacity(flat.ops.len()),
            next: vec![NONE; flat.ops.len()],
            scope: vec![ScopeId::ROOT; flat.ops.len()],
        }
    }

    /// An equal operation that runs whenever this one does. If there is none, enters this operation into the table.
    fn earlier(&mut self, flat: &Flat, number: u32, scope: ScopeId) -> Option<u32> {
        let op = |number: u32| flat.ops[number as usize];
        self.scope[number as usize] = scope;
        let entry = self.first.entry(
            hash(flat, op(number)),
            |other| same(flat, op(*other), op(number)),
            |other| hash(flat, op(*other)),
        );
        let mut at = match entry {
            Entry::Vacant(free) => {
                free.insert(number);
                return None;
            }
            Entry::Occupied(first) => *first.get(),
        };
        loop {
            if encloses(flat, self.scope[at as usize], scope) {
                return Some(at);
            }
            match self.next[at as usize] {
                NONE => {
                    self.next[at as usize] = number;
                    return None;
                }
                next => at = next,
            }
        }
    }
}

fn hash(flat: &Flat, op: Op) -> u64 {
    let mut hasher = FxHasher::default();
    op.work.hash(&mut hasher);
    inputs(flat, op).for_each(|word| hasher.write_u32(word));
    hasher.finish()
}

fn same(flat: &Flat, a: Op, b: Op) -> bool {
    a.work == b.work && inputs(flat, a).eq(inputs(flat, b))
}

/// Words that determine the result: all but the written ones.
fn inputs(flat: &Flat, op: Op) -> impl Iterator<Item = u32> + '_ {
    let shape = flat.shapes.shape(op);
    let words = flat.words(op).iter().enumerate();
    let read = words.filter(move |(k, _)| shape.access(*k) != Access::Write);
    read.map(|(_, word)| *word)
}

/// True for operations without state and devices. Equal inputs give equal outputs within a cycle, including faults.
fn is_pure(op: Op) -> bool {
    match op.work {
        Work::Run(prim, _) => matches!(prim.desc().state, State::None),
        Work::Copy => true,
        Work::Actuate(..) | Work::Call(..) => false,
    }
}
