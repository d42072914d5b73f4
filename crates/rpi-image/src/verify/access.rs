//! Checks of read and write access to slots.

use super::{UNWRITTEN, Verifier};
use crate::image::SlotRange;
use alloc::format;

impl<'a> Verifier<'a> {
    /// Returns the operand words of a step: the range `words` of [`Image::code`](crate::image::Image::code). Reports an
    /// error and returns `None` if the range is outside of the code, or its length is not a multiple of `group`, the
    /// number of words per call.
    pub(super) fn operand_words(&mut self, words: SlotRange, group: usize) -> Option<&'a [u32]> {
        let found = self.image.code.get(words.range());
        let whole = group > 0 && (words.len as usize).is_multiple_of(group);
        self.require(found.is_some() && whole, || {
            format!(
                "operand words {}..{} are not whole groups of {group}",
                words.start,
                words.end()
            )
        });
        found.filter(|_| whole)
    }

    /// Checks the slots that the current step reads as plain values: an earlier step writes each of them, unless they
    /// are constants, external slots or state. The earlier step may be skipped in a cycle, so that a value is from an
    /// earlier cycle.
    pub(super) fn check_read(&mut self, c: SlotRange) {
        let Some(scopes) = self.writer_scope.get(c.range()) else {
            return self.report(format!("slots {}..{} are out of range", c.start, c.end()));
        };
        if let Some(k) = scopes.iter().position(|&s| s == UNWRITTEN) {
            self.report(format!(
                "slot {} is read before it is written",
                c.range().start + k
            ));
        }
    }

    /// Checks that the Boolean slot `cell`, which decides about a skip, a reset or a presence, has been written on
    /// every path to the current step.
    pub(super) fn check_control_read(&mut self, cell: u32) {
        let scope = self.writer_scope.get(cell as usize).copied();
        let written = scope.is_some_and(|scope| self.is_executed(scope));
        self.require(written, || {
            format!("control slot {cell} is not written on every path")
        });
    }

    /// Returns whether the steps of a scope (the steps that one skip jumps over) have run on every path to the current
    /// step: all guards around that scope are known to be true.
    fn is_executed(&self, scope: u32) -> bool {
        let mut at = scope;
        while at != 0 {
            let Some(scope) = self.scopes.get(at as usize) else {
                return false;
            };
            let holds = self
                .open_guards
                .get(scope.guard as usize)
                .is_some_and(|&n| n > 0);
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

    /// Checks that a step of the evaluation phase writes the Boolean slot `cell`, by which the commit phase decides
    /// about a skip.
    pub(super) fn check_commit_control_read(&mut self, cell: u32) {
        self.check_read(SlotRange {
            start: cell,
            len: 1,
        });
    }

    /// Checks that a range of slots is in the region of constants, which no step writes.
    pub(super) fn check_constant(&mut self, c: SlotRange) {
        let is_constant = c.end() <= self.image.layout.constants;
        self.require(is_constant, || {
            format!("slots {}..{} are not constant", c.start, c.end())
        });
    }

    /// Checks that the current step may write a range of slots: the slots are values or state, and no other step writes
    /// them.
    pub(super) fn check_write(&mut self, c: SlotRange) {
        if c.start < self.image.layout.state {
            return self.check_state_write(c);
        }
        let scope = self.scope;
        let Some(scopes) = self.writer_scope.get_mut(c.range()) else {
            return self.report(format!("slots {}..{} are out of range", c.start, c.end()));
        };
        let again = scopes.iter().position(|&s| s != UNWRITTEN);
        scopes.fill(scope);
        if let Some(k) = again {
            self.report(format!("slot {} has two writers", c.range().start + k));
        }
    }

    /// Checks that the current step may write a range of state slots: the slots are in the state region, and no other
    /// step uses them as its state.
    pub(super) fn check_state_write(&mut self, c: SlotRange) {
        let first = self.image.layout.external;
        let range = c.start.checked_sub(first).map(|at| {
            SlotRange {
                start: at,
                len: c.len,
            }
            .range()
        });
        let Some(flags) = range.and_then(|r| self.owned.get_mut(r)) else {
            return self.report(format!("slots {}..{} are not state", c.start, c.end()));
        };
        let again = flags.iter().position(|&owned| owned);
        flags.fill(true);
        if let Some(k) = again {
            self.report(format!("slot {} has two writers", c.start as usize + k));
        }
    }
}
