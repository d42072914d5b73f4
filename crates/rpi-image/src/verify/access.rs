//! Checks of read and write access to slots.

use super::{Check, UNWRITTEN};
use crate::image::Cells;
use alloc::format;

impl<'a> Check<'a> {
    /// Returns the operand words in the range `words`. Reports an error if they are out of range or not whole groups of
    /// `group` words.
    pub(super) fn words(&mut self, words: Cells, group: usize) -> Option<&'a [u32]> {
        let found = self.image.code.get(words.range());
        let whole = group > 0 && (words.len as usize).is_multiple_of(group);
        self.demand(found.is_some() && whole, || {
            format!(
                "operand words {}..{} are not whole groups of {group}",
                words.at,
                words.end()
            )
        });
        found.filter(|_| whole)
    }

    /// Checks a read of plain values: an earlier step has a write to each slot. The value may be stale (from an earlier
    /// cycle).
    pub(super) fn reads(&mut self, c: Cells) {
        let Some(scopes) = self.writer.get(c.range()) else {
            return self.fail(format!("slots {}..{} are out of range", c.at, c.end()));
        };
        if let Some(k) = scopes.iter().position(|&s| s == UNWRITTEN) {
            self.fail(format!(
                "slot {} is read before it is written",
                c.range().start + k
            ));
        }
    }

    /// Checks a read of a Boolean that affects control (skip, reset, presence): it must be written on every path to
    /// this step.
    pub(super) fn decides(&mut self, cell: u32) {
        let scope = self.writer.get(cell as usize).copied();
        let written = scope.is_some_and(|scope| self.is_taken(scope));
        self.demand(written, || {
            format!("control slot {cell} is not written on every path")
        });
    }

    /// Returns whether the steps of a scope have run on every path to this step: all guards of the scope are known to
    /// be true.
    fn is_taken(&self, scope: u32) -> bool {
        let mut at = scope;
        while at != 0 {
            let Some(scope) = self.scopes.get(at as usize) else {
                return false;
            };
            let holds = self.holds.get(scope.guard as usize).is_some_and(|&n| n > 0);
            if !(scope.is_final && holds || self.is_open(at)) {
                return false;
            }
            at = scope.outer;
        }
        true
    }

    fn is_open(&self, scope: u32) -> bool {
        let mut at = self.scope;
        while at != scope && at != 0 {
            at = self.scopes.get(at as usize).map_or(0, |s| s.outer);
        }
        at == scope
    }

    /// Checks a read of a control Boolean in the commit phase: a step of the evaluation phase must write it.
    pub(super) fn decided(&mut self, cell: u32) {
        self.reads(Cells { at: cell, len: 1 });
    }

    /// Checks that slots are constants.
    pub(super) fn constant(&mut self, c: Cells) {
        let fits = c.end() <= self.image.layout.constants;
        self.demand(fits, || {
            format!("slots {}..{} are not constant", c.at, c.end())
        });
    }

    /// Checks a write: no other step may write these slots.
    pub(super) fn writes(&mut self, c: Cells) {
        if c.at < self.image.layout.state {
            return self.owns(c);
        }
        let scope = self.scope;
        let Some(scopes) = self.writer.get_mut(c.range()) else {
            return self.fail(format!("slots {}..{} are out of range", c.at, c.end()));
        };
        let again = scopes.iter().position(|&s| s != UNWRITTEN);
        scopes.fill(scope);
        if let Some(k) = again {
            self.fail(format!("slot {} has two writers", c.range().start + k));
        }
    }

    /// Checks the use of state slots: no other step may own them.
    pub(super) fn owns(&mut self, c: Cells) {
        let first = self.image.layout.external;
        let range =
            c.at.checked_sub(first)
                .map(|at| Cells { at, len: c.len }.range());
        let Some(flags) = range.and_then(|r| self.owned.get_mut(r)) else {
            return self.fail(format!("slots {}..{} are not state", c.at, c.end()));
        };
        let again = flags.iter().position(|&owned| owned);
        flags.fill(true);
        if let Some(k) = again {
            self.fail(format!("slot {} has two writers", c.at as usize + k));
        }
    }
}
