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
mod doubles;
mod gates;
mod integers;
mod invariants;
mod question;
mod reals;
mod symbolic;
mod trace;
mod unrolled;
mod witness;

use super::Schedule;
use super::presence::Sureness;
use super::proof::{Background, Happening};
use crate::solver::Answer;
use concrete::Pool;
use cone::Cone;
use question::{Event, Question, ends, ends_at_once};
use std::fmt;
use trace::{Seen, Trace};
use unrolled::Unrolled;
pub(crate) use witness::Witness;

/// Maximal number of nodes in the cone of a net.
const NODES: usize = 3_000;
/// Step budget of the solver per net: some tenths of a second.
const STEPS: u64 = 6_000_000;
/// Maximal number of node evaluations in random runs per net.
const RUNS: u64 = 60_000;
/// Maximal number of node evaluations in the first random runs.
const FEW_RUNS: u64 = 3_000;
/// Maximal number of node evaluations in long runs per net.
const LONG_RUNS: u64 = 120_000;
/// Maximal number of Boolean variables of a problem.
const SIZE: usize = 150_000;
/// Maximal number of cycles in bounded model checking from the start.
const FAR: usize = 10;
/// Maximal number of cycles of an induction.
const INDUCTION: usize = 3;

/// Result for a pair of events.
#[derive(Clone, PartialEq, Eq, Debug)]
pub(crate) enum Verdict {
    /// Proved never to occur in the same cycle.
    Exclusive(Method),
    /// Example run in which both occur in the same cycle.
    Together(Witness),
    /// Not decided.
    Open,
}

/// Proof method.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub(crate) enum Method {
    /// Proof for one cycle from an arbitrary state.
    OneCycle,
    /// k-induction over this many cycles.
    Induction(usize),
    /// Induction with this many invariants.
    Invariants(usize),
}

impl fmt::Display for Method {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Method::OneCycle => f.write_str("what holds in each cycle"),
            Method::Induction(cycles) => write!(f, "induction over {} cycles", cycles + 1),
            Method::Invariants(count) => write!(f, "induction with {count} invariants"),
        }
    }
}

/// Decides for each pair whether both events can occur in the same cycle.
pub(crate) fn decide(
    background: Background<'_>,
    schedule: &Schedule,
    pairs: &[[Happening; 2]],
) -> Vec<Verdict> {
    let events = pairs.iter().map(|pair| Event::Both(pair.clone()));
    let verdicts = answers(background, schedule, events.collect());
    verdicts
        .into_iter()
        .map(|verdict| verdict.unwrap_or(Verdict::Open))
        .collect()
}

/// Whether it is proved that at least one of these events occurs in every cycle.
pub(crate) fn always_one(
    background: Background<'_>,
    schedule: &Schedule,
    happenings: &[Happening],
) -> bool {
    let event = Event::Neither(happenings.to_vec());
    let verdicts = answers(background, schedule, vec![event]);
    matches!(verdicts[..], [Some(Verdict::Exclusive(_))])
}

fn answers(
    background: Background<'_>,
    schedule: &Schedule,
    events: Vec<Event>,
) -> Vec<Option<Verdict>> {
    if events.is_empty() {
        return Vec::new();
    }
    let net = background.net;
    let ends = ends(net);
    let happenings: Vec<Happening> = events
        .iter()
        .flat_map(|e| e.happenings())
        .cloned()
        .collect();
    let is_total = |port| background.presences.own(port) == Sureness::Total;
    let question = Question {
        cone: Cone::new(net, schedule, &happenings, &ends, NODES, is_total),
        ends,
        ends_at_once: ends_at_once(net),
        events,
    };
    let pool = trace::pool(net, &question.cone.nodes);
    let mut decision = Decision {
        question: &question,
        pool: &pool,
        verdicts: vec![None; question.events.len()],
        steps: STEPS,
        runs: RUNS,
    };
    decision.search();
    decision.verdicts
}

/// Question with the verdicts found so far.
struct Decision<'a> {
    question: &'a Question<'a>,
    pool: &'a Pool,
    verdicts: Vec<Option<Verdict>>,
    /// Remaining steps of the solver and remaining node evaluations in runs.
    steps: u64,
    runs: u64,
}

