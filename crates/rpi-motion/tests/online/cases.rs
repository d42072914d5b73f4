//! Random requests for the online generator, by seed. The comparison in `bench/online` uses this file also.

use rpi_kin::state_to_rest::AxisState;
use rpi_motion::online::{AxisLimits, MotionOptions, OnlineMotion};

#[path = "../support/xorshift.rs"]
mod xorshift;

pub(crate) use xorshift::Random;

impl Random {
    /// Returns whether an event of a given probability happens.
    pub(crate) fn chance(&mut self, probability: f64) -> bool {
        self.unit() < probability
    }

    /// Returns a normally distributed number with the mean 0.
    pub(crate) fn normal(&mut self, deviation: f64) -> f64 {
        let radius = (-2.0 * rpi_math::log(1.0 - self.unit())).sqrt();
        deviation * radius * rpi_math::cos(std::f64::consts::TAU * self.unit())
    }

    /// Returns 0, or a number of random sign from 1e-17 to 1e-3.
    pub(crate) fn noise(&mut self) -> f64 {
        let size = rpi_math::pow(10.0, self.between(-17.0, -3.0));
        [0.0, size, -size][(self.unit() * 3.0) as usize]
    }
}

/// Request for a motion of one axis.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Case {
    /// The target is a velocity.
    pub(crate) is_velocity: bool,
    /// State at the start.
    pub(crate) start: AxisState,
    /// State at the target.
    pub(crate) target: AxisState,
    /// Limits.
    pub(crate) limits: AxisLimits,
}

/// Plans the motion of several axes; the first one says whether the target is a velocity. `None` if a request is not
/// valid.
pub(crate) fn plan_together<const N: usize>(
    cases: &[Case; N],
    options: MotionOptions,
) -> Option<OnlineMotion<N>> {
    let (start, target, limits) = (
        cases.map(|case| case.start),
        cases.map(|case| case.target),
        cases.map(|case| case.limits),
    );
    let motion = if cases[0].is_velocity {
        OnlineMotion::to_velocity(&start, &target, &limits, options)
    } else {
        OnlineMotion::to_position(&start, &target, &limits, options)
    };
    motion.ok()
}

impl Case {
    /// Plans the motion.
    pub(crate) fn plan(&self, options: MotionOptions) -> Option<OnlineMotion<1>> {
        plan_together(core::array::from_ref(self), options)
    }

    /// Returns a random request that is accepted.
    pub(crate) fn random(random: &mut Random) -> Self {
        loop {
            let case = Self::proposal(random);
            if case.plan(MotionOptions::default()).is_some() {
                return case;
            }
        }
    }

    fn proposal(random: &mut Random) -> Self {
        let limits = limits(random);
        let mut case = Self {
            is_velocity: random.chance(0.25),
            start: state(random, &limits, 1.0),
            target: state(random, &limits, 1.0),
            limits,
        };
        match (random.unit() * 8.0) as usize {
            4 => case.be_whole_numbers(random),
            5 => case.scale_limits(rpi_math::pow(10.0, random.between(0.0, 5.0))),
            0 => case.start = state(random, &limits, 2.0),
            1 => case.be_close(random),
            2 => case.be_at_limits(random),
            3 => case.be_on_the_way(random),
            _ => {}
        }
        if random.chance(0.5) {
            for value in [
                &mut case.start.position,
                &mut case.start.velocity,
                &mut case.start.acceleration,
                &mut case.target.position,
                &mut case.target.velocity,
                &mut case.target.acceleration,
            ] {
                *value += random.noise();
            }
        }
        case
    }

    /// Start and target are equal in some or all values.
    fn be_close(&mut self, random: &mut Random) {
        if random.chance(0.7) {
            self.target.position = self.start.position;
        }
        if random.chance(0.7) {
            self.target.velocity = self.start.velocity;
        }
        if random.chance(0.7) {
            self.target.acceleration = self.start.acceleration;
        }
    }

