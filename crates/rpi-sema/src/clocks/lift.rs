//! Where values of other clocks meet: one of a slower clock becomes optional there (M4).
//!
//! Only outside Lustre, which has no optional flows: there clocks that do not meet are an error.

use super::infer::{Inference, Of};
use super::terms::{Term, Terms};
use crate::typed::ExprId;
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
        let clocks: Vec<Option<Term>> = operands.iter().map(|id| self.known(*id)).collect();
        let place = self.common(clocks.iter().flatten().copied())?;
        let slower = |clock: &Option<Term>| clock.is_some_and(|own| self.is_slower(own, place));
        let slower: Vec<bool> = clocks.iter().map(slower).collect();
        if !slower.contains(&true) {
            return None;
        }
        for (operand, is_slower) in operands.iter().zip(slower) {
            match is_slower {
                true => self.lift_all(*operand, place),
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
        let Some(read) = self.common(parts.iter().map(|(_, clock)| *clock)) else {
            return;
        };
        for (leaves, own) in parts {
            match self.is_slower(own, read) {
                true => self.lift(id, Lift { leaves, own, read }),
                false => _ = self.terms.unify(own, read),
            }
        }
        self.values[id.0 as usize] = Of::One(read);
    }

    /// The slowest clock that all of these are sampled from, as far as they are known.
    pub(super) fn common(&self, clocks: impl Iterator<Item = Term>) -> Option<Term> {
        let mut known = clocks.filter(|clock| !self.terms.is_open(*clock));
        let first = known.next()?;
        Some(known.fold(first, |common, clock| self.terms.common(common, clock)))
    }

    pub(super) fn is_slower(&self, clock: Term, than: Term) -> bool {
        let is_known = |term| !self.terms.is_open(term);
        is_known(clock)
            && is_known(than)
            && self.terms.leads_to(clock, than)
            && self.terms.path(clock).len() > self.terms.path(than).len()
    }

    /// What decides, and what is published, is read in all cycles. In Lustre a claim holds where its clock does not tick.
    pub(super) fn read_always(&mut self, id: ExprId, is_claim: bool) {
        let is_sampled = |term| self.terms.parent(term).is_some();
        if self.unit.is_lustre && !is_claim {
            self.all(id, Terms::BASE);
        } else if self.known(id).is_some_and(is_sampled) {
            self.lift_all(id, Terms::BASE);
        }
    }

    /// All of a value is read by another clock.
    fn lift_all(&mut self, id: ExprId, read: Term) {
        let own = self.values[id.0 as usize].first();
        let leaves = 0..self.unit.expr(id).ty.leaf_count();
        self.lift(id, Lift { leaves, own, read });
    }

    /// Leaves of a value are read by another clock.
    pub(super) fn lift(&mut self, id: ExprId, lift: Lift) {
        self.lifted.entry(id).or_default().push(lift);
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
