//! The device ports of a command: sensors, actuators with their staged set-points, functions.

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

/// Resolved ports, and the buffer in which set-points and arguments are put together.
pub(crate) struct Ports {
    sensors: Box<[PortId]>,
    functions: Box<[PortId]>,
    actuators: Box<[Set]>,
    held: Box<[Held]>,
    buffer: Box<[u64]>,
    /// Its first set-points follow those of another command.
    pub(crate) joins: bool,
    /// The first set-point of this cycle that does not join, with its actuator.
    pub(crate) jump: Option<(usize, Jump)>,
    /// The first of those that moved at the end of this cycle and got no set-point, as a place in `held`, with the actuator whose
    /// set-point was refused, if one was.
    lost: Option<(usize, Option<usize>)>,
}

/// An actuator port of the image.
struct Set {
    port: PortId,
    /// The actuators that it moves, as places in `held`.
    moves: Range<usize>,
    /// Where its set-point lies in the buffer.
    at: usize,
    len: usize,
}

/// An actuator (resource) that the command holds.
#[derive(Clone, Copy, Default)]
struct Held {
    resource: u32,
    /// Somebody wants to set it in this cycle.
    claimed: bool,
    /// A set-point for it was accepted in this cycle.
    set: bool,
    /// Whose set-point is handed over at the end of this cycle; at the first of the actuators that it moves.
    staged: Option<usize>,
    /// Whose set-point was handed over at the end of the cycle before.
    last: Option<usize>,
    /// Whose set-point its device has refused in this cycle.
    refused: Option<usize>,
}

impl Ports {
    /// Resolves all ports of an image; notes what the cell does not have.
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

    /// The actuators that the command holds, ascending.
    pub(crate) fn held(&self) -> impl Iterator<Item = u32> + '_ {
        self.held.iter().map(|h| h.resource)
    }

    /// As after loading.
    pub(crate) fn reset(&mut self) {
        for held in &mut self.held {
            *held = Held {
                resource: held.resource,
                ..Held::default()
            };
        }
    }

    /// Latches all sensors, also those inside of inactive fragments.
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

    /// Checks a set-point, stages it if nothing is against it, and tells the command what the device says.
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

    /// Calls a device function; without a result the output is absent, or not a number where it cannot be absent.
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

    /// Hands all staged set-points over. False if an actuator moves and has got none: then it is stopped.
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

    /// The fault of what moved and got no set-point, and the actuator by which messages find it.
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

    /// Drops all staged set-points and lets every actuator that moves come to a stop.
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
