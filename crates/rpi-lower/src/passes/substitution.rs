//! Substitution of registers.

use crate::access::Access;
use crate::flat_net::{FlatNet, Item};
use crate::registers::Register;
use rpi_image::image::{CommandEnd, Signal};

/// Map from registers to the registers that replace them in a flat net.
pub(super) struct Substitution {
    to: Vec<Register>,
    /// False if no register is replaced, so that the map has no effect.
    any: bool,
}

impl Substitution {
    /// Creates a map for the registers of a flat net in which no register is replaced.
    pub(super) fn new(flat: &FlatNet) -> Self {
        Substitution {
            to: (0..).map(Register).take(flat.registers.len()).collect(),
            any: false,
        }
    }

    /// Returns the register that replaces a register, or the register itself. Registers added to the net after the map
    /// was created are not replaced.
    pub(super) fn get(&self, slot: Register) -> Register {
        let mut at = slot;
        while let Some(&next) = self.to.get(at.index()).filter(|n| **n != at) {
            at = next;
        }
        at
    }

    /// Records that `from` is replaced by `to`, or by the replacement of `to` if it has one.
    pub(super) fn set(&mut self, from: Register, to: Register) {
        self.to[from.index()] = self.get(to);
        self.any = true;
    }

    /// Replaces the registers that the operation with index `op` reads.
    pub(super) fn apply_to_op(&self, flat: &mut FlatNet, op: u32) {
        flat.replace(flat.ops[op as usize], Access::is_read, |s| self.get(s));
    }

    /// Replaces registers wherever they are read: by operations, and outside of operations.
    pub(super) fn apply(&self, flat: &mut FlatNet) {
        if self.any {
            for op in 0..flat.ops.len() as u32 {
                self.apply_to_op(flat, op);
            }
            self.apply_outside_ops(flat);
        }
    }

    /// Replaces registers where they are read other than by operations: in guards, resets, copies for the next cycle,
    /// fragment activations, exports and end conditions.
    pub(super) fn apply_outside_ops(&self, flat: &mut FlatNet) {
        for scope in &mut flat.scopes {
            scope.guard = self.get(scope.guard);
            if let Some((unless, _)) = &mut scope.reset {
                *unless = self.get(*unless);
            }
            scope.latches.iter_mut().for_each(|l| l.0 = self.get(l.0));
        }
        let t = &mut flat.tables;
        let signal = |s: &mut Signal| {
            s.start = self.get(Register(s.start)).0;
            s.present = self.get(Register(s.present)).0;
        };
        t.fragments
            .iter_mut()
            .for_each(|f| f.active = self.get(Register(f.active)).0);
        t.exports.iter_mut().for_each(|e| signal(&mut e.value));
        match &mut t.end {
            CommandEnd::Results(results) => {
                results.iter_mut().for_each(|r| signal(&mut r.condition))
            }
            CommandEnd::Ports { terminate, fail } => {
                terminate.iter_mut().chain(fail).for_each(signal);
            }
        }
    }
}

/// Removes operations from all scopes. `dropped` says for each operation, by its index, whether it is removed.
pub(super) fn drop_ops(flat: &mut FlatNet, dropped: &[bool]) {
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
