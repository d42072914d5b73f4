//! Simulated devices of the recorded nets, with a log of every set-point.

use std::collections::BTreeMap;
use std::ops::Range;

use rpi_device::{DeviceBank, PortId, PortQuery, Rejection, ResolveError};
use rpi_sim::{Cell, SimBank};

/// Two arms side by side. The nets start from the positions at their recording, so the arm's check of the first
/// set-point is left out.
pub(crate) const TWO_ARMS: &str = r#"
[devices.left]
kind = "arm"
model = "kuka-lwr4+"
enforce = []

[devices.right]
kind = "arm"
model = "kuka-lwr4+"
enforce = []
"#;

/// Set-points of a cycle by port.
pub(crate) type SetPoints = BTreeMap<String, Vec<u64>>;

/// Simulated devices that log their set-points.
pub(crate) struct RecordingBank {
    bank: SimBank,
    names: BTreeMap<PortId, String>,
    set_points: SetPoints,
}

impl RecordingBank {
    /// Creates the devices of a cell; `period_ns` is the period of the command that moves them.
    pub(crate) fn new(cell: &str, period_ns: u64) -> Self {
        let cell = Cell::parse("cell.toml", cell).unwrap_or_else(|faults| panic!("{faults}"));
        RecordingBank {
            bank: SimBank::new(&cell, period_ns as f64 * 1e-9),
            names: BTreeMap::new(),
            set_points: BTreeMap::new(),
        }
    }

    /// Ends a cycle and returns its set-points.
    pub(crate) fn step(&mut self) -> SetPoints {
        self.bank.step();
        std::mem::take(&mut self.set_points)
    }
}

impl DeviceBank for RecordingBank {
    fn resolve(&mut self, name: &PortQuery<'_>) -> Result<PortId, ResolveError> {
        let port = self.bank.resolve(name)?;
        self.names.insert(port, format!("{name:?}"));
        Ok(port)
    }

    fn resource(&self, port: PortId) -> u32 {
        self.bank.resource(port)
    }

    fn resources(&self, port: PortId) -> Range<u32> {
        self.bank.resources(port)
    }

    fn begin_command(&mut self, resource: u32, ticks: u32) {
        self.bank.begin_command(resource, ticks);
    }

    fn read(&mut self, port: PortId, value: &mut [u64]) -> bool {
        self.bank.read(port, value)
    }

    fn check_set_point(&mut self, port: PortId, value: &[u64]) -> Rejection {
        self.bank.check_set_point(port, value)
    }

    fn error_code(&self, port: PortId) -> i64 {
        self.bank.error_code(port)
    }

    fn write(&mut self, port: PortId, value: &[u64]) {
        self.set_points
            .insert(self.names[&port].clone(), value.to_vec());
        self.bank.write(port, value);
    }

    fn call(&mut self, port: PortId, arguments: &[u64], result: &mut [u64]) -> bool {
        self.bank.call(port, arguments, result)
    }

    fn is_moving(&self, resource: u32) -> bool {
        self.bank.is_moving(resource)
    }

    fn stop(&mut self, resource: u32) {
        self.bank.stop(resource);
    }
}
