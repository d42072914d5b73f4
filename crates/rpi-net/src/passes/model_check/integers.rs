//! Integer terms: linear sums of variables, selected by conditions.
//!
//! Operations and comparisons are pushed through the choices down to the sums, so that only comparisons of sums with
//! constants remain. The values are mathematical integers: on overflow the cycle has a fault and no set-point is
//! emitted; if the operation is not evaluated, its value is never read.

use crate::solver::{LinearTerm, Lit, Solver};
use rustc_hash::FxHashMap;

/// Maximum nesting depth of conditional values in a term. A new variable replaces a deeper term.
const DEPTH: u32 = 120;
/// Maximum number of terms in a problem of the solver. A new variable replaces each further term.
const TERMS: usize = 60_000;

/// Index of an integer term in the table [`Integers`].
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub(super) struct IntId(u32);

#[derive(Clone, PartialEq, Eq, Hash, Debug)]
pub(super) enum IntTerm {
    Sum(LinearTerm),
    Choice(Lit, IntId, IntId),
}

/// Table of all integer terms in a problem of the solver. Equal terms are stored once (hash-consing).
#[derive(Debug, Default)]
pub(super) struct Integers {
    terms: Vec<(IntTerm, u32)>,
    known: FxHashMap<IntTerm, IntId>,
    sums: FxHashMap<(IntId, IntId, i64), IntId>,
    signs: FxHashMap<IntId, Lit>,
    fitting: FxHashMap<IntId, Lit>,
    quotients: FxHashMap<(LinearTerm, i64), LinearTerm>,
    divisions: FxHashMap<(IntId, i64), [IntId; 2]>,
}

impl Integers {
    pub(super) fn term(&self, int: IntId) -> &IntTerm {
        &self.terms[int.0 as usize].0
    }

    /// Returns the value of a constant term; `None` for other terms.
    pub(super) fn as_constant(&self, int: IntId) -> Option<i64> {
        match self.term(int) {
            IntTerm::Sum(sum) if sum.terms.is_empty() => Some(sum.constant),
            _ => None,
        }
    }

    pub(super) fn constant(&mut self, value: i64) -> IntId {
        self.sum(LinearTerm::constant(value))
    }

    /// Creates an integer variable from `low` to `high`, both included.
    pub(super) fn fresh(&mut self, solver: &mut Solver, low: i64, high: i64) -> IntId {
        let variable = solver.integer(low, high);
        self.sum(LinearTerm::variable(variable))
    }

    pub(super) fn unconstrained(&mut self, solver: &mut Solver) -> IntId {
        self.fresh(solver, i64::MIN, i64::MAX)
    }

    pub(super) fn sum(&mut self, sum: LinearTerm) -> IntId {
        self.insert(IntTerm::Sum(sum), 0)
    }

    fn insert(&mut self, term: IntTerm, depth: u32) -> IntId {
        if let Some(known) = self.known.get(&term) {
            return *known;
        }
        let int = IntId(u32::try_from(self.terms.len()).unwrap_or(u32::MAX));
        self.terms.push((term.clone(), depth));
        self.known.insert(term, int);
        int
    }

    fn depth(&self, int: IntId) -> u32 {
        self.terms[int.0 as usize].1
    }

    pub(super) fn minimum(&mut self, solver: &mut Solver, a: IntId, b: IntId) -> IntId {
        let ordered = self.at_most(solver, a, b);
        self.if_then_else(solver, ordered, a, b)
    }

    pub(super) fn maximum(&mut self, solver: &mut Solver, a: IntId, b: IntId) -> IntId {
        let ordered = self.at_most(solver, a, b);
        self.if_then_else(solver, ordered, b, a)
    }

    pub(super) fn if_then_else(
        &mut self,
        solver: &mut Solver,
        condition: Lit,
        yes: IntId,
        no: IntId,
    ) -> IntId {
        match condition {
            Lit::TRUE => return yes,
            Lit::FALSE => return no,
            _ if yes == no => return yes,
            _ => {}
        }
        let (condition, yes, no) = match condition.is_negated() {
            true => (!condition, no, yes),
            false => (condition, yes, no),
        };
        let depth = self.depth(yes).max(self.depth(no)) + 1;
        if depth <= DEPTH && self.terms.len() < TERMS {
            return self.insert(IntTerm::Choice(condition, yes, no), depth);
        }
        let named = self.unconstrained(solver);
        for (branch, guard) in [(yes, !condition), (no, condition)] {
            let equal = self.equal(solver, named, branch);
            let in_range = self.fits(solver, branch);
            solver.add_clause(&[guard, !in_range, equal]);
        }
        named
    }

    /// Returns the term `a + factor * b`.
    pub(super) fn add_scaled(
        &mut self,
        solver: &mut Solver,
        a: IntId,
        b: IntId,
        factor: i64,
    ) -> IntId {
        if let Some(known) = self.sums.get(&(a, b, factor)) {
            return *known;
        }
        let sum = match (self.term(a).clone(), self.term(b).clone()) {
            _ if self.terms.len() > TERMS => self.unconstrained(solver),
            (IntTerm::Sum(a), IntTerm::Sum(b)) => match a.add_scaled(&b, factor) {
                Some(sum) => self.sum(sum),
                None => self.unconstrained(solver),
            },
            (IntTerm::Choice(c, yes, no), other) => {
                let (left, right) = match other {
                    IntTerm::Choice(d, left, right) if c == d => (left, right),
                    _ => (b, b),
                };
                let yes = self.add_scaled(solver, yes, left, factor);
                let no = self.add_scaled(solver, no, right, factor);
                self.if_then_else(solver, c, yes, no)
            }
            (IntTerm::Sum(_), IntTerm::Choice(c, yes, no)) => {
                let yes = self.add_scaled(solver, a, yes, factor);
                let no = self.add_scaled(solver, a, no, factor);
                self.if_then_else(solver, c, yes, no)
            }
        };
        self.sums.insert((a, b, factor), sum);
        sum
    }

