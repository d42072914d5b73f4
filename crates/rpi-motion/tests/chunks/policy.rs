//! A stand-in for a learned policy: a random smooth curve in joint space, sent in chunks.

use crate::xorshift::Random;
use rpi_motion::{Arm, Joints};

/// Time in which the policy comes into motion, s.
const START: f64 = 1.5;

/// Sines of one axis.
const TERMS: usize = 4;

/// Random curve that begins at rest.
#[derive(Clone)]
pub(crate) struct Policy {
    centre: Joints,
    /// Amplitude (rad), angular frequency (rad/s) and phase (rad) of the sines of each axis.
    terms: [[(f64, f64, f64); TERMS]; 7],
    /// Time at which the curve begins to move, s.
    begin: f64,
}

impl Policy {
    /// Creates a policy that asks for the share `ask` of the limits of velocity, acceleration or jerk of each axis, whichever
    /// binds first, and moves from the time `begin` (s) on.
    pub(crate) fn new(arm: &Arm, ask: f64, begin: f64, random: &mut Random) -> Self {
        let mut policy = Self {
            centre: [0.0; 7],
            terms: [[(0.0, 1.0, 0.0); TERMS]; 7],
            begin,
        };
        for (axis, limits) in arm.limits().iter().enumerate() {
            let range = limits.position;
            let (low, high) = (range.lower.max(-2.6), range.upper.min(2.6));
            let middle = low + (high - low) * random.between(0.3, 0.7);
            policy.centre[axis] = middle;
            let mut sums = [0.0; 4];
            for term in &mut policy.terms[axis] {
                let frequency = 0.5 * rpi_math::exp(random.between(0.0, 2.5));
                *term = (
                    random.between(0.1, 1.0) / frequency,
                    frequency,
                    random.between(0.0, core::f64::consts::TAU),
                );
                let mut size = term.0;
                for sum in &mut sums {
                    *sum += size;
                    size *= frequency;
                }
            }
            let room = 0.9 * (high - middle).min(middle - low);
            let scale = (room / sums[0])
                .min(ask * limits.velocity / sums[1])
                .min(ask * limits.acceleration / sums[2])
                .min(ask * limits.jerk / sums[3]);
            policy.terms[axis]
                .iter_mut()
                .for_each(|term| term.0 *= scale);
        }
        policy
    }

    /// Joint positions and velocities at a time (s).
    pub(crate) fn at(&self, time: f64) -> (Joints, Joints) {
        let x = ((time - self.begin) / START).clamp(0.0, 1.0);
        let beyond = (time - self.begin - START).max(0.0);
        let along = START * x * x * x * (1.0 - x / 2.0) + beyond;
        let rate = x * x * (3.0 - 2.0 * x);
        let mut both = (self.centre, [0.0; 7]);
        for axis in 0..7 {
            for (amplitude, frequency, phase) in self.terms[axis] {
                let (sine, cosine) = rpi_math::sincos(frequency * along + phase);
                both.0[axis] += amplitude * sine;
                both.1[axis] += amplitude * frequency * cosine * rate;
            }
        }
        both
    }
}
