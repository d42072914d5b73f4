//! Execution of program tests: a net without devices runs cycle by cycle, and its conditions are monitored.
//!
//! The runner knows an image and the keys of the exports that carry the conditions. It must not depend on the source
//! language.

mod coverage;

pub use coverage::Coverage;

use rpi_core::{Machine, Moment, Verdict};
use rpi_device::NoDevices;
use rpi_diag::Finding;
use rpi_image::Image;
use rpi_image::image::{End, EndKind, Export, Signal, TextRange};
use rpi_net::{Claim, Net};

use crate::claims::{self, Flows};

/// A test and what is monitored in it.
#[derive(Debug)]
pub struct Case<'a> {
    /// Net of the test.
    pub net: &'a Net,
    /// Image of the net, lowered with observable ports.
    pub image: Image,
    /// Conditions of the test.
    pub conditions: &'a [Condition],
    /// Claims of the units that the test calls.
    pub claims: &'a [Claim],
    /// Whether coverage is recorded.
    pub coverage: bool,
    /// Maximum number of cycles. The default is [`MOST`] for a test that can finish and [`CYCLES`] for any other test.
    pub cycles: Option<u64>,
}

/// Default number of cycles of a test that cannot finish.
pub const CYCLES: u64 = 1000;

/// Default limit of cycles for a test that can finish.
pub const MOST: u64 = 100_000;

/// A Boolean export that must be true in every cycle in which it is present.
#[derive(Clone, Debug)]
pub struct Condition {
    /// Key of the export.
    pub key: String,
    /// Names and keys of the exports whose values are shown when the condition fails.
    pub reads: Vec<(String, String)>,
}

/// Result of a test.
#[derive(Debug)]
pub struct Report {
    /// Number of executed cycles.
    pub cycles: u64,
    /// Verdict on each condition.
    pub verdicts: Vec<Holds>,
    /// Diagnostics of violated claims.
    pub broken: Vec<Finding>,
    /// How the test ended; `None` if it cannot finish.
    pub end: Option<Ended>,
    /// Coverage, if it was recorded.
    pub coverage: Option<Coverage>,
}

/// Verdict on a condition.
#[derive(Clone, PartialEq, Debug)]
pub enum Holds {
    /// The condition was true whenever it was present.
    Always,
    /// The condition was absent in all cycles.
    Never,
    /// The condition was false. Only the first such cycle is reported.
    Broken {
        /// Cycle, from 0.
        cycle: u64,
        /// Names and values of the shown exports; `null` for an absent value.
        values: Vec<(String, String)>,
    },
}

/// How a test ended.
#[derive(Clone, PartialEq, Debug)]
pub enum Ended {
    /// The test finished with `finish` or `yield`.
    Finished,
    /// The test can finish, but did not do so within its cycles.
    Unfinished,
    /// The test ended with the `fail` of this name.
    Failed(String),
    /// A fault ended the test.
    Fault {
        /// Description of the fault.
        what: &'static str,
        /// Location in the source.
        place: Option<TextRange>,
    },
}

impl Report {
    /// Returns true if the test finished and no condition or claim was violated.
    #[must_use]
    pub fn passed(&self) -> bool {
        let ended = matches!(self.end, None | Some(Ended::Finished));
        ended && self.broken.is_empty() && self.verdicts.iter().all(|holds| *holds == Holds::Always)
    }
}

/// Runs a test.
///
/// # Errors
/// Returns the load errors if the image cannot be loaded.
pub fn run(case: Case<'_>) -> Result<Report, String> {
    let machine = Machine::load(case.image, &mut NoDevices).map_err(|faults| {
        let faults: Vec<String> = faults.iter().map(ToString::to_string).collect();
        faults.join("; ")
    })?;
    let finishes = can_finish(&machine.image().end);
    let noted = case.coverage.then_some(case.net);
    let coverage = noted.map(|net| Coverage::new(net, machine.image()));
    let mut watch = Watch::new(machine, case.conditions, case.claims, coverage);
    let cycles = case.cycles.unwrap_or(if finishes { MOST } else { CYCLES });
    let end = (0..cycles).find_map(|cycle| watch.cycle(cycle));
    Ok(watch.report(end.or(finishes.then_some(Ended::Unfinished))))
}

fn can_finish(end: &End) -> bool {
    match end {
        End::Results(results) => results.iter().any(|result| result.kind != EndKind::Fail),
        End::Ports { .. } => false,
    }
}

