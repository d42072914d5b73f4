//! Device ports of a command: sensors, actuators with staged set-points, functions.

use crate::continuity::JOINING;
use crate::load::{LoadFault, resolve};
use rpi_device::{DeviceBank, Jump, PortId, PortKind, Refusal};
use rpi_image::Answer;
use rpi_image::image::{Actuator, Cells, Image, TRUE};
use rpi_prims::{Cx, FaultCode};

use alloc::boxed::Box;
use alloc::vec;
use alloc::vec::Vec;
use core::ops::Range;

/// Resolved device ports, and the buffer in which set-points and arguments are assembled.
pub(crate) struct Ports {
    sensors: Box<[PortId]>,
    functions: Box<[PortId]>,
    actuators: Box<[Set]>,
    held: Box<[Held]>,
    buffer: Box<[u64]>,
    /// The command has taken over, so the continuity of its first set-points is checked.
    pub(crate) joins: bool,
    /// The first discontinuous set-point of this cycle, with the index of its actuator port.
    pub(crate) jump: Option<(usize, Jump)>,
    /// The first resource that was moving without a set-point at the end of this cycle, as an index into `held`. The
    /// second part is the actuator port whose set-point was rejected, if any.
    lost: Option<(usize, Option<usize>)>,
}

/// An actuator port of the image.
struct Set {
    port: PortId,
    /// Resources that the port moves, as a range of `held`.
    moves: Range<usize>,
    /// Offset of the set-point in the buffer.
    at: usize,
    len: usize,
}

/// A resource (actuator) that the command holds.
#[derive(Clone, Copy, Default)]
struct Held {
    resource: u32,
    /// A set-point for this resource was computed in this cycle, accepted or not.
    claimed: bool,
    /// A set-point for this resource was accepted in this cycle.
    set: bool,
    /// The actuator port whose set-point is sent at the end of this cycle. Stored at the first resource of the port
    /// only.
    staged: Option<usize>,
    /// The actuator port whose set-point was sent at the end of the previous cycle.
    last: Option<usize>,
    /// The actuator port whose set-point was rejected by its device in this cycle.
    refused: Option<usize>,
}

impl Ports {
    /// Resolves all ports of an image; appends an error for each port that the cell lacks.
    pub(crate) fn load(
        image: &Image,
        bank: &mut dyn DeviceBank,
        faults: &mut Vec<LoadFault>,
    ) -> Self {
        let sensors = image.sensors.iter();
        let sensors = sensors
            .map(|s| resolve(bank, faults, &s.port, PortKind::Sensor))
            .collect();
        let functions = image.functions.iter();
        let functions = functions
            .map(|f| resolve(bank, faults, &f.port, PortKind::Function))
            .collect();
        let ports = image.actuators.iter();
        let ports: Vec<PortId> = ports
            .map(|a| resolve(bank, faults, &a.port, PortKind::Actuator))
            .collect();
        let mut loading = Ports {
            sensors,
            functions,
            actuators: Box::default(),
            held: Box::default(),
            buffer: Box::default(),
            joins: false,
            jump: None,
            lost: None,
        };
        if faults.is_empty() {
            loading.actuators(image, &ports, bank);
        }
        loading
    }

    fn actuators(&mut self, image: &Image, ports: &[PortId], bank: &dyn DeviceBank) {
        let mut resources: Vec<u32> = ports.iter().flat_map(|p| bank.resources(*p)).collect();
        resources.sort_unstable();
        resources.dedup();
        let mut end = 0;
        let set = |(actuator, &port): (&Actuator, &PortId)| {
            let moved = bank.resources(port);
            let place = |resource: u32| resources.partition_point(|r| *r < resource);
            let (at, len) = (end, total(&actuator.inputs));
            end += len;
            Set {
                port,
                moves: place(moved.start)..place(moved.end),
                at,
                len,
            }
        };
        self.actuators = image.actuators.iter().zip(ports).map(set).collect();
        let held = |&resource: &u32| Held {
            resource,
            ..Held::default()
        };
        self.held = resources.iter().map(held).collect();
        let arguments = image.functions.iter().map(|f| total(&f.arguments)).max();
        let results = image.functions.iter().map(|f| total(&f.results)).max();
        let scratch = arguments.unwrap_or(0) + results.unwrap_or(0);
        self.buffer = vec![0; end + scratch].into();
    }

