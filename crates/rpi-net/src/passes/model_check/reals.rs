//! Real terms.
//!
//! A real is represented by an integer, its position in the order of all doubles, and a literal for NaN. So comparisons
//! are exact although the solver has no floating-point arithmetic. A comparison of a monotone function of one real with
//! a constant is reduced to a bound on the argument by binary search. Any other function is an unconstrained real.

use super::double_order::{max_position, position};
use super::integers::IntId;
use super::real_functions::{Binary, Monotone, Unary, apply_binary, apply_unary};
use crate::solver::{LinearTerm, Lit, Solver};
use rustc_hash::FxHashMap;

/// Maximum nesting depth of real terms. The value of a deeper term is unconstrained.
pub(super) const DEPTH: u32 = 120;
/// Maximum number of real terms in a problem of the solver. The values of further terms are unconstrained.
pub(super) const TERMS: usize = 60_000;

/// Index of a real term in the table [`Reals`].
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub(super) struct RealId(u32);

#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub(super) enum RealTerm {
    /// Constant, given by the bits of the double.
    Constant(u64),
    /// Unconstrained real: the solver variable of its rank in the order of doubles, and the literal that is true if it
    /// is NaN.
    Free(usize, Lit),
    Unary(Unary, RealId),
    Binary(Binary, RealId, RealId),
    FromInt(IntId),
    Choice(Lit, RealId, RealId),
}

/// Table of all real terms in a problem of the solver. Equal terms are stored once (hash-consing).
#[derive(Debug, Default)]
pub(super) struct Reals {
    terms: Vec<(RealTerm, u32)>,
    known: FxHashMap<RealTerm, RealId>,
    /// Literals of the comparisons encoded so far: `a < b` for the key `(a, b, true)`, `a <= b` for `(a, b, false)`.
    pub(super) comparisons: FxHashMap<(RealId, RealId, bool), Lit>,
    nans: FxHashMap<RealId, Lit>,
    /// Solver variables for the ranks, in the order of doubles, of terms whose values are not computed exactly.
    places: FxHashMap<RealId, usize>,
}

impl Reals {
    pub(super) fn term(&self, real: RealId) -> RealTerm {
        self.terms[real.0 as usize].0
    }

    fn insert(&mut self, term: RealTerm, depth: u32) -> RealId {
        if let Some(known) = self.known.get(&term) {
            return *known;
        }
        let real = RealId(u32::try_from(self.terms.len()).unwrap_or(u32::MAX));
        self.terms.push((term, depth));
        self.known.insert(term, real);
        real
    }

    pub(super) fn depth(&self, real: RealId) -> u32 {
        self.terms[real.0 as usize].1
    }

    pub(super) fn constant(&mut self, value: f64) -> RealId {
        self.insert(RealTerm::Constant(value.to_bits()), 0)
    }

    pub(super) fn real_of_int(&mut self, int: IntId) -> RealId {
        self.insert(RealTerm::FromInt(int), 0)
    }

    /// Creates a real variable that may have any value, including NaN.
    pub(super) fn unconstrained(&mut self, solver: &mut Solver) -> RealId {
        let nan = solver.new_bool();
        let variable = solver.integer(-max_position(), max_position());
        self.insert(RealTerm::Free(variable, nan), 0)
    }

    /// Creates a real variable that may have any finite value from 0.
    pub(super) fn unconstrained_nonnegative(&mut self, solver: &mut Solver) -> RealId {
        let variable = solver.integer(0, max_position() - 1);
        self.insert(RealTerm::Free(variable, Lit::FALSE), 0)
    }

    /// Returns the rank, in the order of doubles, and the NaN literal of a real variable; `None` for other terms.
    pub(super) fn as_variable(&self, real: RealId) -> Option<(LinearTerm, Lit)> {
        match self.term(real) {
            RealTerm::Free(variable, nan) => Some((LinearTerm::variable(variable), nan)),
            _ => None,
        }
    }

    pub(super) fn unary(&mut self, op: Unary, a: RealId) -> RealId {
        if let RealTerm::Constant(bits) = self.term(a) {
            return self.constant(apply_unary(op, f64::from_bits(bits)));
        }
        if let (Unary::Negate, RealTerm::Unary(Unary::Negate, inner)) = (op, self.term(a)) {
            return inner;
        }
        let depth = self.depth(a) + 1;
        self.insert(RealTerm::Unary(op, a), depth)
    }

    pub(super) fn binary(&mut self, op: Binary, a: RealId, b: RealId) -> RealId {
        if let (RealTerm::Constant(a), RealTerm::Constant(b)) = (self.term(a), self.term(b)) {
            return self.constant(apply_binary(op, f64::from_bits(a), f64::from_bits(b)));
        }
        let depth = self.depth(a).max(self.depth(b)) + 1;
        self.insert(RealTerm::Binary(op, a, b), depth)
    }