/// A running test.
struct Watch {
    machine: Machine,
    conditions: Vec<Watched>,
    claims: claims::Watch,
    broken: Vec<Finding>,
    coverage: Option<Coverage>,
    cycles: u64,
}

struct Watched {
    signal: Option<Signal>,
    reads: Vec<(String, Export)>,
    holds: Holds,
}

impl Watch {
    fn new(
        machine: Machine,
        conditions: &[Condition],
        claims: &[Claim],
        coverage: Option<Coverage>,
    ) -> Watch {
        let image = machine.image().clone();
        let numbered = |key: &str| {
            let place = image.exports.iter().position(|e| e.key == key)?;
            Some((place, image.exports[place].value.ty))
        };
        let export = |key: &String| image.exports.iter().find(|e| e.key == *key);
        let watched = |condition: &Condition| Watched {
            signal: export(&condition.key).map(|e| e.value),
            reads: condition
                .reads
                .iter()
                .filter_map(|(name, key)| Some((name.clone(), export(key)?.clone())))
                .collect(),
            holds: Holds::Never,
        };
        Watch {
            conditions: conditions.iter().map(watched).collect(),
            coverage,
            claims: claims::Watch::new(claims, numbered),
            broken: Vec::new(),
            machine,
            cycles: 0,
        }
    }

    /// Executes one cycle. Returns how the test ended, if it ended in this cycle.
    fn cycle(&mut self, cycle: u64) -> Option<Ended> {
        let bank = &mut NoDevices;
        self.machine.read(bank, &moment(cycle, &self.machine));
        self.machine.evaluate(bank);
        self.machine.commit();
        self.machine.hand_over(bank);
        self.cycles += 1;
        let verdict = self.machine.verdict(&[]);
        if let Some(Verdict::Fault(fault)) = verdict {
            let place = self.machine.image().place_of(fault.cell);
            return Some(Ended::Fault {
                what: rpi_runtime::run::fault_text(fault.code),
                place: place.and_then(|place| place.text),
            });
        }
        for condition in &mut self.conditions {
            condition.look(cycle, &self.machine);
        }
        let broken = self.claims.look(&Exports(&self.machine));
        let told = broken.iter().map(|broken| self.claims.told(broken, cycle));
        self.broken.extend(told);
        if let Some(coverage) = &mut self.coverage {
            coverage.look(&self.machine);
        }
        verdict.map(|verdict| self.ended(verdict))
    }

    fn ended(&self, verdict: Verdict) -> Ended {
        match (verdict, &self.machine.image().end) {
            (Verdict::Result(k), End::Results(results)) if results[k].kind == EndKind::Fail => {
                Ended::Failed(results[k].name.clone())
            }
            _ => Ended::Finished,
        }
    }

    fn report(self, end: Option<Ended>) -> Report {
        Report {
            cycles: self.cycles,
            verdicts: self.conditions.into_iter().map(|c| c.holds).collect(),
            broken: self.broken,
            end,
            coverage: self.coverage,
        }
    }
}

/// Read access to the exports of a machine.
struct Exports<'m>(&'m Machine);

impl Flows for Exports<'_> {
    fn cells(&self, export: usize) -> Option<&[u64]> {
        self.0.value(self.0.image().exports[export].value)
    }
}

impl Watched {
    fn look(&mut self, cycle: u64, machine: &Machine) {
        if matches!(self.holds, Holds::Broken { .. }) {
            return;
        }
        // A condition that is constantly true has no export.
        let value = self
            .signal
            .map_or(Some(1), |s| machine.value(s).map(|v| v[0]));
        match value {
            None => {}
            Some(0) => self.holds = self.broken(cycle, machine),
            Some(_) => self.holds = Holds::Always,
        }
    }

    fn broken(&self, cycle: u64, machine: &Machine) -> Holds {
        let text = |(name, read): &(String, Export)| {
            let value = machine.value(read.value);
            let text = value.map_or_else(
                || "null".to_owned(),
                |cells| rpi_literal::write(cells, read.value.ty),
            );
            (name.clone(), text)
        };
        let values = self.reads.iter().map(text).collect();
        Holds::Broken { cycle, values }
    }
}

/// Returns the time of a cycle. The epoch is the start of the test.
fn moment(cycle: u64, machine: &Machine) -> Moment {
    let ns = cycle.saturating_mul(machine.image().period_ns);
    let ns = i64::try_from(ns).unwrap_or(i64::MAX);
    Moment {
        net_ns: ns,
        wall_ns: ns,
        ..Moment::default()
    }
}
