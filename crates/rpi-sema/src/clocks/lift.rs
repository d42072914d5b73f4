//! Where values of other clocks meet: one of a slower clock becomes optional there (M4).
//!
//! Only outside Lustre, which has no optional flows: there clocks that do not meet are an error.

use super::infer::{Inference, Of};
use super::terms::{Term, Terms};
use crate::typed::{ClockOn, ExprId};
use std::ops::Range;

/// Leaves of a value that are read by another clock than theirs, which leads to it.
#[derive(Clone, Debug)]
pub(super) struct Lift {
    pub(super) leaves: Range<usize>,
    pub(super) own: Term,
    pub(super) read: Term,
}

impl Inference<'_> {
    /// The clock at which values of different clocks meet: the slowest that all of theirs are sampled from. None where all
    /// have one, as far as is known.
    pub(super) fn meeting(&mut self, operands: &[ExprId]) -> Option<Term> {
        if self.unit.is_lustre {
            return None;
        }
        let mut known = operands.iter().filter_map(|id| self.known(*id));
        let first = known.next()?;
        if known.all(|term| self.terms.are_same(first, term)) {
            return None;
        }
        let paths: Vec<Option<Vec<ClockOn>>> = operands
            .iter()
            .map(|id| Some(self.terms.path(self.known(*id)?)))
            .collect();
        let common = in_common(&paths);
        let is_slower = |path: &Option<Vec<ClockOn>>| path.as_ref().map_or(0, Vec::len) > common;
        if !paths.iter().any(is_slower) {
            return None;
        }
        let place = self.terms.outer(first, common);
        for (operand, path) in operands.iter().zip(&paths) {
            match is_slower(path) {
                true => self.lift(*operand, place),
                false => _ = self.all(*operand, place),
            }
        }
        Some(place)
    }

    /// A value of which parts have clocks of their own, for who reads it as one: they are optional beyond the clock that
    /// is common to them.
    pub(super) fn as_one(&mut self, id: ExprId) {
        let Of::Each(parts) = &self.values[id.0 as usize] else {
            return;
        };
        if self.unit.is_lustre || self.known(id).is_some() {
            return;
        }
        let parts = super::targets::in_a_row(parts);
        let known = |term: Term| (!self.terms.is_open(term)).then_some(term);
        let paths: Vec<_> = parts
            .iter()
            .map(|(_, term)| Some(self.terms.path(known(*term)?)))
            .collect();
        let Some(first) = parts.iter().find_map(|(_, term)| known(*term)) else {
            return;
        };
        let common = in_common(&paths);
        let read = self.terms.outer(first, common);
        for ((leaves, own), path) in parts.into_iter().zip(paths) {
            match path {
                Some(path) if path.len() > common => {
                    let lifts = self.lifted.entry(id).or_default();
                    lifts.push(Lift { leaves, own, read });
                }
                _ => _ = self.terms.unify(own, read),
            }
        }
        self.values[id.0 as usize] = Of::One(read);
    }

    /// What decides, and what is published, is read in all cycles. In Lustre a claim holds where its clock does not tick.
    pub(super) fn read_always(&mut self, id: ExprId, is_claim: bool) {
        let is_sampled = |term| self.terms.parent(term).is_some();
        if self.unit.is_lustre && !is_claim {
            self.all(id, Terms::BASE);
        } else if self.known(id).is_some_and(is_sampled) {
            self.lift(id, Terms::BASE);
        }
    }

    /// All of a value is read by another clock.
    fn lift(&mut self, id: ExprId, read: Term) {
        let own = self.values[id.0 as usize].first();
        let leaves = 0..self.unit.expr(id).ty.leaf_count();
        let lifts = self.lifted.entry(id).or_default();
        lifts.push(Lift { leaves, own, read });
    }

    /// The clock of a value, if it has one and that is known.
    pub(super) fn known(&self, id: ExprId) -> Option<Term> {
        let term = match &self.values[id.0 as usize] {
            Of::One(term) => *term,
            Of::Each(parts) => {
                let ((first, _), others) = parts.split_first()?;
                let mut others = others.iter();
                let one = others.all(|(term, _)| self.terms.are_same(*first, *term));
                one.then_some(*first)?
            }
        };
        (!self.terms.is_open(term)).then_some(term)
    }
}

/// How many samplings all clocks have in common.
pub(super) fn in_common(paths: &[Option<Vec<ClockOn>>]) -> usize {
    let mut paths = paths.iter().flatten();
    let first = paths.next().map_or(&[][..], Vec::as_slice);
    paths.fold(first.len(), |common, path| {
        let both = first[..common].iter().zip(path);
        both.take_while(|(a, b)| a == b).count()
    })
}
