//! Integer terms: linear sums of variables, selected by conditions.
//!
//! Operations and comparisons are pushed through the choices down to the sums, so that only comparisons of sums with
//! constants remain. The values are mathematical integers: on overflow the cycle has a fault and no set-point is
//! emitted; if the operation is not evaluated, its value is never read.

use crate::solver::{Linear, Lit, Solver};
use rustc_hash::FxHashMap;

/// Maximal nesting depth of choices, and maximal number of terms of a problem. Beyond them, a new variable replaces the
/// term.
const DEPTH: u32 = 120;
const TERMS: usize = 60_000;

/// Index of an integer term.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub(super) struct Int(u32);

#[derive(Clone, PartialEq, Eq, Hash, Debug)]
pub(super) enum IntTerm {
    Sum(Linear),
    Choice(Lit, Int, Int),
}

/// All integer terms of a problem, hash-consed.
#[derive(Debug, Default)]
pub(super) struct Integers {
    terms: Vec<(IntTerm, u32)>,
    known: FxHashMap<IntTerm, Int>,
    sums: FxHashMap<(Int, Int, i64), Int>,
    signs: FxHashMap<Int, Lit>,
    fitting: FxHashMap<Int, Lit>,
    quotients: FxHashMap<(Linear, i64), Linear>,
    divisions: FxHashMap<(Int, i64), [Int; 2]>,
}

impl Integers {
    pub(super) fn term(&self, int: Int) -> &IntTerm {
        &self.terms[int.0 as usize].0
    }

    /// Value of a constant term; `None` for other terms.
    pub(super) fn as_constant(&self, int: Int) -> Option<i64> {
        match self.term(int) {
            IntTerm::Sum(sum) if sum.terms.is_empty() => Some(sum.constant),
            _ => None,
        }
    }

    pub(super) fn constant(&mut self, value: i64) -> Int {
        self.sum(Linear::constant(value))
    }

    /// Creates an integer variable with inclusive bounds.
    pub(super) fn fresh(&mut self, solver: &mut Solver, low: i64, high: i64) -> Int {
        let variable = solver.integer(low, high);
        self.sum(Linear::variable(variable))
    }

    pub(super) fn unknown(&mut self, solver: &mut Solver) -> Int {
        self.fresh(solver, i64::MIN, i64::MAX)
    }

    pub(super) fn sum(&mut self, sum: Linear) -> Int {
        self.insert(IntTerm::Sum(sum), 0)
    }

    fn insert(&mut self, term: IntTerm, depth: u32) -> Int {
        if let Some(known) = self.known.get(&term) {
            return *known;
        }
        let int = Int(u32::try_from(self.terms.len()).unwrap_or(u32::MAX));
        self.terms.push((term.clone(), depth));
        self.known.insert(term, int);
        int
    }

    fn depth(&self, int: Int) -> u32 {
        self.terms[int.0 as usize].1
    }

    pub(super) fn choose(&mut self, solver: &mut Solver, condition: Lit, yes: Int, no: Int) -> Int {
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
        let named = self.unknown(solver);
        for (branch, guard) in [(yes, !condition), (no, condition)] {
            let equal = self.equal(solver, named, branch);
            let fits = self.fits(solver, branch);
            solver.require(&[guard, !fits, equal]);
        }
        named
    }

    /// Returns the term `a + factor * b`.
    pub(super) fn plus(&mut self, solver: &mut Solver, a: Int, b: Int, factor: i64) -> Int {
        if let Some(known) = self.sums.get(&(a, b, factor)) {
            return *known;
        }
        let sum = match (self.term(a).clone(), self.term(b).clone()) {
            _ if self.terms.len() > TERMS => self.unknown(solver),
            (IntTerm::Sum(a), IntTerm::Sum(b)) => match a.plus(&b, factor) {
                Some(sum) => self.sum(sum),
                None => self.unknown(solver),
            },
            (IntTerm::Choice(c, yes, no), other) => {
                let (left, right) = match other {
                    IntTerm::Choice(d, left, right) if c == d => (left, right),
                    _ => (b, b),
                };
                let yes = self.plus(solver, yes, left, factor);
                let no = self.plus(solver, no, right, factor);
                self.choose(solver, c, yes, no)
            }
            (IntTerm::Sum(_), IntTerm::Choice(c, yes, no)) => {
                let yes = self.plus(solver, a, yes, factor);
                let no = self.plus(solver, a, no, factor);
                self.choose(solver, c, yes, no)
            }
        };
        self.sums.insert((a, b, factor), sum);
        sum
    }

