//! Comparisons of real terms as literals of the solver.

use super::double_order::{double_at, last_where, max_position};
use super::integers::{IntId, Integers};
use super::real_functions::{Binary, Unary};
use super::reals::{DEPTH, RealId, RealTerm, Reals, TERMS};
use crate::solver::{LinearTerm, Lit, Solver};

/// Comparison of two real terms: `a < b` if `is_strict` is true, otherwise `a <= b`.
#[derive(Clone, Copy)]
struct Comparison {
    a: RealId,
    b: RealId,
    is_strict: bool,
}

impl Comparison {
    fn holds(self, a: f64, b: f64) -> bool {
        if self.is_strict { a < b } else { a <= b }
    }
}

/// Table of integer terms and solver, to which the encoding of real comparisons adds terms and literals.
pub(super) struct TermContext<'a> {
    pub(super) integers: &'a mut Integers,
    pub(super) solver: &'a mut Solver,
}

impl Reals {
    /// Returns a literal for `a < b` if `is_strict` is true, otherwise for `a <= b`. The literal is false if an operand
    /// is NaN.
    pub(super) fn compare(
        &mut self,
        around: &mut TermContext<'_>,
        a: RealId,
        b: RealId,
        is_strict: bool,
    ) -> Lit {
        if let Some(known) = self.comparisons.get(&(a, b, is_strict)) {
            return *known;
        }
        let comparison = Comparison { a, b, is_strict };
        let is_deep = self.depth(a).max(self.depth(b)) > DEPTH;
        let lit = match is_deep || self.comparisons.len() > TERMS {
            true => self.compare_places(around, comparison),
            false => self.compare_terms(around, comparison),
        };
        self.comparisons.insert((a, b, is_strict), lit);
        lit
    }

    fn compare_terms(&mut self, around: &mut TermContext<'_>, comparison: Comparison) -> Lit {
        let Comparison { a, b, is_strict } = comparison;
        match (self.term(a), self.term(b)) {
            (RealTerm::Constant(x), RealTerm::Constant(y)) => {
                Lit::constant(comparison.holds(f64::from_bits(x), f64::from_bits(y)))
            }
            (RealTerm::Choice(condition, yes, no), _) => {
                let yes = self.compare(around, yes, b, is_strict);
                let no = self.compare(around, no, b, is_strict);
                around.solver.if_then_else(condition, yes, no)
            }
            (_, RealTerm::Choice(condition, yes, no)) => {
                let yes = self.compare(around, a, yes, is_strict);
                let no = self.compare(around, a, no, is_strict);
                around.solver.if_then_else(condition, yes, no)
            }
            (RealTerm::Binary(op @ (Binary::Minimum | Binary::Maximum), x, y), _) => {
                let sides = [x, y].map(|x| self.compare(around, x, b, is_strict));
                let nans = [x, y].map(|x| self.is_nan(around.solver, x));
                compare_extreme(around.solver, op == Binary::Minimum, sides, nans)
            }
            (_, RealTerm::Binary(op @ (Binary::Minimum | Binary::Maximum), x, y)) => {
                let sides = [x, y].map(|x| self.compare(around, a, x, is_strict));
                let nans = [x, y].map(|x| self.is_nan(around.solver, x));
                compare_extreme(around.solver, op == Binary::Maximum, sides, nans)
            }
            (RealTerm::Binary(Binary::Subtract, x, y), _) if x == y => {
                let (zero, nan) = (self.constant(0.0), self.is_nan(around.solver, a));
                let order = self.compare(around, zero, b, is_strict);
                around.solver.and(order, !nan)
            }
            (_, RealTerm::Binary(Binary::Subtract, x, y)) if x == y => {
                let (zero, nan) = (self.constant(0.0), self.is_nan(around.solver, b));
                let order = self.compare(around, a, zero, is_strict);
                around.solver.and(order, !nan)
            }
            (RealTerm::Binary(Binary::Subtract, x, y), RealTerm::Constant(zero))
                if is_zero(zero) =>
            {
                self.compare_difference(around, a, [x, y], is_strict)
            }
            (RealTerm::Constant(zero), RealTerm::Binary(Binary::Subtract, x, y))
                if is_zero(zero) =>
            {
                self.compare_difference(around, b, [y, x], is_strict)
            }
            (_, RealTerm::Constant(bits)) => {
                let inverted =
                    self.reduce_monotone(around, comparison, a, f64::from_bits(bits), true);
                inverted.unwrap_or_else(|| self.compare_places(around, comparison))
            }
            (RealTerm::Constant(bits), _) => {
                let inverted =
                    self.reduce_monotone(around, comparison, b, f64::from_bits(bits), false);
                inverted.unwrap_or_else(|| self.compare_places(around, comparison))
            }
            _ => self.compare_places(around, comparison),
        }
    }

