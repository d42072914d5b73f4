//! Tests of the S-R-S inverse kinematics: exactness, limits, choice by the hint, and errors only where there is no
//! solution.

mod common;

use common::{Random, distance, largest};
use rpi_kin::model::InverseKinematics;
use rpi_kin::models::kuka_lbr::{IIWA_7, IIWA_14, LWR_4_PLUS};
use rpi_kin::srs::{Geometry, Joints};
use rpi_kin::{ArmModel, InverseKinematicsError, Pose, Range, to_pose, to_transform};
use std::f64::consts::{FRAC_PI_2, PI, TAU};

const ARMS: [&ArmModel; 3] = [&LWR_4_PLUS, &IIWA_7, &IIWA_14];
const EXACT: f64 = 1e-9;

fn geometry(arm: &ArmModel) -> Geometry {
    match arm.inverse {
        InverseKinematics::Srs(geometry) => geometry,
        _ => panic!("{} is not an S-R-S arm", arm.id),
    }
}

fn ranges(arm: &ArmModel) -> [Range; 7] {
    std::array::from_fn(|axis| arm.limits[axis].position)
}

fn within(arm: &ArmModel, joints: &Joints) -> bool {
    joints
        .iter()
        .zip(ranges(arm))
        .all(|(joint, range)| range.contains(*joint))
}

/// Solves the pose of `joints` with `hint`. Returns the joint values after a check of exactness and limits.
fn reached(arm: &ArmModel, joints: &Joints, hint: &Joints) -> Joints {
    let pose = arm.forward(joints);
    let found = arm
        .inverse(&pose, hint, arm.limits)
        .unwrap_or_else(|why| panic!("{}: {why:?} for {joints:?} from {hint:?}", arm.id));
    let error = distance(&arm.forward(&found), &pose);
    assert!(
        error < EXACT,
        "{}: {error:e} off at {joints:?} from {hint:?}: {found:?}",
        arm.id
    );
    assert!(within(arm, &found), "{}: out of limits: {found:?}", arm.id);
    found
}

#[test]
fn a_pose_with_its_own_joints_as_hint_gives_these_joints() {
    let mut random = Random(1);
    for arm in ARMS {
        for _ in 0..20_000 {
            let joints: Joints = random.joints(arm.limits);
            let found = reached(arm, &joints, &joints);
            assert!(
                largest(&found, &joints) < 1e-6,
                "{}: {joints:?} became {found:?}",
                arm.id
            );
        }
    }
}

#[test]
fn any_reachable_pose_is_reached_from_any_hint() {
    let mut random = Random(2);
    for arm in ARMS {
        for _ in 0..20_000 {
            let joints: Joints = random.joints(arm.limits);
            let hint: Joints = random.joints(arm.limits);
            let pose = arm.forward(&joints);
            match arm.inverse(&pose, &hint, arm.limits) {
                Ok(_) => drop(reached(arm, &joints, &hint)),
                Err(why) => panic!("{}: {why:?} for {joints:?} from {hint:?}", arm.id),
            }
        }
    }
}

#[test]
fn straight_and_nearly_straight_joints_are_reached_exactly() {
    let mut random = Random(3);
    let bends = [0.0, 1e-16, 1e-13, 1e-12, 1e-11, 1e-9, 1e-8, 1e-6, 1e-3];
    for arm in ARMS {
        for round in 0..20_000 {
            let mut joints: Joints = random.joints(arm.limits);
            for axis in [1, 3, 5] {
                if random.unit() < 0.6 {
                    let sign = if random.unit() < 0.5 { 1.0 } else { -1.0 };
                    joints[axis] = sign * bends[(round + axis) % bends.len()];
                }
            }
            let found = reached(arm, &joints, &joints);
            // The pose does not distinguish two tiny bends; the rotations next to them may then be distributed
            // differently.
            let tiny = [1, 3, 5]
                .into_iter()
                .filter(|axis| joints[*axis].abs() < 1e-5);
            if tiny.count() > 1 {
                continue;
            }
            assert!(
                largest(&found, &joints) < 1e-2,
                "{}: {joints:?} became {found:?}",
                arm.id
            );
        }
    }
}

#[test]
fn a_small_step_of_the_flange_is_a_small_step_of_the_joints() {
    let mut random = Random(4);
    for arm in ARMS {
        for _ in 0..5_000 {
            let mut joints: Joints = random.joints(arm.limits);
            for axis in [1, 3, 5] {
                joints[axis] = 0.3_f64.max(joints[axis].abs()) * joints[axis].signum();
            }
            let near: Joints =
                std::array::from_fn(|axis| joints[axis] + random.between(-1e-5, 1e-5));
            if !within(arm, &near) || shoulder_to_wrist_is_steep(arm, &joints) {
                continue;
            }
            let found = reached(arm, &near, &joints);
            assert!(
                largest(&found, &joints) < 1e-2,
                "{}: {joints:?} became {found:?}",
                arm.id
            );
        }
    }
}

