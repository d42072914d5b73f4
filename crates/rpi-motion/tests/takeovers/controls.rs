//! Override and pause at random moments: on the path, within all limits, and to the end all the same.

use crate::random::{self, Kind, Random};
use crate::watch::{PERIOD, Watch};
use crate::{ARMS, number};
use rpi_kin::{ArmModel, Pose};
use rpi_motion::{Arm, Controls, MotionCore, Path, check_path};

/// Random controls, and the cycle until which they hold.
fn changed(cycle: usize, random: &mut Random) -> (usize, Controls) {
    // Every few cycles: as if most plans came too late.
    let often = random.unit() < 0.5;
    let until = cycle + 1 + random.below(if often { 4 } else { 300 });
    // Undisturbed after 10 s, so that each motion ends.
    let calm = cycle > 10_000;
    let share = random.between(-0.1, 1.1).clamp(0.0, 1.0);
    let controls = Controls {
        speed_share: if calm { 1.0 } else { share },
        paused: !calm && random.unit() < 0.3,
    };
    (until, controls)
}

/// One motion from rest under random controls. Returns false if this try makes no motion.
fn disturbed(model: &'static ArmModel, random: &mut Random) -> bool {
    let arm = Arm::new(model, Pose::identity(), &[]);
    let start = random::joints(model, random);
    let kind = if random.unit() < 0.5 {
        Kind::Line
    } else {
        Kind::Arc
    };
    let Some(path) = random::path(model, &arm, kind, &start, random) else {
        return false;
    };
    let requested = random::requested(kind, random, false);
    if check_path(&arm, path, &start, requested).is_err() {
        return false;
    }
    let mut watch = Watch::standing(&start);
    let mut core = MotionCore::new(arm, PERIOD);
    core.begin(path, &watch.state(), requested)
        .expect("the check accepted it");
    let mut controls = Controls::default();
    let (mut until, mut last) = (0, 0.0);
    for cycle in 0..200_000 {
        if cycle >= until {
            (until, controls) = changed(cycle, random);
        }
        let at = core.next_set_point(controls).expect("the path was checked");
        watch.push(&arm, &at.joints);
        assert!(
            at.path.s >= last - 1e-12,
            "the path is never left backwards: {} after {last}",
            at.path.s
        );
        last = at.path.s;
        if let Path::Tool(tool) = &path {
            let off = arm.forward(&at.joints).translation.vector
                - tool.pose(at.path.s).translation.vector;
            assert!(off.norm() < 1e-9, "off the path by {}", off.norm());
        }
        assert!(
            watch.is_within(),
            "{} {path:?} {controls:?} {:?}",
            model.id,
            watch.worst
        );
        if at.done {
            return true;
        }
    }
    panic!("{} did not arrive on {path:?}", model.id);
}

#[test]
fn override_and_pause_keep_the_path_and_every_limit() {
    let count = number("RPI_DISTURBED", 10);
    let mut random = Random::new(number("RPI_SEED", 1));
    for model in ARMS {
        let mut done = 0;
        while done < count {
            done += u64::from(disturbed(model, &mut random));
        }
    }
}

#[test]
fn a_pause_ends_at_rest_and_stays_there() {
    let model = ARMS[1];
    let arm = Arm::new(model, Pose::identity(), &[]);
    let start = [0.1, -1.6, 1.9, 0.2, 0.6, 0.1, 0.0];
    let from = arm.forward(&start);
    let mut to = from;
    to.translation.vector.y += 0.2;
    let requested = random::requested(Kind::Line, &mut Random::new(1), true);
    let mut core = MotionCore::new(arm, PERIOD);
    core.begin(
        Path::line(&from, &to),
        &rpi_motion::JointState::at_rest(start),
        requested,
    )
    .expect("reachable");
    let mut cycles = |count: usize, paused: bool| {
        let controls = Controls {
            paused,
            ..Controls::default()
        };
        (0..count)
            .map(|_| core.next_set_point(controls).expect("on the path"))
            .last()
            .expect("a cycle")
    };
    let moving = cycles(500, false);
    assert!(moving.path.velocity > 0.1);
    let resting = cycles(2000, true);
    assert_eq!(
        (resting.path.velocity, resting.path.acceleration),
        (0.0, 0.0)
    );
    assert_eq!(cycles(100, true).joints, resting.joints);
    assert!(!resting.done && cycles(5000, false).done);
}
