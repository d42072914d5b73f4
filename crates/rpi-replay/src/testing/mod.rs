//! Execution of program tests: a net without devices runs cycle by cycle, and its conditions are monitored.
//!
//! The runner knows an image and the keys of the exports that carry the conditions. It must not depend on the source
//! language.

mod coverage;

pub use coverage::Coverage;

use rpi_core::{CycleContext, Instance, Verdict};
use rpi_device::{DeviceBank, NoDevices};
use rpi_diag::{Diagnostic, FileId, Quote, Span};
use rpi_image::Image;
use rpi_image::image::{CommandEnd, CommandEndKind, Export, Signal, TextRange};
use rpi_net::{Claim, Net};
use rpi_runtime::ImageLoadError;

use crate::monitor::{self, ExportValues};

/// Test of a program, ready to be run: its net and image, its conditions and claims, and options.
#[derive(Debug)]
pub struct TestCase<'a> {
    /// Net that was compiled from the `test` declaration in the program.
    pub net: &'a Net,
    /// Image of the net, lowered so that all ports can be observed.
    pub image: Image,
    /// Assertions in the test, in the order of the text. Their conditions must hold in every cycle.
    pub conditions: &'a [TestCondition],
    /// Claims (assertions and contracts) of the nodes and commands that the test calls.
    pub claims: &'a [Claim],
    /// Whether to record which fragments, branches and transitions of the net the test covers.
    pub coverage: bool,
    /// Maximum number of cycles. The default is [`MAX_FINISH_CYCLES`] for a test that can finish and [`DEFAULT_CYCLES`] for any other test.
    pub cycles: Option<u64>,
}

/// Default number of cycles of a test that cannot finish.
pub const DEFAULT_CYCLES: u64 = 1000;

/// Number of cycles after which a test with a `finish` counts as failed, unless `--cycles` gives another number.
pub const MAX_FINISH_CYCLES: u64 = 100_000;

/// Condition of a test: a Boolean export that must be true in every cycle in which it is present.
#[derive(Clone, Debug)]
pub struct TestCondition {
    /// Key of the Boolean export in the net of the test. A condition that is constantly true has no export.
    pub key: String,
    /// Names and export keys of the values that are shown when the condition fails.
    pub reads: Vec<(String, String)>,
}

/// Outcome of one test of a program: its verdicts, violated claims, end and coverage.
#[derive(Debug)]
pub struct TestReport {
    /// Number of cycles that the test has run.
    pub cycles: u64,
    /// For each assertion of the test, in the order of the text, whether it held, failed or was never active.
    pub verdicts: Vec<ConditionVerdict>,
    /// Diagnostics of the claims (assertions and contracts of called nodes) that were violated.
    pub violations: Vec<Diagnostic>,
    /// How the test ended; `None` if it cannot finish and has run its number of cycles.
    pub end: Option<TestEnd>,
    /// Coverage of the net by the test; `None` if it was not recorded.
    pub coverage: Option<Coverage>,
}

/// Whether a condition of a test held, and where it failed first.
#[derive(Clone, PartialEq, Debug)]
pub enum ConditionVerdict {
    /// The condition was true whenever it was present.
    Held,
    /// The condition was absent in all cycles, so that it tested nothing.
    NeverPresent,
    /// The condition was false in at least one cycle. Only the first such cycle is reported.
    Violated {
        /// First cycle in which the condition was false, from 0.
        cycle: u64,
        /// Names and values, as text, of the exports shown for the failed condition; `null` for an absent value.
        values: Vec<(String, String)>,
    },
}

/// How a test ended: with a result, with a fault, or at the cycle limit.
#[derive(Clone, PartialEq, Debug)]
pub enum TestEnd {
    /// The test finished with `finish` or `yield`.
    Finished,
    /// The test can finish, but did not do so within its cycles.
    Unfinished,
    /// The test ended with the `fail` of this name.
    Failed(String),
    /// A fault, such as an overflow, ended the test before its `finish`.
    Fault {
        /// Description of the fault that ended the test.
        what: String,
        /// Advice for the operation, if a program can avoid the fault. It quotes the source ([`rpi_diag::Quote`]).
        advice: Option<String>,
        /// Range in the source of the operation that raised the fault; `None` if it is unknown.
        location: Option<TextRange>,
    },
}

