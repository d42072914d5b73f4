//! Decides whether two events can occur in the same cycle, or whether a cycle without any of several events exists:
//! proved impossible, or shown by an example run.
//!
//! The cone of influence is encoded for the [solver](crate::solver): presence and activity as literals, integers and
//! reals as terms. The stages are: random runs, since most possible events occur soon; one cycle from an arbitrary
//! state; bounded model checking from the start, with solutions confirmed by a run; and k-induction over up to three
//! cycles (Sheeran et al. 2000) with invariants guessed from the runs. Some long runs follow, for events that a counter
//! delays. All stages are limited by counted steps, not by time, so that the answer is the same on every machine.

mod concrete;
mod cone;
mod cycle;
mod domain;
mod double_order;
mod gates;
mod integers;
mod interpretation;
mod invariants;
mod query;
mod real_comparison;
mod real_functions;
mod reals;
mod symbolic;
mod trace;
mod unrolling;
mod witness;

use super::Schedule;
use super::fact_prover::{Event, ProofContext};
use super::presence::FlowPresence;
use crate::solver::SatResult;
use concrete::BoundaryValues;
use cone::Cone;
use query::{Problem, Query, ends, ends_at_once};
use std::fmt;
use trace::{Exploration, Trace};
use unrolling::Unrolling;
pub(crate) use witness::Witness;

/// Maximum number of nodes in the cone of influence of the queries. Nodes further away are not modelled.
const NODES: usize = 3_000;
/// Step budget of the solver per net, equal to some tenths of a second.
const STEPS: u64 = 6_000_000;
/// Maximum number of node evaluations in random runs per net. Bounds the compile time.
const RUN_BUDGET: u64 = 60_000;
/// Maximum number of node evaluations in the first random runs, before any proof is tried.
const FEW_RUNS: u64 = 3_000;
/// Maximum number of node evaluations in long random runs per net. Bounds the compile time.
const LONG_RUNS: u64 = 120_000;
/// Number of Boolean variables in a problem of the solver above which it is not unrolled further.
const MAX_VARIABLES: usize = 150_000;
/// Maximum number of cycles, from the start of the command, in bounded model checking.
const BMC_DEPTH: usize = 10;
/// Maximum number of cycles in the assumption of a k-induction.
const INDUCTION: usize = 3;

/// Result of the model checker for the question of whether two events can occur in the same cycle.
#[derive(Clone, PartialEq, Eq, Debug)]
pub(crate) enum Verdict {
    /// The events are proved never to occur in the same cycle, by this method.
    Exclusive(Method),
    /// Both events occur in the same cycle of this example run.
    Witnessed(Witness),
    /// Neither a proof nor an example run was found within the limits.
    Undecided,
}

/// Method by which the model checker proved that two events never occur in the same cycle.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub(crate) enum Method {
    /// Proof for one cycle that starts in an arbitrary state.
    SingleCycle,
    /// k-induction that assumes the property for this number of preceding cycles.
    Induction(usize),
    /// Induction that uses this number of invariants of the net.
    Invariants(usize),
}

impl fmt::Display for Method {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Method::SingleCycle => f.write_str("what holds in each cycle"),
            Method::Induction(cycles) => write!(f, "induction over {} cycles", cycles + 1),
            Method::Invariants(count) => write!(f, "induction with {count} invariants"),
        }
    }
}

/// Returns for each pair of events whether both can occur in the same cycle, with a proof or an example run.
pub(crate) fn decide(
    background: ProofContext<'_>,
    schedule: &Schedule,
    pairs: &[[Event; 2]],
) -> Vec<Verdict> {
    let events = pairs.iter().map(|pair| Query::Both(pair.clone()));
    let verdicts = solve_queries(background, schedule, events.collect());
    verdicts
        .into_iter()
        .map(|verdict| verdict.unwrap_or(Verdict::Undecided))
        .collect()
}