    /// Velocities or accelerations are at limits.
    fn be_at_limits(&mut self, random: &mut Random) {
        let limits = self.limits;
        for state in [&mut self.start, &mut self.target] {
            if random.chance(0.5) {
                state.velocity = pick(random, &[limits.max_velocity, limits.min_velocity]);
                state.acceleration = 0.0;
            } else if random.chance(0.7) {
                let bound = pick(random, &[limits.max_acceleration, limits.min_acceleration]);
                state.acceleration = bound;
            }
            let change = state.acceleration * state.acceleration / (2.0 * limits.max_jerk);
            if random.chance(0.3) {
                state.velocity = pick(
                    random,
                    &[
                        limits.max_velocity - change,
                        limits.min_velocity + change,
                        change,
                        -change,
                    ],
                );
            }
        }
    }

    /// All values are small whole numbers, so that many of them coincide.
    fn be_whole_numbers(&mut self, random: &mut Random) {
        for state in [&mut self.start, &mut self.target] {
            *state = AxisState {
                position: pick(random, &[-1.0, 0.0, 1.0]),
                velocity: pick(random, &[-1.0, 0.0, 1.0]),
                acceleration: pick(random, &[-1.0, 0.0, 1.0]),
            };
        }
        let mut limit = || pick(random, &[1.0, 2.0]);
        let (velocity, acceleration) = (limit(), limit());
        self.limits = AxisLimits {
            max_velocity: velocity,
            min_velocity: -velocity,
            max_acceleration: acceleration,
            min_acceleration: -acceleration,
            max_jerk: limit(),
        };
    }

    fn scale_limits(&mut self, factor: f64) {
        let limits = &mut self.limits;
        limits.max_velocity *= factor;
        limits.min_velocity *= factor;
        limits.max_acceleration *= factor;
        limits.min_acceleration *= factor;
        limits.max_jerk *= factor;
    }

    /// The start lies on the way of an earlier motion to the same target.
    fn be_on_the_way(&mut self, random: &mut Random) {
        if let Some(motion) = self.plan(MotionOptions::default()) {
            let profile = &motion.axes()[0];
            let time = if random.chance(0.5) {
                // At the end of a phase.
                let phases = profile.phases();
                let count = (random.unit() * (phases.len() + 1) as f64) as usize;
                phases[..count.min(phases.len())]
                    .iter()
                    .map(|phase| phase.duration)
                    .sum()
            } else {
                random.unit() * profile.duration()
            };
            self.start = profile.state_at(time);
        }
    }
}

fn pick(random: &mut Random, values: &[f64]) -> f64 {
    values[((random.unit() * values.len() as f64) as usize).min(values.len() - 1)]
}

fn limits(random: &mut Random) -> AxisLimits {
    let limit = |random: &mut Random| match (random.unit() * 4.0) as usize {
        0 => 1.0,
        1 => rpi_math::pow(10.0, random.between(-2.0, 2.0)),
        _ => random.between(0.08, 16.0),
    };
    let (v, a) = (limit(random), limit(random));
    let is_symmetric = random.chance(0.5);
    let mut other = |same: f64| if is_symmetric { same } else { limit(random) };
    AxisLimits {
        max_velocity: v,
        min_velocity: -other(v),
        max_acceleration: a,
        min_acceleration: -other(a),
        max_jerk: limit(random),
    }
}

/// Random state with velocity and acceleration up to `share` of the limits.
fn state(random: &mut Random, limits: &AxisLimits, share: f64) -> AxisState {
    let within = |random: &mut Random, low: f64, high: f64| match (random.unit() * 5.0) as usize {
        0 | 1 => 0.0,
        2 => random.normal(0.8).clamp(low * share, high * share),
        _ => random.between(low * share, high * share),
    };
    AxisState {
        position: if random.chance(0.2) {
            0.0
        } else {
            random.normal(4.0)
        },
        velocity: within(random, limits.min_velocity, limits.max_velocity),
        acceleration: within(random, limits.min_acceleration, limits.max_acceleration),
    }
}
