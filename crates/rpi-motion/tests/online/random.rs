//! Properties of random motions.

use crate::cases::{Case, Random, plan_together};
use crate::verify::errors;
use rpi_kin::state_to_rest::AxisState;
use rpi_motion::online::{MotionOptions, OnlineMotion, Synchronization};

fn count() -> usize {
    let text = std::env::var("RPI_ONLINE").unwrap_or_default();
    text.parse().unwrap_or(3000)
}

fn together(synchronization: Synchronization, minimum_duration: f64) -> MotionOptions {
    MotionOptions {
        synchronization,
        minimum_duration,
    }
}

/// Asserts that a motion ends at its target, and keeps its limits from the moment at which they are reached.
fn assert_valid<const N: usize>(cases: &[Case; N], motion: &OnlineMotion<N>) {
    for (case, profile) in cases.iter().zip(motion.axes()) {
        let found = errors(case, profile);
        let end = found.worst_end();
        assert!(end <= 1.01e-8 + found.rounding, "{found:?} {case:?}");
        assert!(found.worst_excess() <= 1e-9, "{found:?} {case:?}");
        let last = profile.state_at(profile.duration());
        assert_eq!(last, profile.end());
        let left = (profile.duration()
            - profile
                .phases()
                .iter()
                .map(|phase| phase.duration)
                .sum::<f64>())
        .abs();
        assert!(
            left <= 1e-11 * profile.duration().max(1.0),
            "{left} {case:?}"
        );
    }
}

#[test]
fn random_motions_end_at_the_target_within_the_limits() {
    let mut random = Random::new(1);
    for _ in 0..count() {
        let case = Case::random(&mut random);
        let motion = case
            .plan(MotionOptions::default())
            .expect("the request is valid");
        assert_valid(&[case], &motion);
    }
}

/// The rest of a time-optimal motion is time-optimal, so planning anew on the way must not make it longer.
#[test]
fn planning_anew_on_the_way_does_not_take_longer() {
    let mut random = Random::new(2);
    for _ in 0..count() {
        let mut case = Case::random(&mut random);
        let motion = case
            .plan(MotionOptions::default())
            .expect("the request is valid");
        // A long motion accumulates rounding that is a state of its own.
        if motion.duration() > 50.0 {
            continue;
        }
        let time = random.unit() * motion.duration();
        let request = case;
        case.start = motion.axes()[0].state_at(time);
        let rest = case
            .plan(MotionOptions::default())
            .expect("the request is valid");
        let whole = time + rest.duration();
        // A motion that misses the target by less than 1e-8 m may have replaced a longer one.
        let tolerance = 1e-4 + 2.0 * rpi_math::cbrt(32e-8 / case.limits.max_jerk);
        assert!(
            whole <= motion.duration() + tolerance,
            "{whole} instead of {} from {time}: {request:?}",
            motion.duration()
        );
    }
}

/// No slower motion of a similar kind is found by planning over a waypoint.
#[test]
fn no_way_over_a_random_state_is_shorter() {
    let mut random = Random::new(3);
    let (mut compared, mut shorter) = (0, Vec::new());
    for _ in 0..count() {
        let case = Case::random(&mut random);
        let motion = case
            .plan(MotionOptions::default())
            .expect("the request is valid");
        let on_the_way = motion.axes()[0].state_at(random.unit() * motion.duration());
        let nudge =
            |value: f64, random: &mut Random| value + random.normal(0.05) * (0.1 + value.abs());
        let waypoint = AxisState {
            position: nudge(on_the_way.position, &mut random),
            velocity: nudge(on_the_way.velocity, &mut random),
            acceleration: nudge(on_the_way.acceleration, &mut random),
        };
        let (first, second) = (
            Case {
                target: waypoint,
                ..case
            },
            Case {
                start: waypoint,
                ..case
            },
        );
        // From a state that cannot keep the maximum velocity, the second motion would exceed it.
        let coasting = waypoint.velocity
            + waypoint.acceleration * waypoint.acceleration.abs() / (2.0 * case.limits.max_jerk);
        let range = case.limits.min_velocity..=case.limits.max_velocity;
        if !case.is_velocity && !range.contains(&coasting) {
            continue;
        }
        let options = MotionOptions::default();
        if let (Some(first), Some(second)) = (first.plan(options), second.plan(options)) {
            compared += 1;
            let detour = first.duration() + second.duration();
            if detour < motion.duration() - 1e-4 {
                shorter.push((detour, motion.duration(), case));
            }
        }
    }
    assert!(compared > count() / 4, "{compared}");
    assert!(
        shorter.is_empty(),
        "{} shorter, first {:?}",
        shorter.len(),
        shorter[0]
    );
}

