//! Dead code elimination.
//!
//! Live are exports and results, set-points, operations that may fault, and everything that these read, including
//! through delays and guards.

use super::order::Writers;
use super::rename::drop_ops;
use crate::access::Access;
use crate::flat::{Flat, Item, Op, ScopeId, Work};
use crate::slots::{Region, Slot};
use rpi_image::image::{End, Signal};
use rpi_prims::Clock;
use rustc_hash::FxHashMap;

pub(super) fn remove(flat: &mut Flat, _: Clock) {
    let writers = Writers::new(flat);
    let mut life = Life::new(flat, &writers);
    for &(number, scope) in &writers.order {
        if has_effect(flat.ops[number as usize]) {
            life.op(flat, number, scope);
        }
    }
    life.ends(flat);
    while let Some(slot) = life.waiting.pop() {
        life.follow(flat, slot);
    }
    let dropped: Vec<bool> = life.ops.iter().map(|alive| !alive).collect();
    let alive = &life.slots;
    drop_ops(flat, &dropped);
    for scope in &mut flat.scopes {
        scope.latches.retain(|l| alive[l.1.index()]);
    }
    tables(flat, alive);
    empty_scopes(flat);
}

/// True for operations that must run even if their outputs are not read.
fn has_effect(op: Op) -> bool {
    match op.work {
        Work::Run(prim, _) => prim.desc().may_fault,
        Work::Actuate(..) => true,
        Work::Copy | Work::Call(..) => false,
    }
}

struct Life<'a> {
    ops: Vec<bool>,
    slots: Vec<bool>,
    scopes: Vec<bool>,
    waiting: Vec<Slot>,
    writers: &'a Writers,
    /// For each latched register, the source of the latch and its scope.
    latch: FxHashMap<Slot, (Slot, ScopeId)>,
}

impl<'a> Life<'a> {
    fn new(flat: &Flat, writers: &'a Writers) -> Self {
        let mut life = Life {
            ops: vec![false; flat.ops.len()],
            slots: vec![false; flat.slots.len()],
            scopes: vec![false; flat.scopes.len()],
            waiting: Vec::new(),
            writers,
            latch: FxHashMap::default(),
        };
        for (k, scope) in (0..).map(ScopeId).zip(&flat.scopes) {
            for (from, to) in &scope.latches {
                life.latch.insert(*to, (*from, k));
            }
        }
        life
    }

    fn slot(&mut self, slot: Slot) {
        if !std::mem::replace(&mut self.slots[slot.index()], true) {
            self.waiting.push(slot);
        }
    }

    fn op(&mut self, flat: &Flat, number: u32, scope: ScopeId) {
        if std::mem::replace(&mut self.ops[number as usize], true) {
            return;
        }
        let accesses = flat.accesses(flat.ops[number as usize]);
        for (_, slot) in accesses.filter(|a| a.0 != Access::Write) {
            self.slot(slot);
        }
        self.scope(flat, scope);
    }

    /// Marks the guards and reset conditions of a scope and of the scopes around it as live.
    fn scope(&mut self, flat: &Flat, scope: ScopeId) {
        let mut at = Some(scope);
        while let Some(s) = at.filter(|s| !self.scopes[s.index()]) {
            self.scopes[s.index()] = true;
            let scope = &flat.scopes[s.index()];
            self.slot(scope.guard);
            scope.reset.iter().for_each(|r| self.slot(r.0));
            at = scope.parent;
        }
    }

    fn ends(&mut self, flat: &Flat) {
        let exports = flat.tables.exports.iter().map(|e| e.value);
        let ends: Vec<_> = match &flat.tables.end {
            End::Results(results) => results.iter().map(|r| r.condition).collect(),
            End::Ports { terminate, fail } => terminate.iter().chain(fail).copied().collect(),
        };
        for signal in exports.chain(ends) {
            self.slot(Slot(signal.at));
            self.slot(Slot(signal.present));
        }
    }

    fn follow(&mut self, flat: &Flat, slot: Slot) {
        if let Some((_, number, scope)) = self.writers.of(slot) {
            self.op(flat, number, scope);
        }
        if let Some(&(from, scope)) = self.latch.get(&slot) {
            self.slot(from);
            self.scope(flat, scope);
        }
    }
}

/// Removes sensors and core flows that are not read.
fn tables(flat: &mut Flat, alive: &[bool]) {
    let t = &mut flat.tables;
    let constant = |s: u32| flat.slots.region(Slot(s)) == Region::Constant;
    let read =
        |s: Signal| alive[s.at as usize] || (alive[s.present as usize] && !constant(s.present));
    t.flows.retain(|f| read(f.value));
    t.sensors.retain(|(s, _)| read(s.value));
    for f in &mut t.fragments {
        if !alive[f.active as usize] && !constant(f.active) {
            f.active = Slot::FALSE.0;
        }
    }
}

/// Removes empty scopes.
fn empty_scopes(flat: &mut Flat) {
    for k in (0..flat.scopes.len()).rev() {
        let keep: Vec<bool> = flat.scopes[k]
            .items
            .iter()
            .map(|item| match item {
                Item::Op(_) => true,
                Item::Scope(inner) => {
                    let inner = &flat.scopes[inner.index()];
                    !inner.items.is_empty() || !inner.latches.is_empty()
                }
            })
            .collect();
        let mut keep = keep.into_iter();
        flat.scopes[k].items.retain(|_| keep.next().unwrap_or(true));
    }
}
