//! Devices whose answers are logged on a tick log.

use std::cell::RefCell;
use std::ops::Range;

use rpi_core::AbortReason;
use rpi_device::{DeviceBank, Discontinuity, PortId, PortQuery, Rejection, ResolveError};

use super::entry::EntryKind;
use super::entry_buffer::EntryBuffer;
use super::reason::reason_number;
use crate::control::{AttributedOverrun, Plant};

/// Device bank that can log the exchange between its devices and the core in the current tick.
pub struct LoggingBank<P> {
    plant: P,
    /// Log of the current tick; `None` without logging. Queries take `&self` but are logged as well. A single thread
    /// owns the devices, so the cell is never borrowed twice.
    stage: Option<RefCell<EntryBuffer>>,
}

/// Capacity in 64-bit words of the log of the exchange with the devices in one tick.
const CAPACITY: usize = 1 << 16;

impl<P> LoggingBank<P> {
    /// Wraps a device bank without logging.
    #[must_use]
    pub fn new(plant: P) -> LoggingBank<P> {
        LoggingBank { plant, stage: None }
    }

    /// Begins to log the exchange between the core and the devices. Nothing is logged before.
    pub fn start_logging(&mut self) {
        self.stage = Some(RefCell::new(EntryBuffer::with_capacity(CAPACITY)));
    }

    /// Returns the wrapped devices. Direct accesses to them are not logged.
    pub fn plant(&mut self) -> &mut P {
        &mut self.plant
    }

    /// Returns the log of the exchange in the current tick; `None` without logging.
    pub fn buffer(&mut self) -> Option<&mut EntryBuffer> {
        self.stage.as_mut().map(RefCell::get_mut)
    }

    /// Logs that all commands are aborted for the reason `why`.
    pub fn log_halt(&mut self, why: AbortReason) {
        self.log(EntryKind::Halt, reason_number(why), false, &[]);
    }

    fn log(&self, kind: EntryKind, key: u32, flag: bool, words: &[u64]) {
        if let Some(mut stage) = self.stage.as_ref().and_then(|s| s.try_borrow_mut().ok()) {
            stage.push(kind, key, flag, &[words]);
        }
    }
}

/// Encodes a discontinuity of set-points as words of a tick log entry: actuator, quantity, value, limit.
fn encode_discontinuity(jump: &Discontinuity) -> [u64; 4] {
    let (value, limit) = (jump.value.to_bits(), jump.limit.to_bits());
    [u64::from(jump.resource), jump.quantity as u64, value, limit]
}

impl<P: Plant> DeviceBank for LoggingBank<P> {
    fn resolve(&mut self, name: &PortQuery<'_>) -> Result<PortId, ResolveError> {
        self.plant.resolve(name)
    }

    fn resource(&self, port: PortId) -> u32 {
        self.plant.resource(port)
    }

    fn resources(&self, port: PortId) -> Range<u32> {
        self.plant.resources(port)
    }

    fn begin_command(&mut self, resource: u32, ticks: u32) {
        self.plant.begin_command(resource, ticks);
        self.log(EntryKind::Period, resource, false, &[u64::from(ticks)]);
    }

    fn read(&mut self, port: PortId, value: &mut [u64]) -> bool {
        let there = self.plant.read(port, value);
        self.log(EntryKind::Read, port.0, there, value);
        there
    }

    fn check_set_point(&mut self, port: PortId, value: &[u64]) -> Rejection {
        let refusal = self.plant.check_set_point(port, value);
        self.log(EntryKind::Check, port.0, false, &[u64::from(refusal.0)]);
        refusal
    }

    fn discontinuity(&self, port: PortId, value: &[u64]) -> Option<Discontinuity> {
        let jump = self.plant.discontinuity(port, value);
        let words = jump.as_ref().map_or([0; 4], encode_discontinuity);
        self.log(EntryKind::Discontinuity, port.0, jump.is_some(), &words);
        jump
    }

    fn error_code(&self, port: PortId) -> i64 {
        let error = self.plant.error_code(port);
        self.log(EntryKind::Error, port.0, false, &[error.cast_unsigned()]);
        error
    }

    fn write(&mut self, port: PortId, value: &[u64]) {
        self.plant.write(port, value);
        self.log(EntryKind::Write, port.0, false, value);
    }

    fn call(&mut self, port: PortId, arguments: &[u64], result: &mut [u64]) -> bool {
        let found = self.plant.call(port, arguments, result);
        self.log(EntryKind::Call, port.0, found, result);
        found
    }

    fn is_moving(&self, resource: u32) -> bool {
        let moving = self.plant.is_moving(resource);
        self.log(EntryKind::Moving, resource, moving, &[]);
        moving
    }

    fn stop(&mut self, resource: u32) {
        self.plant.stop(resource);
        self.log(EntryKind::Stop, resource, false, &[]);
    }

    // No entry of the log: the end of the command, which a replay repeats, is the only cause.
    fn make_safe(&mut self, resource: u32) {
        self.plant.make_safe(resource);
    }

    fn make_all_safe(&mut self) -> bool {
        self.plant.make_all_safe()
    }
}

impl<P: Plant> Plant for LoggingBank<P> {
    type Device = P::Device;

    fn swap(&mut self, place: usize, part: Option<P::Device>) -> Option<P::Device> {
        self.plant.swap(place, part)
    }

    fn on_overrun(&mut self, late: &AttributedOverrun) {
        let words = [late.command.to_number(), late.took_ns, late.late_ns];
        self.log(EntryKind::OverrunCause, late.fragment, false, &words);
    }

    fn step(&mut self) {
        self.plant.step();
    }

    fn device_states(&self, each: &mut dyn FnMut(usize, i64, bool)) {
        self.plant.device_states(&mut |device, code, moving| {
            // There are fewer than 2^32 devices.
            self.log(
                EntryKind::DeviceState,
                device as u32,
                moving,
                &[code.cast_unsigned()],
            );
            each(device, code, moving);
        });
    }
}