    pub(super) fn if_then_else(
        &mut self,
        solver: &mut Solver,
        condition: Lit,
        yes: RealId,
        no: RealId,
    ) -> RealId {
        match condition {
            Lit::TRUE => return yes,
            Lit::FALSE => return no,
            _ if yes == no => return yes,
            _ => {}
        }
        let depth = self.depth(yes).max(self.depth(no)) + 1;
        match depth <= DEPTH && self.terms.len() < TERMS {
            true => self.insert(RealTerm::Choice(condition, yes, no), depth),
            false => self.unconstrained(solver),
        }
    }

    /// Returns a literal that is true exactly if the term is NaN.
    pub(super) fn is_nan(&mut self, solver: &mut Solver, real: RealId) -> Lit {
        if let Some(known) = self.nans.get(&real) {
            return *known;
        }
        let lit = match self.term(real) {
            _ if self.depth(real) > DEPTH => solver.new_bool(),
            RealTerm::Constant(bits) => Lit::constant(f64::from_bits(bits).is_nan()),
            RealTerm::Free(_, nan) => nan,
            RealTerm::FromInt(_) => Lit::FALSE,
            RealTerm::Unary(_, a) => self.is_nan(solver, a),
            RealTerm::Choice(condition, yes, no) => {
                let (yes, no) = (self.is_nan(solver, yes), self.is_nan(solver, no));
                solver.if_then_else(condition, yes, no)
            }
            RealTerm::Binary(op, a, b) => {
                let operands = [self.is_nan(solver, a), self.is_nan(solver, b)];
                let is_monotone = self.monotone(real).is_some();
                binary_is_nan(solver, op, operands, is_monotone)
            }
        };
        self.nans.insert(real, lit);
        lit
    }

    /// Returns the argument and the function of a term that is a monotone function of another term; `None` for other
    /// terms. The function never maps a number to NaN.
    pub(super) fn monotone(&self, real: RealId) -> Option<(RealId, Monotone)> {
        let usable =
            |value: f64, is_factor: bool| value.is_finite() && (!is_factor || value != 0.0);
        match self.term(real) {
            RealTerm::Unary(Unary::Absolute, _) => None,
            RealTerm::Unary(op, x) => Some((x, Monotone::unary(op))),
            RealTerm::Binary(op, x, y) => match (self.term(x), self.term(y)) {
                (_, RealTerm::Constant(bits)) => {
                    let constant = f64::from_bits(bits);
                    let is_factor = matches!(op, Binary::Multiply | Binary::Divide);
                    let known = !matches!(op, Binary::Minimum | Binary::Maximum);
                    (known && usable(constant, is_factor))
                        .then(|| (x, Monotone::binary(op, constant, false)))
                }
                (RealTerm::Constant(bits), _) => {
                    let constant = f64::from_bits(bits);
                    let known = matches!(op, Binary::Add | Binary::Subtract | Binary::Multiply);
                    (known && usable(constant, op == Binary::Multiply))
                        .then(|| (y, Monotone::binary(op, constant, true)))
                }
                _ => None,
            },
            _ => None,
        }
    }

    /// Returns the rank of a real term in the order of all doubles, as a linear term over solver variables. Ranks
    /// reduce comparisons of doubles to comparisons of integers.
    pub(super) fn position(&mut self, solver: &mut Solver, real: RealId) -> LinearTerm {
        match self.term(real) {
            RealTerm::Constant(bits) => {
                let value = f64::from_bits(bits);
                // The position of NaN is irrelevant.
                LinearTerm::constant(if value.is_nan() { 0 } else { position(value) })
            }
            RealTerm::Free(variable, _) => LinearTerm::variable(variable),
            // Negation mirrors the position at 0.
            RealTerm::Unary(Unary::Negate, a) => {
                let place = self.position(solver, a);
                let negated = LinearTerm::constant(0).add_scaled(&place, -1);
                negated.unwrap_or_else(|| {
                    LinearTerm::variable(solver.integer(-max_position(), max_position()))
                })
            }
            term => {
                let low = lowest_position(term);
                let variable = self.places.entry(real);
                LinearTerm::variable(
                    *variable.or_insert_with(|| solver.integer(low, max_position())),
                )
            }
        }
    }
}

/// Returns a literal that is true exactly if the result of a binary operation is NaN. `left` and `right` are the
/// literals for NaN operands.
///
/// A monotone operation gives NaN only for a NaN operand; any other operation may also give NaN for numbers.
fn binary_is_nan(
    solver: &mut Solver,
    op: Binary,
    [left, right]: [Lit; 2],
    is_monotone: bool,
) -> Lit {
    match op {
        Binary::Minimum | Binary::Maximum => solver.all([left, right]),
        _ if is_monotone => solver.any([left, right]),
        _ => {
            let result = solver.new_bool();
            solver.any([left, right, result])
        }
    }
}

/// Returns the lowest rank, in the order of doubles, that a term can have. Squares and absolute values are not
/// negative.
fn lowest_position(term: RealTerm) -> i64 {
    match term {
        RealTerm::Binary(Binary::Multiply, a, b) if a == b => 0,
        RealTerm::Unary(Unary::Absolute, _) => 0,
        _ => -max_position(),
    }
}
