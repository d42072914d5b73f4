//! A bank without devices.

use rpi_device::{DeviceBank, PortId, PortName, Refusal, ResolveError};

/// No primitive with code may need a device.
pub(crate) struct NoDevices;

impl DeviceBank for NoDevices {
    fn resolve(&mut self, _: &PortName<'_>) -> Result<PortId, ResolveError> {
        Err(ResolveError::NoDevice)
    }
    fn resource(&self, _: PortId) -> u32 {
        0
    }
    fn read(&mut self, _: PortId, _: &mut [u64]) -> bool {
        false
    }
    fn check(&mut self, _: PortId, _: &[u64]) -> Refusal {
        Refusal::DEVICE_FAILED
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
