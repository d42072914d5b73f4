//! What the verification accepts, a much finer look accepts, too: velocity, acceleration and jerk of every axis every
//! 10 µs along the held brake of random motions.

use crate::random::{self, Random};
use crate::watch::PERIOD;
use crate::{ARMS, Counts, motion, number};
use rpi_kin::{ArmModel, Pose};
use rpi_motion::{Arm, Controls, JointState, MotionCore};

/// Time between two looks, s.
const STEP: f64 = 1e-5;

/// Number of looks over which a difference of accelerations gives a jerk: rounding of the accelerations, which are
/// differences of the inverse kinematics, would drown that of a single step.
const SPAN: usize = 40;

/// Share of the jerk limit that rounding of the acceleration may add.
const ROUNDING: f64 = 5e-3;

/// Largest share of a limit of an axis between two states that are `SPAN` steps apart.
fn worst_share(arm: &Arm, before: &JointState, now: &JointState) -> f64 {
    let axes = arm.limits().iter().enumerate();
    axes.map(|(axis, limits)| {
        let jerk = (now.acceleration[axis] - before.acceleration[axis]) / (SPAN as f64 * STEP);
        let shares = [
            now.velocity[axis] / limits.velocity,
            now.acceleration[axis] / limits.acceleration,
            jerk / limits.jerk - ROUNDING * jerk.signum(),
        ];
        shares
            .into_iter()
            .fold(0.0, |most: f64, share| most.max(share.abs()))
    })
    .fold(0.0, f64::max)
}

/// Looks at the way to rest from the present cycle of `core` on. Returns the largest share of a limit.
fn look(arm: &Arm, mut core: MotionCore) -> f64 {
    /// Maximum duration of a look, s; only a part of the long ways to rest is looked at.
    const LONGEST: f64 = 0.2;
    let mut last = [core.braking_state(0.0); SPAN];
    let mut worst = 0.0f64;
    for step in 1..=(LONGEST / STEP) as usize {
        let elapsed = step as f64 * STEP;
        // The inverse kinematics of a set-point is the hint for the next one, as in motion.
        core.braking_set_point(elapsed).expect("verified");
        let now = core.braking_state(elapsed);
        let before = core::mem::replace(&mut last[step % SPAN], now);
        if step >= SPAN {
            worst = worst.max(worst_share(arm, &before, &now));
        }
    }
    worst
}

fn looks(model: &'static ArmModel, count: u64, random: &mut Random) -> f64 {
    let arm = Arm::new(model, Pose::identity(), &[]);
    let mut core = MotionCore::new(arm, PERIOD);
    let mut state = JointState::at_rest(random::joints(model, random));
    let mut worst = 0.0f64;
    for _ in 0..count {
        let Some(next) = motion(model, &arm, &state, random, &mut Counts::default()) else {
            core = MotionCore::new(arm, PERIOD);
            state = JointState::at_rest(random::joints(model, random));
            continue;
        };
        core.begin_at(next.path, &next.start, &state, next.requested)
            .expect("checked");
        for _ in 0..1 + random.below(700) {
            core.next_set_point(Controls::default()).expect("checked");
        }
        worst = worst.max(look(&arm, core.clone()));
        state = core.state();
    }
    worst
}

#[test]
fn the_verification_passes_nothing_that_brute_force_refuses() {
    let mut random = Random::new(number("RPI_SEED", 61));
    for model in ARMS {
        let worst = looks(model, number("RPI_LOOKS", 5), &mut random);
        println!("{}: {worst}", model.id);
        assert!(worst > 0.1 && worst <= 1.0 + 1e-6, "{}: {worst}", model.id);
    }
}
