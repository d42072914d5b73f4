//! Run-time monitoring of claims: assertions, properties and contracts (assume, guarantee, modes) of a net.
//!
//! A violation is reported for the first cycle only; the number of violations is reported at the end. After a violated
//! assumption the guarantees of the same call are no longer checked. This module knows the exports that carry the
//! claims. It must not depend on the source language.

mod sink;
mod told;

pub use sink::ClaimSink;

use std::collections::BTreeSet;

use rpi_diag::Finding;
use rpi_image::Type;
use rpi_net::{Claim, ClaimKind, ClaimRead};
use rpi_prims::FaultCode;

use rpi_runtime::run::fault_text;

/// Access to the values of exports.
pub trait Flows {
    /// Returns the memory words of an export in this cycle; `None` if the flow is absent or the export does not exist.
    fn cells(&self, export: usize) -> Option<&[u64]>;
}

/// Monitor of a set of claims.
#[derive(Debug)]
pub struct Watch {
    claims: Vec<Watched>,
    /// Paths of the calls with a violated assumption. Their guarantees are not checked any more.
    released: BTreeSet<String>,
}

#[derive(Debug)]
struct Watched {
    claim: Claim,
    condition: Option<usize>,
    reads: Vec<(usize, Type)>,
    /// Values read in the previous cycle, if the claim refers to it.
    before: Vec<Option<Vec<u64>>>,
    /// Number of cycles in which the claim was present. `failed` is the number of cycles in which it was violated.
    seen: u64,
    failed: u64,
}

/// A violated claim with the values that it reads.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Broken {
    claim: usize,
    now: String,
    before: Option<String>,
}

/// Number of evaluations and violations of a claim in a run.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Tally {
    /// Number of cycles in which the claim was evaluated.
    pub seen: u64,
    /// Number of cycles in which the claim was violated.
    pub broken: u64,
}

impl Watch {
    /// Creates a monitor. `export` returns the index and type of an export by its key.
    pub fn new(claims: &[Claim], export: impl Fn(&str) -> Option<(usize, Type)>) -> Watch {
        let watched = |claim: &Claim| {
            let found = claim.reads.iter().map(|read| export(&read.key));
            let there: Vec<bool> = found.clone().map(|found| found.is_some()).collect();
            let mut claim = claim.clone();
            let mut there = there.into_iter();
            claim.reads.retain(|_| there.next().unwrap_or(false));
            let reads: Vec<(usize, Type)> = found.flatten().collect();
            Watched {
                condition: export(&claim.key).map(|found| found.0),
                before: vec![None; reads.len()],
                reads,
                claim,
                seen: 0,
                failed: 0,
            }
        };
        // Assumptions first: a violated assumption releases the guarantees of the same cycle.
        let mut all: Vec<Watched> = claims.iter().map(watched).collect();
        all.sort_by_key(|watched| watched.claim.kind == ClaimKind::Guarantee);
        Watch {
            claims: all,
            released: BTreeSet::new(),
        }
    }

    /// Evaluates all claims in a cycle and returns those that are violated for the first time.
    pub fn look(&mut self, flows: &dyn Flows) -> Vec<Broken> {
        let mut broken = Vec::new();
        for (k, watched) in self.claims.iter_mut().enumerate() {
            if watched.look(flows, &mut self.released) {
                broken.push(watched.broken(k, flows));
            }
            watched.keep(flows);
        }
        broken
    }

    /// Returns the diagnostic for a claim that was violated in a cycle.
    #[must_use]
    pub fn told(&self, broken: &Broken, cycle: u64) -> Finding {
        told::finding(&self.claims[broken.claim].claim, broken, cycle)
    }

    /// Rewrites the diagnostic of a fault if the fault was raised by this violated claim. Returns the new message;
    /// `None` if the fault has another cause.
    pub(crate) fn tell_fault(&self, fault: &mut Finding, broken: &Broken) -> Option<String> {
        let claim = &self.claims[broken.claim].claim;
        let assertion = fault_text(FaultCode::AssertionFailed);
        let is_of_it = fault.span() == claim.span && fault.message.ends_with(assertion);
        is_of_it.then(|| {
            let (told, sentence) = (told::finding(claim, broken, 0), told::sentence(claim));
            fault.message = fault.message.replace(assertion, &sentence);
            (fault.labels, fault.notes) = (told.labels, told.notes);
            sentence
        })
    }

    /// Returns the statistics of each claim.
    pub fn tallies(&self) -> impl Iterator<Item = (&Claim, Tally)> {
        self.claims.iter().map(|watched| {
            let (seen, broken) = (watched.seen, watched.failed);
            (&watched.claim, Tally { seen, broken })
        })
    }

