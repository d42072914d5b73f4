//! Literals for comparisons of linear integer terms with constants, and the clauses between these literals.

use super::rational::gcd;
use super::sat::{Lit, Sat};
use super::simplex::{Feasibility, Simplex};
use rustc_hash::FxHashMap;
use std::collections::BTreeMap;

/// Linear term: a sum of solver variables with coefficients, sorted by variable, plus a constant.
#[derive(Clone, PartialEq, Eq, Hash, Debug, Default)]
pub(crate) struct LinearTerm {
    pub(crate) terms: Vec<(usize, i64)>,
    pub(crate) constant: i64,
}

impl LinearTerm {
    pub(crate) fn constant(value: i64) -> LinearTerm {
        LinearTerm {
            terms: Vec::new(),
            constant: value,
        }
    }

    pub(crate) fn variable(variable: usize) -> LinearTerm {
        LinearTerm {
            terms: vec![(variable, 1)],
            constant: 0,
        }
    }

    /// Returns `self + factor * other`; `None` on overflow.
    pub(crate) fn add_scaled(&self, other: &LinearTerm, factor: i64) -> Option<LinearTerm> {
        let mut terms: BTreeMap<usize, i64> = self.terms.iter().copied().collect();
        for (variable, own) in &other.terms {
            let term = terms.entry(*variable).or_insert(0);
            *term = term.checked_add(own.checked_mul(factor)?)?;
        }
        terms.retain(|_, factor| *factor != 0);
        let scaled = other.constant.checked_mul(factor)?;
        Some(LinearTerm {
            terms: terms.into_iter().collect(),
            constant: self.constant.checked_add(scaled)?,
        })
    }
}

/// Comparison of a simplex variable with a bound, represented by a literal of the SAT solver that is true exactly if
/// the variable is at most the bound.
#[derive(Clone, Copy, Debug)]
struct Atom {
    lit: Lit,
    variable: usize,
    bound: i128,
}

/// Theory of linear integer arithmetic: all comparisons of a problem, which the simplex method decides.
#[derive(Debug, Default)]
pub(crate) struct LinearTheory {
    simplex: Simplex,
    sums: FxHashMap<Vec<(usize, i64)>, usize>,
    atoms: Vec<Atom>,
    /// For each simplex variable, the literals of its upper bounds.
    bounds: FxHashMap<usize, BTreeMap<i128, Lit>>,
}

impl LinearTheory {
    /// Adds an integer variable from `low` to `high`, both included, and returns its index.
    pub(crate) fn variable(&mut self, low: i64, high: i64) -> usize {
        self.simplex.variable(i128::from(low), i128::from(high))
    }

    /// Returns a literal that is true exactly if the sum is at most `bound`; `None` on overflow.
    pub(crate) fn at_most_bound(
        &mut self,
        sat: &mut Sat,
        sum: &LinearTerm,
        bound: i128,
    ) -> Option<Lit> {
        let constant = i128::from(sum.constant).checked_sub(bound)?;
        let Some((_, first)) = sum.terms.first() else {
            return Some(Lit::constant(constant <= 0));
        };
        let shared = sum
            .terms
            .iter()
            .try_fold(0, |shared, (_, f)| gcd(shared, i128::from(*f)))?;
        let divisor = i64::try_from(shared).ok()?.checked_mul(first.signum())?;
        let terms: Option<Vec<(usize, i64)>> = sum
            .terms
            .iter()
            .map(|(variable, f)| Some((*variable, f.checked_div(divisor)?)))
            .collect();
        let variable = self.variable_for_sum(terms?)?;
        // d * s + c <= 0 is s <= floor(-c / d) for positive d, and not s <= ceil(c / -d) - 1 for negative d.
        let size = i128::from(divisor).abs();
        Some(match divisor > 0 {
            true => self.at_most(sat, variable, (-constant).div_euclid(size)),
            false => {
                let least = constant.div_euclid(size) + i128::from(constant.rem_euclid(size) != 0);
                !self.at_most(sat, variable, least - 1)
            }
        })
    }

    /// Returns the index of the simplex variable for a sum of variables with factors, which is added if needed; `None`
    /// on overflow.
    fn variable_for_sum(&mut self, terms: Vec<(usize, i64)>) -> Option<usize> {
        if let [(variable, 1)] = terms[..] {
            return Some(variable);
        }
        if let Some(known) = self.sums.get(&terms) {
            return Some(*known);
        }
        let (mut low, mut high) = (0i128, 0i128);
        for (variable, factor) in &terms {
            let (least, most) = self.simplex.limits(*variable);
            let factor = i128::from(*factor);
            let ends = [least.checked_mul(factor)?, most.checked_mul(factor)?];
            low = low.checked_add(ends[0].min(ends[1]))?;
            high = high.checked_add(ends[0].max(ends[1]))?;
        }
        let sum = self.simplex.sum(&terms, (low, high))?;
        self.sums.insert(terms, sum);
        Some(sum)
    }

    /// Returns the literal that is true exactly if a variable is at most a bound. Clauses relate it to the literals of
    /// the next smaller and the next greater bound.
    fn at_most(&mut self, sat: &mut Sat, variable: usize, bound: i128) -> Lit {
        let (low, high) = self.simplex.limits(variable);
        if bound < low || bound >= high {
            return Lit::constant(bound >= high);
        }
        let bounds = self.bounds.entry(variable).or_default();
        if let Some(lit) = bounds.get(&bound) {
            return *lit;
        }
        let lit = sat.fresh();
        if let Some((_, smaller)) = bounds.range(..bound).next_back() {
            sat.add(&[!*smaller, lit]);
        }
        if let Some((_, greater)) = bounds.range(bound..).next() {
            sat.add(&[!lit, *greater]);
        }
        bounds.insert(bound, lit);
        self.atoms.push(Atom {
            lit,
            variable,
            bound,
        });
        lit
    }

    /// Returns the number of comparisons and variables that each feasibility check visits.
    pub(crate) fn size(&self) -> usize {
        self.atoms.len() + self.simplex.size()
    }

    /// Returns the cost of the last feasibility check in steps of the SAT search, without the cost of visiting each
    /// comparison.
    pub(crate) fn work(&self) -> u64 {
        self.simplex.work()
    }

    /// Checks whether the comparisons that the assignment of the SAT solver makes true or false have an integer
    /// solution.
    pub(crate) fn check(&mut self, sat: &Sat) -> Feasibility {
        let bounds: Vec<(usize, i128, bool, Lit)> = self
            .atoms
            .iter()
            .filter_map(|atom| {
                Some(match sat.value(atom.lit)? {
                    true => (atom.variable, atom.bound, true, atom.lit),
                    false => (atom.variable, atom.bound + 1, false, !atom.lit),
                })
            })
            .collect();
        self.simplex.check(&bounds)
    }

    /// Returns the value of a linear term in the last solution; `None` if it is not an integer or overflows.
    pub(crate) fn value(&self, sum: &LinearTerm) -> Option<i128> {
        let mut total = i128::from(sum.constant);
        for (variable, factor) in &sum.terms {
            let value = self.simplex.value(*variable)?;
            total = total.checked_add(value.checked_mul(i128::from(*factor))?)?;
        }
        Some(total)
    }
}
