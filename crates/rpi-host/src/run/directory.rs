//! The names of a cell's ports, found once: lets commands be loaded beside the cycle, which has the devices.

use std::ops::Range;

use rpi_device::{DeviceBank, PortId, PortKind, PortName, Refusal, ResolveError};
use rpi_image::Type;

/// A port's name with what the cell said to it.
#[derive(Clone, Debug)]
struct Entry {
    device: String,
    port: String,
    index: u32,
    kind: PortKind,
    ty: Type,
    found: Result<PortId, ResolveError>,
    resources: Range<u32>,
}

impl Entry {
    fn is(&self, name: &PortName<'_>) -> bool {
        (self.index, self.kind, self.ty) == (name.index, name.kind, name.ty)
            && self.device == name.device
            && self.port == name.port
    }
}

/// What was asked of a cell, and its answers. As a bank of devices it gives the same answers again and does nothing.
#[derive(Clone, Debug, Default)]
pub(super) struct Directory {
    entries: Vec<Entry>,
}

impl Directory {
    /// A bank that asks the real one and remembers.
    pub(super) fn learn<'a>(&'a mut self, bank: &'a mut dyn DeviceBank) -> impl DeviceBank + 'a {
        Learning {
            directory: self,
            bank,
        }
    }

    fn resources(&self, port: PortId) -> Range<u32> {
        let entry = self.entries.iter().find(|e| e.found == Ok(port));
        entry.map_or(0..0, |e| e.resources.clone())
    }
}

struct Learning<'a> {
    directory: &'a mut Directory,
    bank: &'a mut dyn DeviceBank,
}

impl DeviceBank for Learning<'_> {
    fn resolve(&mut self, name: &PortName<'_>) -> Result<PortId, ResolveError> {
        let found = self.bank.resolve(name);
        self.directory.entries.push(Entry {
            device: name.device.to_owned(),
            port: name.port.to_owned(),
            index: name.index,
            kind: name.kind,
            ty: name.ty,
            found,
            resources: found.map_or(0..0, |port| self.bank.resources(port)),
        });
        found
    }

    fn resource(&self, port: PortId) -> u32 {
        self.bank.resource(port)
    }

    fn resources(&self, port: PortId) -> Range<u32> {
        self.bank.resources(port)
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

impl DeviceBank for Directory {
    fn resolve(&mut self, name: &PortName<'_>) -> Result<PortId, ResolveError> {
        let entry = self.entries.iter().find(|e| e.is(name));
        entry.map_or(Err(ResolveError::NoPort), |e| e.found)
    }

    fn resource(&self, port: PortId) -> u32 {
        Directory::resources(self, port).start
    }

    fn resources(&self, port: PortId) -> Range<u32> {
        Directory::resources(self, port)
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
