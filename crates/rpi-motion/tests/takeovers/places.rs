//! Places that are hard for an arm: singular wrist, outstretched arm, kinks of the elbow; and an easy line, whose
//! duration is that of its bounds.

use crate::ARMS;
use crate::random::{self, Kind, Random};
use crate::watch::{PERIOD, Watch};
use nalgebra::{Translation3, Vector3};
use rpi_kin::state_to_rest::{AxisState, Bounds, StateToRestProfile};
use rpi_kin::{ArmModel, Pose};
use rpi_motion::{Arm, Controls, Joints, MotionCore, Path, PathErrorKind, check_path};

pub(crate) const DEFAULT: Bounds = Bounds {
    speed: 0.25,
    acceleration: 0.5,
    jerk: 5.0,
};

fn moved(from: &Pose, way: Vector3<f64>) -> Pose {
    Pose::from_parts(
        Translation3::from(from.translation.vector + way),
        from.rotation,
    )
}

/// Follows a path from rest to its end, within all limits. Returns the duration, s, and whether the arm stood still on the
/// way.
pub(crate) fn followed(model: &'static ArmModel, path: Path, start: &Joints) -> (f64, bool) {
    let arm = Arm::new(model, Pose::identity(), &[]);
    let mut core = MotionCore::new(arm, PERIOD);
    let mut watch = Watch::standing(start);
    core.begin(path, &watch.state(), DEFAULT).expect("checked");
    let mut stood = false;
    for cycle in 1..60_000 {
        let at = core
            .next_set_point(Controls::default())
            .expect("the path was checked");
        watch.push(&arm, &at.joints);
        assert!(watch.is_within(), "{} {:?}", model.id, watch.worst);
        if at.done {
            return (f64::from(cycle) * PERIOD, stood);
        }
        stood |= cycle > 20 && at.path.velocity == 0.0;
    }
    panic!("{} did not arrive on {path:?}", model.id);
}

/// Lines past the singularity of the wrist, at some distances from it.
#[test]
fn a_line_past_a_singular_wrist_is_refused_with_its_place_or_slowed() {
    let (mut refused, mut passed) = (0, 0);
    for model in &ARMS[1..3] {
        let arm = Arm::new(model, Pose::identity(), &[]);
        // Axis 5 at 0: the wrist is singular here.
        let singular = [0.1, -1.5, 1.7, 0.3, 0.0, 0.1, 0.0];
        let place = arm.forward(&singular);
        for distance in [1e-4, 3e-4, 1e-3, 3e-3, 1e-2] {
            let aside = moved(&place, Vector3::new(0.0, 0.0, distance));
            let (from, to) = (
                moved(&aside, Vector3::new(0.0, -0.1, 0.0)),
                moved(&aside, Vector3::new(0.0, 0.1, 0.0)),
            );
            let mut near = singular;
            near[4] = 0.1;
            let Ok((start, _)) = arm.inverse(&from, &near, 0.0) else {
                continue;
            };
            let path = Path::line(&from, &to);
            match check_path(&arm, path, &start, DEFAULT) {
                Ok(_) => {
                    passed += 1;
                    assert!(!followed(model, path, &start).1, "{} stood", model.id);
                }
                Err(error) => {
                    refused += 1;
                    assert!((0.0..0.2).contains(&error.s), "{error}");
                }
            }
        }
    }
    println!("{passed} passed, {refused} refused");
    assert!(passed > 0);
}

/// A line that leaves the reach of the arm is refused where it does, and one that ends just within is followed.
#[test]
fn a_line_to_the_outstretched_arm_is_refused_where_the_reach_ends() {
    let model = ARMS[1];
    let arm = Arm::new(model, Pose::identity(), &[]);
    let start = [0.1, -0.6, 0.9, 0.2, 0.6, 0.1, 0.0];
    let from = arm.forward(&start);
    let outwards = Vector3::new(from.translation.vector.x, from.translation.vector.y, 0.0);
    let outwards = outwards.normalize();
    let line = |length: f64| Path::line(&from, &moved(&from, outwards * length));
    let error = check_path(&arm, line(0.8), &start, DEFAULT).expect_err("too far");
    assert!(
        matches!(
            error.kind,
            PathErrorKind::NoInverse(_) | PathErrorKind::Unresolved { .. }
        ),
        "{error}"
    );
    let near = line(error.s - 2e-3);
    if check_path(&arm, near, &start, DEFAULT).is_ok() {
        assert!(!followed(model, near, &start).1);
    }
    let safe = line(error.s * 0.9);
    check_path(&arm, safe, &start, DEFAULT).expect("within reach");
    assert!(!followed(model, safe, &start).1);
}

/// The ranges of the elbow make kinks in the path of the joints: such lines are refused, or followed without a stop.
#[test]
fn lines_of_redundant_arms_with_a_bent_elbow_never_stop() {
    let mut random = Random::new(23);
    for model in [ARMS[0], ARMS[3]] {
        let arm = Arm::new(model, Pose::identity(), &[]);
        let mut followed_lines = 0;
        while followed_lines < 8 {
            let mut start = random::joints(model, &mut random);
            let elbow = model.limits[3].position;
            // Near to the end of the range of axis 4.
            start[3] = elbow.upper - random.between(0.05, 0.3);
            let Some(path) = random::path(model, &arm, Kind::Line, &start, &mut random) else {
                continue;
            };
            if check_path(&arm, path, &start, DEFAULT).is_ok() {
                followed_lines += 1;
                assert!(!followed(model, path, &start).1, "{} {path:?}", model.id);
            }
        }
    }
}

#[test]
fn a_straight_line_takes_as_long_as_its_bounds_and_one_period() {
    let model = ARMS[1];
    let arm = Arm::new(model, Pose::identity(), &[]);
    let start = [0.1, -1.6, 1.9, 0.2, 0.6, 0.1, 0.0];
    let from = arm.forward(&start);
    for length in [0.02, 0.1, 0.25] {
        let path = Path::line(&from, &moved(&from, Vector3::new(0.0, length, 0.0)));
        let least = StateToRestProfile::new(AxisState::default(), length, DEFAULT)
            .expect("positive bounds")
            .duration();
        let (duration, _) = followed(model, path, &start);
        println!("{length} m: {duration} s, at least {least}");
        // The end of a period is the first time at which the arm can be seen at rest.
        assert!(duration <= least + PERIOD + 1e-9 && duration >= least - PERIOD);
    }
}

/// With a period of 4 ms or more, every cycle makes a plan, and must compute nodes all the same.
#[test]
fn long_lines_arrive_at_any_period() {
    let model = ARMS[1];
    let arm = Arm::new(model, Pose::identity(), &[]);
    let start = [0.1, -1.6, 1.9, 0.2, 0.6, 0.1, 0.0];
    let from = arm.forward(&start);
    let path = Path::line(&from, &moved(&from, Vector3::new(0.0, 0.4, 0.0)));
    for period in [5e-4, 2e-3, 4e-3, 8e-3] {
        let mut core = MotionCore::new(arm, period);
        let state = rpi_motion::JointState::at_rest(start);
        core.begin(path, &state, DEFAULT).expect("reachable");
        let cycles = (1..).find(|_| {
            let at = core.next_set_point(Controls::default());
            at.expect("on the path").done
        });
        let duration = cycles.map_or(0.0, |cycles| f64::from(cycles) * period);
        println!("period {period} s: {duration} s");
        assert!(
            (2.2..2.4).contains(&duration),
            "period {period}: {duration}"
        );
    }
}
