//! Feasibility of bounds on integer variables and on sums of them: the simplex method with lazily asserted bounds
//! (Dutertre and de Moura 2006), then a divisibility test and a limited branch and bound for the integers.
//!
//! The arithmetic is exact and bounded. On overflow of 128 bits or after too many steps the result is `Unknown`, which
//! never counts as a proof.

use super::rational::{Rational, gcd};
use super::sat::Lit;
use std::cmp::Ordering;
use std::collections::BTreeMap;

/// Maximum number of branches in a feasibility check (branch and bound, which makes the variables integers). Beyond it,
/// the result is unknown.
const BRANCHES: usize = 40;
/// Maximum number of pivots in a feasibility check. Beyond it, the result is unknown.
const PIVOTS: usize = 2_000;
/// Cost of an update of a tableau row, in steps of the SAT search.
const STEPS_PER_ROW: u64 = 8;

/// Reason for a bound of a variable. Conflicts are explained by the reasons of their bounds.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
enum Reason {
    Always,
    Asserted(Lit),
    /// The bound was assumed by the branch at this depth of branch and bound.
    Branch(usize),
}

/// Result of a feasibility check: whether linear constraints have an integer solution.
#[derive(Clone, PartialEq, Eq, Debug)]
pub(crate) enum Feasibility {
    Feasible,
    /// There is no solution: these literals, whose bounds conflict, cannot all be true.
    Infeasible(Vec<Lit>),
    Unknown,
}

/// Cause for which a feasibility check ends without a solution: a conflict between bounds, or an undecided result.
enum CheckError {
    Conflict(Vec<Reason>),
    Unknown,
}

type CheckResult = Result<(), CheckError>;

type Bound = Option<(i128, Reason)>;

#[derive(Clone, Debug)]
struct Variable {
    value: Rational,
    lower: Bound,
    upper: Bound,
    /// Lowest and highest value of the variable in any check.
    limits: (i128, i128),
}

type Row = BTreeMap<usize, Rational>;

/// Simplex tableau: variables with bounds, and rows that each define a basic variable as a sum of non-basic variables.
#[derive(Debug, Default)]
pub(crate) struct Simplex {
    variables: Vec<Variable>,
    rows: BTreeMap<usize, Row>,
    /// For each variable that equals a sum, the sum over the variables with which it was created.
    definitions: BTreeMap<usize, Row>,
    pivots: usize,
    branches: usize,
}

fn or_unknown<T>(value: Option<T>) -> Result<T, CheckError> {
    value.ok_or(CheckError::Unknown)
}

/// Returns the least common denominator of the factors in a row.
fn common_denominator(row: &Row) -> Result<i128, CheckError> {
    let mut common: i128 = 1;
    for factor in row.values() {
        let denominator = factor.denominator();
        let shared = or_unknown(gcd(common, denominator))?.max(1);
        common = or_unknown((common / shared).checked_mul(denominator))?;
    }
    Ok(common)
}

impl Simplex {
    /// Adds a variable from `low` to `high`, both included, and returns its index.
    pub(crate) fn variable(&mut self, low: i128, high: i128) -> usize {
        self.variables.push(Variable {
            value: Rational::from_int(0.clamp(low, high)),
            lower: Some((low, Reason::Always)),
            upper: Some((high, Reason::Always)),
            limits: (low, high),
        });
        self.variables.len() - 1
    }

    /// Returns the number of variables of the tableau.
    pub(crate) fn size(&self) -> usize {
        self.variables.len()
    }

    /// Returns the approximate cost of the last feasibility check, in steps of the SAT search.
    pub(crate) fn work(&self) -> u64 {
        (self.pivots + self.branches) as u64 * (self.rows.len() as u64 + 1) * STEPS_PER_ROW
    }

    /// Returns the lowest and the highest value of a variable in any check.
    pub(crate) fn limits(&self, variable: usize) -> (i128, i128) {
        self.variables[variable].limits
    }