/// Returns whether it is proved that at least one of these events occurs in every cycle.
pub(crate) fn always_one(
    background: ProofContext<'_>,
    schedule: &Schedule,
    all_events: &[Event],
) -> bool {
    let event = Query::Neither(all_events.to_vec());
    let verdicts = solve_queries(background, schedule, vec![event]);
    matches!(verdicts[..], [Some(Verdict::Exclusive(_))])
}

fn solve_queries(
    background: ProofContext<'_>,
    schedule: &Schedule,
    events: Vec<Query>,
) -> Vec<Option<Verdict>> {
    if events.is_empty() {
        return Vec::new();
    }
    let net = background.net;
    let ends = ends(net);
    let all_events: Vec<Event> = events.iter().flat_map(|e| e.events()).cloned().collect();
    let is_total = |port| background.presences.own(port) == FlowPresence::Total;
    let question = Problem {
        cone: Cone::new(net, schedule, &all_events, &ends, NODES, is_total),
        ends,
        ends_at_once: ends_at_once(net),
        events,
    };
    let pool = trace::boundary_values(net, &question.cone.nodes);
    let mut decision = QuerySolver {
        question: &question,
        pool: &pool,
        verdicts: vec![None; question.events.len()],
        steps: STEPS,
        runs: RUN_BUDGET,
    };
    decision.search();
    decision.verdicts
}

/// Decision procedure for queries about a net. It tries random runs, bounded model checking and induction, and stores
/// the verdicts found so far.
struct QuerySolver<'a> {
    question: &'a Problem<'a>,
    pool: &'a BoundaryValues,
    verdicts: Vec<Option<Verdict>>,
    /// Number of steps that the solver may still take for this net.
    steps: u64,
    /// Number of node evaluations that random runs may still take for this net.
    runs: u64,
}

