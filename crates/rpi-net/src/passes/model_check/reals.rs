//! Real terms and their comparisons.
//!
//! A real is represented by an integer, its position in the order of all doubles, and a literal for NaN. So comparisons
//! are exact although the solver has no floating-point arithmetic. A comparison of a monotone function of one real with
//! a constant is reduced to a bound on the argument by binary search. Any other function is an unconstrained real.

use super::double_order::{double_at, last_where, max_position, position};
use super::integers::{IntId, Integers};
use crate::solver::{LinearTerm, Lit, Solver};
use rustc_hash::FxHashMap;

/// Maximal nesting depth, and maximal number of terms of a problem.
const DEPTH: u32 = 120;
const TERMS: usize = 60_000;

/// Index of a real term.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub(super) struct RealId(u32);

/// Operation on one real.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub(super) enum Unary {
    Negate,
    Absolute,
    Floor,
    Ceiling,
    Round,
}

/// Operation on two reals.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub(super) enum Binary {
    Add,
    Subtract,
    Multiply,
    Divide,
    Minimum,
    Maximum,
}

#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub(super) enum RealTerm {
    /// Constant, as the bits of a double.
    Constant(u64),
    /// Position as a solver variable, and the literal for NaN.
    Free(usize, Lit),
    Unary(Unary, RealId),
    Binary(Binary, RealId, RealId),
    FromInt(IntId),
    Choice(Lit, RealId, RealId),
}

/// All real terms of a problem, hash-consed.
#[derive(Debug, Default)]
pub(super) struct Reals {
    terms: Vec<(RealTerm, u32)>,
    known: FxHashMap<RealTerm, RealId>,
    comparisons: FxHashMap<(RealId, RealId, bool), Lit>,
    nans: FxHashMap<RealId, Lit>,
    /// Position variables of terms that are not interpreted.
    places: FxHashMap<RealId, usize>,
}

/// Comparison `a < b` if `is_strict`, otherwise `a <= b`.
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

/// Integer terms and solver, which comparisons need.
pub(super) struct TermContext<'a> {
    pub(super) integers: &'a mut Integers,
    pub(super) solver: &'a mut Solver,
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

    fn depth(&self, real: RealId) -> u32 {
        self.terms[real.0 as usize].1
    }

    pub(super) fn constant(&mut self, value: f64) -> RealId {
        self.insert(RealTerm::Constant(value.to_bits()), 0)
    }

    pub(super) fn real_of_int(&mut self, int: IntId) -> RealId {
        self.insert(RealTerm::FromInt(int), 0)
    }

    /// Creates an unconstrained real.
    pub(super) fn unconstrained(&mut self, solver: &mut Solver) -> RealId {
        let nan = solver.new_bool();
        let variable = solver.integer(-max_position(), max_position());
        self.insert(RealTerm::Free(variable, nan), 0)
    }

    /// Creates an unconstrained finite real that is not negative.
    pub(super) fn unconstrained_nonnegative(&mut self, solver: &mut Solver) -> RealId {
        let variable = solver.integer(0, max_position() - 1);
        self.insert(RealTerm::Free(variable, Lit::FALSE), 0)
    }

    /// Position and NaN literal of a free variable; `None` for other terms.
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

    /// Literal that is true exactly if a term is NaN.
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
                match op {
                    Binary::Minimum | Binary::Maximum => solver.all(operands),
                    _ if self.monotone(real).is_some() => solver.any(operands),
                    _ => {
                        let result = solver.new_bool();
                        solver.any([operands[0], operands[1], result])
                    }
                }
            }
        };
        self.nans.insert(real, lit);
        lit
    }

    /// Literal for `a < b` if `is_strict`, otherwise for `a <= b`. False if an operand is NaN.
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

    /// Compares `x - y` with 0 by comparing `x` with `y`. This is exact, since different doubles have a non-zero
    /// difference; that of equal infinities is NaN.
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

    /// Reduces a comparison of a function of one term with a constant to a comparison of that term; `None` if the
    /// function is not monotone.
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

    /// Compares a term with the position of the change: at most there if `up_to`, otherwise beyond. False for NaN.
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
        let wanted = if up_to { below } else { !below };
        around.solver.and(wanted, !nan)
    }

    /// Decomposes a term into a monotone function and its argument; `None` if it is not one. The function maps numbers
    /// to numbers.
    fn monotone(&self, real: RealId) -> Option<(RealId, Monotone)> {
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

    /// Compares two terms by their positions only.
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

    /// Position of a term as a sum of solver variables.
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
                let low = match term {
                    RealTerm::Binary(Binary::Multiply, a, b) if a == b => 0,
                    RealTerm::Unary(Unary::Absolute, _) => 0,
                    _ => -max_position(),
                };
                let variable = self.places.entry(real);
                LinearTerm::variable(
                    *variable.or_insert_with(|| solver.integer(low, max_position())),
                )
            }
        }
    }
}

/// Monotone function of one double.
#[derive(Clone, Copy)]
struct Monotone {
    op: Result<Unary, Binary>,
    constant: f64,
    constant_first: bool,
    rises: bool,
}

impl Monotone {
    fn unary(op: Unary) -> Monotone {
        Monotone {
            op: Ok(op),
            constant: 0.0,
            constant_first: false,
            rises: op != Unary::Negate,
        }
    }

    fn binary(op: Binary, constant: f64, constant_first: bool) -> Monotone {
        let is_factor = matches!(op, Binary::Multiply | Binary::Divide);
        let is_subtracted = op == Binary::Subtract && constant_first;
        Monotone {
            op: Err(op),
            constant,
            constant_first,
            rises: !(is_subtracted || is_factor && constant < 0.0),
        }
    }

    fn value(self, x: f64) -> f64 {
        match (self.op, self.constant_first) {
            (Ok(op), _) => apply_unary(op, x),
            (Err(op), true) => apply_binary(op, self.constant, x),
            (Err(op), false) => apply_binary(op, x, self.constant),
        }
    }
}

fn is_zero(bits: u64) -> bool {
    f64::from_bits(bits) == 0.0
}

/// Literal for a comparison with the minimum or maximum of two terms. It holds if one side does (`one_is_enough`),
/// otherwise both must. A NaN operand is ignored unless both are NaN.
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

/// Literal for a comparison of an integer whose truth value changes once.
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

fn apply_unary(op: Unary, a: f64) -> f64 {
    match op {
        Unary::Negate => -a,
        Unary::Absolute => a.abs(),
        Unary::Floor => a.floor(),
        Unary::Ceiling => a.ceil(),
        Unary::Round => a.round(),
    }
}

fn apply_binary(op: Binary, a: f64, b: f64) -> f64 {
    match op {
        Binary::Add => a + b,
        Binary::Subtract => a - b,
        Binary::Multiply => a * b,
        Binary::Divide => a / b,
        // If one operand is NaN, the other is returned, as in C's `fmin`.
        Binary::Minimum => a.min(b),
        Binary::Maximum => a.max(b),
    }
}