    /// Adds a variable that equals a sum of variables with factors, and returns its index; `None` on overflow. `limits`
    /// are the lowest and the highest value of the sum.
    pub(crate) fn sum(&mut self, terms: &[(usize, i64)], limits: (i128, i128)) -> Option<usize> {
        let mut row = Row::new();
        let mut definition = Row::new();
        let mut value = Rational::ZERO;
        for (variable, factor) in terms {
            let factor = Rational::from_int(i128::from(*factor));
            value = value.add(self.variables[*variable].value.mul(factor)?)?;
            definition.insert(*variable, factor);
            match self.rows.get(variable).cloned() {
                Some(inner) => add_scaled(&mut row, &inner, factor)?,
                None => add_scaled(&mut row, &Row::from([(*variable, Rational::ONE)]), factor)?,
            }
        }
        let new = self.variable(limits.0, limits.1);
        self.variables[new].value = value;
        self.rows.insert(new, row);
        self.definitions.insert(new, definition);
        Some(new)
    }

    /// Resets the bounds of all variables to their limits, which hold in any check.
    pub(crate) fn reset(&mut self) {
        for variable in &mut self.variables {
            variable.lower = Some((variable.limits.0, Reason::Always));
            variable.upper = Some((variable.limits.1, Reason::Always));
        }
        (self.pivots, self.branches) = (0, 0);
    }

    /// Checks whether there is an integer solution within bounds. Each bound consists of the variable, the value,
    /// whether it is an upper bound, and the literal that asserts it.
    pub(crate) fn check(&mut self, bounds: &[(usize, i128, bool, Lit)]) -> Feasibility {
        self.reset();
        let mut asserted = bounds.iter();
        let all = self
            // Non-basic variables keep their values from the last check as a warm start.
            .recompute()
            .and_then(|()| {
                asserted.try_for_each(|(variable, bound, is_upper, lit)| {
                    self.assert_bound(*variable, *bound, *is_upper, Reason::Asserted(*lit))
                })
            })
            .and_then(|()| self.make_feasible())
            .and_then(|()| self.check_divisibility())
            .and_then(|()| self.branch(0));
        match all {
            Ok(()) => Feasibility::Feasible,
            Err(CheckError::Unknown) => {
                self.restore_rows();
                Feasibility::Unknown
            }
            Err(CheckError::Conflict(reasons)) => Feasibility::Infeasible(literals(&reasons)),
        }
    }

    /// Restores the rows of the tableau from the definitions of the sums. A pivot that overflows leaves the rows
    /// inconsistent.
    fn restore_rows(&mut self) {
        self.rows.clone_from(&self.definitions);
        for variable in &mut self.variables {
            let (low, high) = variable.limits;
            variable.value = Rational::from_int(0.clamp(low, high));
        }
    }

    /// Returns the value of a variable after a check; `None` if the value is not an integer.
    pub(crate) fn value(&self, variable: usize) -> Option<i128> {
        self.variables[variable].value.as_int()
    }

    fn assert_bound(
        &mut self,
        at: usize,
        bound: i128,
        is_upper: bool,
        reason: Reason,
    ) -> CheckResult {
        let variable = &mut self.variables[at];
        let (own, other) = match is_upper {
            true => (&mut variable.upper, &variable.lower),
            false => (&mut variable.lower, &variable.upper),
        };
        let exceeds = |a: i128, b: i128| if is_upper { a < b } else { a > b };
        if own.is_some_and(|(old, _)| !exceeds(bound, old)) {
            return Ok(());
        }
        if let Some((other, why)) = other
            && exceeds(bound, *other)
        {
            return Err(CheckError::Conflict(vec![reason, *why]));
        }
        *own = Some((bound, reason));
        let limit = Rational::from_int(bound);
        let order = or_unknown(variable.value.checked_cmp(limit))?;
        let violated = match is_upper {
            true => order == Ordering::Greater,
            false => order == Ordering::Less,
        };
        // A basic variable outside its bounds is repaired later by `feasible`.
        match violated && !self.rows.contains_key(&at) {
            true => self.update(at, limit),
            false => Ok(()),
        }
    }

