//! Invariants of the registers: candidates are guessed from runs, then only the inductive ones are kept (Houdini,
//! Flanagan and Leino 2001).
//!
//! The candidates are bounds of integers, constant sums and differences of two integers, and clauses of two facts. A
//! fact is a Boolean, a bound or a value of an integer, or presence.

use super::concrete::ConcreteDomain;
use super::cycle::State;
use super::symbolic::{SymbolicDomain, Term};
use super::unrolling::Unrolling;
use crate::solver::{Lit, SatResult};

/// Maximum number of facts from which invariants of two facts are made. The number of pairs grows with its square.
const FACTS: usize = 56;
/// Maximum number of different sampled values of an integer register for which facts about single values are made. A
/// register with more values gets no such facts.
const VALUES: usize = 12;
/// Maximum number of integer registers whose sums and differences are examined for invariants. The number of pairs
/// grows with its square.
const INTEGERS: usize = 12;

/// Atomic statement about the content of a register (state element), identified by its index. Candidate invariants
/// consist of facts.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub(super) enum Fact {
    Present(usize),
    True(usize),
    AtMost(usize, i64),
    Equals(usize, i64),
}

/// Candidate invariant of a net. Samples of runs propose it, and the solver proves or refutes it.
#[derive(Clone, PartialEq, Eq, Debug)]
pub(super) enum Candidate {
    /// Disjunction of facts: at least one of them has the truth value given with it.
    Clause(Vec<(Fact, bool)>),
    /// Linear relation `a + factor * b = sum` of two integer registers: the indices of `a` and `b`, `factor` (1 or -1)
    /// and `sum`.
    Sum(usize, usize, i64, i64),
}

type Sample = State<ConcreteDomain<'static>>;

fn integer(sample: &Sample, register: usize) -> Option<i64> {
    sample[register].value.value.as_int()
}

impl Fact {
    fn holds(self, sample: &Sample) -> bool {
        match self {
            Fact::Present(r) => sample[r].present.value,
            Fact::True(r) => sample[r].value.value.as_bool() == Some(true),
            Fact::AtMost(r, bound) => integer(sample, r).is_some_and(|v| v <= bound),
            Fact::Equals(r, value) => integer(sample, r) == Some(value),
        }
    }

    fn lit(self, domain: &mut SymbolicDomain, state: &State<SymbolicDomain>) -> Lit {
        match self {
            Fact::Present(r) => state[r].present,
            Fact::True(r) => match state[r].value {
                Term::Bool(lit) => lit,
                _ => domain.solver.new_bool(),
            },
            Fact::AtMost(r, bound) => match state[r].value {
                Term::Int(int) => {
                    let bound = domain.integers.constant(bound);
                    domain.at_most(int, bound)
                }
                _ => domain.solver.new_bool(),
            },
            Fact::Equals(r, value) => match state[r].value {
                Term::Int(int) => {
                    let value = domain.integers.constant(value);
                    domain.equal(int, value)
                }
                _ => domain.solver.new_bool(),
            },
        }
    }
}

impl Candidate {
    fn lit(&self, domain: &mut SymbolicDomain, state: &State<SymbolicDomain>) -> Lit {
        match self {
            Candidate::Clause(facts) => {
                let mut any = Lit::FALSE;
                for (fact, polarity) in facts {
                    let lit = fact.lit(domain, state);
                    any = domain.solver.or(any, if *polarity { lit } else { !lit });
                }
                any
            }
            Candidate::Sum(a, b, factor, sum) => match (state[*a].value, state[*b].value) {
                (Term::Int(a), Term::Int(b)) => {
                    let total = domain
                        .integers
                        .add_scaled(&mut domain.solver, a, b, *factor);
                    let sum = domain.integers.constant(*sum);
                    domain.equal(total, sum)
                }
                _ => domain.solver.new_bool(),
            },
        }
    }
}

/// Returns the candidate invariants that hold in all samples. A sample is the contents of all registers at the start of
/// a cycle.
pub(super) fn candidates(samples: &[Sample]) -> Vec<Candidate> {
    let Some(first) = samples.first() else {
        return Vec::new();
    };
    let mut facts = Vec::new();
    let mut integers = Vec::new();
    for (register, flow) in first.iter().enumerate() {
        facts.push(Fact::Present(register));
        if flow.value.value.as_bool().is_some() {
            facts.push(Fact::True(register));
        }
        if flow.value.value.as_int().is_some() {
            integers.push(register);
        }
    }
    let mut guesses = Vec::new();
    for register in &integers {
        let mut values: Vec<i64> = samples
            .iter()
            .filter_map(|s| integer(s, *register))
            .collect();
        values.sort_unstable();
        values.dedup();
        let (Some(low), Some(high)) = (values.first(), values.last()) else {
            continue;
        };
        guesses.push(Candidate::Clause(vec![(
            Fact::AtMost(*register, *high),
            true,
        )]));
        if let Some(below) = low.checked_sub(1) {
            guesses.push(Candidate::Clause(vec![(
                Fact::AtMost(*register, below),
                false,
            )]));
        }
        if values.len() <= VALUES {
            let (_, inner) = values.split_last().unwrap_or((&0, &[]));
            facts.extend(inner.iter().map(|v| Fact::AtMost(*register, *v)));
            facts.extend(values.iter().map(|v| Fact::Equals(*register, *v)));
        }
    }
    guesses.extend(sums(samples, &integers));
    guesses.extend(clauses(samples, &facts));
    guesses
}