fn three(random: &mut Random) -> [Case; 3] {
    loop {
        let cases = [(); 3].map(|()| Case::random(random));
        if cases
            .iter()
            .all(|case| case.is_velocity == cases[0].is_velocity)
        {
            return cases;
        }
    }
}

fn plan(cases: &[Case; 3], options: MotionOptions) -> OnlineMotion<3> {
    plan_together(cases, options).expect("the request is valid")
}

#[test]
fn synchronised_axes_end_together() {
    let mut random = Random::new(4);
    for _ in 0..count() / 3 {
        let cases = three(&mut random);
        let minimum = if random.chance(0.5) {
            random.between(0.0, 20.0)
        } else {
            0.0
        };
        let options = together(Synchronization::Time, minimum);
        let motion = rpi_testkit::no_alloc(|| plan(&cases, options));
        assert_eq!(motion.synchronization(), Synchronization::Time, "{cases:?}");
        assert!(motion.duration() >= minimum);
        assert!(
            motion
                .axes()
                .iter()
                .all(|profile| profile.duration() == motion.duration())
        );
        assert_valid(&cases, &motion);
        let alone = plan(&cases, together(Synchronization::None, 0.0));
        assert!(motion.duration() >= alone.duration() * (1.0 - 1e-12));
    }
}

#[test]
fn proportional_states_move_on_a_straight_line() {
    let mut random = Random::new(5);
    for _ in 0..count() / 3 {
        let case = Case::random(&mut random);
        let shares = [1.0, random.between(-2.0, 2.0), 0.0];
        let scaled = |state: AxisState, share: f64| AxisState {
            position: state.position * share,
            velocity: state.velocity * share,
            acceleration: state.acceleration * share,
        };
        let cases = shares.map(|share| Case {
            start: scaled(case.start, share),
            target: scaled(case.target, share),
            ..case
        });
        let (start, target, limits) = (
            cases.map(|case| case.start),
            cases.map(|case| case.target),
            cases.map(|case| case.limits),
        );
        let options = together(Synchronization::Phase, 0.0);
        let is_still = |state: &AxisState| state.velocity == 0.0 && state.acceleration == 0.0;
        let Ok(motion) = OnlineMotion::to_position(&start, &target, &limits, options) else {
            continue;
        };
        if is_still(&case.start) && is_still(&case.target) && start != target {
            assert_eq!(motion.synchronization(), Synchronization::Phase, "{case:?}");
        }
        if motion.synchronization() != Synchronization::Phase {
            continue;
        }
        let time = random.unit() * motion.duration();
        let [first, second, third] = motion.state_at(time);
        let size = 1.0 + first.position.abs() + case.start.position.abs() + time * time;
        assert!(
            (second.position - shares[1] * first.position).abs() <= 1e-9 * size,
            "{case:?}"
        );
        assert_eq!(third.velocity, 0.0);
    }
}

#[test]
fn extrema_enclose_the_positions() {
    let mut random = Random::new(6);
    for _ in 0..count() {
        let case = Case::random(&mut random);
        let motion = case
            .plan(MotionOptions::default())
            .expect("the request is valid");
        let profile = &motion.axes()[0];
        let [extrema] = motion.position_extrema();
        let slack = 1.1e-8
            + 1e-12 * (1.0 + extrema.min.abs() + extrema.max.abs()) * motion.duration().max(1.0);
        for _ in 0..20 {
            let position = profile.state_at(random.unit() * motion.duration()).position;
            assert!(
                position >= extrema.min - slack && position <= extrema.max + slack,
                "{case:?}"
            );
        }
        for (time, position) in [
            (extrema.time_of_min, extrema.min),
            (extrema.time_of_max, extrema.max),
        ] {
            assert!(
                (profile.state_at(time).position - position).abs() <= slack,
                "{case:?}"
            );
        }
    }
}
