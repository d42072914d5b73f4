//! Device bank of a trace replay. Every port exists and has no effect, because all device values come from the trace.

use rpi_device::{DeviceBank, PortId, PortName, Refusal, ResolveError};

/// A cell in which every device exists.
#[derive(Default)]
pub(super) struct ReplayBank {
    ports: u32,
}

impl DeviceBank for ReplayBank {
    /// Each port is a separate actuator. Conflicts between writers are part of the trace.
    fn resolve(&mut self, _: &PortName<'_>) -> Result<PortId, ResolveError> {
        self.ports += 1;
        Ok(PortId(self.ports))
    }

    fn resource(&self, port: PortId) -> u32 {
        port.0
    }

    fn read(&mut self, _: PortId, _: &mut [u64]) -> bool {
        true
    }

    fn check(&mut self, _: PortId, _: &[u64]) -> Refusal {
        Refusal::NONE
    }

    fn error(&self, _: PortId) -> i64 {
        0
    }

    fn write(&mut self, _: PortId, _: &[u64]) {}

    fn call(&mut self, _: PortId, _: &[u64], _: &mut [u64]) -> bool {
        false
    }

    fn moving(&self, _: u32) -> bool {
        false
    }

    fn stop(&mut self, _: u32) {}
}
