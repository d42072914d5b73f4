//! SAT solver: conflict-driven clause learning (Marques-Silva and Sakallah 1999) with watched literals as in Moskewicz
//! et al. 2001.
//!
//! There are no restarts and no deletion of clauses: the problems are small and the number of steps is bounded. Ties
//! are broken by index, so that the same clauses take the same steps on every machine.

use std::cmp::Reverse;
use std::collections::BinaryHeap;
use std::ops::Not;

/// Literal of the SAT solver: a Boolean variable or its negation. The lowest bit is 1 for the negation.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub(crate) struct Lit(u32);

impl Lit {
    /// Literal that is always true: variable 0 is fixed to true.
    pub(crate) const TRUE: Lit = Lit(0);
    /// Literal that is always false, the negation of [`Lit::TRUE`].
    pub(crate) const FALSE: Lit = Lit(1);

    pub(crate) fn constant(value: bool) -> Lit {
        if value { Lit::TRUE } else { Lit::FALSE }
    }

    pub(crate) fn var(self) -> usize {
        (self.0 >> 1) as usize
    }

    pub(crate) fn is_negated(self) -> bool {
        self.0 & 1 == 1
    }

    /// Returns the truth value of the literal if its variable has the value `value`.
    fn under(self, value: bool) -> bool {
        value != self.is_negated()
    }

    fn index(self) -> usize {
        self.0 as usize
    }
}

impl Not for Lit {
    type Output = Lit;
    fn not(self) -> Lit {
        Lit(self.0 ^ 1)
    }
}

/// Result of a search of the SAT solver: satisfiable, unsatisfiable or undecided.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum SatResult {
    Sat,
    Unsat,
    /// Undecided, because the step budget is exhausted.
    Unknown,
}

/// Index that stands for "no clause" as the reason of a variable's value: the value is a decision or a fact.
const NONE: u32 = u32::MAX;
/// Factor by which a conflict counts more than the previous one in the choice of the next variable (VSIDS).
const DECAY: f64 = 1.0 / 0.95;
/// Activity of a variable above which all activities are scaled down, so that they stay finite.
const LARGE: f64 = 1e100;
/// Cost of a decision in steps of the search: the decision is queued, and undone later.
const STEPS_PER_DECISION: u64 = 4;

/// Number of variables that the analysis of a conflict visits in the time of one step of the search.
const VARIABLES_PER_STEP: u64 = 32;

/// Boolean satisfiability problem with the state of its search: the clauses and a partial assignment.
///
/// `trail` holds the true literals in the order of their assignment, and `decision_starts` its length at each decision.
#[derive(Debug)]
pub(crate) struct Sat {
    clauses: Vec<Vec<Lit>>,
    /// For each literal, the indices of the clauses that watch it. These clauses are visited when the literal becomes
    /// false.
    watches: Vec<Vec<u32>>,
    values: Vec<Option<bool>>,
    levels: Vec<u32>,
    reasons: Vec<u32>,
    phases: Vec<bool>,
    activity: Vec<f64>,
    bump: f64,
    /// Variables that may be decided next, by activity. Entries that are out of date are skipped.
    queue: BinaryHeap<(u64, Reverse<u32>)>,
    trail: Vec<Lit>,
    decision_starts: Vec<usize>,
    propagation_head: usize,
    is_contradictory: bool,
}

impl Sat {
    pub(crate) fn new() -> Sat {
        let mut sat = Sat {
            clauses: Vec::new(),
            watches: Vec::new(),
            values: Vec::new(),
            levels: Vec::new(),
            reasons: Vec::new(),
            phases: Vec::new(),
            activity: Vec::new(),
            bump: 1.0,
            queue: BinaryHeap::new(),
            trail: Vec::new(),
            decision_starts: Vec::new(),
            propagation_head: 0,
            is_contradictory: false,
        };
        let fixed = sat.fresh();
        sat.add(&[fixed]);
        sat
    }

    /// Adds a Boolean variable and returns its positive literal.
    pub(crate) fn fresh(&mut self) -> Lit {
        let var = u32::try_from(self.values.len()).unwrap_or(u32::MAX >> 1);
        self.watches.extend([Vec::new(), Vec::new()]);
        self.values.push(None);
        self.levels.push(0);
        self.reasons.push(NONE);
        self.phases.push(false);
        self.activity.push(0.0);
        self.queue.push((0, Reverse(var)));
        Lit(var << 1)
    }

