//! The device bank of a simulated cell.

use crate::arm::Arm;
use crate::base::Base;
use crate::cell::{Cell, DeviceKind, DeviceSpec};
use crate::device::{Device, PortIndex, Report};
use crate::error_code::ErrorCode;
use crate::fault::ScheduledFault;
use crate::force::ForceSensor;
use crate::gripper::Gripper;
use crate::io::IoDevice;
use core::ops::Range;
use rpi_device::{DeviceBank, Discontinuity, PortId, PortQuery, Rejection, ResolveError};

/// The simulated devices of a cell, with the time of the cell.
///
/// [`step`](Self::step) is called once per tick. Between two steps the core reads, checks and writes. Only
/// [`inject`](Self::inject) allocates.
///
/// Port and resource numbers depend only on the index of a device and its type. Two banks with the same devices at the
/// same indices therefore agree on all numbers, so that one can resolve names outside the cycle that owns the other.
pub struct SimBank {
    /// Devices by index; an entry may be empty.
    devices: Vec<Option<NamedDevice>>,
    tick: f64,
    ticks: u64,
}

/// A device with its name, built outside the cycle and put into a bank between two ticks.
pub struct NamedDevice {
    name: String,
    device: Box<dyn Device>,
}

impl NamedDevice {
    /// Builds the device that `spec` describes, at rest. `tick` is the tick in s; `seed` and `place`, the index in the
    /// bank, seed its noise.
    #[must_use]
    pub fn new(spec: &DeviceSpec, tick: f64, seed: u64, place: usize) -> NamedDevice {
        NamedDevice {
            name: spec.name.clone(),
            device: build_device(spec, tick, seed, place),
        }
    }

    /// Name of the device.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }
}

/// Maximum number of devices in a bank: a port number has 8 bits for the device.
pub const MAX_DEVICES: usize = 256;

/// Encodes a port number: 8 bits for the device, 8 for the row of its port table, 16 for the index.
fn encode_port(place: usize, slot: PortIndex) -> Option<PortId> {
    let (place, line) = (u8::try_from(place).ok()?, u8::try_from(slot.row).ok()?);
    let number = u32::from(place) << 24 | u32::from(line) << 16 | u32::from(slot.index);
    Some(PortId(number))
}

/// Decodes a port number into the device index and the port of the device.
fn decode_port(number: PortId) -> (usize, PortIndex) {
    let slot = PortIndex {
        row: (number.0 >> 16) as u16 & 0xff,
        index: number.0 as u16,
    };
    ((number.0 >> 24) as usize, slot)
}

/// First resource number of a device. Each device has 2^16 numbers.
fn first_resource(place: usize) -> u32 {
    (place as u32) << 16
}

/// Decodes a resource number into the device index and the resource within the device.
pub(crate) fn split_resource(resource: u32) -> (usize, u32) {
    ((resource >> 16) as usize, resource & 0xffff)
}

/// What a report of a cell says about one device.
#[derive(Clone, Debug, PartialEq)]
pub struct DeviceStatus<'a> {
    /// Index of the device in the bank.
    pub index: usize,
    /// Name of the device.
    pub name: &'a str,
    /// Present error code of the device.
    pub code: ErrorCode,
    /// True while the device moves.
    pub moving: bool,
}

impl SimBank {
    /// A bank with the devices of `cell`, all at rest. `tick` is the tick in s.
    #[must_use]
    pub fn new(cell: &Cell, tick: f64) -> Self {
        let parts = cell.devices.iter().enumerate();
        let parts = parts.map(|(place, spec)| Some(NamedDevice::new(spec, tick, cell.seed, place)));
        Self {
            devices: parts.take(MAX_DEVICES).collect(),
            tick,
            ticks: 0,
        }
    }

    /// A bank with `places` empty entries, at most [`MAX_DEVICES`]. `tick` is the tick in s.
    #[must_use]
    pub fn empty(places: usize, tick: f64) -> Self {
        let mut devices = Vec::new();
        devices.resize_with(places.min(MAX_DEVICES), || None);
        Self {
            devices,
            tick,
            ticks: 0,
        }
    }

    /// Replaces the device at an index (`None` for an empty entry) and returns the previous one. If the index is out of
    /// range, returns `part`.
    pub fn swap(&mut self, place: usize, part: Option<NamedDevice>) -> Option<NamedDevice> {
        match self.devices.get_mut(place) {
            Some(there) => core::mem::replace(there, part),
            None => part,
        }
    }

    /// Simulates one tick: the devices apply the latest set-points, move, and take new samples.
    pub fn step(&mut self) {
        self.ticks += 1;
        let time = self.time();
        let parts = self.devices.iter_mut().flatten();
        parts.for_each(|part| part.device.step(time));
    }

    /// Simulated time of the cell, in s.
    #[must_use]
    pub fn time(&self) -> f64 {
        self.ticks as f64 * self.tick
    }

    /// Schedules a fault of a device. Returns false if the device does not exist or does not support the fault.
    /// Allocates, so not for the cycle.
    pub fn inject(&mut self, device: &str, fault: ScheduledFault) -> bool {
        let mut parts = self.devices.iter_mut().flatten();
        let part = parts.find(|part| part.name == device);
        part.is_some_and(|part| part.device.inject(fault))
    }

