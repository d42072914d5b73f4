//! All devices of a simulated cell, as the core sees them.

use crate::arm::Arm;
use crate::base::Base;
use crate::cell::{Cell, DeviceSpec, Kind};
use crate::code::Code;
use crate::device::{Device, Report, Slot};
use crate::fault::Fault;
use crate::force::ForceSensor;
use crate::gripper::Gripper;
use crate::io::Io;
use core::ops::Range;
use rpi_device::{DeviceBank, PortId, PortName, Refusal, ResolveError};

/// The simulated devices of a cell, and the cell's time.
///
/// One [`step`](Self::step) for each tick; between two of them the core reads, checks and writes. Apart from
/// [`inject`](Self::inject) nothing allocates.
pub struct SimBank {
    devices: Vec<Named>,
    tick: f64,
    ticks: u64,
}

struct Named {
    name: String,
    /// The first number of its actuators.
    resources: u32,
    device: Box<dyn Device>,
}

/// A resolved port.
#[derive(Clone, Copy, PartialEq, Eq)]
struct Port {
    device: usize,
    slot: Slot,
}

/// Bits of a port's number for its index and for its line in the device's table; the rest is the device, from 1. So numbers
/// follow from the cell alone, and two banks of one cell give the same.
const INDEX_BITS: u32 = 12;
const LINE_BITS: u32 = 8;

impl Port {
    fn number(self) -> Result<PortId, ResolveError> {
        let (line, index) = (u32::from(self.slot.line), u32::from(self.slot.index));
        let device = u32::try_from(self.device + 1).map_err(|_| ResolveError::NoIndex)?;
        let fits = index >> INDEX_BITS == 0
            && line >> LINE_BITS == 0
            && device.leading_zeros() >= INDEX_BITS + LINE_BITS;
        let number = (device << LINE_BITS | line) << INDEX_BITS | index;
        fits.then_some(PortId(number)).ok_or(ResolveError::NoIndex)
    }

    fn of(number: PortId) -> Port {
        let (index, rest) = (number.0 & ((1 << INDEX_BITS) - 1), number.0 >> INDEX_BITS);
        let line = rest & ((1 << LINE_BITS) - 1);
        // Both are masked to less than 16 bits.
        let slot = Slot {
            line: line as u16,
            index: index as u16,
        };
        Port {
            device: ((rest >> LINE_BITS) as usize).wrapping_sub(1),
            slot,
        }
    }
}

/// How a device does.
#[derive(Clone, Debug, PartialEq)]
pub struct DeviceStatus<'a> {
    /// Its name.
    pub name: &'a str,
    /// What is wrong with it.
    pub code: Code,
    /// Whether it moves.
    pub moving: bool,
}

impl SimBank {
    /// The devices of `cell`, all at rest. `tick` is the length of a tick in s.
    #[must_use]
    pub fn new(cell: &Cell, tick: f64) -> Self {
        let mut devices = Vec::with_capacity(cell.devices.len());
        let mut resources = 0;
        for (number, spec) in cell.devices.iter().enumerate() {
            let device = build(spec, tick, cell.seed, number);
            let first = resources;
            resources += device.resources();
            devices.push(Named {
                name: spec.name.clone(),
                resources: first,
                device,
            });
        }
        Self {
            devices,
            tick,
            ticks: 0,
        }
    }

    /// Lets one tick pass: devices take what was handed over since the last, move, and have new samples.
    pub fn step(&mut self) {
        self.ticks += 1;
        let time = self.time();
        self.devices
            .iter_mut()
            .for_each(|named| named.device.step(time));
    }

    /// The cell's time, in s.
    #[must_use]
    pub fn time(&self) -> f64 {
        self.ticks as f64 * self.tick
    }

    /// Adds a fault to those that are planned for a device; false if there is no such device or it knows no such
    /// trouble. Not for the cycle: it may allocate.
    pub fn inject(&mut self, device: &str, fault: Fault) -> bool {
        let named = self.devices.iter_mut().find(|named| named.name == device);
        named.is_some_and(|named| named.device.inject(fault))
    }

