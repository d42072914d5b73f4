//! Fact-based prover: proves that two events never occur in the same cycle.
//!
//! It uses three sound and bounded methods: contradictory facts about one cycle ([`facts`]), a case distinction on one
//! or two flows, and latches that turn each other off for good or are turned on by the same one-time signal
//! ([`latches`]). What is not proved is checked at run time.

mod contradiction;
mod event;
pub(crate) mod facts;
mod latches;
mod numbers;
pub(crate) mod truth_tables;
mod values;

use crate::net::{FragmentId, PortRef};
use contradiction::ContradictionError;
pub(crate) use event::Event;
use facts::Facts;
pub(crate) use facts::{EffortBudget, ProofContext};
use latches::Latches;
use std::collections::BTreeMap;
use std::rc::Rc;
use truth_tables::ValueSet;

/// Maximum number of nested case distinctions in a proof. A case distinction assumes each possible value of a flow in
/// turn.
const DEPTH: usize = 2;
/// Maximum number of flows that are tried for a case distinction at each depth. Bounds the compile time.
const CASES: usize = 6;
/// Maximum number of node visits in all proofs without case distinctions, for one net. Bounds the compile time.
const EFFORT: u32 = 10_000;
/// Maximum number of node visits in all proofs with case distinctions, for one net. Bounds the compile time.
const EFFORT_FOR_CASES: u32 = 2_000;

/// Prover of statements about single cycles of a net, with a limited effort.
pub(crate) struct Prover<'a> {
    background: ProofContext<'a>,
    effort: &'a EffortBudget,
    latches: Latches,
    /// Cache of the facts that follow from one fragment being active; `Err` if the fragment is never active.
    single_facts: BTreeMap<FragmentId, Result<Rc<Facts<'a>>, ContradictionError>>,
    /// Cache: facts that follow from two fragments being active; an error if they never are in the same cycle.
    pair_facts: BTreeMap<(FragmentId, FragmentId), Result<Rc<Facts<'a>>, ContradictionError>>,
}

impl<'a> Prover<'a> {
    pub(crate) fn new(background: ProofContext<'a>, effort: &'a EffortBudget) -> Self {
        effort.set(EFFORT);
        Prover {
            background,
            effort,
            latches: Latches::new(background),
            single_facts: BTreeMap::new(),
            pair_facts: BTreeMap::new(),
        }
    }

    /// Returns for each pair whether it is proved that its events never occur in the same cycle.
    ///
    /// Proofs without case distinctions come first, so that a difficult pair cannot use up the effort for them.
    pub(crate) fn never_together(&mut self, pairs: &[[Event; 2]]) -> Vec<bool> {
        let easy: Vec<bool> = pairs
            .iter()
            .map(|[a, b]| self.is_refuted(a, b, 0))
            .collect();
        self.effort.set(EFFORT_FOR_CASES);
        self.pair_facts.retain(|_, facts| facts.is_err());
        let hard = pairs.iter().zip(easy);
        hard.map(|([a, b], done)| done || self.is_refuted(a, b, DEPTH))
            .collect()
    }

    /// Returns whether it is proved that at least one of these events occurs in every cycle.
    pub(crate) fn always_one(&mut self, of: &[Event]) -> bool {
        self.effort.set(EFFORT_FOR_CASES);
        let mut facts = Facts::new(self.background, self.effort);
        let denied = of.iter().try_for_each(|one| facts.deny(one));
        denied.and_then(|()| facts.propagate()).is_err() || self.refuted(&facts, DEPTH)
    }

    /// Returns whether it is proved that two events never occur in the same cycle. `depth` is the maximum number of
    /// nested case distinctions.
    pub(crate) fn is_refuted(&mut self, a: &Event, b: &Event, depth: usize) -> bool {
        let Ok(both) = self.both_active(a.fragment, b.fragment, depth) else {
            return true;
        };
        if depth == 0 || self.effort.get() == 0 || [a, b].iter().all(|h| self.is_always_present(h))
        {
            // Presence adds no facts: the facts of the fragments have already been tried.
            return false;
        }
        let mut facts = Facts::clone(&both);
        let all = [a, b].into_iter().try_for_each(|h| {
            let mut present = h.present.iter();
            present.try_for_each(|p| facts.require(h.fragment, *p, ValueSet::PRESENT))
        });
        all.and_then(|()| facts.propagate()).is_err() || self.refuted(&facts, depth)
    }

