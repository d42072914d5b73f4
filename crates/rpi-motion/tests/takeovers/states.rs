//! The state that the core gives at its last set-point is the exact one, also on the way on to a path.

use crate::random::Random;
use crate::watch::PERIOD;
use crate::{ARMS, Counts, any, motion, number, random};
use rpi_kin::Pose;
use rpi_motion::{Arm, Controls, JointState, MotionCore};
use rpi_testkit::no_alloc;

/// Excess of the next set-point beyond the parabola of a state, as a share of what a period of the greatest jerk makes.
fn excess(arm: &Arm, state: &JointState, next: &[f64]) -> f64 {
    /// Rounding of the inverse, rad.
    const ROUNDING: f64 = 1e-14;
    let axes = arm.limits().iter().enumerate();
    let share = |(axis, limits): (usize, &rpi_kin::AxisLimits)| {
        let half = state.acceleration[axis] * PERIOD / 2.0;
        let parabola = state.position[axis] + PERIOD * (state.velocity[axis] + half);
        let most = limits.jerk * PERIOD * PERIOD * PERIOD / 6.0;
        ((next[axis] - parabola).abs() - ROUNDING) / most
    };
    axes.map(share).fold(0.0, f64::max)
}

#[test]
fn the_next_set_point_is_within_a_period_of_jerk_of_the_state() {
    let mut random = Random::new(number("RPI_SEED", 51));
    for model in ARMS {
        let arm = Arm::new(model, Pose::identity(), &[]);
        let mut core = MotionCore::new(arm, PERIOD);
        let mut state = JointState::at_rest(random::joints(model, &mut random));
        let mut worst = 0.0f64;
        for _ in 0..10 {
            let mut counts = Counts::default();
            let Some(next) = motion(model, &arm, &state, &mut random, &mut counts) else {
                break;
            };
            core.begin_at(next.path, &next.start, &state, next.requested)
                .expect("checked");
            for _ in 0..any(&mut random) {
                let at = core.next_set_point(Controls::default()).expect("checked");
                worst = worst.max(excess(&arm, &state, &at.joints));
                state = no_alloc(|| core.state());
            }
        }
        assert!(worst > 0.1 && worst < 1.001, "{}: {worst}", model.id);
    }
}
