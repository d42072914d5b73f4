//! A node and its cycles.

use std::sync::Arc;

use rpi_core::{Machine, Moment};
use rpi_image::Image;
use rpi_image::image::Signal;
use rpi_net::{Claim, Column};
use rpi_prims::FaultCode;
use rpi_sim::{Cell, SimBank};

use super::told;
use crate::claims::{Flows, Watch};
use rpi_diag::Finding;

/// The cells of each column in one cycle; none where the flow is absent.
pub type Row = Vec<Option<Vec<u64>>>;

/// What a cycle gave.
#[derive(Debug)]
pub struct Cycle {
    /// The columns that are shown; none if the cycle could not be computed.
    pub row: Option<Row>,
    /// What went wrong in it.
    pub findings: Vec<Finding>,
}

/// A node that runs by itself, without devices.
pub struct NodeRun {
    machine: Machine,
    bank: SimBank,
    /// For each column that is fed the image's inputs of that key.
    inputs: Vec<Option<usize>>,
    shown: Vec<Option<Signal>>,
    exports: Vec<Signal>,
    claims: Watch,
}

impl NodeRun {
    /// Loads a node's image; the claims that it publishes are watched.
    ///
    /// # Errors
    /// Why it cannot run, in words.
    pub fn load(
        image: Image,
        inputs: &[Column],
        shown: &[Column],
        claims: &[Claim],
    ) -> Result<NodeRun, String> {
        let image = Arc::new(image);
        let cell = Cell::parse("no devices", "").map_err(|errors| errors.to_string())?;
        let mut bank = SimBank::new(&cell, image.period_ns as f64 * 1e-9);
        let input = |column: &Column| image.inputs.iter().position(|i| i.key == column.key);
        let export = |key: &str| image.exports.iter().find(|e| e.key == key).map(|e| e.value);
        let inputs = inputs.iter().map(input).collect();
        let shown = shown.iter().map(|column| export(&column.key)).collect();
        let numbered = |key: &str| {
            let place = image.exports.iter().position(|e| e.key == key)?;
            Some((place, image.exports[place].value.ty))
        };
        let claims = Watch::new(claims, numbered);
        let exports = image.exports.iter().map(|e| e.value).collect();
        let machine = Machine::load(Arc::clone(&image), &mut bank);
        let machine = machine.map_err(|faults| {
            let words: Vec<String> = faults.iter().map(ToString::to_string).collect();
            words.join("\n")
        })?;
        Ok(NodeRun {
            machine,
            bank,
            inputs,
            shown,
            exports,
            claims,
        })
    }

    /// One cycle. `given` has the cells of every in-port, in their order.
    pub fn cycle(&mut self, given: &[Option<Vec<u64>>]) -> Cycle {
        let now = Moment::default();
        for (input, cells) in self.inputs.iter().zip(given) {
            match (input, cells) {
                (Some(index), Some(cells)) => {
                    self.machine.set_input(*index, cells, now.net_ns);
                }
                (Some(index), None) => self.machine.clear_input(*index),
                (None, _) => {}
            }
        }
        let number = self.machine.cycle();
        self.machine.read(&mut self.bank, &now);
        self.machine.evaluate(&mut self.bank);
        let cycle = self.seen(number);
        self.machine.commit();
        self.machine.hand_over(&mut self.bank);
        cycle
    }

    fn seen(&mut self, number: u64) -> Cycle {
        let seen = Seen {
            machine: &self.machine,
            exports: &self.exports,
        };
        let fault = self.machine.fault();
        // After any other fault nothing is told of values that were computed from it.
        let counts = fault.is_none_or(|fault| fault.code == FaultCode::AssertionFailed);
        let broken = match counts {
            true => self.claims.look(&seen),
            false => Vec::new(),
        };
        if let Some(fault) = fault {
            let mut finding = told::fault(self.machine.image(), fault, number, None);
            let mut broken = broken.iter();
            broken.find_map(|broken| self.claims.tell_fault(&mut finding, broken));
            return Cycle {
                row: None,
                findings: vec![finding],
            };
        }
        let shown = self.shown.iter();
        let value = |signal: &Option<Signal>| self.machine.value((*signal)?).map(<[u64]>::to_vec);
        let row = Some(shown.map(value).collect());
        let findings = broken.iter().map(|b| self.claims.told(b, number));
        let findings = findings.collect();
        Cycle { row, findings }
    }

    /// How often claims did not hold, a line for each that did not hold more than once.
    #[must_use]
    pub fn summary(&self) -> String {
        self.claims.summary()
    }
}

/// What the machine publishes.
struct Seen<'m> {
    machine: &'m Machine,
    exports: &'m [Signal],
}

impl Flows for Seen<'_> {
    fn cells(&self, export: usize) -> Option<&[u64]> {
        self.machine.value(self.exports[export])
    }
}