    /// Returns whether all flows of an event are present whenever its fragment is active.
    fn is_always_present(&self, event: &Event) -> bool {
        self.background.obstacles(event).1.is_empty()
    }

    /// Returns the facts that follow from two fragments being active; an error if it is proved that they never are in
    /// the same cycle. `depth` is the maximum number of nested case distinctions.
    fn both_active(
        &mut self,
        a: FragmentId,
        b: FragmentId,
        depth: usize,
    ) -> Result<Rc<Facts<'a>>, ContradictionError> {
        let key = (a.min(b), a.max(b));
        if let Some(known) = self.pair_facts.get(&key) {
            return known.clone();
        }
        let (first, second) = (self.active(a)?, self.active(b)?);
        let found = first
            .conjoin(&second)
            .and_then(|facts| self.checked(facts, depth));
        self.pair_facts.insert(key, found.clone());
        found
    }

    /// Returns the facts; an error if they contradict each other. At depth 0, no further facts are derived first, so
    /// that many pairs are cheap.
    fn checked(
        &self,
        mut facts: Facts<'a>,
        depth: usize,
    ) -> Result<Rc<Facts<'a>>, ContradictionError> {
        if depth > 0 {
            facts.propagate()?;
        }
        facts.check_numbers()?;
        match self.refuted(&facts, depth) {
            true => Err(ContradictionError),
            false => Ok(Rc::new(facts)),
        }
    }

    fn active(&mut self, fragment: FragmentId) -> Result<Rc<Facts<'a>>, ContradictionError> {
        let (background, effort) = (self.background, self.effort);
        let known = self.single_facts.entry(fragment).or_insert_with(|| {
            let mut facts = Facts::new(background, effort);
            facts.activate(fragment)?;
            facts.propagate()?;
            Ok(Rc::new(facts))
        });
        known.clone()
    }

    fn refuted(&self, facts: &Facts<'_>, depth: usize) -> bool {
        self.latches.exclude(facts, self.effort) || self.refuted_in_cases(facts, depth)
    }

    /// Returns whether the facts contradict each possible value of some flow. `depth` is the maximum number of nested
    /// case distinctions.
    fn refuted_in_cases(&self, facts: &Facts<'_>, depth: usize) -> bool {
        if depth == 0 || self.effort.get() == 0 {
            return false;
        }
        let open = facts.known().filter(|(_, set)| set.members().count() == 2);
        let open: Vec<(PortRef, ValueSet)> = open.take(CASES).collect();
        open.into_iter().any(|(port, set)| {
            set.members().all(|case| {
                let mut facts = facts.clone();
                facts.assume(port, case).is_err()
                    || self.latches.exclude(&facts, self.effort)
                    || self.refuted_in_cases(&facts, depth - 1)
            })
        })
    }
}

/// Returns whether it is proved that a flow, as seen from the active fragment `reader`, is never true in a cycle in
/// which all flows `others` are false.
///
/// The effort is subtracted from `all`, which many proofs share.
pub(crate) fn never_true_without(
    background: ProofContext<'_>,
    all: &EffortBudget,
    (reader, port): (FragmentId, PortRef),
    others: &[PortRef],
) -> bool {
    let share = EFFORT_FOR_CASES.min(all.get());
    if share == 0 {
        return false;
    }
    let effort = EffortBudget::new(share);
    let mut facts = Facts::new(background, &effort);
    let held = facts.activate(reader).and_then(|()| {
        let mut others = others.iter();
        others.try_for_each(|other| facts.assume(*other, ValueSet::FALSE))
    });
    let held = held
        .and_then(|()| facts.require(reader, port, ValueSet::TRUE))
        .and_then(|()| facts.propagate());
    all.set(all.get().saturating_sub(1 + share - effort.get()));
    held.is_err()
}