    /// Sets the value of the non-basic variable `at` and updates all basic ones.
    fn update(&mut self, at: usize, value: Rational) -> CheckResult {
        let change = or_unknown(value.sub(self.variables[at].value))?;
        self.variables[at].value = value;
        for (basic, row) in &self.rows {
            if let Some(factor) = row.get(&at) {
                let sum = &mut self.variables[*basic].value;
                *sum = or_unknown(factor.mul(change).and_then(|c| sum.add(c)))?;
            }
        }
        Ok(())
    }

    /// Returns the first basic variable outside of its bounds, the bound that it must reach, and whether its value must
    /// grow. `None` if all are within their bounds.
    fn violation(&self) -> Result<Option<(usize, i128, bool)>, CheckError> {
        for basic in self.rows.keys() {
            let variable = &self.variables[*basic];
            if let Some((low, _)) = variable.lower
                && or_unknown(variable.value.checked_cmp(Rational::from_int(low)))?
                    == Ordering::Less
            {
                return Ok(Some((*basic, low, true)));
            }
            if let Some((high, _)) = variable.upper
                && or_unknown(variable.value.checked_cmp(Rational::from_int(high)))?
                    == Ordering::Greater
            {
                return Ok(Some((*basic, high, false)));
            }
        }
        Ok(None)
    }

    fn make_feasible(&mut self) -> CheckResult {
        while let Some((basic, target, upwards)) = self.violation()? {
            self.pivots += 1;
            if self.pivots > PIVOTS {
                return Err(CheckError::Unknown);
            }
            let Some(entering) = self.entering(basic, upwards) else {
                return Err(CheckError::Conflict(self.explain(basic, upwards)));
            };
            self.pivot(basic, entering, target)?;
        }
        Ok(())
    }

    /// Returns the first non-basic variable whose change moves the basic variable `basic` up (`upwards`) or down;
    /// `None` if none can change.
    ///
    /// The choice of the first one guarantees termination (Bland 1977).
    fn entering(&self, basic: usize, upwards: bool) -> Option<usize> {
        let row = self.rows.get(&basic)?;
        let can_move = |(at, factor): &(&usize, &Rational)| {
            let variable = &self.variables[**at];
            let bound = match factor.is_positive() == upwards {
                true => variable.upper,
                false => variable.lower,
            };
            bound.is_none_or(|(b, _)| Some(b) != variable.value.as_int())
        };
        row.iter().find(can_move).map(|(at, _)| *at)
    }

    fn explain(&self, basic: usize, upwards: bool) -> Vec<Reason> {
        let side = |at: usize, upper: bool| match upper {
            true => self.variables[at].upper,
            false => self.variables[at].lower,
        };
        let row = self.rows.get(&basic).into_iter().flatten();
        let others = row.filter_map(|(at, factor)| side(*at, factor.is_positive() == upwards));
        let own = side(basic, !upwards);
        own.into_iter().chain(others).map(|(_, why)| why).collect()
    }

    /// Makes `entering` a basic variable in place of `basic`, which gets the value `target`.
    fn pivot(&mut self, basic: usize, entering: usize, target: i128) -> CheckResult {
        let Some(mut row) = self.rows.remove(&basic) else {
            return Err(CheckError::Unknown);
        };
        let factor = or_unknown(row.remove(&entering))?;
        let move_by = Rational::from_int(target).sub(self.variables[basic].value);
        let change = or_unknown(move_by.and_then(|m| m.div(factor)))?;
        // entering = (basic - rest) / factor
        let inverse = or_unknown(Rational::ONE.div(factor))?;
        let negated = or_unknown(inverse.negated())?;
        let mut solved = Row::from([(basic, inverse)]);
        or_unknown(add_scaled(&mut solved, &row, negated))?;
        for other in self.rows.values_mut() {
            if let Some(factor) = other.remove(&entering) {
                or_unknown(add_scaled(other, &solved, factor))?;
            }
        }
        let moved = or_unknown(self.variables[entering].value.add(change))?;
        self.variables[entering].value = moved;
        self.rows.insert(entering, solved);
        self.variables[basic].value = Rational::from_int(target);
        self.recompute()
    }

