//! Paths at the ends of the ranges of axes: each is refused before it moves, or followed to its end.

use crate::places::{DEFAULT, followed};
use crate::random::{self, Random};
use crate::{ARMS, watch::PERIOD};
use nalgebra::{Point3, Vector3};
use rpi_kin::Pose;
use rpi_motion::path::{Arc, ArcOrientation, Piece, ToolPath};
use rpi_motion::{
    Arm, JointState, Joints, MotionCore, MotionError, Path, PathErrorKind, check_path, scan_path,
};

/// A line along axes to the very end of the range of an axis is followed to its end; beyond, it is refused.
#[test]
fn a_joint_line_reaches_the_end_of_a_range_and_not_beyond() {
    for model in ARMS {
        let arm = Arm::new(model, Pose::identity(), &[]);
        for seed in 0..20 {
            let start = random::joints(model, &mut Random::new(5 + seed));
            let axis = seed as usize % arm.axes();
            let mut end = start;
            end[axis] = model.limits[axis].position.upper;
            let to = |end: &Joints| Path::joint_line(&start, end, arm.axes());
            check_path(&arm, to(&end), &start, DEFAULT).expect("within the range");
            assert_eq!(scan_path(&arm, &to(&end), &start), Ok(()));
            followed(model, to(&end), &start);
            end[axis] += 1e-6;
            let error = check_path(&arm, to(&end), &start, DEFAULT).expect_err("beyond the range");
            assert_eq!(error.kind, PathErrorKind::OutOfRange { axis });
            assert!(scan_path(&arm, &to(&end), &start).is_err());
        }
    }
}

/// An arc about axis 1, which alone moves: it ends a little before the end of its range. A path that came within 0.1 mrad
/// of it passed the check, and the motion, which keeps this distance, stood before it for ever.
#[test]
fn an_arc_to_the_end_of_a_range_is_refused_or_followed_to_its_end() {
    let (mut refused, mut passed) = (0, 0);
    for model in ARMS {
        let arm = Arm::new(model, Pose::identity(), &[]);
        let end = model.limits[0].position.upper;
        let mut start = random::joints(model, &mut Random::new(9));
        start[0] = end - 0.3;
        let here = arm.forward(&start);
        let mut centre = Vector3::zeros();
        centre.z = here.translation.vector.z;
        let up = arm_axis(&arm, &start);
        for before in [-1e-5, 1e-5, 5e-5, 9e-5, 1.5e-4, 3e-4, 1e-2] {
            let angle = 0.3 - before;
            let arc = Arc::by_angle(&here, &centre, &up, angle, ArcOrientation::Turning);
            let path = Path::Tool(ToolPath::new(Piece::Arc(arc.expect("an arc"))));
            match check_path(&arm, path, &start, DEFAULT) {
                Ok(_) => {
                    passed += 1;
                    // A redundant arm evades the end with its elbow.
                    assert!(before > 0.0 || arm.axes() == 7, "{}: {before}", model.id);
                    followed(model, path, &start);
                }
                Err(error) => {
                    refused += 1;
                    assert_eq!(
                        error.kind,
                        PathErrorKind::OutOfRange { axis: 0 },
                        "{before}"
                    );
                    assert!(arm.axes() == 7 || scan_path(&arm, &path, &start).is_err());
                }
            }
        }
    }
    assert!(passed >= 4 && refused >= 4, "{passed} {refused}");
}

/// Direction of axis 1 in the base frame, about which the tool turns if this axis moves.
fn arm_axis(arm: &Arm, joints: &Joints) -> Vector3<f64> {
    let mut turned = *joints;
    turned[0] += 0.1;
    let (one, other) = (arm.forward(joints), arm.forward(&turned));
    let turn = (other.rotation * one.rotation.inverse()).scaled_axis();
    assert!(Point3::from(turn.cross(&Vector3::z())).coords.norm() < 1e-9);
    turn.normalize()
}

/// An arm that has come to 0.05 mrad before the end of a range by a joint line goes on from there, and back to there.
#[test]
fn paths_begin_and_turn_back_next_to_the_end_of_a_range() {
    for model in ARMS {
        let arm = Arm::new(model, Pose::identity(), &[]);
        let mut start = random::joints(model, &mut Random::new(9));
        start[0] = model.limits[0].position.upper - 5e-5;
        let here = arm.forward(&start);
        let mut centre = Vector3::zeros();
        centre.z = here.translation.vector.z;
        let back = -arm_axis(&arm, &start);
        let arc = Arc::by_angle(&here, &centre, &back, 0.3, ArcOrientation::Turning);
        let path = Path::Tool(ToolPath::new(Piece::Arc(arc.expect("an arc"))));
        check_path(&arm, path, &start, DEFAULT).expect("away from the end");
        followed(model, path, &start);
    }
}

/// A path that starts outside a range while the arm is inside must not lead the arm out.
#[test]
fn a_path_that_starts_outside_a_range_is_refused() {
    for model in ARMS {
        let arm = Arm::new(model, Pose::identity(), &[]);
        let inside = random::joints(model, &mut Random::new(3));
        let mut outside = inside;
        outside[0] = model.limits[0].position.upper + 0.1;
        let path = Path::joint_line(&outside, &inside, arm.axes());
        let mut core = MotionCore::new(arm, PERIOD);
        let begun = core.begin_at(path, &outside, &JointState::at_rest(inside), DEFAULT);
        let kind = PathErrorKind::OutOfRange { axis: 0 };
        assert!(matches!(begun, Err(MotionError::Path(error)) if error.kind == kind));
        // An arm that is outside may move back.
        core.begin_at(path, &outside, &JointState::at_rest(outside), DEFAULT)
            .expect("the way back");
    }
}

#[test]
fn a_goal_that_is_not_a_number_is_refused() {
    let model = ARMS[0];
    let arm = Arm::new(model, Pose::identity(), &[]);
    let start = random::joints(model, &mut Random::new(3));
    let mut goal = start;
    goal[1] += 0.2;
    goal[2] = f64::NAN;
    let path = Path::joint_line(&start, &goal, arm.axes());
    let mut core = MotionCore::new(arm, PERIOD);
    assert!(
        core.begin(path, &JointState::at_rest(start), DEFAULT)
            .is_err()
    );
    assert!(check_path(&arm, path, &start, DEFAULT).is_err());
}
