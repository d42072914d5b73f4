//! Device ports of a command: sensors, actuators with staged set-points, functions.

use crate::continuity::CHECKED_CYCLES;
use crate::load::{LoadError, resolve_port};
use rpi_device::{DeviceBank, Discontinuity, PortId, PortKind, Rejection};
use rpi_image::DeviceResponse;
use rpi_image::image::{ActuatorPort, Image, SlotRange, TRUE};
use rpi_prims::{Context, FaultCode};

use alloc::boxed::Box;
use alloc::vec;
use alloc::vec::Vec;
use core::ops::Range;

/// Device ports of a command, resolved in the cell, and the buffer in which set-points and arguments are assembled.
#[derive(Clone)]
pub(crate) struct Ports {
    sensors: Box<[PortId]>,
    functions: Box<[PortId]>,
    actuators: Box<[LoadedPort]>,
    resources: Box<[HeldResource]>,
    buffer: Box<[u64]>,
    /// True if the command has taken over from a predecessor, so that its first set-points are checked for continuity.
    pub(crate) checks_continuity: bool,
    /// The first discontinuous set-point of this cycle, after the index of its actuator port in the image; `None` if
    /// all are continuous.
    pub(crate) discontinuity: Option<(usize, Discontinuity)>,
    /// The first resource that was moving without a set-point at the end of this cycle, as an index into `resources`.
    /// The second number is the index of the actuator port whose set-point was rejected, if any.
    uncontrolled: Option<(usize, Option<usize>)>,
}

/// An actuator port of the image, resolved when the image was loaded.
#[derive(Clone)]
struct LoadedPort {
    port: PortId,
    /// Resources that the port moves, as a range of indices into `resources` of [`Ports`].
    moves: Range<usize>,
    /// Index of the first slot of the set-point in `buffer` of [`Ports`].
    offset: usize,
    len: usize,
}

/// A resource (actuator) of the command, with the set-points of the present and the previous cycle.
#[derive(Clone, Copy, Default)]
struct HeldResource {
    resource: u32,
    /// True if a set-point for this resource was computed in this cycle, accepted or not.
    claimed: bool,
    /// True if a set-point for this resource was accepted in this cycle.
    has_set_point: bool,
    /// Index of the actuator port whose set-point is sent at the end of this cycle. Stored only at the first resource
    /// of the port.
    staged: Option<usize>,
    /// Index of the actuator port whose set-point was sent at the end of the previous cycle; `None` if none was sent.
    last_sent: Option<usize>,
    /// Index of the actuator port whose set-point was rejected in this cycle; `None` if none was rejected.
    rejected: Option<usize>,
}

impl Ports {
    /// Resolves all ports of an image; appends an error for each port that the cell lacks.
    pub(crate) fn load(
        image: &Image,
        bank: &mut dyn DeviceBank,
        faults: &mut Vec<LoadError>,
    ) -> Self {
        let sensors = image.sensors.iter();
        let sensors = sensors
            .map(|s| resolve_port(bank, faults, &s.port, PortKind::Sensor))
            .collect();
        let functions = image.functions.iter();
        let functions = functions
            .map(|f| resolve_port(bank, faults, &f.port, PortKind::Function))
            .collect();
        let ports = image.actuators.iter();
        let ports: Vec<PortId> = ports
            .map(|a| resolve_port(bank, faults, &a.port, PortKind::Actuator))
            .collect();
        let mut loading = Ports {
            sensors,
            functions,
            actuators: Box::default(),
            resources: Box::default(),
            buffer: Box::default(),
            checks_continuity: false,
            discontinuity: None,
            uncontrolled: None,
        };
        if faults.is_empty() {
            loading.resolve_actuators(image, &ports, bank);
        }
        loading
    }

