//! A decision procedure for Booleans and linear integer arithmetic: clauses, gates over literals, and comparisons.
//!
//! [`sat`] searches the Boolean structure, [`simplex`] refutes sets of bounds, [`linear`] ties the two together. Reals take
//! part as integers that are ordered as they are. It must not know nets.

mod linear;
mod rational;
mod sat;
mod simplex;

use linear::Comparisons;
pub(crate) use linear::Linear;
use rustc_hash::FxHashMap;
use sat::Sat;
pub(crate) use sat::{Answer, Lit};
use simplex::Feasible;

/// Steps that a check of the comparisons counts as, per comparison and variable.
const STEPS_PER_COMPARISON: u64 = 8;

/// A problem that grows, and the solution that was found last.
#[derive(Debug)]
pub(crate) struct Solver {
    sat: Sat,
    comparisons: Comparisons,
    gates: FxHashMap<(Lit, Lit), Lit>,
}

impl Solver {
    pub(crate) fn new() -> Solver {
        Solver {
            sat: Sat::new(),
            comparisons: Comparisons::default(),
            gates: FxHashMap::default(),
        }
    }

    /// A new Boolean.
    pub(crate) fn fresh(&mut self) -> Lit {
        self.sat.fresh()
    }

    /// Number of Booleans so far: what building the problem has cost.
    pub(crate) fn size(&self) -> usize {
        self.sat.len()
    }

    /// Requires that one of these is true.
    pub(crate) fn require(&mut self, clause: &[Lit]) {
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

    pub(crate) fn choose(&mut self, condition: Lit, yes: Lit, no: Lit) -> Lit {
        if yes == no {
            return yes;
        }
        let (left, right) = (self.and(condition, yes), self.and(!condition, no));
        self.or(left, right)
    }

    /// A new integer between two limits.
    pub(crate) fn integer(&mut self, low: i64, high: i64) -> usize {
        self.comparisons.variable(low, high)
    }

    /// A literal that is true exactly if the sum is at most 0; one of which nothing is known if it is too large.
    pub(crate) fn at_most_zero(&mut self, sum: &Linear) -> Lit {
        self.at_most(sum, 0)
    }

    /// A literal that is true exactly if the sum is a 64-bit integer; one of which nothing is known if it is too large.
    pub(crate) fn fits(&mut self, sum: &Linear) -> Lit {
        let is_low = self.at_most(sum, i128::from(i64::MAX));
        let is_too_low = self.at_most(sum, i128::from(i64::MIN) - 1);
        self.and(is_low, !is_too_low)
    }

    fn at_most(&mut self, sum: &Linear, bound: i128) -> Lit {
        match self.comparisons.at_most_bound(&mut self.sat, sum, bound) {
            Some(lit) => lit,
            None => self.sat.fresh(),
        }
    }

    /// Looks for a solution under assumptions. Steps are taken off `steps`.
    pub(crate) fn solve(&mut self, assumptions: &[Lit], steps: &mut u64) -> Answer {
        loop {
            match self.sat.search(assumptions, steps) {
                Answer::Sat => {}
                other => return other,
            }
            let work = self.comparisons.size() as u64 * STEPS_PER_COMPARISON;
            *steps = steps.saturating_sub(work);
            let checked = self.comparisons.check(&self.sat);
            *steps = steps.saturating_sub(self.comparisons.work());
            match checked {
                // What is left open counts as a solution: nothing is proved by it.
                Feasible::Yes | Feasible::Unknown => return Answer::Sat,
                Feasible::No(_) if *steps == 0 => return Answer::Unknown,
                Feasible::No(together) => {
                    let clause: Vec<Lit> = together.into_iter().map(|lit| !lit).collect();
                    self.sat.add(&clause);
                }
            }
        }
    }

    /// The truth value of a literal in the solution that was found last.
    pub(crate) fn value(&self, lit: Lit) -> Option<bool> {
        self.sat.value(lit)
    }

    /// The value of a sum in the solution that was found last.
    pub(crate) fn sum(&self, sum: &Linear) -> Option<i128> {
        self.comparisons.value(sum)
    }
}

#[cfg(test)]
mod tests;
