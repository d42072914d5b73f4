//! A force/torque sensor whose readings follow a script.

use crate::cell::ForceSpec;
use crate::device::{Device, Line, Slot, find, tell, within};
use crate::noise::Noise;
use core::ops::Range;
use nalgebra::Vector6;
use rpi_device::{PortName, Refusal, ResolveError};
use rpi_image::Scalar;

/// A force/torque sensor of a simulated cell.
#[derive(Clone, Debug)]
pub(crate) struct ForceSensor {
    spec: ForceSpec,
    felt: Vector6<f64>,
    noise: Noise,
}

const PORTS: &[Line<ForceSensor>] = &[
    Line::sensor("wrench", Scalar::Wrench, |sensor, _, out| {
        out.reals(sensor.felt.iter().copied())
    }),
    Line::sensor("tcp.force_x", Scalar::Real, |sensor, _, out| {
        out.real(sensor.felt[0])
    }),
    Line::sensor("tcp.force_y", Scalar::Real, |sensor, _, out| {
        out.real(sensor.felt[1])
    }),
    Line::sensor("tcp.force_z", Scalar::Real, |sensor, _, out| {
        out.real(sensor.felt[2])
    }),
    Line::sensor("tcp.torque_x", Scalar::Real, |sensor, _, out| {
        out.real(sensor.felt[3])
    }),
    Line::sensor("tcp.torque_y", Scalar::Real, |sensor, _, out| {
        out.real(sensor.felt[4])
    }),
    Line::sensor("tcp.torque_z", Scalar::Real, |sensor, _, out| {
        out.real(sensor.felt[5])
    }),
];

/// Descriptions of the sensor's ports, for the manual.
pub(crate) fn ports() -> impl Iterator<Item = crate::device::PortInfo> {
    PORTS.iter().map(|line| line.head.info())
}

impl ForceSensor {
    pub(crate) fn new(spec: &ForceSpec, seed: u64, device: usize) -> Self {
        let mut sensor = Self {
            spec: spec.clone(),
            felt: Vector6::zeros(),
            noise: Noise::new(seed, device),
        };
        sensor.step(0.0);
        sensor
    }
}

impl Device for ForceSensor {
    fn resolve(&self, name: &PortName<'_>) -> Result<Slot, ResolveError> {
        find(PORTS.iter().map(|line| &line.head), name, |_| 1)
    }

    fn has(&self, slot: Slot) -> bool {
        let line = PORTS.get(usize::from(slot.line));
        within(line.map(|line| &line.head), slot, |_| 1)
    }

    fn resources_of(&self, _slot: Slot) -> Range<u32> {
        0..0
    }

    fn read(&self, slot: Slot, value: &mut [u64]) -> bool {
        tell(PORTS, self, slot, value)
    }

    fn check(&mut self, _slot: Slot, _value: &[u64]) -> Refusal {
        Refusal::ILLEGAL_VALUE
    }

    fn error(&self, _slot: Slot) -> i64 {
        0
    }

    fn write(&mut self, _slot: Slot, _value: &[u64]) {}

    fn step(&mut self, time: f64) {
        let since = if self.spec.repeat.is_finite() && self.spec.repeat > 0.0 {
            time % self.spec.repeat
        } else {
            time
        };
        let now = self
            .spec
            .script
            .iter()
            .take_while(|(at, _)| *at <= since)
            .last();
        self.felt = now.map_or_else(Vector6::zeros, |(_, wrench)| *wrench);
        for part in self.felt.iter_mut() {
            *part += self.noise.normal(self.spec.noise);
        }
    }
}
