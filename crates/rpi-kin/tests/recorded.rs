//! Our inverse kinematics against every recorded call of the reference system's: the same branch and the same arm angle.
//!
//! The recorded joints come out of arc cosines and are off their own pose by up to 1e-8, so bits cannot agree; what is
//! asked for is agreement within that error. Where the reference hands on joints that are out of range, jumps to another
//! branch to keep the arm angle, or misses the pose (it rounds targets just out of reach inwards), we differ on purpose;
//! such rows are counted apart.

mod common;
mod rows;

use common::{distance, largest};
use rows::Row;
use rpi_kin::models::lbr::{IIWA_7, IIWA_14, LWR_4_PLUS};
use rpi_kin::{ArmModel, Pose};
use std::f64::consts::{PI, TAU};

/// How a recorded row compares with ours.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Verdict {
    /// All joints agree within 1e-9 rad.
    Exact,
    /// They agree within what the recorded joints are off their own pose, amplified near straight joints.
    Rounding,
    /// Both say: out of reach.
    BothUnreachable,
    /// The recorded joints are out of range, so ours swing the elbow.
    TheirsOutOfRange,
    /// The recorded joints jump to another branch where ours swing the elbow and stay near the hint.
    TheirsJump,
    /// The recorded joints miss the pose, which is out of reach.
    TheirsInexact,
    /// None of these.
    Different,
}

#[test]
fn recorded_calls_are_reproduced() {
    let Some(nets) = rpi_testkit::shared_path("nets") else {
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

/// The nets name their robots freely; which model stands behind a name follows from the recorded pose and joints.
fn arm_of(row: &Row) -> &'static ArmModel {
    let off = |arm: &ArmModel| {
        (forward(arm, &row.joints).translation.vector - row.flange.translation.vector).amax()
    };
    let all = [&LWR_4_PLUS, &IIWA_7, &IIWA_14];
    all.into_iter()
        .min_by(|one, other| off(one).total_cmp(&off(other)))
        .unwrap_or(&LWR_4_PLUS)
}

/// The reference turns an iiwa's flange frame by half a turn about its z, against the vendor's.
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
    // What a pose is off, a nearly straight joint makes larger in its neighbours' turns.
    let bend = [1, 3, 5]
        .map(|axis| libm::sin(row.joints[axis]).abs())
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

/// How far the recorded joints are off the pose they were to reach.
fn miss(arm: &ArmModel, row: &Row) -> f64 {
    distance(&forward(arm, &row.joints), &row.flange)
}

/// Largest difference of two sets of joints, whole turns left aside.
fn angular(one: &[f64; 7], other: &[f64; 7]) -> f64 {
    let turns = one
        .iter()
        .zip(other)
        .map(|(one, other)| (one - other).rem_euclid(TAU));
    turns.map(|turn| turn.min(TAU - turn)).fold(0.0, f64::max)
}
