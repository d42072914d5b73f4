//! Common subexpression elimination.
//!
//! Two stateless operations are equal if they do the same with the same registers. The earlier one replaces the later
//! one if it runs whenever the later one does, which holds if its scope encloses that of the later one.

use super::substitution::{Substitution, drop_ops};
use super::traversal::{encloses, ops_in_order};
use crate::access::Access;
use crate::flat_net::{FlatNet, Op, OpKind, ScopeId};
use hashbrown::hash_table::{Entry, HashTable};
use rpi_image::StateSize;
use rpi_prims::CycleTime;
use rustc_hash::FxHasher;
use std::hash::{Hash, Hasher};

pub(super) fn eliminate(flat: &mut FlatNet, _: CycleTime) {
    let mut renames = Substitution::new(flat);
    let mut dropped = vec![false; flat.ops.len()];
    let mut known = VisitedOps::new(flat);
    for (number, scope) in ops_in_order(flat) {
        renames.apply_to_op(flat, number);
        let op = flat.ops[number as usize];
        if !is_pure(op) {
            continue;
        }
        if let Some(earlier) = known.find_or_insert(flat, number, scope) {
            let results = flat.writes(flat.ops[earlier as usize]);
            for (own, other) in flat.writes(op).zip(results) {
                renames.set(own, other);
            }
            dropped[number as usize] = true;
        }
    }
    // Operations run after those whose results they read, so their own reads are already renamed.
    renames.apply_outside_ops(flat);
    drop_ops(flat, &dropped);
}

const NONE: u32 = u32::MAX;

/// Table of the operations visited so far, hashed by kind and inputs. Equal operations in scopes that do not enclose
/// each other form a chain: `next` has the index of the following one.
struct VisitedOps {
    first: HashTable<u32>,
    next: Vec<u32>,
    scope: Vec<ScopeId>,
}

impl VisitedOps {
    fn new(flat: &FlatNet) -> Self {
        VisitedOps {
            first: HashTable::with_capacity(flat.ops.len()),
            next: vec![NONE; flat.ops.len()],
            scope: vec![ScopeId::ROOT; flat.ops.len()],
        }
    }

    /// Returns the index of an earlier operation that is equal to operation `number` and runs whenever `scope` is
    /// active. If there is none, enters the operation into the table and returns `None`.
    fn find_or_insert(&mut self, flat: &FlatNet, number: u32, scope: ScopeId) -> Option<u32> {
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

fn hash(flat: &FlatNet, op: Op) -> u64 {
    let mut hasher = FxHasher::default();
    op.kind.hash(&mut hasher);
    inputs(flat, op).for_each(|word| hasher.write_u32(word));
    hasher.finish()
}

fn same(flat: &FlatNet, a: Op, b: Op) -> bool {
    a.kind == b.kind && inputs(flat, a).eq(inputs(flat, b))
}

/// Returns the operand words that determine the result of an operation: all but those of the registers that it writes.
fn inputs(flat: &FlatNet, op: Op) -> impl Iterator<Item = u32> + '_ {
    let shape = flat.accesses.op_accesses(op);
    let words = flat.words(op).iter().enumerate();
    let read = words.filter(move |(k, _)| shape.access(*k) != Access::Write);
    read.map(|(_, word)| *word)
}

/// Returns true for operations without state and devices: equal inputs give equal outputs within a cycle, including
/// faults.
fn is_pure(op: Op) -> bool {
    match op.kind {
        OpKind::Run(prim, _) => matches!(prim.desc().state, StateSize::None),
        OpKind::Copy => true,
        OpKind::Actuate(..) | OpKind::Call(..) => false,
    }
}
