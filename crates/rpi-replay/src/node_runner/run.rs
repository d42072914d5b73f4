//! Executes a single node cycle by cycle.

use std::fmt;
use std::sync::Arc;

use rpi_core::{CycleContext, Instance, LoadError};
use rpi_device::{DeviceBank, NoDevices};
use rpi_image::Image;
use rpi_image::image::Signal;
use rpi_net::{Claim, Column};
use rpi_prims::FaultCode;

use crate::faults::ReportedFault;
use crate::monitor::{ClaimMonitor, ExportValues};
use rpi_diag::Diagnostic;
use rpi_runtime::run::FaultOrigin;

/// Memory words of the value in each column of a table in one cycle; `None` where the flow is absent.
pub type ColumnValues = Vec<Option<Vec<u64>>>;

/// Result of executing one cycle of a node: the values of its outputs, and diagnostics.
#[derive(Debug)]
pub struct CycleResult {
    /// Values of the shown columns; `None` if the cycle raised a fault.
    pub row: Option<ColumnValues>,
    /// Diagnostics of claims that were violated for the first time and of faults in the cycle.
    pub diagnostics: Vec<Diagnostic>,
}

/// All errors of the image of a node that cannot be loaded. The text has one line for each.
#[derive(Clone, PartialEq, Debug)]
pub struct NodeLoadError(pub Vec<LoadError>);

impl fmt::Display for NodeLoadError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let texts: Vec<String> = self.0.iter().map(ToString::to_string).collect();
        f.write_str(&texts.join("\n"))
    }
}

impl std::error::Error for NodeLoadError {}

/// A loaded node that is executed without devices, with the monitor of its claims.
pub struct NodeRun {
    machine: Instance,
    bank: Box<dyn DeviceBank>,
    /// For each input column, the index of the image input with the same key; `None` if the image has no such input.
    inputs: Vec<Option<usize>>,
    outputs: Vec<Option<Signal>>,
    exports: Vec<Signal>,
    claims: ClaimMonitor,
}

impl NodeRun {
    /// Loads the image of a node. `inputs` and `shown` are the columns of its in-ports and of the flows to return;
    /// `claims` (assertions and contracts) are monitored.
    ///
    /// # Errors
    /// Returns the load errors if the image cannot be loaded.
    pub fn load(
        image: Image,
        inputs: &[Column],
        shown: &[Column],
        claims: &[Claim],
    ) -> Result<NodeRun, NodeLoadError> {
        NodeRun::load_with(image, Box::new(NoDevices), inputs, shown, claims)
    }

    /// Loads the image of a node as [`NodeRun::load`] does. `bank` has the external functions of the node.
    ///
    /// # Errors
    /// Returns the load errors if the image cannot be loaded.
    pub fn load_with(
        image: Image,
        mut bank: Box<dyn DeviceBank>,
        inputs: &[Column],
        shown: &[Column],
        claims: &[Claim],
    ) -> Result<NodeRun, NodeLoadError> {
        let image = Arc::new(image);
        let input = |column: &Column| image.inputs.iter().position(|i| i.key == column.key);
        let export = |key: &str| image.exports.iter().find(|e| e.key == key).map(|e| e.value);
        let inputs = inputs.iter().map(input).collect();
        let shown = shown.iter().map(|column| export(&column.key)).collect();
        let numbered = |key: &str| {
            let place = image.exports.iter().position(|e| e.key == key)?;
            Some((place, image.exports[place].value.ty))
        };
        let claims = ClaimMonitor::new(claims, numbered);
        let exports = image.exports.iter().map(|e| e.value).collect();
        let machine = Instance::load(Arc::clone(&image), &mut *bank).map_err(NodeLoadError)?;
        Ok(NodeRun {
            machine,
            bank,
            inputs,
            outputs: shown,
            exports,
            claims,
        })
    }

    /// Executes one cycle. `given` holds the memory words of every in-port, in the order of the input columns; `None`
    /// is an absent value.
    pub fn cycle(&mut self, given: &[Option<Vec<u64>>]) -> CycleResult {
        self.cycle_observed(given, &mut |_| {})
    }

    /// Executes one cycle as [`NodeRun::cycle`] does, and passes the instance to `observe` after the evaluation, before the
    /// delays are stored.
    pub fn cycle_observed(
        &mut self,
        given: &[Option<Vec<u64>>],
        observe: &mut dyn FnMut(&Instance),
    ) -> CycleResult {
        let now = CycleContext::default();
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
        self.machine.read(&mut *self.bank, &now);
        self.machine.evaluate(&mut *self.bank);
        observe(&self.machine);
        let cycle = self.cycle_result(number);
        self.machine.commit();
        self.machine.hand_over(&mut *self.bank);
        cycle
    }

    fn cycle_result(&mut self, number: u64) -> CycleResult {
        let seen = MachineExports {
            machine: &self.machine,
            exports: &self.exports,
        };
        let fault = self.machine.fault();
        // After any other fault the values may have been computed from invalid data, so the claims are not evaluated.
        let counts = fault.is_none_or(|fault| fault.code == FaultCode::AssertionFailed);
        let broken = match counts {
            true => self.claims.evaluate(&seen),
            false => Vec::new(),
        };
        if let Some(fault) = fault {
            let origin = FaultOrigin::of(self.machine.image(), fault, number);
            let mut report = ReportedFault::new(&origin, None);
            let mut broken = broken.iter();
            broken.find_map(|broken| self.claims.explain_fault(&mut report, broken));
            return CycleResult {
                row: None,
                diagnostics: vec![report.into_diagnostic()],
            };
        }
        let shown = self.outputs.iter();
        let value = |signal: &Option<Signal>| self.machine.value((*signal)?).map(<[u64]>::to_vec);
        let row = Some(shown.map(value).collect());
        let diagnostics = broken.iter().map(|b| self.claims.diagnostic(b, number));
        let diagnostics = diagnostics.collect();
        CycleResult { row, diagnostics }
    }

    /// Returns as text one line for each claim that was violated in more than one cycle, with the number of violations.
    #[must_use]
    pub fn summary(&self) -> String {
        self.claims.summary()
    }
}

/// Access to the exported flows of a running node, by which its claims are monitored.
struct MachineExports<'m> {
    machine: &'m Instance,
    exports: &'m [Signal],
}

impl ExportValues for MachineExports<'_> {
    fn words(&self, export: usize) -> Option<&[u64]> {
        self.machine.value(self.exports[export])
    }
}
