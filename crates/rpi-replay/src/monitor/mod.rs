//! Run-time monitoring of claims: assertions, properties and contracts (assume, guarantee, modes) of a net.
//!
//! A violation is reported for the first cycle only; the number of violations is reported at the end. After a violated
//! assumption the guarantees of the same call are no longer checked. This module knows the exports that carry the
//! claims. It must not depend on the source language.

mod sink;
mod violation_report;

pub use sink::ClaimMonitorSink;

use std::collections::BTreeSet;

use rpi_diag::Diagnostic;
use rpi_image::Type;
use rpi_net::{Claim, ClaimKind, ClaimRead};

use crate::faults::ReportedFault;

/// Access to the exported flows of a running command, for monitors.
pub trait ExportValues {
    /// Returns the memory words of the export with this index in the current cycle; `None` if the flow is absent.
    fn words(&self, export: usize) -> Option<&[u64]>;
}

/// Monitor that evaluates a set of claims (assertions and contracts) of a command in each cycle.
#[derive(Debug)]
pub struct ClaimMonitor {
    claims: Vec<MonitoredClaim>,
    /// Paths of the node calls with a violated assumption. Their guarantees are not checked any more.
    released_calls: BTreeSet<String>,
}

#[derive(Debug)]
struct MonitoredClaim {
    claim: Claim,
    condition: Option<usize>,
    reads: Vec<(usize, Type)>,
    /// Memory words of the values read in the previous cycle, if the claim refers to them; `None` for an absent value.
    before: Vec<Option<Vec<u64>>>,
    /// Number of cycles in which the claim was present and evaluated. `violated` is the number of those in which it was
    /// false.
    evaluated: u64,
    violated: u64,
}

/// Violation of a claim in a cycle: the index of the claim, and the values that the claim reads, as text.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct ClaimViolation {
    claim: usize,
    now: String,
    before: Option<String>,
}

/// Numbers of evaluations and violations of a claim (assertion or contract) in a run.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct ClaimStats {
    /// Number of cycles in which the claim was evaluated.
    pub evaluated: u64,
    /// Number of cycles in which the claim was violated.
    pub violated: u64,
}

impl ClaimMonitor {
    /// Creates a monitor of these claims. `export` returns the index and type of the command's export with a key;
    /// `None` if there is no such export.
    pub fn new(claims: &[Claim], export: impl Fn(&str) -> Option<(usize, Type)>) -> ClaimMonitor {
        let watched = |claim: &Claim| {
            let found = claim.reads.iter().map(|read| export(&read.key));
            let there: Vec<bool> = found.clone().map(|found| found.is_some()).collect();
            let mut claim = claim.clone();
            let mut there = there.into_iter();
            claim.reads.retain(|_| there.next().unwrap_or(false));
            let reads: Vec<(usize, Type)> = found.flatten().collect();
            MonitoredClaim {
                condition: export(&claim.key).map(|found| found.0),
                before: vec![None; reads.len()],
                reads,
                claim,
                evaluated: 0,
                violated: 0,
            }
        };
        // Assumptions first: a violated assumption releases the guarantees of the same cycle.
        let mut all: Vec<MonitoredClaim> = claims.iter().map(watched).collect();
        all.sort_by_key(|watched| watched.claim.kind == ClaimKind::Guarantee);
        ClaimMonitor {
            claims: all,
            released_calls: BTreeSet::new(),
        }
    }

    /// Evaluates all claims in a cycle and returns those that are violated for the first time. `flows` has the
    /// command's exports.
    pub fn evaluate(&mut self, flows: &dyn ExportValues) -> Vec<ClaimViolation> {
        let mut broken = Vec::new();
        for (k, watched) in self.claims.iter_mut().enumerate() {
            if watched.evaluate(flows, &mut self.released_calls) {
                broken.push(watched.violation(k, flows));
            }
            watched.store_previous(flows);
        }
        broken
    }

    /// Returns the diagnostic for a claim that was violated in the cycle with this number, from 0.
    #[must_use]
    pub fn diagnostic(&self, broken: &ClaimViolation, cycle: u64) -> Diagnostic {
        violation_report::diagnostic(&self.claims[broken.claim].claim, broken, cycle)
    }

    /// Rewrites the report of a fault if the fault was raised by this violated claim. Returns the description of the
    /// violation; `None` if the fault has another cause.
    pub(crate) fn explain_fault(
        &self,
        fault: &mut ReportedFault,
        broken: &ClaimViolation,
    ) -> Option<String> {
        let claim = &self.claims[broken.claim].claim;
        fault.is_assertion_at(claim.span).then(|| {
            let sentence = violation_report::violation_text(claim);
            fault.explain(&sentence, violation_report::diagnostic(claim, broken, 0));
            sentence
        })
    }

    /// Returns for each claim in how many cycles it was evaluated and in how many it was violated.
    pub fn stats(&self) -> impl Iterator<Item = (&Claim, ClaimStats)> {
        self.claims.iter().map(|watched| {
            let (seen, broken) = (watched.evaluated, watched.violated);
            (
                &watched.claim,
                ClaimStats {
                    evaluated: seen,
                    violated: broken,
                },
            )
        })
    }

    /// Returns as text one line for each claim that was violated in more than one cycle, with the number of violations.
    #[must_use]
    pub fn summary(&self) -> String {
        let often = self.stats().filter(|(_, tally)| tally.violated > 1);
        let line = |(claim, tally): (&Claim, ClaimStats)| {
            let what = violation_report::claim_name(claim);
            let call = match &claim.path[..] {
                "" => String::new(),
                path => format!(" in the call `{path}`"),
            };
            format!(
                "{what}{call} did not hold in {} of {}\n",
                tally.violated,
                rpi_diag::with_noun(tally.evaluated, "cycle")
            )
        };
        often.map(line).collect()
    }
}

