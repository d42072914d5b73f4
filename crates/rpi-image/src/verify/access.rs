//! Who may read and who may write a cell.

use super::{Check, UNWRITTEN};
use crate::image::Cells;
use alloc::format;

impl<'a> Check<'a> {
    /// Operand words in range and in whole groups.
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

    /// Plain values: somebody has written them in an earlier step, perhaps in an earlier cycle.
    pub(super) fn reads(&mut self, c: Cells) {
        let Some(scopes) = self.writer.get(c.range()) else {
            return self.fail(format!("cells {}..{} are outside", c.at, c.end()));
        };
        if let Some(k) = scopes.iter().position(|&s| s == UNWRITTEN) {
            self.fail(format!(
                "cell {} is read before it is written",
                c.range().start + k
            ));
        }
    }

    /// A Boolean that decides: written on every path that leads here.
    pub(super) fn decides(&mut self, cell: u32) {
        let scope = self.writer.get(cell as usize).copied();
        let written = scope.is_some_and(|scope| self.is_taken(scope));
        self.demand(written, || {
            format!("cell {cell} decides, but is not written on every path")
        });
    }

    /// True if the steps of a scope have run on every path that leads here: all its guards are known to hold.
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

    /// A Boolean that decides in the commit phase: the evaluation has a step that writes it.
    pub(super) fn decided(&mut self, cell: u32) {
        self.reads(Cells { at: cell, len: 1 });
    }

    /// Constants only.
    pub(super) fn constant(&mut self, c: Cells) {
        let fits = c.end() <= self.image.layout.constants;
        self.demand(fits, || {
            format!("cells {}..{} are not constant", c.at, c.end())
        });
    }

    /// Cells that this step alone writes.
    pub(super) fn writes(&mut self, c: Cells) {
        if c.at < self.image.layout.state {
            return self.owns(c);
        }
        let scope = self.scope;
        let Some(scopes) = self.writer.get_mut(c.range()) else {
            return self.fail(format!("cells {}..{} are outside", c.at, c.end()));
        };
        let again = scopes.iter().position(|&s| s != UNWRITTEN);
        scopes.fill(scope);
        if let Some(k) = again {
            self.fail(format!("cell {} has two writers", c.range().start + k));
        }
    }

    /// State cells that this step alone keeps.
    pub(super) fn owns(&mut self, c: Cells) {
        let first = self.image.layout.external;
        let range =
            c.at.checked_sub(first)
                .map(|at| Cells { at, len: c.len }.range());
        let Some(flags) = range.and_then(|r| self.owned.get_mut(r)) else {
            return self.fail(format!("cells {}..{} are not state", c.at, c.end()));
        };
        let again = flags.iter().position(|&owned| owned);
        flags.fill(true);
        if let Some(k) = again {
            self.fail(format!("cell {} has two writers", c.at as usize + k));
        }
    }
}
