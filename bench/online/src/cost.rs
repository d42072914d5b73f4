//! Time of a calculation, beside that of the crate `rsruckig` and the Python package `ruckig`.
//!
//! The requests have the distribution of the benchmark of Ruckig: positions with a deviation of 4, velocities and
//! accelerations with one of 0.8 or zero, limits from 0.1 to 12 above those of the target.

use crate::cases::{Case, Random};
use crate::reference::{Request, run};
use rpi_kin::state_to_rest::AxisState;
use rpi_motion::online::{AxisLimits, MotionOptions, OnlineMotion, Synchronization};
use rsruckig::prelude as other;
use std::hint::black_box;
use std::time::Instant;

/// Number of motion requests in a measurement.
const COUNT: usize = 4_000;

/// Number of measurements, of which the fastest counts, because the machine does other work, too.
const ROUNDS: usize = 15;

/// Measures the time for computing motions of 1, 3 and 7 axes to a position, and of 1 and 7 axes to a velocity, and
/// prints it beside the times of two other implementations.
pub fn measure() {
    println!(
        "microseconds per calculation, {COUNT} requests, best of {ROUNDS} (ruckig with its Python interface: mean)"
    );
    row::<1>(false);
    row::<3>(false);
    row::<7>(false);
    row::<1>(true);
    row::<7>(true);
}

fn row<const N: usize>(is_velocity: bool) {
    let mut random = Random::new(7);
    let requests: Vec<[Case; N]> = (0..COUNT)
        .map(|_| core::array::from_fn(|_| case(&mut random, is_velocity)))
        .collect();
    let own = best_of(&requests, |axes| {
        let (start, target, limits) = (
            axes.map(|c| c.start),
            axes.map(|c| c.target),
            axes.map(|c| c.limits),
        );
        let options = MotionOptions::default();
        let plan = if is_velocity {
            OnlineMotion::to_velocity
        } else {
            OnlineMotion::to_position
        };
        plan(&start, &target, &limits, options).map_or(0.0, |motion| motion.duration())
    });
    let mut generator = other::Ruckig::<N, other::IgnoreErrorHandler>::new(None, 0.01);
    let inputs: Vec<_> = requests.iter().map(input).collect();
    let mut trajectory = other::Trajectory::new(None);
    let crate_time = best_of(&inputs, |input| {
        _ = black_box(generator.calculate(input, &mut trajectory));
        trajectory.get_duration()
    });
    let references = run(requests.iter().map(|axes| Request {
        axes,
        synchronization: Synchronization::Time,
        minimum_duration: 0.0,
    }));
    let python = references.map(|results| {
        results.iter().map(|result| result.calculation).sum::<f64>() / results.len() as f64 * 1e6
    });
    let interface = if is_velocity { "velocity" } else { "position" };
    let python = python.map_or("skipped".into(), |time| format!("{time:.2}"));
    println!("{N} axes, {interface}: own {own:.2}, rsruckig {crate_time:.2}, ruckig {python}");
}

/// Returns the mean time of `plan` for a request in microseconds, in the fastest of several measurements.
fn best_of<T>(requests: &[T], mut plan: impl FnMut(&T) -> f64) -> f64 {
    let round = |_| {
        let begin = Instant::now();
        for request in requests {
            black_box(plan(black_box(request)));
        }
        begin.elapsed().as_secs_f64() / requests.len() as f64 * 1e6
    };
    (0..ROUNDS).map(round).fold(f64::INFINITY, f64::min)
}

fn case(random: &mut Random, is_velocity: bool) -> Case {
    let or_zero = |random: &mut Random, share: f64| {
        if random.chance(share) {
            random.normal(0.8)
        } else {
            0.0
        }
    };
    loop {
        let start = AxisState {
            position: random.normal(4.0),
            velocity: or_zero(random, 0.9),
            acceleration: or_zero(random, 0.8),
        };
        let target = AxisState {
            position: random.normal(4.0),
            velocity: or_zero(random, 0.7),
            acceleration: or_zero(random, 0.6),
        };
        let velocity = random.between(0.1, 12.0) + target.velocity.abs();
        let acceleration = random.between(0.1, 12.0) + target.acceleration.abs();
        let limits = AxisLimits {
            max_velocity: velocity,
            min_velocity: -velocity,
            max_acceleration: acceleration,
            min_acceleration: -acceleration,
            max_jerk: random.between(0.1, 12.0),
        };
        let case = Case {
            is_velocity,
            start,
            target,
            limits,
        };
        if case.plan(MotionOptions::default()).is_some() {
            return case;
        }
    }
}

fn input<const N: usize>(axes: &[Case; N]) -> other::InputParameter<N> {
    let column = |value: fn(&Case) -> f64| other::DataArrayOrVec::Stack(axes.each_ref().map(value));
    let mut input = other::InputParameter::new(None);
    input.control_interface = if axes[0].is_velocity {
        other::ControlInterface::Velocity
    } else {
        other::ControlInterface::Position
    };
    input.current_position = column(|case| case.start.position);
    input.current_velocity = column(|case| case.start.velocity);
    input.current_acceleration = column(|case| case.start.acceleration);
    input.target_position = column(|case| case.target.position);
    input.target_velocity = column(|case| case.target.velocity);
    input.target_acceleration = column(|case| case.target.acceleration);
    input.max_velocity = column(|case| case.limits.max_velocity);
    input.max_acceleration = column(|case| case.limits.max_acceleration);
    input.max_jerk = column(|case| case.limits.max_jerk);
    input
}