impl Decision<'_> {
    fn search(&mut self) {
        // Cheap stages first: most possible events occur soon, and most of the others are impossible in any state.
        self.explore(FEW_RUNS);
        self.in_one_cycle();
        if self.open().is_empty() {
            return;
        }
        let seen = self.explore(RUNS);
        if self.question.ends_at_once {
            self.in_first_cycle();
            return;
        }
        // For `Event::Neither` only a proof of impossibility is useful, so no example run is searched.
        let is_run_wanted = self
            .question
            .events
            .iter()
            .any(|e| matches!(e, Event::Both(_)));
        if is_run_wanted {
            self.look_from_start(2);
        }
        self.by_induction(&seen);
        if !is_run_wanted {
            return;
        }
        self.look_from_start(FAR);
        self.in_long_runs();
    }

    /// Decides in the only cycle of a command that ends at once.
    fn in_first_cycle(&mut self) {
        self.look_from_start(1);
        let free = self.free_of(1);
        for pair in self.open() {
            if free[pair] > 0 {
                self.verdicts[pair] = Some(Verdict::Exclusive(Method::OneCycle));
            }
        }
    }

    fn open(&self) -> Vec<usize> {
        let pairs = 0..self.verdicts.len();
        pairs
            .filter(|pair| self.verdicts[*pair].is_none())
            .collect()
    }

    /// Random runs with at most `nodes` node evaluations.
    fn explore(&mut self, mut nodes: u64) -> Seen {
        let open = self.open();
        let seen = trace::explore(self.question, self.pool, &open, &mut nodes);
        for (pair, trace) in seen.traces.iter().enumerate() {
            if let Some(trace) = trace {
                self.happened(pair, trace);
            }
        }
        seen
    }

    fn happened(&mut self, pair: usize, trace: &Trace) {
        let trace = trace::simplified(self.question, self.pool, pair, trace.clone());
        let witness = witness::of(self.question, self.pool, pair, &trace);
        self.verdicts[pair] = Some(Verdict::Together(witness));
    }

    /// Decides the events that are impossible in any state.
    fn in_one_cycle(&mut self) {
        let open = self.open();
        if open.is_empty() {
            return;
        }
        let mut unrolled = Unrolled::from_anywhere(self.question);
        unrolled.extend();
        for pair in open {
            if unrolled.happens(pair, false, &mut self.steps) == Answer::Unsat {
                self.verdicts[pair] = Some(Verdict::Exclusive(Method::OneCycle));
            }
        }
    }

    /// Bounded model checking from the start with up to `cycles` cycles.
    fn look_from_start(&mut self, cycles: usize) {
        if self.open().is_empty() || self.steps == 0 {
            return;
        }
        let mut unrolled = Unrolled::from_start(self.question);
        for last in 0..cycles {
            if unrolled.domain.solver.size() > SIZE || self.steps == 0 {
                return;
            }
            unrolled.extend();
            for pair in self.open() {
                if unrolled.happens(pair, false, &mut self.steps) != Answer::Sat {
                    continue;
                }
                let trace = Trace {
                    script: unrolled.script(),
                    last,
                };
                let shown = match trace::shows(self.question, self.pool, pair, &trace) {
                    true => Some(trace),
                    false => trace::varied(self.question, self.pool, pair, &trace, &mut self.runs),
                };
                if let Some(trace) = shown {
                    self.happened(pair, &trace);
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
            match trace::explore_far(self.question, self.pool, &open, &mut steps) {
                Some((pair, trace)) => self.happened(pair, &trace),
                None => return,
            }
        }
    }

    /// Proves the remaining events impossible by k-induction, strengthened by invariants.
    fn by_induction(&mut self, seen: &Seen) {
        if self.open().is_empty() || self.question.cone.registers.is_empty() {
            return;
        }
        let mut unrolled = Unrolled::from_anywhere(self.question);
        unrolled.extend();
        let guesses = invariants::guesses(&seen.samples);
        let invariants = invariants::proved(&mut unrolled, guesses, &mut self.steps);
        let mut unrolled = Unrolled::from_anywhere(self.question);
        let base = self.free_of(INDUCTION);
        for cycles in 0..=INDUCTION {
            if unrolled.domain.solver.size() > SIZE || self.steps == 0 {
                return;
            }
            invariants::require(&mut unrolled, &invariants, cycles);
            unrolled.extend();
            for pair in self.open() {
                let begins = base[pair] >= cycles;
                if begins && unrolled.happens(pair, true, &mut self.steps) == Answer::Unsat {
                    let method = match invariants.len() {
                        0 => Method::Induction(cycles),
                        count => Method::Invariants(count),
                    };
                    self.verdicts[pair] = Some(Verdict::Exclusive(method));
                }
            }
        }
    }

    /// For each event, the number of cycles from the start that are proved free of it, at most `cycles`.
    fn free_of(&mut self, cycles: usize) -> Vec<usize> {
        let mut free = vec![0; self.verdicts.len()];
        let mut unrolled = Unrolled::from_start(self.question);
        for before in 0..cycles {
            unrolled.extend();
            for pair in self.open() {
                let is_free = free[pair] == before
                    && unrolled.happens(pair, false, &mut self.steps) == Answer::Unsat;
                free[pair] += usize::from(is_free);
            }
        }
        free
    }
}