impl MonitoredClaim {
    /// Evaluates the claim in a cycle. Returns true if it is violated for the first time. `released` are the paths of
    /// node calls with a violated assumption, whose guarantees are not checked.
    fn evaluate(&mut self, flows: &dyn ExportValues, released: &mut BTreeSet<String>) -> bool {
        let is_due =
            self.claim.kind != ClaimKind::Guarantee || !released.contains(&self.claim.path);
        // A claim that is constantly true has no export.
        let holds = self.condition.map_or(Some(true), |export| {
            flows.words(export).map(|cells| cells.first() != Some(&0))
        });
        self.evaluated += u64::from(is_due && holds.is_some());
        let fails = is_due && holds == Some(false);
        self.violated += u64::from(fails);
        if fails && self.claim.kind == ClaimKind::Assume {
            released.insert(self.claim.path.clone());
        }
        fails && self.violated == 1
    }

    /// Stores the values that the claim reads, for the next cycle, if the claim refers to the previous cycle.
    fn store_previous(&mut self, flows: &dyn ExportValues) {
        if self.claim.reads_past {
            let cells = |(export, _): &(usize, Type)| flows.words(*export).map(<[u64]>::to_vec);
            self.before = self.reads.iter().map(cells).collect();
        }
    }

    fn violation(&self, claim: usize, flows: &dyn ExportValues) -> ClaimViolation {
        let then = self.values(|k| self.before[k].as_deref());
        ClaimViolation {
            claim,
            now: self.values(|k| flows.words(self.reads[k].0)),
            before: (self.claim.reads_past && self.evaluated > 1).then_some(then),
        }
    }

    fn values<'v>(&self, cells: impl Fn(usize) -> Option<&'v [u64]>) -> String {
        let reads = self.claim.reads.iter().enumerate();
        let text = |(k, read): (usize, &ClaimRead)| {
            format!(
                "{} = {}",
                read.name,
                violation_report::value_text(read, cells(k), self.reads[k].1)
            )
        };
        reads.map(text).collect::<Vec<_>>().join(", ")
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rpi_diag::{Code, Span};
    use rpi_image::Scalar;

    struct FixedExports(Vec<Option<Vec<u64>>>);

    impl ExportValues for FixedExports {
        fn words(&self, export: usize) -> Option<&[u64]> {
            self.0[export].as_deref()
        }
    }

    fn claim(kind: ClaimKind, key: &str) -> Claim {
        Claim {
            key: key.to_owned(),
            kind,
            path: "a.b".to_owned(),
            subject: "Half".to_owned(),
            mode: None,
            label: None,
            span: Span::NONE,
            reads_past: true,
            is_strict: true,
            reads: vec![ClaimRead {
                name: "x".to_owned(),
                key: "x".to_owned(),
                unit: String::new(),
                values: Vec::new(),
            }],
        }
    }

    fn watch() -> ClaimMonitor {
        let claims = [
            claim(ClaimKind::Guarantee, "g"),
            claim(ClaimKind::Assume, "a"),
        ];
        let keys = ["g", "a", "x"];
        ClaimMonitor::new(&claims, |key| {
            let place = keys.iter().position(|known| *known == key);
            Some((place?, Type::Scalar(Scalar::Int)))
        })
    }

    fn look(watch: &mut ClaimMonitor, cycle: u64, flows: &FixedExports) -> Vec<Diagnostic> {
        let broken = watch.evaluate(flows);
        broken.iter().map(|b| watch.diagnostic(b, cycle)).collect()
    }

    fn codes(diagnostics: &[Diagnostic]) -> Vec<Code> {
        diagnostics
            .iter()
            .map(|diagnostic| diagnostic.code)
            .collect()
    }

    #[test]
    fn the_first_cycle_is_told_with_values_and_those_before() {
        let mut watch = watch();
        let cycle = |g, x| FixedExports(vec![Some(vec![g]), Some(vec![1]), Some(vec![x])]);
        assert_eq!(look(&mut watch, 0, &cycle(1, 5)), []);
        let found = look(&mut watch, 1, &cycle(0, 6));
        assert_eq!(codes(&found), [Code::RPI9014]);
        assert!(found[0].message.ends_with("is not kept in cycle 1"));
        let notes = ["in this cycle x = 6", "in the previous cycle x = 5"];
        assert_eq!(found[0].notes[..2], notes);
        assert_eq!(look(&mut watch, 2, &cycle(0, 7)), []);
        assert!(
            watch.summary().contains("2 of 3 cycles"),
            "{}",
            watch.summary()
        );
    }

    #[test]
    fn nothing_is_owed_once_an_assumption_is_broken() {
        let mut watch = watch();
        let cycle = |g, a| FixedExports(vec![Some(vec![g]), Some(vec![a]), None]);
        assert_eq!(codes(&look(&mut watch, 0, &cycle(0, 0))), [Code::RPI9013]);
        assert_eq!(look(&mut watch, 1, &cycle(0, 1)), []);
    }

    #[test]
    fn an_absent_claim_is_not_broken() {
        let mut watch = watch();
        assert_eq!(
            look(&mut watch, 0, &FixedExports(vec![None, None, None])),
            []
        );
        assert!(watch.stats().all(|(_, tally)| tally.evaluated == 0));
    }
}
