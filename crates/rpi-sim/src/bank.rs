//! The device bank of a simulated cell.

use crate::arm::Arm;
use crate::arm::driven::DrivenArm;
use crate::arm::limit_usage::AxisUsage;
use crate::base::Base;
use crate::cell::{ArmDriver, ArmSpec, Cell, DeviceKind, DeviceSpec};
use crate::device::{Device, PortIndex, Report};
use crate::error_code::ErrorCode;
use crate::fault::ScheduledFault;
use crate::io::IoDevice;
use crate::kinds::BuildContext;
#[cfg(feature = "rtde")]
use crate::rtde::UrController;
use crate::udp::UdpController;
use core::ops::Range;
use rpi_device::{
    DeviceBank, DeviceState, Discontinuity, PortId, PortQuery, Rejection, ResolveError,
};
use std::io;

/// The simulated devices of a cell, with the time of the cell.
///
/// [`step`](Self::step) is called once per tick. Between two steps, the control core reads, checks and writes. Only
/// [`inject`](Self::inject) allocates.
///
/// Port and resource numbers depend only on the index of a device and its type. Two banks with the same devices at the
/// same indices therefore agree on all numbers, so that one bank can resolve names outside the cycle for the bank in
/// the cycle.
pub struct SimBank {
    /// Devices by index; `None` for an index without a device.
    devices: Vec<Option<NamedDevice>>,
    tick: f64,
    ticks: u64,
}

/// Device of a bank: the interface of the control cycle, and operations outside of the cycle.
pub(crate) trait CellDevice: Device {
    /// Schedules a simulated fault. Returns false if the device does not support it. Allocates.
    fn inject(&mut self, fault: ScheduledFault) -> bool {
        let _ = fault;
        false
    }

    /// Calls `each` with the use of the limits of every axis; a device without axes calls it never.
    fn limit_usage(&self, each: &mut dyn FnMut(AxisUsage<'_>)) {
        let _ = each;
    }

    /// Ends the work of the device at the end of a run: it reports the events that a program still waits for.
    fn finish(&mut self) {}

    /// Sets all outputs that have a safe value to it, at the end of a run. Returns true if an output has changed to its safe
    /// value since the last step.
    fn make_all_safe(&mut self) -> bool {
        false
    }

    /// True for a real device, which needs real time and must be opened before use.
    fn has_driver(&self) -> bool {
        false
    }

    /// Connects a real device to its controller and waits for it.
    ///
    /// # Errors
    /// Returns the error of the connection.
    fn open(&mut self) -> io::Result<()> {
        Ok(())
    }
}

/// Error when connecting a real device to its controller.
#[derive(Debug)]
pub struct OpenError {
    /// Name of the device in the cell.
    pub device: String,
    /// Error of the connection; `None` if the cell runs on simulated time, which a real device does not allow.
    pub cause: Option<io::Error>,
}

impl core::fmt::Display for OpenError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        let device = &self.device;
        match &self.cause {
            Some(cause) => write!(f, "device `{device}`: {cause}"),
            None => write!(
                f,
                "device `{device}` is real and cannot run on simulated time; run it with `--real-time`"
            ),
        }
    }
}

impl std::error::Error for OpenError {}

/// Device with its name, which is built outside the cycle and put into a bank between two ticks.
pub struct NamedDevice {
    name: String,
    device: Box<dyn CellDevice>,
}

impl NamedDevice {
    /// Builds the device that `spec` describes, at rest. `tick` is the duration of a tick in s. `seed` and `place`, the
    /// index in the bank, determine its noise.
    #[must_use]
    pub fn new(spec: &DeviceSpec, tick: f64, seed: u64, place: usize) -> NamedDevice {
        NamedDevice {
            name: spec.name.clone(),
            device: build_device(spec, tick, seed, place),
        }
    }

    /// Returns the name of the device in the cell.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }
}

/// Maximum number of devices in a bank: a port number has 8 bits for the device.
pub const MAX_DEVICES: usize = 256;

