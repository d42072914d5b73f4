//! Sensors of an arm: a first-order lag, noise and latency of the measured states.

use super::FaultEffects;
use super::axis::Axis;
use super::sample::{History, Sample};
use crate::cell::ArmSpec;
use crate::noise::Noise;
use rpi_kin::MAX_AXES;

/// Sensors of a simulated arm: lag, latency and noise of its measured positions, and the samples that are on their way.
#[derive(Clone, Debug)]
pub(super) struct Sensing {
    pub(super) history: History,
    /// Duration of a tick, in s.
    tick: f64,
    /// Fraction of the difference to the true position, from 0 to 1, by which a measured position follows in a tick.
    lag_fraction: f64,
    /// Latency of samples without simulated faults, in s.
    latency: f64,
    /// Standard deviation of a measured position without simulated faults, in rad.
    deviation: f64,
    noise: Noise,
    /// Positions (rad or m) measured by the controller of a real arm, which replace the simulated ones; `None` for a
    /// simulated arm.
    pub(super) external: Option<[f64; MAX_AXES]>,
}

impl Sensing {
    pub(super) fn new(spec: &ArmSpec, tick: f64, noise: Noise, axes: &[Axis]) -> Self {
        Self {
            history: History::new(measured_sample(axes), 0),
            tick,
            lag_fraction: if spec.lag > 0.0 {
                -rpi_math::expm1(-tick / spec.lag)
            } else {
                1.0
            },
            latency: spec.latency,
            deviation: spec.noise,
            noise,
            external: None,
        }
    }

    /// Measures all axes at the end of a tick, with the additional latency and noise of the active faults.
    pub(super) fn sample(&mut self, axes: &mut [Axis], effects: &FaultEffects) {
        let (share, tick) = (self.lag_fraction, self.tick);
        match self.external {
            Some(positions) => axes.iter_mut().zip(positions).for_each(|(axis, position)| {
                axis.measured = axis.measured.after_set_point(position, tick);
            }),
            None => axes.iter_mut().for_each(|axis| axis.measure(share, tick)),
        }
        let mut sample = measured_sample(axes);
        let deviation = self.deviation + effects.deviation;
        for axis in sample.iter_mut().take(axes.len()) {
            axis.position += self.noise.normal(deviation);
        }
        let age = self.ticks(self.latency + effects.delay);
        self.history.add(sample, age);
    }

    /// Reserves memory for samples that simulated faults delay by `delay` seconds.
    pub(super) fn reserve(&mut self, delay: f64) {
        let oldest = self.ticks(self.latency + delay);
        self.history.reserve(oldest);
    }

    fn ticks(&self, time: f64) -> usize {
        // The conversion saturates. Times are never negative, and the history limits the age.
        (time / self.tick).ceil() as usize
    }
}

fn measured_sample(axes: &[Axis]) -> Sample {
    let mut sample = Sample::default();
    sample
        .iter_mut()
        .zip(axes)
        .for_each(|(slot, axis)| *slot = axis.measured);
    sample
}
