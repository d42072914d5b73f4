//! Tests of the closed forms for six-axis arms: exactness, completeness and choice by the hint.

mod common;

use common::{Random, distance, largest};
use rpi_kin::angle::{turn_within, wrap};
use rpi_kin::model::InverseKinematics;
use rpi_kin::models::{kuka_kr, universal_robots};
use rpi_kin::six_axis::{Joints, Solutions};
use rpi_kin::{ArmModel, AxisLimits, InverseKinematicsError, Range, to_transform};

const ARMS: [&ArmModel; 3] = [
    &kuka_kr::KR_6_R900,
    &kuka_kr::KR_16_2,
    &universal_robots::UR5E,
];
const EXACT: f64 = 1e-9;

fn solutions(arm: &ArmModel, joints: &Joints, hint: &Joints) -> Solutions {
    let flange = to_transform(&arm.forward(joints));
    match arm.inverse {
        InverseKinematics::Opw(geometry) => geometry.solutions(&flange, hint),
        InverseKinematics::Ur(geometry) => geometry.solutions(&flange, hint),
        _ => panic!("{} has six axes", arm.id),
    }
    .expect("finite")
}

#[test]
fn every_solution_reaches_the_pose_and_one_is_where_it_came_from() {
    let mut random = Random(11);
    for arm in ARMS {
        for _ in 0..10_000 {
            let joints: Joints = random.joints(arm.limits);
            let pose = arm.forward(&joints);
            let all = solutions(arm, &joints, &[0.0; 6]);
            let existing = all
                .iter()
                .filter(|one| one.iter().all(|joint| joint.is_finite()));
            assert!(existing.clone().count() >= 2, "{}: {joints:?}", arm.id);
            let mut nearest = f64::INFINITY;
            for one in existing {
                let error = distance(&arm.forward(one), &pose);
                assert!(
                    error < EXACT,
                    "{}: {error:e} off: {one:?} for {joints:?}",
                    arm.id
                );
                let off = one
                    .iter()
                    .zip(&joints)
                    .map(|(one, joint)| wrap(one - joint).abs());
                nearest = nearest.min(off.fold(0.0, f64::max));
            }
            assert!(
                nearest < 1e-5,
                "{}: {joints:?} is not among {all:?}",
                arm.id
            );
        }
    }
}

#[test]
fn a_pose_with_its_own_joints_as_hint_gives_these_joints() {
    let mut random = Random(12);
    for arm in ARMS {
        for _ in 0..10_000 {
            let joints: Joints = random.joints(arm.limits);
            let found = arm
                .inverse(&arm.forward(&joints), &joints, arm.limits)
                .expect("reachable");
            assert!(
                largest(&found, &joints) < 1e-5,
                "{}: {joints:?} became {found:?}",
                arm.id
            );
        }
    }
}

#[test]
fn results_are_in_range_from_any_hint() {
    let mut random = Random(13);
    for arm in ARMS {
        for _ in 0..10_000 {
            let (joints, hint): (Joints, Joints) =
                (random.joints(arm.limits), random.joints(arm.limits));
            let pose = arm.forward(&joints);
            let found = arm.inverse(&pose, &hint, arm.limits).expect("reachable");
            assert!(distance(&arm.forward(&found), &pose) < EXACT);
            let mut ranges = found.iter().zip(arm.limits);
            assert!(
                ranges.all(|(joint, axis)| axis.position.contains(*joint)),
                "{}: {found:?}",
                arm.id
            );
        }
    }
}

/// Returns the solution nearest to `hint` among all of them, by its definition.
fn nearest_of_all(all: &Solutions, hint: &Joints, limits: &[AxisLimits]) -> Option<Joints> {
    let turned = all.iter().filter_map(|joints| {
        let mut turned = *joints;
        for (axis, joint) in turned.iter_mut().enumerate() {
            *joint = turn_within(*joint, hint[axis], limits[axis].position)?;
        }
        Some(turned)
    });
    turned.min_by(|a, b| largest(a, hint).total_cmp(&largest(b, hint)))
}