    pub(super) fn scaled(&mut self, solver: &mut Solver, a: IntId, factor: i64) -> IntId {
        let zero = self.constant(0);
        self.add_scaled(solver, zero, a, factor)
    }

    /// Returns the product of two terms; `None` unless one of them is constant.
    pub(super) fn times(&mut self, solver: &mut Solver, a: IntId, b: IntId) -> Option<IntId> {
        match (self.as_constant(a), self.as_constant(b)) {
            (Some(factor), _) => Some(self.scaled(solver, b, factor)),
            (_, Some(factor)) => Some(self.scaled(solver, a, factor)),
            _ => None,
        }
    }

    /// Returns a literal that is true exactly if the term is at most 0.
    pub(super) fn at_most_zero(&mut self, solver: &mut Solver, int: IntId) -> Lit {
        if let Some(known) = self.signs.get(&int) {
            return *known;
        }
        let lit = match self.term(int).clone() {
            IntTerm::Sum(sum) => solver.at_most_zero(&sum),
            IntTerm::Choice(condition, yes, no) => {
                let yes = self.at_most_zero(solver, yes);
                let no = self.at_most_zero(solver, no);
                solver.if_then_else(condition, yes, no)
            }
        };
        self.signs.insert(int, lit);
        lit
    }

    pub(super) fn at_most(&mut self, solver: &mut Solver, a: IntId, b: IntId) -> Lit {
        let difference = self.add_scaled(solver, a, b, -1);
        self.at_most_zero(solver, difference)
    }

    /// Returns a literal that is true exactly if the value of the term fits in `i64`. It need not fit if the operation
    /// is not evaluated in the cycle.
    fn fits(&mut self, solver: &mut Solver, int: IntId) -> Lit {
        if let Some(known) = self.fitting.get(&int) {
            return *known;
        }
        let lit = match self.term(int).clone() {
            IntTerm::Sum(sum) => solver.fits(&sum),
            IntTerm::Choice(condition, yes, no) => {
                let yes = self.fits(solver, yes);
                let no = self.fits(solver, no);
                solver.if_then_else(condition, yes, no)
            }
        };
        self.fitting.insert(int, lit);
        lit
    }

    pub(super) fn equal(&mut self, solver: &mut Solver, a: IntId, b: IntId) -> Lit {
        let (up, down) = (self.at_most(solver, a, b), self.at_most(solver, b, a));
        solver.and(up, down)
    }

    /// Returns the quotient, truncated towards 0, and the remainder of the division by a non-zero constant; `None` on
    /// overflow.
    pub(super) fn div_rem(
        &mut self,
        solver: &mut Solver,
        a: IntId,
        divisor: i64,
    ) -> Option<[IntId; 2]> {
        let size = divisor.checked_abs()?;
        if let Some(known) = self.divisions.get(&(a, divisor)) {
            return Some(*known);
        }
        let parts = match self.term(a).clone() {
            IntTerm::Choice(condition, yes, no) => {
                let yes = self.div_rem(solver, yes, divisor)?;
                let no = self.div_rem(solver, no, divisor)?;
                [0, 1].map(|k| self.if_then_else(solver, condition, yes[k], no[k]))
            }
            IntTerm::Sum(sum) => {
                let quotient = self.quotient(solver, sum, size)?;
                let rest = self.add_scaled(solver, a, quotient, size.checked_neg()?);
                let signed = self.scaled(solver, quotient, divisor.signum());
                [signed, rest]
            }
        };
        self.divisions.insert((a, divisor), parts);
        Some(parts)
    }

    fn quotient(&mut self, solver: &mut Solver, sum: LinearTerm, size: i64) -> Option<IntId> {
        if sum.terms.is_empty() {
            return Some(self.constant(sum.constant.checked_div(size)?));
        }
        let key = (sum, size);
        if let Some(known) = self.quotients.get(&key).cloned() {
            return Some(self.sum(known));
        }
        let quotient = LinearTerm::variable(solver.integer(i64::MIN / size, i64::MAX / size));
        let in_range = solver.fits(&key.0);
        let rest = key.0.add_scaled(&quotient, size.checked_neg()?)?;
        let is_negative = solver.at_most_zero(&key.0.add_scaled(&LinearTerm::constant(1), 1)?);
        for (unless, sum) in remainder_bounds(is_negative, &rest, size)? {
            let lit = solver.at_most_zero(&sum);
            solver.add_clause(&[!in_range, unless, lit]);
        }
        self.quotients.insert(key, quotient.clone());
        Some(self.sum(quotient))
    }
}

/// Returns bounds on the remainder `rest` of a division by `size`: sums that are at most 0 unless the literal with them
/// is true.
///
/// The remainder has the sign of the dividend: it is 0 to `size - 1`, or `1 - size` to 0 if `is_negative` is true.
/// Returns `None` on an overflow.
fn remainder_bounds(
    is_negative: Lit,
    rest: &LinearTerm,
    size: i64,
) -> Option<[(Lit, LinearTerm); 4]> {
    let negated = LinearTerm::constant(0).add_scaled(rest, -1)?;
    let last = LinearTerm::constant(1 - size);
    Some([
        (is_negative, rest.add_scaled(&last, 1)?),
        (is_negative, negated.clone()),
        (!is_negative, rest.clone()),
        (!is_negative, negated.add_scaled(&last, 1)?),
    ])
}
