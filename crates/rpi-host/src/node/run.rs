//! A node and its cycles.

use std::sync::Arc;

use rpi_core::{Machine, Moment};
use rpi_image::Image;
use rpi_image::image::Signal;
use rpi_net::Column;
use rpi_sim::{Cell, SimBank};

use super::told;
use rpi_diag::{Finding, Span};

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
    claims: Vec<Claim>,
}

/// A condition that the node's text claims to hold.
struct Claim {
    signal: Signal,
    name: String,
    span: Span,
}

impl NodeRun {
    /// Loads a node's image. Claims are exported Booleans, with the place of each.
    ///
    /// # Errors
    /// Why it cannot run, in words.
    pub fn load(
        image: Image,
        inputs: &[Column],
        shown: &[Column],
        claims: &[(String, Span)],
    ) -> Result<NodeRun, String> {
        let image = Arc::new(image);
        let cell = Cell::parse("no devices", "").map_err(|errors| errors.to_string())?;
        let mut bank = SimBank::new(&cell, image.period_ns as f64 * 1e-9);
        let input = |column: &Column| image.inputs.iter().position(|i| i.key == column.key);
        let export = |key: &str| image.exports.iter().find(|e| e.key == key).map(|e| e.value);
        let inputs = inputs.iter().map(input).collect();
        let shown = shown.iter().map(|column| export(&column.key)).collect();
        let claim = |(key, span): &(String, Span)| {
            Some(Claim {
                signal: export(key)?,
                name: key.clone(),
                span: *span,
            })
        };
        let claims = claims.iter().filter_map(claim).collect();
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
            claims,
        })
    }

    /// One cycle. `given` has the cells of every in-port, in their order.
    pub fn cycle(&mut self, given: &[Vec<u64>]) -> Cycle {
        let now = Moment::default();
        for (input, cells) in self.inputs.iter().zip(given) {
            if let Some(index) = input {
                self.machine.set_input(*index, cells, now.net_ns);
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

    fn seen(&self, number: u64) -> Cycle {
        if let Some(fault) = self.machine.fault() {
            let finding = told::fault(self.machine.image(), fault, number);
            return Cycle {
                row: None,
                findings: vec![finding],
            };
        }
        let shown = self.shown.iter();
        let value = |signal: &Option<Signal>| self.machine.value((*signal)?).map(<[u64]>::to_vec);
        let holds = |claim: &&Claim| self.machine.value(claim.signal) != Some(&[0][..]);
        let broken = self.claims.iter().filter(|claim| !holds(claim));
        let findings = broken.map(|claim| told::claim(&claim.name, claim.span, number));
        let findings = findings.collect();
        Cycle {
            row: Some(shown.map(value).collect()),
            findings,
        }
    }
}