    /// Returns the number of Boolean variables.
    pub(crate) fn len(&self) -> usize {
        self.values.len()
    }

    /// Returns the truth value of a literal in the current assignment; `None` if its variable is not assigned.
    pub(crate) fn value(&self, lit: Lit) -> Option<bool> {
        self.values[lit.var()].map(|value| lit.under(value))
    }

    /// Adds a clause and undoes all decisions.
    pub(crate) fn add(&mut self, clause: &[Lit]) {
        self.backtrack(0);
        let mut lits: Vec<Lit> = clause.to_vec();
        lits.sort_unstable();
        lits.dedup();
        let is_tautology = lits.windows(2).any(|w| w[0] == !w[1]);
        if is_tautology || lits.iter().any(|l| self.value(*l) == Some(true)) {
            return;
        }
        lits.retain(|l| self.value(*l).is_none());
        match lits[..] {
            [] => self.is_contradictory = true,
            [fact] => self.assign(fact, NONE),
            _ => {
                self.attach(lits);
            }
        }
    }

    /// Searches for an assignment of all variables that satisfies all clauses and makes the literals `assumptions`
    /// true. Subtracts one step from `steps` for each clause visited.
    ///
    /// After [`SatResult::Sat`], the assignment remains until a clause is added.
    pub(crate) fn search(&mut self, assumptions: &[Lit], steps: &mut u64) -> SatResult {
        self.backtrack(0);
        loop {
            if self.is_contradictory {
                return SatResult::Unsat;
            }
            match self.propagate(steps) {
                // A conflict without any decision refutes the clauses themselves.
                Some(_) if self.decision_starts.is_empty() => self.is_contradictory = true,
                Some(conflict) => {
                    *steps = steps.saturating_sub(self.values.len() as u64 / VARIABLES_PER_STEP);
                    self.resolve(conflict);
                }
                None if *steps == 0 => return SatResult::Unknown,
                None => match self.next_decision(assumptions) {
                    Some(Ok(decision)) => {
                        *steps = steps.saturating_sub(STEPS_PER_DECISION);
                        self.decide(decision);
                    }
                    Some(Err(())) => return SatResult::Unsat,
                    None => return SatResult::Sat,
                },
            }
        }
    }

    /// Returns the next literal to assign, an assumption or a decision. `None` if all variables are assigned; an error
    /// if an assumption is false.
    fn next_decision(&mut self, assumptions: &[Lit]) -> Option<Result<Lit, ()>> {
        if let Some(&assumed) = assumptions.get(self.decision_starts.len()) {
            return Some(match self.value(assumed) {
                Some(false) => Err(()),
                _ => Ok(assumed),
            });
        }
        while let Some((_, Reverse(var))) = self.queue.pop() {
            let at = var as usize;
            if self.values[at].is_none() {
                return Some(Ok(Lit((var << 1) | u32::from(!self.phases[at]))));
            }
        }
        None
    }

    /// Assigns a decision or assumption, which begins a new decision level.
    fn decide(&mut self, decision: Lit) {
        self.decision_starts.push(self.trail.len());
        // An assumption that is already true gets an empty level, since levels index the assumptions.
        if self.value(decision).is_none() {
            self.assign(decision, NONE);
        }
    }

    fn attach(&mut self, lits: Vec<Lit>) -> u32 {
        let id = u32::try_from(self.clauses.len()).unwrap_or(NONE - 1);
        self.watches[lits[0].index()].push(id);
        self.watches[lits[1].index()].push(id);
        self.clauses.push(lits);
        id
    }

    fn assign(&mut self, lit: Lit, reason: u32) {
        let var = lit.var();
        self.values[var] = Some(!lit.is_negated());
        self.levels[var] = u32::try_from(self.decision_starts.len()).unwrap_or(u32::MAX);
        self.reasons[var] = reason;
        self.trail.push(lit);
    }

    /// Assigns the literals that the clauses imply (unit propagation). Returns the index of a clause whose literals are
    /// all false; `None` if there is none. Subtracts one step from `steps` for each clause visited.
    fn propagate(&mut self, steps: &mut u64) -> Option<u32> {
        while let Some(&lit) = self.trail.get(self.propagation_head) {
            self.propagation_head += 1;
            let falsified = !lit;
            let mut watching = std::mem::take(&mut self.watches[falsified.index()]);
            let mut conflict = None;
            watching.retain(|&id| {
                if conflict.is_some() {
                    return true;
                }
                *steps = steps.saturating_sub(1);
                let (stays, failed) = self.update_watch(id, falsified);
                conflict = failed.then_some(id);
                stays
            });
            self.watches[falsified.index()].append(&mut watching);
            if conflict.is_some() {
                return conflict;
            }
        }
        None
    }