    /// How the devices do, in the order of the cell.
    pub fn status(&self) -> impl Iterator<Item = DeviceStatus<'_>> {
        self.devices.iter().map(|named| DeviceStatus {
            name: &named.name,
            code: named.device.code(),
            moving: named.device.moving(0),
        })
    }

    /// Gives what the devices had against their commands since the last call, with the device's name; the result is how
    /// many more there were than could be kept. Allocates nothing itself.
    pub fn reports(&mut self, mut each: impl FnMut(&str, Report)) -> u64 {
        let mut lost = 0;
        for Named { name, device, .. } in &mut self.devices {
            lost += device.reports(&mut |report| each(name, report));
        }
        lost
    }

    /// The device and its port behind a number that `resolve` gave.
    fn at(&self, port: PortId) -> Option<(&Named, Slot)> {
        let port = Port::of(port);
        Some((self.devices.get(port.device)?, port.slot))
    }

    fn at_mut(&mut self, port: PortId) -> Option<(&mut Named, Slot)> {
        let port = Port::of(port);
        Some((self.devices.get_mut(port.device)?, port.slot))
    }

    /// The device that an actuator belongs to, and the actuator's number within it.
    fn owner(&self, resource: u32) -> Option<(usize, u32)> {
        let device = self
            .devices
            .iter()
            .rposition(|named| named.resources <= resource)?;
        Some((device, resource - self.devices[device].resources))
    }
}

fn build(spec: &DeviceSpec, tick: f64, seed: u64, number: usize) -> Box<dyn Device> {
    match &spec.kind {
        Kind::Arm(arm) => Box::new(Arm::new(arm, tick, seed, number)),
        Kind::Io(io) => Box::new(Io::new(io)),
        Kind::Base(base) => Box::new(Base::new(base, tick)),
        Kind::Gripper(gripper) => Box::new(Gripper::new(gripper, tick)),
        Kind::Force(force) => Box::new(ForceSensor::new(force, seed, number)),
    }
}

impl DeviceBank for SimBank {
    fn resolve(&mut self, name: &PortName<'_>) -> Result<PortId, ResolveError> {
        let device = self
            .devices
            .iter()
            .position(|named| named.name == name.device);
        let device = device.ok_or(ResolveError::NoDevice)?;
        let port = Port {
            device,
            slot: self.devices[device].device.resolve(name)?,
        };
        port.number()
    }

    fn resource(&self, port: PortId) -> u32 {
        self.resources(port).start
    }

    fn resources(&self, port: PortId) -> Range<u32> {
        self.at(port).map_or(0..0, |(named, slot)| {
            let own = named.device.resources_of(slot);
            named.resources + own.start..named.resources + own.end
        })
    }

    fn pace(&mut self, resource: u32, ticks: u32) {
        if let Some((device, own)) = self.owner(resource) {
            self.devices[device].device.pace(own, ticks);
        }
    }

    fn read(&mut self, port: PortId, value: &mut [u64]) -> bool {
        self.at(port)
            .is_some_and(|(named, slot)| named.device.read(slot, value))
    }

    fn check(&mut self, port: PortId, value: &[u64]) -> Refusal {
        self.at_mut(port)
            .map_or(Refusal::DEVICE_FAILED, |(named, slot)| {
                named.device.check(slot, value)
            })
    }

    fn error(&self, port: PortId) -> i64 {
        self.at(port)
            .map_or(0, |(named, slot)| named.device.error(slot))
    }

    fn write(&mut self, port: PortId, value: &[u64]) {
        if let Some((named, slot)) = self.at_mut(port) {
            named.device.write(slot, value);
        }
    }

    fn call(&mut self, port: PortId, arguments: &[u64], result: &mut [u64]) -> bool {
        self.at(port)
            .is_some_and(|(named, slot)| named.device.call(slot, arguments, result))
    }

    fn moving(&self, resource: u32) -> bool {
        self.owner(resource)
            .is_some_and(|(device, own)| self.devices[device].device.moving(own))
    }

    fn stop(&mut self, resource: u32) {
        if let Some((device, own)) = self.owner(resource) {
            self.devices[device].device.stop(own);
        }
    }
}
