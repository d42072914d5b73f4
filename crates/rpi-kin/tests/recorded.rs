//! Tests of inverse kinematics against all recorded calls of the reference system: same branch and same arm angle.
//!
//! The recorded joint values are results of arc cosines and miss their own pose by up to 1e-8, so they cannot be
//! bit-identical. The tests require agreement within that error. The results differ on purpose where the reference
//! outputs joints out of range, jumps to another branch to keep the arm angle, or misses the pose (it moves targets
//! just out of reach inwards). Such rows are counted separately.

mod common;
mod rows;

use common::{distance, largest};
use rows::Row;
use rpi_kin::models::kuka_lbr::{IIWA_7, IIWA_14, LWR_4_PLUS};
use rpi_kin::{ArmModel, Pose};
use std::f64::consts::{PI, TAU};

/// Result of the comparison of a recorded row with the computed joints.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Verdict {
    /// All joints agree within 1e-9 rad.
    Exact,
    /// All joints agree within the error of the recorded joints, amplified near straight joints.
    Rounding,
    /// Both find the pose out of reach.
    BothUnreachable,
    /// The recorded joints are out of range; the computed ones move the elbow.
    TheirsOutOfRange,
    /// The recorded joints jump to another branch; the computed ones move the elbow and stay near the hint.
    TheirsJump,
    /// The recorded joints miss the pose, which is out of reach.
    TheirsInexact,
    /// None of the others.
    Different,
}

#[test]
fn recorded_calls_are_reproduced() {
    let Some(nets) = rpi_testkit::external_data_path("nets") else {
        return;
    };
    let rows = rows::all(&nets);
    assert!(rows.len() > 1_400, "only {} rows found", rows.len());
    let mut counts = std::collections::BTreeMap::<Verdict, usize>::new();
    for row in &rows {
        let arm = arm_of(row);
        let verdict = verdict(arm, row);
        *counts.entry(verdict).or_default() += 1;
        if verdict == Verdict::Different {
            eprintln!(
                "{} {}: {:?}\n  ours {:?}",
                arm.id,
                row.place,
                row,
                solve(arm, row)
            );
        }
    }
    let count = |verdict| counts.get(&verdict).copied().unwrap_or(0);
    eprintln!("{counts:?} of {}", rows.len());
    assert_eq!(count(Verdict::Different), 0, "{counts:?}");
    let agreeing =
        count(Verdict::Exact) + count(Verdict::Rounding) + count(Verdict::BothUnreachable);
    assert!(agreeing * 100 >= rows.len() * 98, "{counts:?}");
}

/// Returns the arm model of a row. The names of robots in the nets are arbitrary, so the recorded pose and joints
/// identify the model.
fn arm_of(row: &Row) -> &'static ArmModel {
    let off = |arm: &ArmModel| {
        (forward(arm, &row.joints).translation.vector - row.flange.translation.vector).amax()
    };
    let all = [&LWR_4_PLUS, &IIWA_7, &IIWA_14];
    all.into_iter()
        .min_by(|one, other| off(one).total_cmp(&off(other)))
        .unwrap_or(&LWR_4_PLUS)
}

/// Returns the transform from the flange frame of the vendor to that of the reference, which is rotated by half a turn
/// about z for an iiwa.
fn flange_of_reference(arm: &ArmModel) -> Pose {
    let turn = if arm.id == LWR_4_PLUS.id { 0.0 } else { PI };
    Pose::rotation(nalgebra::Vector3::z() * turn)
}

fn forward(arm: &ArmModel, joints: &[f64]) -> Pose {
    arm.forward(joints) * flange_of_reference(arm)
}

fn solve(arm: &ArmModel, row: &Row) -> [f64; 7] {
    let flange = row.flange * flange_of_reference(arm).inverse();
    arm.inverse_or_nan(&flange, &row.hint, arm.limits)
}

fn verdict(arm: &ArmModel, row: &Row) -> Verdict {
    let ours = solve(arm, row);
    let nowhere = |joints: &[f64; 7]| joints.iter().all(|joint| joint.is_nan());
    match (nowhere(&ours), nowhere(&row.joints)) {
        (true, true) => Verdict::BothUnreachable,
        (true, false) if miss(arm, row) > 1e-6 => Verdict::TheirsInexact,
        (false, false) => compared(arm, row, &ours),
        _ => Verdict::Different,
    }
}

fn compared(arm: &ArmModel, row: &Row, ours: &[f64; 7]) -> Verdict {
    let apart = angular(ours, &row.joints);
    let mut limits = row.joints.iter().zip(arm.limits);
    let in_range = limits.all(|(joint, axis)| axis.position.contains(*joint));
    // A nearly straight joint amplifies the error of the pose in the rotations of the adjacent joints.
    let bend = [1, 3, 5]
        .map(|axis| rpi_math::sin(row.joints[axis]).abs())
        .into_iter()
        .fold(1.0, f64::min);
    let rounding = 10.0 * (miss(arm, row) + 1e-8) / bend;
    match () {
        () if apart <= 1e-9 => Verdict::Exact,
        () if apart <= rounding => Verdict::Rounding,
        () if !in_range => Verdict::TheirsOutOfRange,
        () if largest(&row.joints, &row.hint) > largest(ours, &row.hint) + 1.0 => {
            Verdict::TheirsJump
        }
        () => Verdict::Different,
    }
}

/// Returns the distance between the recorded pose and the pose of the recorded joints.
fn miss(arm: &ArmModel, row: &Row) -> f64 {
    distance(&forward(arm, &row.joints), &row.flange)
}

/// Returns the largest difference of two sets of joints, modulo full turns.
fn angular(one: &[f64; 7], other: &[f64; 7]) -> f64 {
    let turns = one
        .iter()
        .zip(other)
        .map(|(one, other)| (one - other).rem_euclid(TAU));
    turns.map(|turn| turn.min(TAU - turn)).fold(0.0, f64::max)
}