impl TestReport {
    /// Returns true if the test finished, or cannot finish, and every condition held and no claim was violated.
    #[must_use]
    pub fn passed(&self) -> bool {
        let ended = matches!(self.end, None | Some(TestEnd::Finished));
        ended
            && self.violations.is_empty()
            && self
                .verdicts
                .iter()
                .all(|holds| *holds == ConditionVerdict::Held)
    }
}

/// Runs a test and returns its report.
///
/// # Errors
/// Returns the load errors if the image cannot be loaded.
pub fn run(case: TestCase<'_>) -> Result<TestReport, ImageLoadError> {
    run_observed(case, &mut NoDevices, &mut |_| {})
}

/// Runs a test as [`run`] does, and passes the instance to `observe` in each cycle, after the evaluation and before the
/// delays are stored. `bank` has the external functions of the test, if it calls any.
///
/// # Errors
/// Returns the load errors if the image cannot be loaded.
pub fn run_observed(
    case: TestCase<'_>,
    bank: &mut dyn DeviceBank,
    observe: &mut dyn FnMut(&Instance),
) -> Result<TestReport, ImageLoadError> {
    let machine = Instance::load(case.image, bank).map_err(ImageLoadError)?;
    let finishes = can_finish(&machine.image().end);
    let noted = case.coverage.then_some(case.net);
    let coverage = noted.map(|net| Coverage::new(net, machine.image()));
    let mut watch = TestRun::new(machine, case.conditions, case.claims, coverage);
    let cycles = case.cycles.unwrap_or(if finishes {
        MAX_FINISH_CYCLES
    } else {
        DEFAULT_CYCLES
    });
    let end = (0..cycles).find_map(|cycle| watch.cycle(cycle, bank, observe));
    Ok(watch.report(end.or(finishes.then_some(TestEnd::Unfinished))))
}

fn can_finish(end: &CommandEnd) -> bool {
    match end {
        CommandEnd::Results(results) => results
            .iter()
            .any(|result| result.kind != CommandEndKind::Fail),
        CommandEnd::Ports { .. } => false,
    }
}

/// State of a running test: the net's image, and the verdicts on its conditions so far.
struct TestRun {
    machine: Instance,
    conditions: Vec<MonitoredCondition>,
    claims: monitor::ClaimMonitor,
    violations: Vec<Diagnostic>,
    coverage: Option<Coverage>,
    cycles: u64,
}

struct MonitoredCondition {
    signal: Option<Signal>,
    reads: Vec<(String, Export)>,
    verdict: ConditionVerdict,
}

impl TestRun {
    fn new(
        machine: Instance,
        conditions: &[TestCondition],
        claims: &[Claim],
        coverage: Option<Coverage>,
    ) -> TestRun {
        let image = machine.image().clone();
        let numbered = |key: &str| {
            let place = image.exports.iter().position(|e| e.key == key)?;
            Some((place, image.exports[place].value.ty))
        };
        let export = |key: &String| image.exports.iter().find(|e| e.key == *key);
        let watched = |condition: &TestCondition| MonitoredCondition {
            signal: export(&condition.key).map(|e| e.value),
            reads: condition
                .reads
                .iter()
                .filter_map(|(name, key)| Some((name.clone(), export(key)?.clone())))
                .collect(),
            verdict: ConditionVerdict::NeverPresent,
        };
        TestRun {
            conditions: conditions.iter().map(watched).collect(),
            coverage,
            claims: monitor::ClaimMonitor::new(claims, numbered),
            violations: Vec::new(),
            machine,
            cycles: 0,
        }
    }

