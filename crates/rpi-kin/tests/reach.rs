//! Tests of motions to a goal from random states: backward differences of their samples keep the bounds.

mod common;

use common::Random;
use rpi_kin::state_to_rest::{AxisState, Bounds, StateToRestProfile};

const DT: f64 = 1e-3;

/// Returns bounds with magnitudes from 0.001 to 1000, and a start within them.
fn case(random: &mut Random) -> (AxisState, f64, Bounds) {
    let mut bound = || rpi_math::pow(10.0, random.between(-3.0, 3.0));
    let bounds = Bounds {
        speed: bound(),
        acceleration: bound(),
        jerk: bound(),
    };
    let start = AxisState {
        position: random.between(-1.0, 1.0),
        velocity: bounds.speed * random.between(-1.0, 1.0),
        acceleration: bounds.acceleration * random.between(-1.0, 1.0),
    };
    (start, random.between(-2.0, 2.0), bounds)
}

/// Returns whether the velocity stays within the bounds until the acceleration has decayed, so that the start can keep
/// the bounds.
fn can_keep(start: AxisState, bounds: Bounds) -> bool {
    let coming =
        start.velocity + start.acceleration * start.acceleration.abs() / (2.0 * bounds.jerk);
    coming.abs() <= bounds.speed
}

#[test]
fn every_goal_is_reached_at_rest() {
    let mut random = Random(1);
    for k in 0..200_000 {
        let (start, goal, bounds) = case(&mut random);
        let way = StateToRestProfile::new(start, goal, bounds).unwrap();
        let (end, duration) = (way.state_at(way.duration()), way.duration());
        assert_eq!(
            (end.position, end.velocity, end.acceleration),
            (goal, 0.0, 0.0)
        );
        let before = way.state_at(duration * (1.0 - 1e-9));
        let scale = 1.0 + bounds.speed * duration;
        assert!(
            (before.position - goal).abs() < 1e-7 * scale,
            "case {k}: {before:?} before {goal} of {start:?} {bounds:?}"
        );
    }
}

#[test]
fn bounds_hold_on_the_whole_way() {
    let mut random = Random(2);
    for k in 0..20_000 {
        let (start, goal, bounds) = case(&mut random);
        if !can_keep(start, bounds) {
            continue;
        }
        let way = StateToRestProfile::new(start, goal, bounds).unwrap();
        for step in 0..=500 {
            let state = way.state_at(way.duration() * f64::from(step) / 500.0);
            let much = 1.0 + 1e-9;
            assert!(
                state.velocity.abs() <= bounds.speed * much
                    && state.acceleration.abs() <= bounds.acceleration * much,
                "case {k}, step {step}: {state:?} of {start:?} to {goal} {bounds:?}"
            );
        }
    }
}

/// Simulates a device: a sequence of set-points with changing goals, each motion planned from the differences of the
/// last one.
#[test]
fn goals_may_change_on_the_way() {
    let bounds = Bounds {
        speed: 1.9,
        acceleration: 4.0,
        jerk: 39.0,
    };
    let mut random = Random(3);
    let mut seen = AxisState::default();
    for case in 0..20_000 {
        let way = StateToRestProfile::from_differences(seen, DT, random.between(-3.0, 3.0), bounds)
            .unwrap();
        let cycles = random.between(1.0, 200.0) as u32;
        for cycle in 1..=cycles {
            let target = way.state_at(f64::from(cycle) * DT).position;
            let velocity = (target - seen.position) / DT;
            let acceleration = (velocity - seen.velocity) / DT;
            let jerk = (acceleration - seen.acceleration) / DT;
            let much = 1.0 + 1e-6;
            assert!(
                velocity.abs() <= bounds.speed * much
                    && acceleration.abs() <= bounds.acceleration * much
                    && jerk.abs() <= bounds.jerk * much,
                "case {case}, cycle {cycle}: {velocity} {acceleration} {jerk}"
            );
            seen = AxisState {
                position: target,
                velocity,
                acceleration,
            };
        }
    }
}

/// From rest, the motion is a double-S profile. The duration equals the closed form for a motion on which all bounds
/// are reached.
#[test]
fn from_rest_it_takes_the_least_time() {
    let bounds = Bounds {
        speed: 2.0,
        acceleration: 4.0,
        jerk: 20.0,
    };
    let way = StateToRestProfile::new(AxisState::default(), 5.0, bounds).unwrap();
    // T = d/v + v/a + a/j.
    let least = 5.0 / 2.0 + 2.0 / 4.0 + 4.0 / 20.0;
    assert!((way.duration() - least).abs() < 1e-12, "{}", way.duration());
}

#[test]
fn what_cannot_be_planned_is_none() {
    let good = Bounds {
        speed: 1.0,
        acceleration: 1.0,
        jerk: 1.0,
    };
    for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert_eq!(
            StateToRestProfile::new(AxisState::default(), 1.0, Bounds { jerk: bad, ..good }),
            None
        );
    }
    assert_eq!(
        StateToRestProfile::new(AxisState::default(), f64::NAN, good),
        None
    );
}