    /// Returns one line for each claim that was violated in more than one cycle.
    #[must_use]
    pub fn summary(&self) -> String {
        let often = self.tallies().filter(|(_, tally)| tally.broken > 1);
        let line = |(claim, tally): (&Claim, Tally)| {
            let what = told::what(claim);
            let call = match &claim.path[..] {
                "" => String::new(),
                path => format!(" in the call `{path}`"),
            };
            format!(
                "{what}{call} did not hold in {} of {}\n",
                tally.broken,
                rpi_diag::counted(tally.seen, "cycle")
            )
        };
        often.map(line).collect()
    }
}

impl Watched {
    /// Evaluates the claim in a cycle. Returns true if it is violated for the first time.
    fn look(&mut self, flows: &dyn Flows, released: &mut BTreeSet<String>) -> bool {
        let owed = self.claim.kind != ClaimKind::Guarantee || !released.contains(&self.claim.path);
        // A claim that is constantly true has no export.
        let holds = self.condition.map_or(Some(true), |export| {
            flows.cells(export).map(|cells| cells.first() != Some(&0))
        });
        self.seen += u64::from(owed && holds.is_some());
        let fails = owed && holds == Some(false);
        self.failed += u64::from(fails);
        if fails && self.claim.kind == ClaimKind::Assume {
            released.insert(self.claim.path.clone());
        }
        fails && self.failed == 1
    }

    /// Stores the values of this cycle for the next one, if the claim refers to the previous cycle.
    fn keep(&mut self, flows: &dyn Flows) {
        if self.claim.looks_back {
            let cells = |(export, _): &(usize, Type)| flows.cells(*export).map(<[u64]>::to_vec);
            self.before = self.reads.iter().map(cells).collect();
        }
    }

    fn broken(&self, claim: usize, flows: &dyn Flows) -> Broken {
        let then = self.values(|k| self.before[k].as_deref());
        Broken {
            claim,
            now: self.values(|k| flows.cells(self.reads[k].0)),
            before: (self.claim.looks_back && self.seen > 1).then_some(then),
        }
    }

    fn values<'v>(&self, cells: impl Fn(usize) -> Option<&'v [u64]>) -> String {
        let reads = self.claim.reads.iter().enumerate();
        let text = |(k, read): (usize, &ClaimRead)| {
            format!(
                "{} = {}",
                read.name,
                told::value(read, cells(k), self.reads[k].1)
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

    struct Given(Vec<Option<Vec<u64>>>);

    impl Flows for Given {
        fn cells(&self, export: usize) -> Option<&[u64]> {
            self.0[export].as_deref()
        }
    }

    fn claim(kind: ClaimKind, key: &str) -> Claim {
        Claim {
            key: key.to_owned(),
            kind,
            path: "a.b".to_owned(),
            of: "Half".to_owned(),
            mode: None,
            label: None,
            span: Span::NONE,
            looks_back: true,
            is_strict: true,
            reads: vec![ClaimRead {
                name: "x".to_owned(),
                key: "x".to_owned(),
                unit: String::new(),
                values: Vec::new(),
            }],
        }
    }

    fn watch() -> Watch {
        let claims = [
            claim(ClaimKind::Guarantee, "g"),
            claim(ClaimKind::Assume, "a"),
        ];
        let keys = ["g", "a", "x"];
        Watch::new(&claims, |key| {
            let place = keys.iter().position(|known| *known == key);
            Some((place?, Type::One(Scalar::Int)))
        })
    }

    fn look(watch: &mut Watch, cycle: u64, flows: &Given) -> Vec<Finding> {
        let broken = watch.look(flows);
        broken.iter().map(|b| watch.told(b, cycle)).collect()
    }

    fn codes(findings: &[Finding]) -> Vec<Code> {
        findings.iter().map(|finding| finding.code).collect()
    }

    #[test]
    fn the_first_cycle_is_told_with_values_and_those_before() {
        let mut watch = watch();
        let cycle = |g, x| Given(vec![Some(vec![g]), Some(vec![1]), Some(vec![x])]);
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
        let cycle = |g, a| Given(vec![Some(vec![g]), Some(vec![a]), None]);
        assert_eq!(codes(&look(&mut watch, 0, &cycle(0, 0))), [Code::RPI9013]);
        assert_eq!(look(&mut watch, 1, &cycle(0, 1)), []);
    }

    #[test]
    fn an_absent_claim_is_not_broken() {
        let mut watch = watch();
        assert_eq!(look(&mut watch, 0, &Given(vec![None, None, None])), []);
        assert!(watch.tallies().all(|(_, tally)| tally.seen == 0));
    }
}
