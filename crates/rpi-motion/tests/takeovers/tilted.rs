//! Chains of default lines with tilted tools: each line is refused before it moves, with its place and its cause, or runs
//! through; none stops in motion.

use crate::random::{self, Kind, Random};
use crate::watch::{PERIOD, Watch};
use crate::{ARMS, number};
use nalgebra::UnitQuaternion;
use rpi_kin::{ArmModel, InverseKinematicsError, Pose};
use rpi_motion::{Arm, Controls, JointState, MotionCore, Path, PathErrorKind, check_path};
use std::collections::BTreeMap;

/// Number of lines of a chain.
const LINES: usize = 6;

/// Greatest angle by which a line turns the tool, rad.
const TILT: f64 = 1.2;

/// A line in a random direction, of 50 to 400 mm, during which the tool tilts.
fn tilting_line(arm: &Arm, state: &JointState, random: &mut Random) -> Path {
    let here = arm.forward(&state.position);
    let way = random.direction() * random.between(0.05, 0.4);
    let tilt = UnitQuaternion::from_scaled_axis(random.direction() * random.between(0.2, TILT));
    let to = Pose::from_parts((here.translation.vector + way).into(), tilt * here.rotation);
    Path::line(&here, &to)
}

/// Counts of what happened to the lines.
#[derive(Default, Debug)]
struct Outcomes {
    run_through: usize,
    refused: BTreeMap<String, usize>,
}

fn chain(model: &'static ArmModel, random: &mut Random, outcomes: &mut Outcomes) {
    let arm = Arm::new(model, Pose::identity(), &[]);
    let mut watch = Watch::standing(&random::joints(model, random));
    let mut core = MotionCore::new(arm, PERIOD);
    let mut state = watch.state();
    for _ in 0..LINES {
        let path = tilting_line(&arm, &state, random);
        let requested = random::requested(Kind::Line, random, true);
        if let Err(error) = check_path(&arm, path, &state.position, requested) {
            assert!((0.0..=path.length()).contains(&error.s), "{error}");
            let name = match error.kind {
                PathErrorKind::NoInverse(InverseKinematicsError::OutOfReach) => "out of reach",
                PathErrorKind::OutOfRange { axis } if axis < arm.axes() => "out of range",
                PathErrorKind::ConfigurationChange { axis } if axis < arm.axes() => "configuration",
                PathErrorKind::Unresolved { axis } if axis < arm.axes() => "singular",
                _ => panic!("neither an axis nor the reach: {error:?}"),
            };
            *outcomes.refused.entry(name.to_owned()).or_default() += 1;
            continue;
        }
        core.begin(path, &state, requested)
            .expect("the check accepted it");
        let mut has_moved = false;
        let runs_through = (0..60_000).any(|_| {
            let at = core
                .next_set_point(Controls::default())
                .expect("the path was checked");
            watch.push(&arm, &at.joints);
            let is_moving = at.path.velocity > 0.0;
            assert!(
                is_moving || !has_moved || at.done,
                "{} stopped in motion at {} on {path:?}",
                model.id,
                at.path.s
            );
            has_moved |= is_moving;
            at.done
        });
        assert!(runs_through, "{} did not arrive on {path:?}", model.id);
        assert!(watch.is_within(), "{}: {:?}", model.id, watch.worst);
        outcomes.run_through += 1;
        state = core.state();
    }
}

#[test]
fn chains_of_lines_that_tilt_the_tool_run_through_or_are_refused_before_they_move() {
    let mut random = Random::new(number("RPI_SEED", 71));
    for model in ARMS {
        let mut outcomes = Outcomes::default();
        (0..number("RPI_CHAINS", 5)).for_each(|_| chain(model, &mut random, &mut outcomes));
        println!("{}: {outcomes:?}", model.id);
        assert!(outcomes.run_through > 0, "{}", model.id);
    }
}
