//! Durations of the requests in the tests and examples of Ruckig. `bench/online/published_cases.py` writes the file.

use rpi_kin::state_to_rest::AxisState;
use rpi_motion::online::{AxisLimits, MotionOptions, OnlineMotion, Synchronization};

/// Request for three axes with the published durations: of the motion, and of each axis by itself.
struct PublishedCase {
    is_velocity: bool,
    options: MotionOptions,
    start: [AxisState; 3],
    target: [AxisState; 3],
    limits: [AxisLimits; 3],
    duration: f64,
    alone: [f64; 3],
}

fn published() -> Vec<PublishedCase> {
    include_str!("published.csv").lines().map(parsed).collect()
}

fn parsed(line: &str) -> PublishedCase {
    let numbers: Vec<f64> = line
        .split(',')
        .map(|number| number.parse().expect("a number"))
        .collect();
    let at = |axis: usize, k: usize| numbers[4 + 11 * axis + k];
    let state = |axis: usize, k: usize| AxisState {
        position: at(axis, k),
        velocity: at(axis, k + 1),
        acceleration: at(axis, k + 2),
    };
    PublishedCase {
        is_velocity: numbers[1] == 1.0,
        options: MotionOptions {
            synchronization: [
                Synchronization::None,
                Synchronization::Time,
                Synchronization::Phase,
            ][numbers[2] as usize],
            minimum_duration: numbers[3],
        },
        start: [0, 1, 2].map(|axis| state(axis, 0)),
        target: [0, 1, 2].map(|axis| state(axis, 3)),
        limits: [0, 1, 2].map(|axis| AxisLimits {
            max_velocity: at(axis, 6),
            min_velocity: at(axis, 7),
            max_acceleration: at(axis, 8),
            min_acceleration: at(axis, 9),
            max_jerk: at(axis, 10),
        }),
        duration: numbers[37],
        alone: [numbers[38], numbers[39], numbers[40]],
    }
}

impl PublishedCase {
    fn plan(&self, options: MotionOptions) -> OnlineMotion<3> {
        let motion = if self.is_velocity {
            OnlineMotion::to_velocity(&self.start, &self.target, &self.limits, options)
        } else {
            OnlineMotion::to_position(&self.start, &self.target, &self.limits, options)
        };
        motion.expect("the request is valid")
    }
}

#[test]
fn durations_of_published_cases_are_reached() {
    let cases = published();
    assert_eq!(cases.len(), 20);
    for (number, case) in cases.iter().enumerate() {
        let duration = case.plan(case.options).duration();
        assert!(
            (duration - case.duration).abs() <= 1e-8,
            "case {number}: {duration} instead of {}",
            case.duration
        );
    }
}

#[test]
fn each_axis_alone_takes_the_published_duration() {
    for (number, case) in published().iter().enumerate() {
        let options = MotionOptions {
            synchronization: Synchronization::None,
            minimum_duration: 0.0,
        };
        let motion = case.plan(options);
        for (profile, duration) in motion.axes().iter().zip(case.alone) {
            let own = profile.duration();
            assert!(
                (own - duration).abs() <= 1e-8,
                "case {number}: {own} instead of {duration}"
            );
        }
    }
}

#[test]
fn published_positions_on_the_way_are_reached() {
    let cases = published();
    let positions = |case: &PublishedCase, time: f64| {
        case.plan(case.options)
            .state_at(time)
            .map(|state| state.position)
    };
    let expected = [
        (&cases[11], [1.0 / 12.0, -2.0 - 1.0 / 12.0, 1.0 / 6.0]),
        (&cases[12], [5.0 / 6.0, -2.0 - 1.0 / 12.0, 1.0 / 6.0]),
    ];
    for (case, positions_after_1_s) in expected {
        for (own, published) in positions(case, 1.0).iter().zip(positions_after_1_s) {
            assert!((own - published).abs() < 1e-9, "{own} {published}");
        }
    }
}