    /// Lets the clause with the index `id` watch another literal than `falsified`, which has become false. Returns
    /// whether the clause still watches `falsified`, and whether all its literals are false.
    fn update_watch(&mut self, id: u32, falsified: Lit) -> (bool, bool) {
        let at = id as usize;
        if self.clauses[at][0] == falsified {
            self.clauses[at].swap(0, 1);
        }
        let first = self.clauses[at][0];
        if self.value(first) == Some(true) {
            return (true, false);
        }
        let other =
            (2..self.clauses[at].len()).find(|k| self.value(self.clauses[at][*k]) != Some(false));
        if let Some(other) = other {
            self.clauses[at].swap(1, other);
            let watched = self.clauses[at][1];
            self.watches[watched.index()].push(id);
            return (false, false);
        }
        match self.value(first) {
            Some(false) => (true, true),
            _ => {
                self.assign(first, id);
                (true, false)
            }
        }
    }

    /// Learns a clause from a conflict (first unique implication point), and returns to the decision level at which
    /// that clause implies a literal.
    fn resolve(&mut self, conflict: u32) {
        let (learnt, level) = self.analyse(conflict);
        self.backtrack(level);
        self.bump *= DECAY;
        let asserted = learnt[0];
        let reason = match learnt.len() {
            1 => NONE,
            _ => self.attach(learnt),
        };
        if self.value(asserted).is_none() {
            self.assign(asserted, reason);
        }
    }

    fn analyse(&mut self, conflict: u32) -> (Vec<Lit>, usize) {
        let here = u32::try_from(self.decision_starts.len()).unwrap_or(u32::MAX);
        let mut seen = vec![false; self.values.len()];
        let mut learnt = vec![Lit::TRUE];
        let (mut open, mut at, mut clause) = (0, self.trail.len(), conflict);
        loop {
            for k in 0..self.clauses[clause as usize].len() {
                let lit = self.clauses[clause as usize][k];
                let var = lit.var();
                let is_new = !seen[var] && self.levels[var] > 0 && self.value(lit) == Some(false);
                if !is_new {
                    continue;
                }
                seen[var] = true;
                self.bump(var);
                match self.levels[var] == here {
                    true => open += 1,
                    false => learnt.push(lit),
                }
            }
            let lit = loop {
                at -= 1;
                if seen[self.trail[at].var()] {
                    break self.trail[at];
                }
            };
            open -= 1;
            if open == 0 {
                learnt[0] = !lit;
                break;
            }
            clause = self.reasons[lit.var()];
        }
        let level = self.second_highest_first(&mut learnt);
        (learnt, level)
    }

    /// Moves the literal with the highest decision level, except the first one of a learnt clause, to the second place,
    /// where it is watched. Returns that level; 0 for a single literal.
    fn second_highest_first(&self, learnt: &mut [Lit]) -> usize {
        let level = |lit: &Lit| self.levels[lit.var()];
        let highest = (1..learnt.len()).max_by_key(|k| (level(&learnt[*k]), Reverse(*k)));
        let Some(highest) = highest else {
            return 0;
        };
        learnt.swap(1, highest);
        level(&learnt[1]) as usize
    }

    fn bump(&mut self, var: usize) {
        self.activity[var] += self.bump;
        if self.activity[var] > LARGE {
            self.activity.iter_mut().for_each(|a| *a /= LARGE);
            self.bump /= LARGE;
        }
        self.enqueue(var);
    }

    fn enqueue(&mut self, var: usize) {
        let number = u32::try_from(var).unwrap_or(u32::MAX >> 1);
        // The bits of non-negative reals are ordered like the reals.
        self.queue
            .push((self.activity[var].to_bits(), Reverse(number)));
    }

    fn backtrack(&mut self, level: usize) {
        let Some(&limit) = self.decision_starts.get(level) else {
            return;
        };
        while self.trail.len() > limit {
            if let Some(lit) = self.trail.pop() {
                let var = lit.var();
                self.phases[var] = !lit.is_negated();
                self.values[var] = None;
                self.enqueue(var);
            }
        }
        self.decision_starts.truncate(level);
        self.propagation_head = self.trail.len();
    }
}
