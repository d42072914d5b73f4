//! Tests of the closed forms for six-axis arms: exactness, completeness and choice by the hint.

mod common;

use common::{Random, distance, largest};
use rpi_kin::angle::wrap;
use rpi_kin::model::InverseKinematics;
use rpi_kin::models::{kuka_kr, universal_robots};
use rpi_kin::six_axis::{Joints, Solutions};
use rpi_kin::{ArmModel, InverseKinematicsError, to_transform};

const ARMS: [&ArmModel; 3] = [
    &kuka_kr::KR_6_R900,
    &kuka_kr::KR_16_2,
    &universal_robots::UR5E,
];
const EXACT: f64 = 1e-9;

fn solutions(arm: &ArmModel, joints: &Joints, hint: &Joints) -> Solutions {
    let flange = arm.chain.flange_pose(joints);
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
    let hint = [0.2, 0.1, -0.2, -1.4, 0.5, 1.6, 0.6];
    let found = panda.inverse(&panda.forward(&joints), &hint, panda.limits);
    let found = found.expect("near to the hint");
    for axis in 0..7 {
        assert!((found[axis] - joints[axis]).abs() < 1e-9, "{found:?}");
    }
}