/// Returns whether the wrist is nearly above the shoulder. The arm angle is measured from the vertical plane, which
/// rotates fast there.
fn shoulder_to_wrist_is_steep(arm: &ArmModel, joints: &Joints) -> bool {
    let wrist = arm
        .chain
        .link_frames(joints)
        .nth(4)
        .map(|frame| frame.translation.vector);
    wrist.is_some_and(|wrist| rpi_math::hypot(wrist.x, wrist.y) < 0.05)
}

#[test]
fn the_arm_angle_is_kept_where_limits_allow() {
    let mut random = Random(5);
    for arm in ARMS {
        let (geometry, ranges) = (geometry(arm), ranges(arm));
        let (mut kept, mut moved) = (0, 0);
        for _ in 0..20_000 {
            let pose = arm.chain.flange_pose(&random.joints::<7>(arm.limits));
            let hint: Joints = random.joints(arm.limits);
            let choice = geometry.inverse(&pose, &hint, &ranges).expect("reachable");
            let change = geometry.arm_angle(&choice.joints) - geometry.arm_angle(&hint);
            let off = (change - choice.arm_angle_change + 9.0 * PI).rem_euclid(TAU) - PI;
            assert!(
                off.abs() < 1e-6,
                "{}: says {}, moved {change}",
                arm.id,
                choice.arm_angle_change
            );
            if choice.arm_angle_change == 0.0 {
                kept += 1
            } else {
                moved += 1
            }
        }
        assert!(
            kept > 1000 && moved > 1000,
            "both happen: kept {kept}, moved {moved}"
        );
    }
}

#[test]
fn the_arm_angle_is_moved_no_farther_than_needed() {
    let mut random = Random(6);
    for arm in ARMS {
        let (geometry, ranges) = (geometry(arm), ranges(arm));
        for _ in 0..1_000 {
            let flange = arm.chain.flange_pose(&random.joints::<7>(arm.limits));
            let hint: Joints = random.joints(arm.limits);
            let choice = geometry
                .inverse(&flange, &hint, &ranges)
                .expect("reachable");
            // At half of the way back there is no solution on this branch.
            for part in [0.25, 0.5, 0.9] {
                let angle = choice.arm_angle - choice.arm_angle_change * part;
                let all = geometry.branches(&flange, angle).expect("same reach");
                let there = all[choice.branch.index()];
                let is_in_range =
                    there
                        .iter()
                        .zip(&ranges)
                        .zip(&hint)
                        .all(|((joint, range), hint)| {
                            let turn = rpi_kin::angle::nearest_turn(*joint, *hint);
                            range.shrunk(1e-8).contains(turn)
                        });
                assert!(
                    choice.arm_angle_change == 0.0 || !is_in_range,
                    "{}: {angle} would have done",
                    arm.id
                );
            }
        }
    }
}

#[test]
fn the_elbow_can_be_that_of_other_joints_than_the_hint() {
    let mut random = Random(9);
    for arm in ARMS {
        let (geometry, ranges) = (geometry(arm), ranges(arm));
        let mut kept = 0;
        for _ in 0..2_000 {
            let (joints, elbow): (Joints, Joints) =
                (random.joints(arm.limits), random.joints(arm.limits));
            let flange = arm.chain.flange_pose(&joints);
            let choice = geometry
                .inverse_with_elbow(&flange, &joints, &elbow, &ranges)
                .expect("reachable");
            assert!(distance(&arm.forward(&choice.joints), &to_pose(&flange)) < EXACT);
            if choice.arm_angle_change == 0.0 {
                let off = geometry.arm_angle(&choice.joints) - geometry.arm_angle(&elbow);
                assert!(rpi_kin::angle::wrap(off).abs() < 1e-6, "{}: {off}", arm.id);
                kept += 1;
            }
        }
        assert!(kept > 100, "{}: kept {kept}", arm.id);
    }
}

#[test]
fn all_eight_branches_reach_the_pose_and_differ() {
    let mut random = Random(7);
    for arm in ARMS {
        for _ in 0..2_000 {
            let joints: Joints = random.joints(arm.limits);
            let flange = arm.chain.flange_pose(&joints);
            let all = geometry(arm)
                .branches(&flange, random.between(-PI, PI))
                .expect("reachable");
            for (index, one) in all.iter().enumerate() {
                assert!(distance(&arm.forward(one), &to_pose(&flange)) < EXACT);
                assert!(all[..index].iter().all(|other| largest(one, other) > 1e-3));
            }
        }
    }
}