/// Encodes a port number: 8 bits for the index of the device, 8 for the row of its port table, 16 for the index in the
/// row. `None` if a number is too large.
fn encode_port(place: usize, slot: PortIndex) -> Option<PortId> {
    let (place, line) = (u8::try_from(place).ok()?, u8::try_from(slot.row).ok()?);
    let number = u32::from(place) << 24 | u32::from(line) << 16 | u32::from(slot.index);
    Some(PortId(number))
}

/// Decodes a port number into the index of the device and the port of the device.
fn decode_port(number: PortId) -> (usize, PortIndex) {
    let slot = PortIndex {
        row: (number.0 >> 16) as u16 & 0xff,
        index: number.0 as u16,
    };
    ((number.0 >> 24) as usize, slot)
}

/// Returns the number of the first resource of the device with index `place`. Each device has 2^16 resource numbers.
fn first_resource(place: usize) -> u32 {
    (place as u32) << 16
}

/// Decodes a resource number of a bank into the index of the device and the number of the resource within the device.
pub(crate) fn split_resource(resource: u32) -> (usize, u32) {
    ((resource >> 16) as usize, resource & 0xffff)
}

/// Status of one device of a bank.
#[derive(Clone, Debug, PartialEq)]
pub struct DeviceStatus<'a> {
    /// Index of the device in the bank.
    pub index: usize,
    /// Name of the device.
    pub name: &'a str,
    /// Present error code of the device; 0 for none.
    pub code: ErrorCode,
    /// Ability of the device to follow set-points.
    pub state: DeviceState,
    /// True while the device moves.
    pub moving: bool,
    /// Time of the device's own clock at its present samples, in s; `None` if it uses the clock of the cell.
    pub clock: Option<f64>,
}

impl SimBank {
    /// Creates a bank with the devices of `cell`, all at rest. `tick` is the duration of a tick in s.
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

    /// Creates a bank with `places` indices without a device, at most [`MAX_DEVICES`]. `tick` is the duration of a tick
    /// in s.
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

    /// Connects all real devices to their controllers and waits for them. `is_real_time` is true if the cell runs on
    /// real time. Banks that only resolve names are not opened.
    ///
    /// # Errors
    /// Returns the first device that cannot be connected, or the first real device if the cell runs on simulated time.
    pub fn open(&mut self, is_real_time: bool) -> Result<(), OpenError> {
        let parts = self.devices.iter_mut().flatten();
        for NamedDevice { name, device } in parts.filter(|part| part.device.has_driver()) {
            let opened = is_real_time.then(|| device.open());
            if !matches!(opened, Some(Ok(()))) {
                return Err(OpenError {
                    device: name.clone(),
                    cause: opened.and_then(Result::err),
                });
            }
        }
        Ok(())
    }

    /// Replaces the device with index `place` by `part` (`None` removes it) and returns the previous one. If the index
    /// is out of range, returns `part`.
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

    /// Returns the simulated time since the start of the cell, in s.
    #[must_use]
    pub fn time(&self) -> f64 {
        self.ticks as f64 * self.tick
    }

    /// Schedules a simulated fault of the device with this name. Returns false if the device does not exist or does not
    /// support the fault. Allocates, so not for the cycle.
    pub fn inject(&mut self, device: &str, fault: ScheduledFault) -> bool {
        let mut parts = self.devices.iter_mut().flatten();
        let part = parts.find(|part| part.name == device);
        part.is_some_and(|part| part.device.inject(fault))
    }