    /// Computes the values of all basic variables from those of the non-basic ones.
    fn recompute(&mut self) -> CheckResult {
        for (basic, row) in &self.rows {
            let mut sum = Rational::ZERO;
            for (at, factor) in row {
                let term = or_unknown(self.variables[*at].value.mul(*factor))?;
                sum = or_unknown(sum.add(term))?;
            }
            self.variables[*basic].value = sum;
        }
        Ok(())
    }

    /// Divisibility (GCD) test: returns a conflict if a row has no integer solution, given the variables whose bounds
    /// are equal.
    fn check_divisibility(&self) -> CheckResult {
        for (basic, row) in &self.rows {
            let scale = common_denominator(row)?;
            let (mut constant, mut divisor) = (0i128, 0i128);
            let mut reasons = Vec::new();
            let own = (basic, Rational::from_int(-1));
            for (at, factor) in row.iter().map(|(at, f)| (at, *f)).chain([own]) {
                let scaled = or_unknown(factor.mul(Rational::from_int(scale)))?;
                let scaled = or_unknown(scaled.as_int())?;
                match self.fixed_value(*at) {
                    Some((value, whys)) => {
                        let term = or_unknown(scaled.checked_mul(value))?;
                        constant = or_unknown(constant.checked_add(term))?;
                        reasons.extend(whys);
                    }
                    None => divisor = or_unknown(gcd(divisor, scaled))?,
                }
            }
            if divisor != 0 && constant % divisor != 0 {
                return Err(CheckError::Conflict(reasons));
            }
        }
        Ok(())
    }

    fn fixed_value(&self, at: usize) -> Option<(i128, [Reason; 2])> {
        let variable = &self.variables[at];
        let ((low, why), (high, because)) = (variable.lower?, variable.upper?);
        (low == high).then_some((low, [why, because]))
    }

    /// Searches a solution in which all variables are integers by branch and bound. `depth` is the number of branches
    /// around this one.
    fn branch(&mut self, depth: usize) -> CheckResult {
        let fraction = (0..self.variables.len()).find(|at| self.value(*at).is_none());
        let Some(at) = fraction else {
            return Ok(());
        };
        self.branches += 1;
        if self.branches > BRANCHES {
            return Err(CheckError::Unknown);
        }
        let below = self.variables[at].value.floor();
        let saved = (self.variables[at].lower, self.variables[at].upper);
        let mut reasons = Vec::new();
        for (bound, is_upper) in [(below, true), (or_unknown(below.checked_add(1))?, false)] {
            let tried = self
                .assert_bound(at, bound, is_upper, Reason::Branch(depth))
                .and_then(|()| self.make_feasible())
                .and_then(|()| self.check_divisibility())
                .and_then(|()| self.branch(depth + 1));
            let Err(CheckError::Conflict(found)) = tried else {
                return tried;
            };
            (self.variables[at].lower, self.variables[at].upper) = saved;
            let depends = found.contains(&Reason::Branch(depth));
            reasons.extend(found.into_iter().filter(|r| *r != Reason::Branch(depth)));
            // If the conflict does not depend on this branch, the other branch fails in the same way.
            if !depends {
                break;
            }
        }
        Err(CheckError::Conflict(reasons))
    }
}

fn add_scaled(row: &mut Row, other: &Row, factor: Rational) -> Option<()> {
    for (at, coefficient) in other {
        let term = coefficient.mul(factor)?;
        let sum = row.get(at).map_or(Some(term), |old| old.add(term))?;
        match sum.is_zero() {
            true => row.remove(at),
            false => row.insert(*at, sum),
        };
    }
    Some(())
}

fn literals(reasons: &[Reason]) -> Vec<Lit> {
    let asserted = reasons.iter().filter_map(|reason| match reason {
        Reason::Asserted(lit) => Some(*lit),
        Reason::Always | Reason::Branch(_) => None,
    });
    let mut lits: Vec<Lit> = asserted.collect();
    lits.sort_unstable();
    lits.dedup();
    lits
}
