//! The check of a path refuses few of the random lines that have an inverse all along.

use crate::random::{self, Kind, Random};
use crate::{ARMS, number};
use rpi_kin::{ArmModel, Pose};
use rpi_motion::{Arm, Joints, Path, PathError, PathErrorKind, check_path, scan_path};

/// Follows a path in steps of 1 mm with a free arm angle: whether the arm can pass without a jump of an axis.
fn has_inverse(arm: &Arm, path: &Path, start: &Joints) -> bool {
    let Path::Tool(tool) = path else { return true };
    let steps = (path.length() / 1e-3).ceil() as u32;
    let mut joints = *start;
    (0..=steps).all(|k| {
        let pose = tool.pose(path.length() * f64::from(k) / f64::from(steps));
        let angle = arm.arm_angle(&joints).unwrap_or(0.0);
        let Ok((next, _)) = arm.inverse(&pose, &joints, angle) else {
            return false;
        };
        let jump = (0..arm.axes()).any(|axis| (next[axis] - joints[axis]).abs() > 0.1);
        joints = next;
        !jump
    })
}

fn refusals(model: &'static ArmModel, count: u64, random: &mut Random) -> (u64, Vec<PathError>) {
    let arm = Arm::new(model, Pose::identity(), &[]);
    let (mut lines, mut refused) = (0, Vec::new());
    while lines < count {
        let start = random::joints(model, random);
        let Some(path) = random::path(model, &arm, Kind::Line, &start, random) else {
            continue;
        };
        if has_inverse(&arm, &path, &start) {
            lines += 1;
            let requested = random::requested(Kind::Line, random, true);
            refused.extend(check_path(&arm, path, &start, requested).err());
        }
    }
    (lines, refused)
}

#[test]
fn few_lines_with_an_inverse_are_refused() {
    for model in ARMS {
        let (lines, refused) = refusals(model, number("RPI_LINES", 100), &mut Random::new(7));
        let mut kinds = std::collections::BTreeMap::new();
        for error in &refused {
            let name = format!("{:?}", error.kind);
            *kinds
                .entry(name.split([' ', '(']).next().unwrap_or_default().to_owned())
                .or_insert(0) += 1;
        }
        println!(
            "{}: {} of {lines} refused {kinds:?}",
            model.id,
            refused.len()
        );
        assert!(refused.len() as u64 * 20 <= lines, "{}", model.id);
    }
}

/// Lines that begin with an upright upper arm: axes 1 and 3 in line, axis 3 anywhere.
#[test]
fn a_line_begins_with_axis_2_at_zero() {
    let mut random = Random::new(11);
    let redundant = ARMS.into_iter().filter(|model| model.axes() == 7);
    for model in redundant {
        let arm = Arm::new(model, Pose::identity(), &[]);
        let (mut lines, mut refused) = (0, Vec::new());
        while lines < number("RPI_LINES", 100) {
            let mut start = random::joints(model, &mut random);
            start[1] = 0.0;
            let path = random::path(model, &arm, Kind::Line, &start, &mut random);
            let Some(path) = path.filter(|path| has_inverse(&arm, path, &start)) else {
                continue;
            };
            lines += 1;
            let requested = random::requested(Kind::Line, &mut random, true);
            refused.extend(check_path(&arm, path, &start, requested).err());
        }
        println!("{}: {} of {lines} refused", model.id, refused.len());
        refused.iter().for_each(|error| println!("{error:?}"));
        assert!(refused.len() as u64 * 20 <= lines, "{}", model.id);
    }
}

/// What the check of the whole path takes, the look at a few places before the motion takes, too; and it finds most of
/// what the check refuses for reach, ranges and configuration.
#[test]
fn the_look_before_a_motion_agrees_with_the_check() {
    let mut random = Random::new(13);
    for model in ARMS {
        let arm = Arm::new(model, Pose::identity(), &[]);
        let (mut refused, mut seen) = (0, 0);
        for _ in 0..number("RPI_LINES", 100) * 3 {
            let start = random::joints(model, &mut random);
            let Some(path) = random::path(model, &arm, Kind::Line, &start, &mut random) else {
                continue;
            };
            let requested = random::requested(Kind::Line, &mut random, true);
            let scanned = scan_path(&arm, &path, &start);
            let Err(error) = check_path(&arm, path, &start, requested) else {
                assert_eq!(scanned, Ok(()), "{}", model.id);
                continue;
            };
            if !matches!(error.kind, PathErrorKind::Unresolved { .. }) {
                refused += 1;
                seen += u32::from(scanned.is_err());
            }
        }
        println!("{}: {seen} of {refused} seen", model.id);
        assert!(seen * 10 >= refused * 6, "{}", model.id);
    }
}
