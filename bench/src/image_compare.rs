//! Comparison of two images of the same net, observed and optimised, which must behave alike.

use crate::BenchError;
use crate::fake_devices::FakeDevices;
use rpi_core::{CycleContext, Instance, Verdict};
use rpi_image::Image;
use rpi_image::image::Signal;
use rpi_lower::{LowerOptions, Plan, lower};
use rpi_net::Net;
use rpi_net::passes::analyse;

/// Runs the observed and the optimised image of a net side by side and compares all outputs.
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

/// Analyses and lowers a net.
///
/// # Errors
/// Returns the reason why the net could not be lowered.
pub fn lower_net(net: &Net, options: &LowerOptions<'_>) -> Result<Image, BenchError> {
    let analysis = analyse(net.clone(), options.may_be_absent).map_err(BenchError::from_cause)?;
    let plan = Plan::from_analysis(&analysis).ok_or_else(|| BenchError::new("dependency cycle"))?;
    lower(&analysis.net, &plan, options).map_err(BenchError::from_cause)
}

/// An instance of a net's image with a device bank of its own, which is run cycle by cycle.
pub struct Runner {
    machine: Instance,
    bank: FakeDevices,
}

/// Outputs of a command in one cycle.
#[derive(Clone, PartialEq, Debug)]
pub struct CycleOutputs {
    /// How the command ends with this cycle.
    pub verdict: Option<Verdict>,
    /// Exports by key, including absent ones.
    pub exports: Vec<(String, Option<Vec<u64>>)>,
    /// Hash of all set-points so far.
    pub set_point_hash: u64,
}

impl Runner {
    /// Lowers, verifies and loads a net.
    ///
    /// # Errors
    /// Returns the reason why the net could not be loaded.
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

    /// Runs one cycle. `cancel`, `takeover` and `predecessor` vary with the number of the cycle.
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

    /// The instance that is run.
    #[must_use]
    pub fn machine(&self) -> &Instance {
        &self.machine
    }
}

impl CycleOutputs {
    /// Compares the outputs of two machines.
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
