//! Dead code elimination.
//!
//! Live are exports and results, set-points, operations that may fault, and everything that these read, including
//! through delays and guards.

use super::substitution::drop_ops;
use super::traversal::Writers;
use crate::access::Access;
use crate::flat_net::{FlatNet, Item, Op, OpKind, ScopeId};
use crate::registers::{Region, Register};
use rpi_image::image::{CommandEnd, Signal};
use rpi_prims::CycleTime;
use rustc_hash::FxHashMap;

pub(super) fn remove(flat: &mut FlatNet, _: CycleTime) {
    let writers = Writers::new(flat);
    let mut life = Liveness::new(flat, &writers);
    for &(number, scope) in &writers.order {
        if has_effect(flat.ops[number as usize]) {
            life.mark_op(flat, number, scope);
        }
    }
    life.mark_outputs(flat);
    while let Some(slot) = life.waiting.pop() {
        life.follow(flat, slot);
    }
    let dropped: Vec<bool> = life.ops.iter().map(|alive| !alive).collect();
    let alive = &life.slots;
    drop_ops(flat, &dropped);
    for scope in &mut flat.scopes {
        scope.latches.retain(|l| alive[l.1.index()]);
    }
    prune_tables(flat, alive);
    remove_empty_scopes(flat);
}

/// Returns true for operations that must run even if their outputs are not read: those that may raise a fault, and
/// set-points.
fn has_effect(op: Op) -> bool {
    match op.kind {
        OpKind::Run(prim, _) => prim.desc().may_fault,
        OpKind::Actuate(..) => true,
        OpKind::Copy | OpKind::Call(..) => false,
    }
}

struct Liveness<'a> {
    ops: Vec<bool>,
    slots: Vec<bool>,
    scopes: Vec<bool>,
    waiting: Vec<Register>,
    writers: &'a Writers,
    /// For each register that receives a value at the end of the cycle for the next one: the register that is copied,
    /// and the scope of the copy.
    latch: FxHashMap<Register, (Register, ScopeId)>,
}

impl<'a> Liveness<'a> {
    fn new(flat: &FlatNet, writers: &'a Writers) -> Self {
        let mut life = Liveness {
            ops: vec![false; flat.ops.len()],
            slots: vec![false; flat.registers.len()],
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

    fn mark_register(&mut self, slot: Register) {
        if !std::mem::replace(&mut self.slots[slot.index()], true) {
            self.waiting.push(slot);
        }
    }

    fn mark_op(&mut self, flat: &FlatNet, number: u32, scope: ScopeId) {
        if std::mem::replace(&mut self.ops[number as usize], true) {
            return;
        }
        let accesses = flat.accesses(flat.ops[number as usize]);
        for (_, slot) in accesses.filter(|a| a.0 != Access::Write) {
            self.mark_register(slot);
        }
        self.mark_scope(flat, scope);
    }

    /// Marks as live the guards and reset conditions of a scope and of all scopes around it, because they decide
    /// whether it runs.
    fn mark_scope(&mut self, flat: &FlatNet, scope: ScopeId) {
        let mut at = Some(scope);
        while let Some(s) = at.filter(|s| !self.scopes[s.index()]) {
            self.scopes[s.index()] = true;
            let scope = &flat.scopes[s.index()];
            self.mark_register(scope.guard);
            scope.reset.iter().for_each(|r| self.mark_register(r.0));
            at = scope.parent;
        }
    }

    fn mark_outputs(&mut self, flat: &FlatNet) {
        let exports = flat.tables.exports.iter().map(|e| e.value);
        let ends: Vec<_> = match &flat.tables.end {
            CommandEnd::Results(results) => results.iter().map(|r| r.condition).collect(),
            CommandEnd::Ports { terminate, fail } => {
                terminate.iter().chain(fail).copied().collect()
            }
        };
        for signal in exports.chain(ends) {
            self.mark_register(Register(signal.start));
            self.mark_register(Register(signal.present));
        }
    }

    fn follow(&mut self, flat: &FlatNet, slot: Register) {
        if let Some((_, number, scope)) = self.writers.writer_of(slot) {
            self.mark_op(flat, number, scope);
        }
        if let Some(&(from, scope)) = self.latch.get(&slot) {
            self.mark_register(from);
            self.mark_scope(flat, scope);
        }
    }
}

/// Removes sensors and core flows that no operation or output reads. `alive` says for each register whether it is read.
fn prune_tables(flat: &mut FlatNet, alive: &[bool]) {
    let t = &mut flat.tables;
    let constant = |s: u32| flat.registers.region(Register(s)) == Region::Constant;
    let read =
        |s: Signal| alive[s.start as usize] || (alive[s.present as usize] && !constant(s.present));
    t.flows.retain(|f| read(f.value));
    t.sensors.retain(|(s, _)| read(s.value));
    for f in &mut t.fragments {
        if !alive[f.active as usize] && !constant(f.active) {
            f.active = Register::FALSE.0;
        }
    }
}

/// Removes scopes that contain neither items nor copies for the next cycle from the scopes around them.
fn remove_empty_scopes(flat: &mut FlatNet) {
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
