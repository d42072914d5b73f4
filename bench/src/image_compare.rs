//! Comparison of two images of the same net, observed and optimised, which must behave alike.

use crate::BenchError;
use crate::fake_devices::FakeDevices;
use rpi_core::{CycleContext, Instance, Verdict};
use rpi_image::Image;
use rpi_image::image::Signal;
use rpi_lower::{LowerOptions, Plan, lower};
use rpi_net::Net;
use rpi_net::passes::analyse;

/// Runs two images of a net side by side and compares all outputs: one with observable ports, and one optimised for
/// execution.
///
/// # Errors
/// Returns the first difference with its cycle, or the reason why the net could not be run.
pub fn compare(net: &Net, cycles: u64, period_ns: u64) -> Result<(), BenchError> {
    let mut plain = Runner::new(net, &LowerOptions::observed(period_ns))?;
    let mut fast = Runner::new(net, &LowerOptions::running(period_ns))?;
    for cycle in 0..cycles {
        let (a, b) = (plain.cycle(cycle), fast.cycle(cycle));
        a.compare(&b)
            .map_err(|error| BenchError::new(format!("cycle {cycle}: {error}")))?;
        if a.verdict.is_some() {
            return Ok(());
        }
    }
    Ok(())
}

/// Analyses a net and lowers it to an image.
///
/// # Errors
/// Returns the reason why the net cannot be lowered.
pub fn lower_net(net: &Net, options: &LowerOptions<'_>) -> Result<Image, BenchError> {
    let analysis = analyse(net.clone(), options.may_be_absent).map_err(BenchError::from_cause)?;
    let plan = Plan::from_analysis(&analysis).ok_or_else(|| BenchError::new("dependency cycle"))?;
    lower(&analysis.net, &plan, options).map_err(BenchError::from_cause)
}

/// Runner of the image of a net, with simulated devices of its own, cycle by cycle.
pub struct Runner {
    machine: Instance,
    bank: FakeDevices,
}

/// Outputs of a command in one cycle: end, exports and set-points.
#[derive(Clone, PartialEq, Debug)]
pub struct CycleOutputs {
    /// Way in which the command ends after this cycle; `None` if it continues.
    pub verdict: Option<Verdict>,
    /// Exported flows: key, and value in memory slots (`None` if it is absent).
    pub exports: Vec<(String, Option<Vec<u64>>)>,
    /// Hash of all set-points up to this cycle.
    pub set_point_hash: u64,
}

impl Runner {
    /// Lowers a net to an image, verifies and loads the image.
    ///
    /// # Errors
    /// Returns the reason why the net cannot be loaded.
    pub fn new(net: &Net, options: &LowerOptions<'_>) -> Result<Runner, BenchError> {
        let image = lower_net(net, options)?;
        let mut bank = FakeDevices::new();
        let machine = Instance::load(image, &mut bank);
        let machine = machine.map_err(|faults| {
            let text: Vec<String> = faults.iter().map(ToString::to_string).collect();
            BenchError::new(text.join("; "))
        })?;
        Ok(Runner { machine, bank })
    }

    /// Runs one cycle and returns its outputs. The flows `cancel`, `takeover` and `predecessor` vary with `cycle`, the
    /// number of the cycle.
    pub fn cycle(&mut self, cycle: u64) -> CycleOutputs {
        let since = cycle * self.machine.image().period_ns;
        let context = CycleContext {
            net_ns: since.cast_signed(),
            wall_ns: since.cast_signed() + 17,
            cancel: cycle > 60,
            takeover: cycle % 7 == 3,
            predecessor: (cycle > 2).then_some(5),
            ..CycleContext::default()
        };
        let (machine, bank) = (&mut self.machine, &mut self.bank);
        bank.advance();
        machine.read(bank, &context);
        machine.evaluate(bank);
        machine.commit();
        machine.hand_over(bank);
        let value = |s: Signal| machine.value(s).map(<[u64]>::to_vec);
        let exports = machine.image().exports.iter();
        CycleOutputs {
            verdict: machine.verdict(&[true; 64]),
            exports: exports.map(|e| (e.key.clone(), value(e.value))).collect(),
            set_point_hash: bank.set_point_hash(),
        }
    }

    /// Returns the running instance of the image.
    #[must_use]
    pub fn machine(&self) -> &Instance {
        &self.machine
    }
}

impl CycleOutputs {
    /// Compares these outputs with those of another run in the same cycle.
    ///
    /// # Errors
    /// Returns a description of the first difference.
    pub fn compare(&self, other: &CycleOutputs) -> Result<(), BenchError> {
        let ends = |l: &CycleOutputs| {
            l.verdict.map(|v| match v {
                Verdict::Fault(fault) => format!("fault {:?}", fault.code),
                other => format!("{other:?}"),
            })
        };
        if ends(self) != ends(other) {
            return Err(BenchError::new(format!(
                "ends {:?} or {:?}",
                self.verdict, other.verdict
            )));
        }
        for (a, b) in self.exports.iter().zip(&other.exports) {
            if a != b {
                return Err(BenchError::new(format!(
                    "export {}: {:x?} or {:x?}",
                    a.0, a.1, b.1
                )));
            }
        }
        let same = self.set_point_hash == other.set_point_hash;
        same.then_some(())
            .ok_or_else(|| BenchError::new("set-points differ"))
    }
}