    /// Status of all devices, in the order of the cell.
    pub fn status(&self) -> impl Iterator<Item = DeviceStatus<'_>> {
        let places = self.devices.iter().enumerate();
        let there = places.filter_map(|(place, part)| Some((place, part.as_ref()?)));
        there.map(|(place, part)| DeviceStatus {
            index: place,
            name: &part.name,
            code: part.device.code(),
            moving: part.device.moving(0),
        })
    }

    /// Passes all new reports of all devices to `each`, with the name of the device. Returns the number of reports lost
    /// for lack of space. Does not allocate.
    pub fn reports(&mut self, mut each: impl FnMut(&str, Report)) -> u64 {
        let mut lost = 0;
        for NamedDevice { name, device } in self.devices.iter_mut().flatten() {
            lost += device.reports(&mut |report| each(name, report));
        }
        lost
    }

    /// Splits the number of a port in the bank into the device and the index of the port in it; `None` if it is out of
    /// range.
    fn at(&self, number: PortId) -> Option<(&dyn Device, PortIndex)> {
        let (place, slot) = decode_port(number);
        let part = self.devices.get(place)?.as_ref()?;
        part.device.has_port(slot).then_some((&*part.device, slot))
    }

    fn at_mut(&mut self, number: PortId) -> Option<(&mut dyn Device, PortIndex)> {
        let (place, slot) = decode_port(number);
        let part = self.devices.get_mut(place)?.as_mut()?;
        part.device
            .has_port(slot)
            .then_some((&mut *part.device, slot))
    }

    /// The device that owns a resource, and the resource within the device.
    fn owner(&self, resource: u32) -> Option<(&dyn Device, u32)> {
        let (place, own) = split_resource(resource);
        let part = self.devices.get(place)?.as_ref()?;
        Some((&*part.device, own))
    }

    fn owner_mut(&mut self, resource: u32) -> Option<(&mut dyn Device, u32)> {
        let (place, own) = split_resource(resource);
        let part = self.devices.get_mut(place)?.as_mut()?;
        Some((&mut *part.device, own))
    }
}

fn build_device(spec: &DeviceSpec, tick: f64, seed: u64, number: usize) -> Box<dyn Device> {
    match &spec.kind {
        DeviceKind::Arm(arm) => Box::new(Arm::new(arm, tick, seed, number)),
        DeviceKind::Io(io) => Box::new(IoDevice::new(io)),
        DeviceKind::Base(base) => Box::new(Base::new(base, tick)),
        DeviceKind::Gripper(gripper) => Box::new(Gripper::new(gripper, tick)),
        DeviceKind::Force(force) => Box::new(ForceSensor::new(force, seed, number)),
    }
}

impl DeviceBank for SimBank {
    fn resolve(&mut self, name: &PortQuery<'_>) -> Result<PortId, ResolveError> {
        let parts = self.devices.iter().enumerate();
        let mut parts = parts.filter_map(|(place, part)| Some((place, part.as_ref()?)));
        let part = parts.find(|(_, part)| part.name == name.device);
        let (place, part) = part.ok_or(ResolveError::UnknownDevice)?;
        let slot = part.device.resolve(name)?;
        encode_port(place, slot).ok_or(ResolveError::IndexOutOfRange)
    }

    fn resource(&self, port: PortId) -> u32 {
        self.resources(port).start
    }

    fn resources(&self, number: PortId) -> Range<u32> {
        let first = first_resource(decode_port(number).0);
        self.at(number).map_or(0..0, |(device, slot)| {
            let own = device.resources_of(slot);
            first + own.start..first + own.end
        })
    }

    fn begin_command(&mut self, resource: u32, ticks: u32) {
        if let Some((device, own)) = self.owner_mut(resource) {
            device.begin(own, ticks);
        }
    }

    fn read(&mut self, port: PortId, value: &mut [u64]) -> bool {
        self.at(port)
            .is_some_and(|(device, slot)| device.read(slot, value))
    }

    fn check_set_point(&mut self, port: PortId, value: &[u64]) -> Rejection {
        self.at_mut(port)
            .map_or(Rejection::DEVICE_FAILED, |(device, slot)| {
                device.check(slot, value)
            })
    }

    fn discontinuity(&self, number: PortId, value: &[u64]) -> Option<Discontinuity> {
        let (device, slot) = self.at(number)?;
        let jump = device.jump(slot, value)?;
        let resource = first_resource(decode_port(number).0) + jump.resource;
        Some(Discontinuity { resource, ..jump })
    }

    fn error_code(&self, port: PortId) -> i64 {
        self.at(port).map_or(0, |(device, slot)| device.error(slot))
    }

    fn write(&mut self, port: PortId, value: &[u64]) {
        if let Some((device, slot)) = self.at_mut(port) {
            device.write(slot, value);
        }
    }

    fn call(&mut self, port: PortId, arguments: &[u64], result: &mut [u64]) -> bool {
        self.at_mut(port)
            .is_some_and(|(device, slot)| device.call(slot, arguments, result))
    }

    fn is_moving(&self, resource: u32) -> bool {
        self.owner(resource)
            .is_some_and(|(device, own)| device.moving(own))
    }

    fn stop(&mut self, resource: u32) {
        if let Some((device, own)) = self.owner_mut(resource) {
            device.stop(own);
        }
    }
}
