//! A takeover in motion is faster than to stop, to go to the start of the path and to go on from there; and the tool stays
//! within its bounds on the way where that is possible.

use crate::random::{Kind, Random};
use crate::watch::PERIOD;
use crate::{ARMS, Counts, Motion, motion, number, random};
use rpi_kin::state_to_rest::Bounds;
use rpi_kin::{ArmModel, Pose};
use rpi_motion::{
    Arm, Controls, EntryPreference, JointState, Joints, MotionCore, Path, check_path, path_start,
};

/// Bounds that leave a joint line to the limits of the axes.
const FAST: Bounds = Bounds {
    speed: 10.0,
    acceleration: 100.0,
    jerk: 1000.0,
};

/// Cycles until the motion of a core is done.
fn cycles_to_end(core: &mut MotionCore) -> usize {
    (1..100_000)
        .find(|_| {
            let at = core.next_set_point(Controls::default());
            at.expect("the path was checked").done
        })
        .expect("every motion arrives")
}

/// Cycles to stop, to go to the start of the path, and to follow it from rest.
fn cycles_with_stop(arm: &Arm, state: &JointState, next: &Motion) -> usize {
    let at = |joints: &Joints| JointState::at_rest(*joints);
    // A joint line of nearly no length along axis 1 leaves the whole stop to be made.
    let mut aside = state.position;
    aside[0] += 1e-9;
    let still = Path::joint_line(&state.position, &aside, 1);
    let stop = path_start(
        arm,
        &JointState {
            acceleration: [0.0; 7],
            ..*state
        },
        &still,
    );
    let mut core = MotionCore::new(*arm, PERIOD);
    core.begin_hold(&stop, state).expect("finite");
    let mut cycles = cycles_to_end(&mut core);
    let back = Path::joint_line(&stop, &next.start, arm.axes());
    if back.length() > 1e-6 {
        core.begin(back, &at(&stop), FAST).expect("reachable");
        cycles += cycles_to_end(&mut core);
    }
    core.begin(next.path, &at(&next.start), next.requested)
        .expect("checked");
    cycles + cycles_to_end(&mut core)
}

/// Durations of takeovers beside those with a stop.
fn shares(model: &'static ArmModel, count: usize, random: &mut Random) -> Vec<f64> {
    let arm = Arm::new(model, Pose::identity(), &[]);
    let mut shares = Vec::new();
    while shares.len() < count {
        let start = JointState::at_rest(random::joints(model, random));
        let mut core = MotionCore::new(arm, PERIOD);
        let mut counts = Counts::default();
        let Some(first) = motion(model, &arm, &start, random, &mut counts) else {
            continue;
        };
        core.begin_at(first.path, &first.start, &start, first.requested)
            .expect("checked");
        for _ in 0..50 + random.below(600) {
            core.next_set_point(Controls::default()).expect("checked");
        }
        let state = core.state();
        let is_moving = state.velocity.iter().any(|velocity| velocity.abs() > 0.02);
        let next = motion(model, &arm, &state, random, &mut counts).filter(|_| is_moving);
        let Some(next) = next else { continue };
        let with_stop = cycles_with_stop(&arm, &state, &next);
        core.begin_at(next.path, &next.start, &state, next.requested)
            .expect("checked");
        shares.push(cycles_to_end(&mut core) as f64 / with_stop as f64);
    }
    shares
}

#[test]
fn a_takeover_is_faster_than_a_stop() {
    let count = number("RPI_DURATIONS", 12) as usize;
    let mut random = Random::new(number("RPI_SEED", 31));
    let mut all = Vec::new();
    for model in ARMS {
        let mut own = shares(model, count, &mut random);
        own.sort_by(f64::total_cmp);
        println!(
            "{}: median {:.3}, worst {:.3}",
            model.id,
            own[own.len() / 2],
            own[own.len() - 1]
        );
        all.extend(own);
    }
    all.sort_by(f64::total_cmp);
    let median = all[all.len() / 2];
    println!("median {median:.3}");
    assert!(median <= 0.85, "{median}");
}

/// Lines that turn off a line: with the preference for the tool's bounds they are kept, and without it the excess is
/// reported.
#[test]
fn lines_that_turn_off_lines_keep_the_bounds_of_the_tool() {
    let mut random = Random::new(number("RPI_SEED", 41));
    let mut kept = 0;
    for model in ARMS {
        let arm = Arm::new(model, Pose::identity(), &[]);
        let (mut within, mut tries, mut exceeded) = (0, 0, 0);
        while tries < 6 {
            let start = random::joints(model, &mut random);
            let requested = random::requested(Kind::Line, &mut random, true);
            let Some(first) = random::path(model, &arm, Kind::Line, &start, &mut random)
                .filter(|path| check_path(&arm, *path, &start, requested).is_ok())
            else {
                continue;
            };
            let mut core = MotionCore::new(arm, PERIOD);
            core.begin(first, &JointState::at_rest(start), requested)
                .expect("checked");
            for _ in 0..600 {
                core.next_set_point(Controls::default()).expect("checked");
            }
            let state = core.state();
            let here = state.position;
            let Some(next) = random::path(model, &arm, Kind::Line, &here, &mut random)
                .filter(|path| check_path(&arm, *path, &here, requested).is_ok())
            else {
                continue;
            };
            tries += 1;
            let most = |preference: EntryPreference| {
                let mut core = core.clone();
                core.set_entry_preference(preference);
                core.begin(next, &state, requested).expect("checked");
                let _ = cycles_to_end(&mut core);
                core.tool_shares_on_entry().into_iter().fold(0.0, f64::max)
            };
            within += u32::from(most(EntryPreference::WithinToolBounds) <= 1.01);
            exceeded += u32::from(most(EntryPreference::Shortest) > 1.01);
        }
        println!(
            "{}: {within} of {tries} within, {exceeded} exceeded else",
            model.id
        );
        kept += within;
        assert!(exceeded > 0, "{}", model.id);
    }
    assert!(kept >= 10, "{kept}");
}
