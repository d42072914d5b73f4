//! A force/torque sensor whose readings follow a script.

use crate::cell::ForceSpec;
use crate::device::{Device, PortIndex, PortRow, find_port, is_in_row, read_port};
use crate::noise::Noise;
use core::ops::Range;
use nalgebra::Vector6;
use rpi_device::{PortQuery, Rejection, ResolveError};
use rpi_image::Scalar;

/// A force/torque sensor of a simulated cell.
#[derive(Clone, Debug)]
pub(crate) struct ForceSensor {
    spec: ForceSpec,
    reading: Vector6<f64>,
    noise: Noise,
}

const PORTS: &[PortRow<ForceSensor>] = &[
    PortRow::sensor("wrench", Scalar::Wrench, |sensor, _, out| {
        out.put_reals(sensor.reading.iter().copied())
    }),
    PortRow::sensor("tcp.force_x", Scalar::Real, |sensor, _, out| {
        out.put_real(sensor.reading[0])
    }),
    PortRow::sensor("tcp.force_y", Scalar::Real, |sensor, _, out| {
        out.put_real(sensor.reading[1])
    }),
    PortRow::sensor("tcp.force_z", Scalar::Real, |sensor, _, out| {
        out.put_real(sensor.reading[2])
    }),
    PortRow::sensor("tcp.torque_x", Scalar::Real, |sensor, _, out| {
        out.put_real(sensor.reading[3])
    }),
    PortRow::sensor("tcp.torque_y", Scalar::Real, |sensor, _, out| {
        out.put_real(sensor.reading[4])
    }),
    PortRow::sensor("tcp.torque_z", Scalar::Real, |sensor, _, out| {
        out.put_real(sensor.reading[5])
    }),
];

/// Descriptions of the sensor's ports, for the manual.
pub(crate) fn ports() -> impl Iterator<Item = crate::device::PortInfo> {
    PORTS.iter().map(|line| line.spec.info())
}

impl ForceSensor {
    pub(crate) fn new(spec: &ForceSpec, seed: u64, device: usize) -> Self {
        let mut sensor = Self {
            spec: spec.clone(),
            reading: Vector6::zeros(),
            noise: Noise::new(seed, device),
        };
        sensor.step(0.0);
        sensor
    }
}

impl Device for ForceSensor {
    fn resolve(&self, name: &PortQuery<'_>) -> Result<PortIndex, ResolveError> {
        find_port(PORTS.iter().map(|line| &line.spec), name, |_| 1)
    }

    fn has_port(&self, slot: PortIndex) -> bool {
        let line = PORTS.get(usize::from(slot.row));
        is_in_row(line.map(|line| &line.spec), slot, |_| 1)
    }

    fn resources_of(&self, _slot: PortIndex) -> Range<u32> {
        0..0
    }

    fn read(&self, slot: PortIndex, value: &mut [u64]) -> bool {
        read_port(PORTS, self, slot, value)
    }

    fn check(&mut self, _slot: PortIndex, _value: &[u64]) -> Rejection {
        Rejection::ILLEGAL_VALUE
    }

    fn error(&self, _slot: PortIndex) -> i64 {
        0
    }

    fn write(&mut self, _slot: PortIndex, _value: &[u64]) {}

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
        self.reading = now.map_or_else(Vector6::zeros, |(_, wrench)| *wrench);
        for part in self.reading.iter_mut() {
            *part += self.noise.normal(self.spec.noise);
        }
    }
}
