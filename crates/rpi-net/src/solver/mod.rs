//! SMT solver for Booleans and linear integer arithmetic: clauses, gates over literals, and comparisons.
//!
//! [`sat`] searches the Boolean structure, [`simplex`] refutes sets of bounds, [`linear`] connects the two. Reals are
//! represented by integers in the same order. The solver does not depend on nets.

mod linear;
mod rational;
mod sat;
mod simplex;

pub(crate) use linear::LinearTerm;
use linear::LinearTheory;
use rustc_hash::FxHashMap;
use sat::Sat;
pub(crate) use sat::{Lit, SatResult};
use simplex::Feasibility;

/// Cost of a feasibility check, in steps of the SAT search per comparison and variable.
const STEPS_PER_COMPARISON: u64 = 8;

/// Incremental SAT solver with linear integer arithmetic, and its last solution.
#[derive(Debug)]
pub(crate) struct Solver {
    sat: Sat,
    comparisons: LinearTheory,
    gates: FxHashMap<(Lit, Lit), Lit>,
}

impl Solver {
    pub(crate) fn new() -> Solver {
        Solver {
            sat: Sat::new(),
            comparisons: LinearTheory::default(),
            gates: FxHashMap::default(),
        }
    }

    /// Adds a Boolean variable and returns its literal.
    pub(crate) fn new_bool(&mut self) -> Lit {
        self.sat.fresh()
    }

    /// Returns the number of Boolean variables, as a measure of the size of the problem.
    pub(crate) fn size(&self) -> usize {
        self.sat.len()
    }

    /// Adds a clause: at least one of the literals must be true.
    pub(crate) fn add_clause(&mut self, clause: &[Lit]) {
        self.sat.add(clause);
    }

    pub(crate) fn and(&mut self, a: Lit, b: Lit) -> Lit {
        if a == b || b == Lit::TRUE {
            return a;
        }
        if a == Lit::TRUE {
            return b;
        }
        if a == Lit::FALSE || b == Lit::FALSE || a == !b {
            return Lit::FALSE;
        }
        let key = (a.min(b), a.max(b));
        if let Some(known) = self.gates.get(&key) {
            return *known;
        }
        let gate = self.sat.fresh();
        self.sat.add(&[!gate, a]);
        self.sat.add(&[!gate, b]);
        self.sat.add(&[gate, !a, !b]);
        self.gates.insert(key, gate);
        gate
    }

    pub(crate) fn or(&mut self, a: Lit, b: Lit) -> Lit {
        !self.and(!a, !b)
    }

    pub(crate) fn all(&mut self, lits: impl IntoIterator<Item = Lit>) -> Lit {
        lits.into_iter()
            .fold(Lit::TRUE, |all, lit| self.and(all, lit))
    }

    pub(crate) fn any(&mut self, lits: impl IntoIterator<Item = Lit>) -> Lit {
        lits.into_iter()
            .fold(Lit::FALSE, |any, lit| self.or(any, lit))
    }

    pub(crate) fn xor(&mut self, a: Lit, b: Lit) -> Lit {
        let (left, right) = (self.and(a, !b), self.and(!a, b));
        self.or(left, right)
    }

    pub(crate) fn if_then_else(&mut self, condition: Lit, yes: Lit, no: Lit) -> Lit {
        if yes == no {
            return yes;
        }
        let (left, right) = (self.and(condition, yes), self.and(!condition, no));
        self.or(left, right)
    }

    /// Adds an integer variable from `low` to `high`, both included, and returns its index.
    pub(crate) fn integer(&mut self, low: i64, high: i64) -> usize {
        self.comparisons.variable(low, high)
    }

    /// Returns a literal that is true exactly if the term is at most 0. If the computation overflows, the literal is
    /// unconstrained.
    pub(crate) fn at_most_zero(&mut self, sum: &LinearTerm) -> Lit {
        self.at_most(sum, 0)
    }

    /// Returns a literal that is true exactly if the value of the term fits in `i64`. If the computation overflows, the
    /// literal is unconstrained.
    pub(crate) fn fits(&mut self, sum: &LinearTerm) -> Lit {
        let is_low = self.at_most(sum, i128::from(i64::MAX));
        let is_too_low = self.at_most(sum, i128::from(i64::MIN) - 1);
        self.and(is_low, !is_too_low)
    }

    fn at_most(&mut self, sum: &LinearTerm, bound: i128) -> Lit {
        match self.comparisons.at_most_bound(&mut self.sat, sum, bound) {
            Some(lit) => lit,
            None => self.sat.fresh(),
        }
    }

    /// Searches for a solution in which all literals `assumptions` are true. Subtracts the steps taken from `steps`.
    ///
    /// A solution whose arithmetic could not be decided also counts as a solution.
    pub(crate) fn solve(&mut self, assumptions: &[Lit], steps: &mut u64) -> SatResult {
        loop {
            match self.sat.search(assumptions, steps) {
                SatResult::Sat => {}
                other => return other,
            }
            let work = self.comparisons.size() as u64 * STEPS_PER_COMPARISON;
            *steps = steps.saturating_sub(work);
            let checked = self.comparisons.check(&self.sat);
            *steps = steps.saturating_sub(self.comparisons.work());
            match checked {
                // An unknown result counts as a solution, so that it never proves anything.
                Feasibility::Feasible | Feasibility::Unknown => return SatResult::Sat,
                Feasibility::Infeasible(_) if *steps == 0 => return SatResult::Unknown,
                Feasibility::Infeasible(together) => {
                    let clause: Vec<Lit> = together.into_iter().map(|lit| !lit).collect();
                    self.sat.add(&clause);
                }
            }
        }
    }

    /// Returns the truth value of a literal in the last solution; `None` if it has none.
    pub(crate) fn value(&self, lit: Lit) -> Option<bool> {
        self.sat.value(lit)
    }

    /// Returns the value of a linear term in the last solution; `None` if it is not an integer or overflows.
    pub(crate) fn sum(&self, sum: &LinearTerm) -> Option<i128> {
        self.comparisons.value(sum)
    }
}

#[cfg(test)]
mod tests;