    fn resolve_actuators(&mut self, image: &Image, ports: &[PortId], bank: &dyn DeviceBank) {
        let mut resources: Vec<u32> = ports.iter().flat_map(|p| bank.resources(*p)).collect();
        resources.sort_unstable();
        resources.dedup();
        let mut end = 0;
        let set = |(actuator, &port): (&ActuatorPort, &PortId)| {
            let moved = bank.resources(port);
            let place = |resource: u32| resources.partition_point(|r| *r < resource);
            let (at, len) = (end, total_len(&actuator.inputs));
            end += len;
            LoadedPort {
                port,
                moves: place(moved.start)..place(moved.end),
                offset: at,
                len,
            }
        };
        self.actuators = image.actuators.iter().zip(ports).map(set).collect();
        let held = |&resource: &u32| HeldResource {
            resource,
            ..HeldResource::default()
        };
        self.resources = resources.iter().map(held).collect();
        let arguments = image
            .functions
            .iter()
            .map(|f| total_len(&f.arguments))
            .max();
        let results = image.functions.iter().map(|f| total_len(&f.results)).max();
        let scratch = arguments.unwrap_or(0) + results.unwrap_or(0);
        self.buffer = vec![0; end + scratch].into();
    }

    /// Returns the numbers of the resources (actuators) that the command needs, in ascending order.
    pub(crate) fn held_resources(&self) -> impl Iterator<Item = u32> + '_ {
        self.resources.iter().map(|h| h.resource)
    }

    /// Forgets the set-points of all resources, as after loading.
    pub(crate) fn reset(&mut self) {
        for held in &mut self.resources {
            *held = HeldResource {
                resource: held.resource,
                ..HeldResource::default()
            };
        }
    }

    /// Reads all sensors into the command's memory, including those in inactive fragments. A missing sample of a flow
    /// that is never absent is a fault.
    pub(crate) fn read_sensors(&self, image: &Image, cx: &mut Context<'_>) {
        for (sensor, &port) in image.sensors.iter().zip(&self.sensors) {
            let value = sensor.value;
            let sampled = cx.devices.read(port, &mut cx.slots[value.slots().range()]);
            match value.present {
                TRUE if !sampled => cx.fault(FaultCode::MissingSample, value.start),
                TRUE => {}
                present => cx.slots[present as usize] = u64::from(sampled),
            }
        }
    }

    /// Checks the set-point of the actuator port with index `index`, prepares a valid one for sending, and stores the
    /// responses of the device in the command's memory.
    pub(crate) fn actuate(&mut self, image: &Image, index: usize, cx: &mut Context<'_>) {
        let (actuator, set) = (&image.actuators[index], &self.actuators[index]);
        let value = &mut self.buffer[set.offset..set.offset + set.len];
        gather(cx.slots, &actuator.inputs, value);
        if self.checks_continuity
            && cx.time.cycle_index < CHECKED_CYCLES
            && self.discontinuity.is_none()
        {
            let jump = cx.devices.discontinuity(set.port, value);
            self.discontinuity = jump.map(|jump| (index, jump));
        }
        let held = &mut self.resources[set.moves.clone()];
        let mut refusal = cx.devices.check_set_point(set.port, value);
        // Claims count even if the first set-point was rejected: two writers in one cycle are always an error.
        if held.iter().any(|h| h.claimed) {
            refusal = refusal.union(Rejection::CONCURRENT_ACCESS);
            cx.fault(FaultCode::ConcurrentAccess, actuator.origin_slot());
        }
        if refusal.intersects(Rejection::KEEPS_VALUE) {
            cx.fault(FaultCode::DeviceFailed, actuator.origin_slot());
        }
        let accepted = refusal == Rejection::NONE;
        for h in held.iter_mut() {
            h.claimed = true;
            h.has_set_point |= accepted;
            if !accepted {
                h.rejected = Some(index);
            }
        }
        let completed = held.first().is_some_and(|h| h.last_sent == Some(index));
        if let Some(first) = held.first_mut().filter(|_| accepted) {
            first.staged = Some(index);
        }
        for &(answer, cell) in &actuator.responses {
            let error = cx.devices.error_code(set.port);
            cx.slots[cell as usize] = match answer {
                DeviceResponse::ConcurrentAccess => {
                    u64::from(refusal.intersects(Rejection::CONCURRENT_ACCESS))
                }
                DeviceResponse::DeviceFailed => {
                    u64::from(refusal.intersects(Rejection::DEVICE_FAILED))
                }
                DeviceResponse::IllegalValue => {
                    u64::from(refusal.intersects(Rejection::ILLEGAL_VALUE))
                }
                DeviceResponse::ErrorCode => error.cast_unsigned(),
                DeviceResponse::Completed => u64::from(completed && error == 0),
            };
        }
    }

    /// Calls the device function with index `index` of the image. Without a result the output is absent, or NaN if it
    /// cannot be absent.
    pub(crate) fn call(&mut self, image: &Image, index: usize, cx: &mut Context<'_>) {
        let function = &image.functions[index];
        let scratch = self.actuators.last().map_or(0, |a| a.offset + a.len);
        let (arguments, rest) = self.buffer[scratch..].split_at_mut(total_len(&function.arguments));
        gather(cx.slots, &function.arguments, arguments);
        let result = &mut rest[..total_len(&function.results)];
        let found = cx.devices.call(self.functions[index], arguments, result);
        if !found {
            result.fill(f64::NAN.to_bits());
        }
        scatter(cx.slots, &function.results, result);
        if function.present != TRUE {
            cx.slots[function.present as usize] = u64::from(found);
        }
    }

    /// Sends all set-points that were accepted in this cycle. Returns false if a moving actuator has no set-point; the
    /// device then stops that actuator.
    pub(crate) fn hand_over(&mut self, bank: &mut dyn DeviceBank) -> bool {
        self.uncontrolled = None;
        for (k, held) in self.resources.iter_mut().enumerate() {
            held.last_sent = held.staged.take();
            if let Some(set) = held.last_sent.map(|index| &self.actuators[index]) {
                bank.write(set.port, &self.buffer[set.offset..set.offset + set.len]);
            }
            held.claimed = false;
            let refused = held.rejected.take();
            if !core::mem::take(&mut held.has_set_point) && bank.is_moving(held.resource) {
                bank.stop(held.resource);
                self.uncontrolled.get_or_insert((k, refused));
            }
        }
        self.uncontrolled.is_none()
    }

    /// Returns the fault for a moving actuator without a set-point: its code, and the index of the actuator port to
    /// report.
    pub(crate) fn uncontrolled_fault(&self) -> (FaultCode, Option<usize>) {
        match self.uncontrolled {
            Some((_, Some(refused))) => (FaultCode::DeviceFailed, Some(refused)),
            Some((k, None)) => {
                let mover = self.actuators.iter().position(|set| set.moves.contains(&k));
                (FaultCode::SetPointMissing, mover)
            }
            None => (FaultCode::SetPointMissing, None),
        }
    }

    /// Drops all set-points of this cycle and stops every moving actuator.
    pub(crate) fn stop(&mut self, bank: &mut dyn DeviceBank) {
        self.reset();
        for held in &self.resources {
            if bank.is_moving(held.resource) {
                bank.stop(held.resource);
            }
        }
    }
}

fn total_len(parts: &[SlotRange]) -> usize {
    parts.iter().map(|c| c.len as usize).sum()
}

fn gather(cells: &[u64], parts: &[SlotRange], into: &mut [u64]) {
    let mut at = 0;
    for part in parts {
        let end = at + part.len as usize;
        into[at..end].copy_from_slice(&cells[part.range()]);
        at = end;
    }
}

fn scatter(cells: &mut [u64], parts: &[SlotRange], from: &[u64]) {
    let mut at = 0;
    for part in parts {
        let end = at + part.len as usize;
        cells[part.range()].copy_from_slice(&from[at..end]);
        at = end;
    }
}