impl QuerySolver<'_> {
    fn search(&mut self) {
        // Cheap stages first: most possible events occur soon, and most of the others are impossible in any state.
        self.explore(FEW_RUNS);
        self.single_cycle_proof();
        if self.open().is_empty() {
            return;
        }
        let seen = self.explore(RUN_BUDGET);
        if self.question.ends_at_once {
            self.in_first_cycle();
            return;
        }
        // For `Event::Neither` only a proof of impossibility is useful, so no example run is searched.
        let is_run_wanted = self
            .question
            .events
            .iter()
            .any(|e| matches!(e, Query::Both(_)));
        if is_run_wanted {
            self.bounded_model_check(2);
        }
        self.k_induction(&seen);
        if !is_run_wanted {
            return;
        }
        self.bounded_model_check(BMC_DEPTH);
        self.in_long_runs();
    }

    /// Decides the remaining queries for a command that always ends in its first cycle.
    fn in_first_cycle(&mut self) {
        self.bounded_model_check(1);
        let free = self.cycles_free_of_event(1);
        for pair in self.open() {
            if free[pair] > 0 {
                self.verdicts[pair] = Some(Verdict::Exclusive(Method::SingleCycle));
            }
        }
    }

    fn open(&self) -> Vec<usize> {
        let pairs = 0..self.verdicts.len();
        pairs
            .filter(|pair| self.verdicts[*pair].is_none())
            .collect()
    }

    /// Searches example runs for the undecided queries in random runs with at most `nodes` node evaluations. Returns
    /// the runs and samples of their states.
    fn explore(&mut self, mut nodes: u64) -> Exploration {
        let open = self.open();
        let seen = trace::explore(self.question, self.pool, &open, &mut nodes);
        for (pair, trace) in seen.witnesses.iter().enumerate() {
            if let Some(trace) = trace {
                self.record_witness(pair, trace);
            }
        }
        seen
    }

    fn record_witness(&mut self, pair: usize, trace: &Trace) {
        let trace = trace::simplify(self.question, self.pool, pair, trace.clone());
        let witness = witness::describe(self.question, self.pool, pair, &trace);
        self.verdicts[pair] = Some(Verdict::Witnessed(witness));
    }

    /// Decides the queries that no cycle can satisfy, whatever the state at its start, reachable or not.
    fn single_cycle_proof(&mut self) {
        let open = self.open();
        if open.is_empty() {
            return;
        }
        let mut unrolled = Unrolling::from_anywhere(self.question);
        unrolled.extend();
        for pair in open {
            if unrolled.solve_last_cycle(pair, false, &mut self.steps) == SatResult::Unsat {
                self.verdicts[pair] = Some(Verdict::Exclusive(Method::SingleCycle));
            }
        }
    }

    /// Searches example runs for the undecided queries by bounded model checking of the first `cycles` cycles.
    fn bounded_model_check(&mut self, cycles: usize) {
        if self.open().is_empty() || self.steps == 0 {
            return;
        }
        let mut unrolled = Unrolling::from_start(self.question);
        for last in 0..cycles {
            if unrolled.domain.solver.size() > MAX_VARIABLES || self.steps == 0 {
                return;
            }
            unrolled.extend();
            for pair in self.open() {
                if unrolled.solve_last_cycle(pair, false, &mut self.steps) != SatResult::Sat {
                    continue;
                }
                let trace = Trace {
                    script: unrolled.script(),
                    last,
                };
                let shown = match trace::satisfies(self.question, self.pool, pair, &trace) {
                    true => Some(trace),
                    false => trace::vary(self.question, self.pool, pair, &trace, &mut self.runs),
                };
                if let Some(trace) = shown {
                    self.record_witness(pair, &trace);
                }
            }
        }
    }

    fn in_long_runs(&mut self) {
        let mut steps = LONG_RUNS;
        loop {
            let open = self.open();
            if open.is_empty() || self.question.cone.registers.is_empty() {
                return;
            }
            match trace::explore_long_runs(self.question, self.pool, &open, &mut steps) {
                Some((pair, trace)) => self.record_witness(pair, &trace),
                None => return,
            }
        }
    }

    /// Proves undecided queries impossible by k-induction, strengthened by invariants that the samples in `seen`
    /// suggest.
    fn k_induction(&mut self, seen: &Exploration) {
        if self.open().is_empty() || self.question.cone.registers.is_empty() {
            return;
        }
        let mut unrolled = Unrolling::from_anywhere(self.question);
        unrolled.extend();
        let guesses = invariants::candidates(&seen.samples);
        let invariants = invariants::inductive_subset(&mut unrolled, guesses, &mut self.steps);
        let mut unrolled = Unrolling::from_anywhere(self.question);
        let base = self.cycles_free_of_event(INDUCTION);
        for cycles in 0..=INDUCTION {
            if unrolled.domain.solver.size() > MAX_VARIABLES || self.steps == 0 {
                return;
            }
            invariants::require(&mut unrolled, &invariants, cycles);
            unrolled.extend();
            for pair in self.open() {
                let begins = base[pair] >= cycles;
                if begins
                    && unrolled.solve_last_cycle(pair, true, &mut self.steps) == SatResult::Unsat
                {
                    let method = induction_method(cycles, invariants.len());
                    self.verdicts[pair] = Some(Verdict::Exclusive(method));
                }
            }
        }
    }

    /// Returns for each query the number of cycles from the start that are proved not to satisfy it, at most `cycles`.
    fn cycles_free_of_event(&mut self, cycles: usize) -> Vec<usize> {
        let mut free = vec![0; self.verdicts.len()];
        let mut unrolled = Unrolling::from_start(self.question);
        for before in 0..cycles {
            unrolled.extend();
            for pair in self.open() {
                let is_free = free[pair] == before
                    && unrolled.solve_last_cycle(pair, false, &mut self.steps) == SatResult::Unsat;
                free[pair] += usize::from(is_free);
            }
        }
        free
    }
}

/// Returns the method of a proof by induction over `cycles` cycles that used a number of invariants.
fn induction_method(cycles: usize, invariants: usize) -> Method {
    match invariants {
        0 => Method::Induction(cycles),
        count => Method::Invariants(count),
    }
}
