//! Tests of the stop of an axis: it ends at rest, keeps its limits and is time-optimal.

mod common;

use common::Random;
use rpi_kin::stop_profile::{StopProfile, VelocityState};

fn states(count: usize) -> impl Iterator<Item = (VelocityState, f64, f64)> {
    let mut random = Random(42);
    (0..count).map(move |round| {
        let acceleration = random.between(0.5, 10.0);
        let jerk = acceleration * random.between(1.0, 100.0);
        let velocity = [0.0, random.between(-3.0, 3.0), random.between(-1e-3, 1e-3)][round % 3];
        let present = [0.0, random.between(-1.0, 1.0) * acceleration, acceleration][round / 3 % 3];
        (
            VelocityState {
                velocity,
                acceleration: present,
            },
            acceleration,
            jerk,
        )
    })
}

#[test]
fn it_ends_at_rest_and_stays_there() {
    for (start, acceleration, jerk) in states(20_000) {
        let stop = StopProfile::new(start, acceleration, jerk).expect("good numbers");
        let end = stop.state_at(stop.duration() * (1.0 - 1e-12));
        assert!(
            end.velocity.abs() < 1e-9 && end.acceleration.abs() < 1e-8 * acceleration.max(jerk),
            "{start:?}: {end:?}"
        );
        assert_eq!(stop.state_at(stop.duration()), VelocityState::default());
        assert_eq!(stop.state_at(1e9), VelocityState::default());
        assert_eq!(stop.state_at(-1.0), start);
    }
}

#[test]
fn limits_hold_in_every_cycle_by_backward_differences() {
    let dt = 1e-3;
    for (start, acceleration, jerk) in states(3_000) {
        let stop = StopProfile::new(start, acceleration, jerk).expect("good numbers");
        let mut before = start;
        for cycle in 1..=(stop.duration() / dt) as usize + 3 {
            let velocity = stop.state_at(cycle as f64 * dt).velocity;
            let gained = (velocity - before.velocity) / dt;
            assert!(
                gained.abs() <= acceleration * (1.0 + 1e-9),
                "{start:?}: {gained} of {acceleration}"
            );
            let jerked = (gained - before.acceleration) / dt;
            assert!(
                jerked.abs() <= jerk * (1.0 + 1e-6),
                "{start:?}: {jerked} of {jerk}"
            );
            before = VelocityState {
                velocity,
                acceleration: gained,
            };
        }
        assert!(before.velocity == 0.0 && before.acceleration.abs() < 1e-9);
    }
}

#[test]
fn the_distance_is_the_integral_of_the_velocity() {
    for (start, acceleration, jerk) in states(300) {
        let stop = StopProfile::new(start, acceleration, jerk).expect("good numbers");
        let steps = 20_000;
        let dt = stop.duration() / f64::from(steps);
        let middle = |step: i32| stop.state_at((f64::from(step) + 0.5) * dt).velocity;
        let sum: f64 = (0..steps).map(middle).sum::<f64>() * dt;
        assert!(
            (sum - stop.distance()).abs() < 1e-6,
            "{start:?}: {sum} and {}",
            stop.distance()
        );
    }
}

#[test]
fn known_stops_take_their_known_time() {
    let at = |velocity, acceleration| VelocityState {
        velocity,
        acceleration,
    };
    // Full braking: deceleration up to 2 in 0.5 s, constant for 1 s, down in 0.5 s. The change of velocity is 0.5 + 2 +
    // 0.5 = 3.
    let full = StopProfile::new(at(3.0, 0.0), 2.0, 4.0).expect("good numbers");
    assert!((full.duration() - 2.0).abs() < 1e-12 && (full.distance() - 3.0).abs() < 1e-12);
    // Too slow for full braking: the peak deceleration is sqrt(j v) = 2, not 10.
    let brief = StopProfile::new(at(-1.0, 0.0), 10.0, 4.0).expect("good numbers");
    assert!((brief.duration() - 1.0).abs() < 1e-12 && (brief.distance() + 0.5).abs() < 1e-12);
    // The decay of the acceleration alone leads to rest.
    let falling = StopProfile::new(at(0.5, -2.0), 2.0, 4.0).expect("good numbers");
    assert!((falling.duration() - 0.5).abs() < 1e-12);
    // Without a jerk limit, the deceleration is constant.
    let plain = StopProfile::new(at(-3.0, 1.0), 2.0, f64::INFINITY).expect("good numbers");
    assert!((plain.duration() - 1.5).abs() < 1e-12 && (plain.distance() + 2.25).abs() < 1e-12);
    assert_eq!(
        StopProfile::new(at(0.0, 0.0), 2.0, 4.0)
            .expect("good numbers")
            .duration(),
        0.0
    );
}

#[test]
fn a_start_beyond_the_acceleration_limit_comes_back_to_it() {
    for present in [5.0, -5.0] {
        for velocity in [-4.0, 4.0] {
            let stop = StopProfile::new(
                VelocityState {
                    velocity,
                    acceleration: present,
                },
                2.0,
                10.0,
            )
            .expect("good numbers");
            let late = stop.duration() / 2.0;
            assert!(stop.state_at(late).acceleration.abs() <= 2.0 + 1e-12);
            assert!(stop.state_at(stop.duration() - 1e-9).velocity.abs() < 1e-9);
        }
    }
}

#[test]
fn bad_numbers_are_refused() {
    let rest = VelocityState::default();
    for bad in [f64::NAN, 0.0, -1.0] {
        assert_eq!(StopProfile::new(rest, bad, 1.0), None);
        assert_eq!(StopProfile::new(rest, 1.0, bad), None);
    }
    for bad in [f64::NAN, f64::INFINITY] {
        assert_eq!(
            StopProfile::new(
                VelocityState {
                    velocity: bad,
                    ..rest
                },
                1.0,
                1.0
            ),
            None
        );
        assert_eq!(
            StopProfile::new(
                VelocityState {
                    acceleration: bad,
                    ..rest
                },
                1.0,
                1.0
            ),
            None
        );
    }
}