    /// Resources that the command holds, in ascending order.
    pub(crate) fn held(&self) -> impl Iterator<Item = u32> + '_ {
        self.held.iter().map(|h| h.resource)
    }

    /// Restores the state after loading.
    pub(crate) fn reset(&mut self) {
        for held in &mut self.held {
            *held = Held {
                resource: held.resource,
                ..Held::default()
            };
        }
    }

    /// Latches all sensors, including those in inactive fragments.
    pub(crate) fn read_sensors(&self, image: &Image, cx: &mut Cx<'_>) {
        for (sensor, &port) in image.sensors.iter().zip(&self.sensors) {
            let value = sensor.value;
            let sampled = cx.devices.read(port, &mut cx.cells[value.cells().range()]);
            match value.present {
                TRUE if !sampled => cx.fault(FaultCode::MissingSample, value.at),
                TRUE => {}
                present => cx.cells[present as usize] = u64::from(sampled),
            }
        }
    }

    /// Checks a set-point, stages it if it is valid, and stores the device's answers in the command's memory.
    pub(crate) fn actuate(&mut self, image: &Image, index: usize, cx: &mut Cx<'_>) {
        let (actuator, set) = (&image.actuators[index], &self.actuators[index]);
        let value = &mut self.buffer[set.at..set.at + set.len];
        gather(cx.cells, &actuator.inputs, value);
        if self.joins && cx.clock.cycle < JOINING && self.jump.is_none() {
            let jump = cx.devices.jump(set.port, value);
            self.jump = jump.map(|jump| (index, jump));
        }
        let held = &mut self.held[set.moves.clone()];
        let mut refusal = cx.devices.check(set.port, value);
        // Claims count even if the first set-point was rejected: two writers in one cycle are always an error.
        if held.iter().any(|h| h.claimed) {
            refusal = refusal.and(Refusal::CONCURRENT_ACCESS);
            cx.fault(FaultCode::ConcurrentAccess, actuator.cell());
        }
        let accepted = refusal == Refusal::NONE;
        for h in held.iter_mut() {
            h.claimed = true;
            h.set |= accepted;
            if !accepted {
                h.refused = Some(index);
            }
        }
        let completed = held.first().is_some_and(|h| h.last == Some(index));
        if let Some(first) = held.first_mut().filter(|_| accepted) {
            first.staged = Some(index);
        }
        for &(answer, cell) in &actuator.answers {
            let error = cx.devices.error(set.port);
            cx.cells[cell as usize] = match answer {
                Answer::ConcurrentAccess => u64::from(refusal.has(Refusal::CONCURRENT_ACCESS)),
                Answer::DeviceFailed => u64::from(refusal.has(Refusal::DEVICE_FAILED)),
                Answer::IllegalValue => u64::from(refusal.has(Refusal::ILLEGAL_VALUE)),
                Answer::ErrorCode => error.cast_unsigned(),
                Answer::Completed => u64::from(completed && error == 0),
            };
        }
    }

    /// Calls a device function. Without a result the output is absent, or NaN if it cannot be absent.
    pub(crate) fn call(&mut self, image: &Image, index: usize, cx: &mut Cx<'_>) {
        let function = &image.functions[index];
        let scratch = self.actuators.last().map_or(0, |a| a.at + a.len);
        let (arguments, rest) = self.buffer[scratch..].split_at_mut(total(&function.arguments));
        gather(cx.cells, &function.arguments, arguments);
        let result = &mut rest[..total(&function.results)];
        let found = cx.devices.call(self.functions[index], arguments, result);
        if !found {
            result.fill(f64::NAN.to_bits());
        }
        scatter(cx.cells, &function.results, result);
        if function.present != TRUE {
            cx.cells[function.present as usize] = u64::from(found);
        }
    }

    /// Sends all staged set-points. Returns false if a moving actuator has no set-point; that actuator is stopped.
    pub(crate) fn hand_over(&mut self, bank: &mut dyn DeviceBank) -> bool {
        self.lost = None;
        for (k, held) in self.held.iter_mut().enumerate() {
            held.last = held.staged.take();
            if let Some(set) = held.last.map(|index| &self.actuators[index]) {
                bank.write(set.port, &self.buffer[set.at..set.at + set.len]);
            }
            held.claimed = false;
            let refused = held.refused.take();
            if !core::mem::take(&mut held.set) && bank.moving(held.resource) {
                bank.stop(held.resource);
                self.lost.get_or_insert((k, refused));
            }
        }
        self.lost.is_none()
    }

    /// Fault code for a moving actuator without a set-point, and the index of the actuator port to report.
    pub(crate) fn loss(&self) -> (FaultCode, Option<usize>) {
        match self.lost {
            Some((_, Some(refused))) => (FaultCode::DeviceFailed, Some(refused)),
            Some((k, None)) => {
                let mover = self.actuators.iter().position(|set| set.moves.contains(&k));
                (FaultCode::SetPointMissing, mover)
            }
            None => (FaultCode::SetPointMissing, None),
        }
    }

    /// Drops all staged set-points and stops every moving actuator.
    pub(crate) fn stop(&mut self, bank: &mut dyn DeviceBank) {
        self.reset();
        for held in &self.held {
            if bank.moving(held.resource) {
                bank.stop(held.resource);
            }
        }
    }
}

fn total(parts: &[Cells]) -> usize {
    parts.iter().map(|c| c.len as usize).sum()
}

fn gather(cells: &[u64], parts: &[Cells], into: &mut [u64]) {
    let mut at = 0;
    for part in parts {
        let end = at + part.len as usize;
        into[at..end].copy_from_slice(&cells[part.range()]);
        at = end;
    }
}

fn scatter(cells: &mut [u64], parts: &[Cells], from: &[u64]) {
    let mut at = 0;
    for part in parts {
        let end = at + part.len as usize;
        cells[part.range()].copy_from_slice(&from[at..end]);
        at = end;
    }
}
