//! Device bank of a trace replay. Every port exists and has no effect, because all device values come from the trace.

use rpi_device::{DeviceBank, PortId, PortQuery, Rejection, ResolveError};

/// Device bank for the replay of a trace: every device exists and has no effect, because all device values come from
/// the trace.
#[derive(Default)]
pub(super) struct TraceBank {
    ports: u32,
}

impl DeviceBank for TraceBank {
    /// Returns a new actuator number for each port, so that no two writers conflict: such conflicts are part of the
    /// trace and need not be detected.
    fn resolve(&mut self, _: &PortQuery<'_>) -> Result<PortId, ResolveError> {
        self.ports += 1;
        Ok(PortId(self.ports))
    }

    fn resource(&self, port: PortId) -> u32 {
        port.0
    }

    fn read(&mut self, _: PortId, _: &mut [u64]) -> bool {
        true
    }

    fn check_set_point(&mut self, _: PortId, _: &[u64]) -> Rejection {
        Rejection::NONE
    }

    fn error_code(&self, _: PortId) -> i64 {
        0
    }

    fn write(&mut self, _: PortId, _: &[u64]) {}

    fn call(&mut self, _: PortId, _: &[u64], _: &mut [u64]) -> bool {
        false
    }

    fn is_moving(&self, _: u32) -> bool {
        false
    }

    fn stop(&mut self, _: u32) {}
}