/// Returns candidates of the form "the sum (or difference) of two integer registers is constant" that hold in all
/// samples. `integers` are the indices of these registers.
fn sums(samples: &[Sample], integers: &[usize]) -> Vec<Candidate> {
    let integers = &integers[..integers.len().min(INTEGERS)];
    let mut found = Vec::new();
    for (k, a) in integers.iter().enumerate() {
        for b in &integers[k + 1..] {
            for factor in [1, -1] {
                let total = |sample: &Sample| {
                    let second = integer(sample, *b)?.checked_mul(factor)?;
                    integer(sample, *a)?.checked_add(second)
                };
                let first = samples.first().and_then(total);
                let same = samples.iter().all(|sample| total(sample) == first);
                found.extend(
                    first
                        .filter(|_| same)
                        .map(|sum| Candidate::Sum(*a, *b, factor, sum)),
                );
            }
        }
    }
    found
}

/// Returns candidates that hold in all samples and consist of facts: one that never changes, or a pair of which at
/// least one always has the given truth value.
fn clauses(samples: &[Sample], facts: &[Fact]) -> Vec<Candidate> {
    let mut found = Vec::new();
    let mut columns: Vec<(Fact, Vec<bool>)> = Vec::new();
    for fact in facts {
        let column: Vec<bool> = samples.iter().map(|sample| fact.holds(sample)).collect();
        match column.iter().all(|value| *value == column[0]) {
            true => found.push(Candidate::Clause(vec![(*fact, column[0])])),
            false if columns.len() < FACTS => columns.push((*fact, column)),
            false => {}
        }
    }
    for (k, (a, first)) in columns.iter().enumerate() {
        for (b, second) in &columns[k + 1..] {
            for (x, y) in [(false, false), (false, true), (true, false), (true, true)] {
                let mut rows = first.iter().zip(second);
                if rows.all(|(p, q)| *p == x || *q == y) {
                    found.push(Candidate::Clause(vec![(*a, x), (*b, y)]));
                }
            }
        }
    }
    found
}

/// Returns the largest subset of the candidates that is inductive: if it holds before a cycle, it holds after the
/// cycle.
///
/// The candidates must hold in the first cycle, and `unrolled` must contain exactly one cycle from an arbitrary state.
/// The result is empty if the step budget `steps` is exhausted.
pub(super) fn inductive_subset(
    unrolled: &mut Unrolling<'_>,
    guesses: Vec<Candidate>,
    steps: &mut u64,
) -> Vec<Candidate> {
    let [before, after] = &unrolled.states[..] else {
        return Vec::new();
    };
    let (before, after) = (before.clone(), after.clone());
    let mut open: Vec<(Candidate, Lit, Lit)> = Vec::with_capacity(guesses.len());
    for guess in guesses {
        let now = guess.lit(&mut unrolled.domain, &before);
        let then = guess.lit(&mut unrolled.domain, &after);
        open.push((guess, now, then));
    }
    loop {
        let some_fails = unrolled.domain.solver.new_bool();
        let mut clause = vec![!some_fails];
        clause.extend(open.iter().map(|(_, _, then)| !*then));
        unrolled.domain.solver.add_clause(&clause);
        let mut assumptions = unrolled.not_ended(1);
        assumptions.extend(open.iter().map(|(_, now, _)| *now));
        assumptions.push(some_fails);
        match unrolled.domain.solver.solve(&assumptions, steps) {
            SatResult::Unknown => return Vec::new(),
            SatResult::Unsat => break,
            SatResult::Sat => {
                let solver = &unrolled.domain.solver;
                let before = open.len();
                open.retain(|(_, _, then)| solver.value(*then) != Some(false));
                if open.len() == before {
                    return Vec::new();
                }
            }
        }
    }
    open.into_iter().map(|(guess, _, _)| guess).collect()
}

/// Requires the invariants for the state at the start of the cycle with the index `cycle`.
pub(super) fn require(unrolled: &mut Unrolling<'_>, invariants: &[Candidate], cycle: usize) {
    let Some(state) = unrolled.states.get(cycle).cloned() else {
        return;
    };
    for guess in invariants {
        let lit = guess.lit(&mut unrolled.domain, &state);
        unrolled.domain.solver.add_clause(&[lit]);
    }
}
