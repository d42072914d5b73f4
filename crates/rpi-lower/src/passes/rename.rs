//! Substitution of registers.

use crate::access::Access;
use crate::flat::{Flat, Item};
use crate::slots::Slot;
use rpi_image::image::{End, Signal};

/// A substitution of registers.
pub(super) struct Renames {
    to: Vec<Slot>,
    /// True if any register is replaced.
    any: bool,
}

impl Renames {
    /// The identity.
    pub(super) fn new(flat: &Flat) -> Self {
        Renames {
            to: (0..).map(Slot).take(flat.slots.len()).collect(),
            any: false,
        }
    }

    /// The replacement of a register. Registers added later are not replaced.
    pub(super) fn get(&self, slot: Slot) -> Slot {
        let mut at = slot;
        while let Some(&next) = self.to.get(at.index()).filter(|n| **n != at) {
            at = next;
        }
        at
    }

    /// Replaces `from` by `to`.
    pub(super) fn set(&mut self, from: Slot, to: Slot) {
        self.to[from.index()] = self.get(to);
        self.any = true;
    }

    /// Applies the substitution to the reads of an operation.
    pub(super) fn reads(&self, flat: &mut Flat, op: u32) {
        flat.replace(flat.ops[op as usize], Access::is_read, |s| self.get(s));
    }

    /// Applies the substitution to all reads.
    pub(super) fn apply(&self, flat: &mut Flat) {
        if self.any {
            for op in 0..flat.ops.len() as u32 {
                self.reads(flat, op);
            }
            self.apply_outside(flat);
        }
    }

    /// Applies the substitution to reads outside operations: guards, resets, latches, tables.
    pub(super) fn apply_outside(&self, flat: &mut Flat) {
        for scope in &mut flat.scopes {
            scope.guard = self.get(scope.guard);
            if let Some((unless, _)) = &mut scope.reset {
                *unless = self.get(*unless);
            }
            scope.latches.iter_mut().for_each(|l| l.0 = self.get(l.0));
        }
        let t = &mut flat.tables;
        let signal = |s: &mut Signal| {
            s.at = self.get(Slot(s.at)).0;
            s.present = self.get(Slot(s.present)).0;
        };
        t.fragments
            .iter_mut()
            .for_each(|f| f.active = self.get(Slot(f.active)).0);
        t.exports.iter_mut().for_each(|e| signal(&mut e.value));
        match &mut t.end {
            End::Results(results) => results.iter_mut().for_each(|r| signal(&mut r.condition)),
            End::Ports { terminate, fail } => {
                terminate.iter_mut().chain(fail).for_each(signal);
            }
        }
    }
}

/// Removes operations from all scopes.
pub(super) fn drop_ops(flat: &mut Flat, dropped: &[bool]) {
    if !dropped.contains(&true) {
        return;
    }
    let keep = |item: &Item| match item {
        Item::Op(op) => !dropped.get(*op as usize).copied().unwrap_or(false),
        Item::Scope(_) => true,
    };
    for scope in &mut flat.scopes {
        scope.items.retain(keep);
    }
}