    /// Executes the cycle of the test with this number, from 0. Returns how the test ended if it ended in this cycle,
    /// else `None`.
    fn cycle(
        &mut self,
        cycle: u64,
        bank: &mut dyn DeviceBank,
        observe: &mut dyn FnMut(&Instance),
    ) -> Option<TestEnd> {
        self.machine
            .read(bank, &cycle_context(cycle, &self.machine));
        self.machine.evaluate(bank);
        observe(&self.machine);
        self.machine.commit();
        self.machine.hand_over(bank);
        self.cycles += 1;
        let verdict = self.machine.verdict(&[]);
        if let Some(Verdict::Fault(fault)) = verdict {
            let place = self.machine.image().location_of(fault.slot);
            let location = place.and_then(|place| place.range);
            let operation = location.map_or_else(|| "...".to_owned(), quoted);
            return Some(TestEnd::Fault {
                what: rpi_runtime::run::fault_message(fault.code, fault.values),
                advice: rpi_runtime::run::fault_advice(fault.code, &operation),
                location,
            });
        }
        for condition in &mut self.conditions {
            condition.evaluate(cycle, &self.machine);
        }
        let broken = self.claims.evaluate(&MachineExports(&self.machine));
        let diagnostics = broken
            .iter()
            .map(|broken| self.claims.diagnostic(broken, cycle));
        self.violations.extend(diagnostics);
        if let Some(coverage) = &mut self.coverage {
            coverage.update(&self.machine);
        }
        verdict.map(|verdict| self.test_end(verdict))
    }

    fn test_end(&self, verdict: Verdict) -> TestEnd {
        match (verdict, &self.machine.image().end) {
            (Verdict::Result(k), CommandEnd::Results(results))
                if results[k].kind == CommandEndKind::Fail =>
            {
                TestEnd::Failed(results[k].name.clone())
            }
            _ => TestEnd::Finished,
        }
    }

    fn report(self, end: Option<TestEnd>) -> TestReport {
        TestReport {
            cycles: self.cycles,
            verdicts: self.conditions.into_iter().map(|c| c.verdict).collect(),
            violations: self.violations,
            end,
            coverage: self.coverage,
        }
    }
}

/// Access to the exported flows of a running test, by which its claims are monitored.
struct MachineExports<'m>(&'m Instance);

impl ExportValues for MachineExports<'_> {
    fn words(&self, export: usize) -> Option<&[u64]> {
        self.0.value(self.0.image().exports[export].value)
    }
}

impl MonitoredCondition {
    fn evaluate(&mut self, cycle: u64, machine: &Instance) {
        if matches!(self.verdict, ConditionVerdict::Violated { .. }) {
            return;
        }
        // A condition that is constantly true has no export.
        let value = self
            .signal
            .map_or(Some(1), |s| machine.value(s).map(|v| v[0]));
        match value {
            None => {}
            Some(0) => self.verdict = self.violation(cycle, machine),
            Some(_) => self.verdict = ConditionVerdict::Held,
        }
    }

    fn violation(&self, cycle: u64, machine: &Instance) -> ConditionVerdict {
        let text = |(name, read): &(String, Export)| {
            let value = machine.value(read.value);
            let text = value.map_or_else(
                || "null".to_owned(),
                |cells| rpi_literal::write(cells, read.value.ty),
            );
            (name.clone(), text)
        };
        let values = self.reads.iter().map(text).collect();
        ConditionVerdict::Violated { cycle, values }
    }
}

/// Returns the context of a cycle of the test (clocks and inputs from the core). The clocks begin with 0 at the start
/// of the test.
fn cycle_context(cycle: u64, machine: &Instance) -> CycleContext {
    let ns = cycle.saturating_mul(machine.image().period_ns);
    let ns = i64::try_from(ns).unwrap_or(i64::MAX);
    CycleContext {
        net_ns: ns,
        wall_ns: ns,
        ..CycleContext::default()
    }
}

/// Returns the quotation of the source text in a range.
fn quoted(range: TextRange) -> String {
    let span = Span {
        file: FileId(range.file),
        start: range.start,
        end: range.end,
    };
    Quote::text(span).to_string()
}
