//! Devices whose answers are logged on a tape.

use std::cell::RefCell;
use std::ops::Range;

use rpi_core::Why;
use rpi_device::{DeviceBank, Jump, PortId, PortName, Refusal, ResolveError};

use super::entry::Kind;
use super::reason::number_of;
use super::stage::Stage;
use crate::control::{Late, Plant};

/// Devices with an optional log of their exchange with the core in the current tick.
pub struct Taped<P> {
    plant: P,
    /// Queries take `&self` but are logged as well. A single thread owns the devices, so the cell is never borrowed
    /// twice.
    stage: Option<RefCell<Stage>>,
}

/// Capacity in words of the log of one tick.
const CAPACITY: usize = 1 << 16;

impl<P> Taped<P> {
    /// Wraps devices without logging.
    #[must_use]
    pub fn new(plant: P) -> Taped<P> {
        Taped { plant, stage: None }
    }

    /// Starts logging.
    pub fn begin(&mut self) {
        self.stage = Some(RefCell::new(Stage::with_capacity(CAPACITY)));
    }

    /// Returns the devices. Direct accesses to them are not logged.
    pub fn plant(&mut self) -> &mut P {
        &mut self.plant
    }

    /// Returns the log of the current tick; `None` without logging.
    pub fn stage(&mut self) -> Option<&mut Stage> {
        self.stage.as_mut().map(RefCell::get_mut)
    }

    /// Logs that all commands are ended.
    pub fn halt(&mut self, why: Why) {
        self.note(Kind::Halt, number_of(why), false, &[]);
    }

    fn note(&self, kind: Kind, key: u32, flag: bool, words: &[u64]) {
        if let Some(mut stage) = self.stage.as_ref().and_then(|s| s.try_borrow_mut().ok()) {
            stage.put(kind, key, flag, &[words]);
        }
    }
}

/// Encodes a discontinuity as words.
fn words_of(jump: &Jump) -> [u64; 4] {
    let (value, limit) = (jump.value.to_bits(), jump.limit.to_bits());
    [u64::from(jump.resource), jump.quantity as u64, value, limit]
}

impl<P: Plant> DeviceBank for Taped<P> {
    fn resolve(&mut self, name: &PortName<'_>) -> Result<PortId, ResolveError> {
        self.plant.resolve(name)
    }

    fn resource(&self, port: PortId) -> u32 {
        self.plant.resource(port)
    }

    fn resources(&self, port: PortId) -> Range<u32> {
        self.plant.resources(port)
    }

    fn begin(&mut self, resource: u32, ticks: u32) {
        self.plant.begin(resource, ticks);
        self.note(Kind::Pace, resource, false, &[u64::from(ticks)]);
    }

    fn read(&mut self, port: PortId, value: &mut [u64]) -> bool {
        let there = self.plant.read(port, value);
        self.note(Kind::Read, port.0, there, value);
        there
    }

    fn check(&mut self, port: PortId, value: &[u64]) -> Refusal {
        let refusal = self.plant.check(port, value);
        self.note(Kind::Check, port.0, false, &[u64::from(refusal.0)]);
        refusal
    }

    fn jump(&self, port: PortId, value: &[u64]) -> Option<Jump> {
        let jump = self.plant.jump(port, value);
        let words = jump.as_ref().map_or([0; 4], words_of);
        self.note(Kind::Jump, port.0, jump.is_some(), &words);
        jump
    }

    fn error(&self, port: PortId) -> i64 {
        let error = self.plant.error(port);
        self.note(Kind::Error, port.0, false, &[error.cast_unsigned()]);
        error
    }

    fn write(&mut self, port: PortId, value: &[u64]) {
        self.plant.write(port, value);
        self.note(Kind::Write, port.0, false, value);
    }

    fn call(&mut self, port: PortId, arguments: &[u64], result: &mut [u64]) -> bool {
        let found = self.plant.call(port, arguments, result);
        self.note(Kind::Call, port.0, found, result);
        found
    }

    fn moving(&self, resource: u32) -> bool {
        let moving = self.plant.moving(resource);
        self.note(Kind::Moving, resource, moving, &[]);
        moving
    }

    fn stop(&mut self, resource: u32) {
        self.plant.stop(resource);
        self.note(Kind::Stop, resource, false, &[]);
    }
}

impl<P: Plant> Plant for Taped<P> {
    type Part = P::Part;

    fn swap(&mut self, place: usize, part: Option<P::Part>) -> Option<P::Part> {
        self.plant.swap(place, part)
    }

    fn too_late(&mut self, late: &Late) {
        let words = [late.command.number(), late.took_ns, late.late_ns];
        self.note(Kind::Blamed, late.fragment, false, &words);
    }

    fn step(&mut self) {
        self.plant.step();
    }

    fn conditions(&self, each: &mut dyn FnMut(usize, i64, bool)) {
        self.plant.conditions(&mut |device, code, moving| {
            // There are fewer than 2^32 devices.
            self.note(
                Kind::Condition,
                device as u32,
                moving,
                &[code.cast_unsigned()],
            );
            each(device, code, moving);
        });
    }
}