#[test]
fn outstretched_is_reached_and_a_hair_farther_is_not() {
    for arm in ARMS {
        let straight = [0.0, 0.4, 0.0, 0.0, 0.0, -0.7, 0.0];
        let pose = arm.forward(&reached(arm, &straight, &straight));
        let lean = pose.translation.vector - nalgebra::Vector3::z() * geometry(arm).base;
        let mut beyond = pose;
        beyond.translation.vector += lean.normalize() * 1e-3;
        assert_eq!(
            arm.inverse(&beyond, &straight, arm.limits),
            Err(InverseKinematicsError::OutOfReach)
        );
        assert!(
            arm.inverse_or_nan(&beyond, &straight, arm.limits)
                .iter()
                .all(|joint| joint.is_nan())
        );
    }
}

#[test]
fn what_only_a_joint_out_of_range_could_reach_is_refused() {
    for arm in ARMS {
        // Folded arm: the elbow would have to bend by 170°, but its limit is 120°.
        let folded = [0.3, 0.5, -0.2, 170.0_f64.to_radians(), 0.1, 0.4, 0.0];
        let pose = arm.forward(&folded);
        assert_eq!(
            arm.inverse(&pose, &folded, arm.limits),
            Err(InverseKinematicsError::OutOfLimits)
        );
    }
}

#[test]
fn bad_numbers_are_refused() {
    let arm = &LWR_4_PLUS;
    let good = [0.1; 7];
    let pose = arm.forward(&good);
    for bad in [f64::NAN, f64::INFINITY] {
        let mut hint = good;
        hint[4] = bad;
        assert_eq!(
            arm.inverse(&pose, &hint, arm.limits),
            Err(InverseKinematicsError::NotFinite)
        );
        let mut broken = pose;
        broken.translation.vector.y = bad;
        assert_eq!(
            arm.inverse(&broken, &good, arm.limits),
            Err(InverseKinematicsError::NotFinite)
        );
        let mut turned = to_transform(&pose);
        turned.rotation =
            nalgebra::Rotation3::from_matrix_unchecked(nalgebra::Matrix3::from_element(bad));
        assert_eq!(
            geometry(arm)
                .inverse(&turned, &good, &ranges(arm))
                .map(|choice| choice.joints),
            Err(InverseKinematicsError::NotFinite)
        );
    }
    assert_eq!(
        arm.inverse(&pose, &good[..6], arm.limits),
        Err(InverseKinematicsError::NotFinite)
    );
    assert_eq!(
        arm.inverse(&pose, &good, &arm.limits[..3]),
        Err(InverseKinematicsError::NotFinite)
    );
}

#[test]
fn a_wrist_above_the_shoulder_is_no_special_case() {
    let mut random = Random(8);
    for arm in ARMS {
        let sense = geometry(arm).sense;
        for round in 0..2_000 {
            // The forearm returns as far as the upper arm reaches out, so the wrist is above the shoulder, or nearly
            // so.
            let bend = random.between(0.2, 1.5);
            let lift = geometry(arm).fore * rpi_math::sin(bend)
                / (geometry(arm).upper + geometry(arm).fore * rpi_math::cos(bend));
            let off = [0.0, 1e-15, 1e-12, 1e-10, 1e-8, 1e-5][round % 6];
            let mut joints: Joints = [random.between(-2.0, 2.0), 0.0, 0.0, 0.0, 0.3, 0.5, 0.1];
            joints[1] = sense[1] * (rpi_math::atan(lift) + off);
            joints[3] = -sense[3] * bend;
            let found = reached(arm, &joints, &joints);
            assert!(
                largest(&found, &joints) < 1e-4,
                "{}: {joints:?} became {found:?}",
                arm.id
            );
        }
    }
}

#[test]
fn the_senses_of_axis_two_are_the_vendors() {
    let lean = [0.0, FRAC_PI_2, 0.0, 0.0, 0.0, 0.0, 0.0];
    let x = |arm: &ArmModel| -> f64 { arm.forward(&lean).translation.x };
    assert!((x(&IIWA_7) - 0.926).abs() < 1e-12);
    assert!((x(&IIWA_14) - 0.946).abs() < 1e-12);
    assert!((x(&LWR_4_PLUS) + 0.868).abs() < 1e-12);
    let upright = LWR_4_PLUS.forward(&[0.0; 7]);
    assert!(distance(&upright, &Pose::translation(0.0, 0.0, 1.1785)) < 1e-12);
}