#[test]
fn the_chosen_solution_is_the_nearest_of_all() {
    let mut random = Random(14);
    for arm in ARMS {
        for round in 0..30_000 {
            let joints: Joints = random.joints(arm.limits);
            let mut hint: Joints = random.joints(arm.limits);
            if round % 3 == 0 {
                hint = core::array::from_fn(|axis| joints[axis] + 1e-3 * hint[axis]);
            }
            // Ranges of any width, so that some poses have no solution within them.
            let limits: Vec<AxisLimits> = (arm.limits.iter().zip(joints))
                .map(|(axis, joint)| {
                    let upper = joint + 3.0 * f64::from(round % 7) * (hint[0].abs() - 0.1);
                    let position = match round % 5 {
                        0 => Range {
                            lower: joint - 1.0,
                            upper,
                        },
                        _ => axis.position,
                    };
                    AxisLimits { position, ..*axis }
                })
                .collect();
            let all = solutions(arm, &joints, &hint);
            let expected = nearest_of_all(&all, &hint, &limits);
            let found = arm.inverse(&arm.forward(&joints), &hint, &limits);
            let found = found.map(|found| core::array::from_fn(|axis| found[axis]));
            let expected = expected.ok_or(InverseKinematicsError::OutOfLimits);
            assert_eq!(found, expected, "{} at {joints:?} from {hint:?}", arm.id);
        }
    }
}

#[test]
fn a_straight_wrist_keeps_the_turns_of_the_hint() {
    for arm in ARMS {
        let joints = [0.3, -0.8, 0.9, 0.7, 0.0, -0.4];
        let found = arm
            .inverse(&arm.forward(&joints), &joints, arm.limits)
            .expect("reachable");
        assert!(largest(&found, &joints) < 1e-6, "{}: {found:?}", arm.id);
    }
}

#[test]
fn far_away_and_nonsense_are_refused() {
    for arm in ARMS {
        let hint = [0.0, -1.0, 1.0, 0.0, 0.5, 0.0];
        let mut pose = arm.forward(&hint);
        pose.translation.vector.x += 9.0;
        assert_eq!(
            arm.inverse(&pose, &hint, arm.limits),
            Err(InverseKinematicsError::OutOfReach)
        );
        pose.translation.vector.x = f64::NAN;
        assert_eq!(
            arm.inverse(&pose, &hint, arm.limits),
            Err(InverseKinematicsError::NotFinite)
        );
        let bad = [f64::INFINITY; 6];
        assert_eq!(
            arm.inverse(&arm.forward(&hint), &bad, arm.limits),
            Err(InverseKinematicsError::NotFinite)
        );
        assert!(
            to_transform(&arm.forward(&bad))
                .translation
                .vector
                .x
                .is_nan()
        );
    }
}

#[test]
fn an_arm_without_an_inverse_says_so() {
    let unit = &rpi_kin::models::linear::LINEAR_UNIT;
    let found = unit.inverse(&unit.forward(&[0.5]), &[0.5], unit.limits);
    assert_eq!(found, Err(InverseKinematicsError::NoClosedForm));
}

#[test]
fn an_arm_without_a_closed_form_is_solved_by_iterations() {
    let panda = rpi_kin::models::by_id("franka-panda").expect("known");
    let joints = [0.1, 0.2, -0.3, -1.5, 0.4, 1.5, 0.6];
    // Axis 3 is held.
    let hint = [0.2, 0.1, -0.3, -1.4, 0.5, 1.6, 0.5];
    let found = panda.inverse(&panda.forward(&joints), &hint, panda.limits);
    let found = found.expect("near to the hint");
    for axis in 0..7 {
        assert!((found[axis] - joints[axis]).abs() < 1e-9, "{found:?}");
    }
}