    pub(super) fn scaled(&mut self, solver: &mut Solver, a: Int, factor: i64) -> Int {
        let zero = self.constant(0);
        self.plus(solver, zero, a, factor)
    }

    /// Product of two terms; `None` unless one of them is constant.
    pub(super) fn times(&mut self, solver: &mut Solver, a: Int, b: Int) -> Option<Int> {
        match (self.as_constant(a), self.as_constant(b)) {
            (Some(factor), _) => Some(self.scaled(solver, b, factor)),
            (_, Some(factor)) => Some(self.scaled(solver, a, factor)),
            _ => None,
        }
    }

    /// Literal that is true exactly if the term is at most 0.
    pub(super) fn at_most_zero(&mut self, solver: &mut Solver, int: Int) -> Lit {
        if let Some(known) = self.signs.get(&int) {
            return *known;
        }
        let lit = match self.term(int).clone() {
            IntTerm::Sum(sum) => solver.at_most_zero(&sum),
            IntTerm::Choice(condition, yes, no) => {
                let yes = self.at_most_zero(solver, yes);
                let no = self.at_most_zero(solver, no);
                solver.choose(condition, yes, no)
            }
        };
        self.signs.insert(int, lit);
        lit
    }

    pub(super) fn at_most(&mut self, solver: &mut Solver, a: Int, b: Int) -> Lit {
        let difference = self.plus(solver, a, b, -1);
        self.at_most_zero(solver, difference)
    }

    /// Literal that is true exactly if the term fits in `i64`. It need not if the operation is not evaluated.
    fn fits(&mut self, solver: &mut Solver, int: Int) -> Lit {
        if let Some(known) = self.fitting.get(&int) {
            return *known;
        }
        let lit = match self.term(int).clone() {
            IntTerm::Sum(sum) => solver.fits(&sum),
            IntTerm::Choice(condition, yes, no) => {
                let yes = self.fits(solver, yes);
                let no = self.fits(solver, no);
                solver.choose(condition, yes, no)
            }
        };
        self.fitting.insert(int, lit);
        lit
    }

    pub(super) fn equal(&mut self, solver: &mut Solver, a: Int, b: Int) -> Lit {
        let (up, down) = (self.at_most(solver, a, b), self.at_most(solver, b, a));
        solver.and(up, down)
    }

    /// Quotient and remainder of the division by a non-zero constant, truncated towards 0.
    pub(super) fn divided(
        &mut self,
        solver: &mut Solver,
        a: Int,
        divisor: i64,
    ) -> Option<[Int; 2]> {
        let size = divisor.checked_abs()?;
        if let Some(known) = self.divisions.get(&(a, divisor)) {
            return Some(*known);
        }
        let parts = match self.term(a).clone() {
            IntTerm::Choice(condition, yes, no) => {
                let yes = self.divided(solver, yes, divisor)?;
                let no = self.divided(solver, no, divisor)?;
                [0, 1].map(|k| self.choose(solver, condition, yes[k], no[k]))
            }
            IntTerm::Sum(sum) => {
                let quotient = self.quotient(solver, sum, size)?;
                let rest = self.plus(solver, a, quotient, size.checked_neg()?);
                let signed = self.scaled(solver, quotient, divisor.signum());
                [signed, rest]
            }
        };
        self.divisions.insert((a, divisor), parts);
        Some(parts)
    }

    fn quotient(&mut self, solver: &mut Solver, sum: Linear, size: i64) -> Option<Int> {
        if sum.terms.is_empty() {
            return Some(self.constant(sum.constant.checked_div(size)?));
        }
        let key = (sum, size);
        if let Some(known) = self.quotients.get(&key).cloned() {
            return Some(self.sum(known));
        }
        let quotient = Linear::variable(solver.integer(i64::MIN / size, i64::MAX / size));
        let fits = solver.fits(&key.0);
        let rest = key.0.plus(&quotient, size.checked_neg()?)?;
        let zero = Linear::constant(0);
        let negated = zero.plus(&rest, -1)?;
        // The remainder has the sign of the dividend: 0 to size - 1, or 1 - size to 0.
        let is_negative = solver.at_most_zero(&key.0.plus(&Linear::constant(1), 1)?);
        let last = Linear::constant(1 - size);
        let bounds = [
            (is_negative, rest.plus(&last, 1)?),
            (is_negative, negated.clone()),
            (!is_negative, rest.clone()),
            (!is_negative, negated.plus(&last, 1)?),
        ];
        for (unless, sum) in bounds {
            let lit = solver.at_most_zero(&sum);
            solver.require(&[!fits, unless, lit]);
        }
        self.quotients.insert(key, quotient.clone());
        Some(self.sum(quotient))
    }
}