    /// Returns the status of all devices, in the order of the cell.
    pub fn status(&self) -> impl Iterator<Item = DeviceStatus<'_>> {
        let places = self.devices.iter().enumerate();
        let there = places.filter_map(|(place, part)| Some((place, part.as_ref()?)));
        there.map(|(place, part)| DeviceStatus {
            index: place,
            name: &part.name,
            code: part.device.code(),
            state: part.device.state(),
            moving: part.device.is_moving(0),
            clock: part.device.clock(),
        })
    }

    /// Passes the use of the limits of all axes to `each`, with the name of the device, in the order of the cell.
    pub fn limit_usage(&self, mut each: impl FnMut(&str, AxisUsage<'_>)) {
        for NamedDevice { name, device } in self.devices.iter().flatten() {
            device.limit_usage(&mut |axis| each(name, axis));
        }
    }

    /// Ends the work of all devices at the end of a run, before their last [`reports`](Self::reports).
    pub fn finish(&mut self) {
        let parts = self.devices.iter_mut().flatten();
        parts.for_each(|part| part.device.finish());
    }

    /// Passes all reports since the last call to `each`, with the name of the device. Returns the number of reports
    /// lost for lack of space. Does not allocate.
    pub fn reports(&mut self, mut each: impl FnMut(&str, Report)) -> u64 {
        let mut lost = 0;
        for NamedDevice { name, device } in self.devices.iter_mut().flatten() {
            lost += device.reports(&mut |report| each(name, report));
        }
        lost
    }

    /// Returns the device of a port number and the port of the device; `None` if there is no such port.
    fn at(&self, number: PortId) -> Option<(&dyn CellDevice, PortIndex)> {
        let (place, slot) = decode_port(number);
        let part = self.devices.get(place)?.as_ref()?;
        part.device.has_port(slot).then_some((&*part.device, slot))
    }

    fn at_mut(&mut self, number: PortId) -> Option<(&mut dyn CellDevice, PortIndex)> {
        let (place, slot) = decode_port(number);
        let part = self.devices.get_mut(place)?.as_mut()?;
        part.device
            .has_port(slot)
            .then_some((&mut *part.device, slot))
    }

    /// Returns the device that owns a resource of the bank, and the number of the resource within the device; `None` if
    /// there is no such device.
    fn owner(&self, resource: u32) -> Option<(&dyn CellDevice, u32)> {
        let (place, own) = split_resource(resource);
        let part = self.devices.get(place)?.as_ref()?;
        Some((&*part.device, own))
    }

    fn owner_mut(&mut self, resource: u32) -> Option<(&mut dyn CellDevice, u32)> {
        let (place, own) = split_resource(resource);
        let part = self.devices.get_mut(place)?.as_mut()?;
        Some((&mut *part.device, own))
    }
}

fn build_device(spec: &DeviceSpec, tick: f64, seed: u64, number: usize) -> Box<dyn CellDevice> {
    match &spec.kind {
        DeviceKind::Arm(arm) => build_arm(arm, tick, Arm::new(arm, tick, seed, number)),
        DeviceKind::Io(io) => Box::new(IoDevice::new(io)),
        DeviceKind::Base(base) => Box::new(Base::new(base, tick)),
        DeviceKind::Small(small) => small.build(&BuildContext {
            tick,
            seed,
            place: number,
        }),
    }
}

fn build_arm(spec: &ArmSpec, tick: f64, arm: Arm) -> Box<dyn CellDevice> {
    match &spec.driver {
        None => Box::new(arm),
        Some(ArmDriver::Udp(udp)) => Box::new(DrivenArm::new(arm, UdpController::new(*udp, tick))),
        #[cfg(feature = "rtde")]
        Some(ArmDriver::Ur(ur)) => {
            let controller = UrController::new(ur, &spec.limits, tick);
            Box::new(DrivenArm::new(arm, controller))
        }
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
            let own = device.resources(slot);
            first + own.start..first + own.end
        })
    }

    fn begin_command(&mut self, resource: u32, ticks: u32) {
        if let Some((device, own)) = self.owner_mut(resource) {
            device.begin_command(own, ticks);
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
        let jump = device.discontinuity(slot, value)?;
        let resource = first_resource(decode_port(number).0) + jump.resource;
        Some(Discontinuity { resource, ..jump })
    }

    fn error_code(&self, port: PortId) -> i64 {
        self.at(port)
            .map_or(0, |(device, slot)| device.port_code(slot).0)
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
            .is_some_and(|(device, own)| device.is_moving(own))
    }

    fn stop(&mut self, resource: u32) {
        if let Some((device, own)) = self.owner_mut(resource) {
            device.stop(own);
        }
    }

    fn make_safe(&mut self, resource: u32) {
        if let Some((device, own)) = self.owner_mut(resource) {
            device.make_safe(own);
        }
    }

    fn make_all_safe(&mut self) -> bool {
        let parts = self.devices.iter_mut().flatten();
        parts.fold(false, |changed, part| part.device.make_all_safe() | changed)
    }
}