    /// Returns a literal for the comparison of `difference`, which is `x - y`, with 0. It compares `x` with `y`.
    ///
    /// This is exact, since the difference of unequal doubles is not 0. The difference of equal infinities is NaN.
    fn compare_difference(
        &mut self,
        around: &mut TermContext<'_>,
        difference: RealId,
        [x, y]: [RealId; 2],
        is_strict: bool,
    ) -> Lit {
        let nan = self.is_nan(around.solver, difference);
        let order = self.compare(around, x, y, is_strict);
        around.solver.and(order, !nan)
    }

    /// Reduces the comparison of a function of one term with a constant to a comparison of that term. `is_left` is true
    /// if the function is the left operand. `None` if the function is not monotone.
    fn reduce_monotone(
        &mut self,
        around: &mut TermContext<'_>,
        comparison: Comparison,
        function: RealId,
        constant: f64,
        is_left: bool,
    ) -> Option<Lit> {
        if constant.is_nan() {
            return Some(Lit::FALSE);
        }
        let test = |value: f64| match is_left {
            true => comparison.holds(value, constant),
            false => comparison.holds(constant, value),
        };
        match self.term(function) {
            RealTerm::FromInt(int) => {
                Some(compare_integer(around, int, is_left, |k| test(k as f64)))
            }
            RealTerm::Unary(Unary::Absolute, x) => {
                let negative = self.unary(Unary::Negate, x);
                let sides = [x, negative].map(|x| match is_left {
                    true => self.compare(around, x, comparison.b, comparison.is_strict),
                    false => self.compare(around, comparison.a, x, comparison.is_strict),
                });
                Some(match is_left {
                    true => around.solver.all(sides),
                    false => around.solver.any(sides),
                })
            }
            _ => {
                let (argument, function) = self.monotone(function)?;
                // The truth value changes once: from true to false if the function rises and is on the left side.
                let begins_true = function.rises == is_left;
                let holds = |k: i64| test(function.value(double_at(k))) == begins_true;
                let turn = last_where(-max_position(), max_position(), holds);
                Some(self.compare_with_turn(around, argument, turn, begins_true))
            }
        }
    }

    /// Returns a literal for a comparison of `argument` with the double of rank `turn`: at most that double if `up_to`
    /// is true, otherwise above it. The literal is false for NaN. The rank `None` lies below all doubles.
    fn compare_with_turn(
        &mut self,
        around: &mut TermContext<'_>,
        argument: RealId,
        turn: Option<i64>,
        up_to: bool,
    ) -> Lit {
        let nan = self.is_nan(around.solver, argument);
        let below = match turn {
            None => Lit::FALSE,
            Some(turn) => {
                let turn = self.constant(double_at(turn));
                self.compare(around, argument, turn, false)
            }
        };
        let reached = if up_to { below } else { !below };
        around.solver.and(reached, !nan)
    }

    /// Returns a literal for a comparison of two terms by their ranks in the order of doubles. It ignores the
    /// operations that compute the terms.
    fn compare_places(&mut self, around: &mut TermContext<'_>, comparison: Comparison) -> Lit {
        let Comparison { a, b, is_strict } = comparison;
        let (left, right) = (
            self.position(around.solver, a),
            self.position(around.solver, b),
        );
        let order = match left.add_scaled(&right, -1) {
            Some(difference) => {
                let shift = LinearTerm::constant(i64::from(is_strict));
                match difference.add_scaled(&shift, 1) {
                    Some(sum) => around.solver.at_most_zero(&sum),
                    None => around.solver.new_bool(),
                }
            }
            None => around.solver.new_bool(),
        };
        let nans = [a, b].map(|x| !self.is_nan(around.solver, x));
        around.solver.all([order, nans[0], nans[1]])
    }
}

fn is_zero(bits: u64) -> bool {
    f64::from_bits(bits) == 0.0
}

/// Returns a literal for a comparison with the minimum or maximum of two terms. `sides` are the comparisons with each
/// term, `nans` whether each is NaN.
///
/// One of the comparisons must hold if `one_is_enough` is true, otherwise both. A NaN operand is ignored unless both
/// are NaN.
fn compare_extreme(
    solver: &mut Solver,
    one_is_enough: bool,
    sides: [Lit; 2],
    nans: [Lit; 2],
) -> Lit {
    if one_is_enough {
        return solver.any(sides);
    }
    let either = [0, 1].map(|k| solver.or(sides[k], nans[k]));
    let both = solver.all(either);
    let no_number = solver.all(nans);
    solver.and(both, !no_number)
}

/// Returns a literal for a comparison of an integer with a constant real. `test` is its truth value for an integer; it
/// changes at most once as the integer grows, from the value `begins_true`.
fn compare_integer(
    around: &mut TermContext<'_>,
    int: IntId,
    begins_true: bool,
    test: impl Fn(i64) -> bool,
) -> Lit {
    let turn = last_where(i64::MIN, i64::MAX, |k| test(k) == begins_true);
    let below = match turn {
        None => Lit::FALSE,
        Some(turn) => {
            let turn = around.integers.constant(turn);
            around.integers.at_most(around.solver, int, turn)
        }
    };
    if begins_true { below } else { !below }
}
