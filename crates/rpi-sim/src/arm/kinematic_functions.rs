//! Device functions of an arm: forward, inverse and velocity kinematics.

use super::{Arm, kinematics::PerAxis};
use crate::device::{SlotWriter, pose_from};

/// Reads `count` reals from the slots `cells`, beginning with the slot `from`; `None` if there are too few slots.
fn reals(cells: &[u64], from: usize, count: usize) -> Option<PerAxis> {
    let part = cells.get(from..from + count)?;
    let mut all = PerAxis::default();
    all.iter_mut()
        .zip(part)
        .for_each(|(slot, bits)| *slot = f64::from_bits(*bits));
    Some(all)
}

/// Writes one value for each axis.
pub(super) fn put_joints(arm: &Arm, values: PerAxis, out: &mut SlotWriter<'_>) {
    out.put_reals(values.into_iter().take(arm.axes()));
}

pub(super) fn kinematics(arm: &Arm, arguments: &[u64], out: &mut SlotWriter<'_>) -> bool {
    let joints = reals(arguments, 0, arm.axes());
    joints
        .map(|joints| out.put_pose(&arm.kinematics.forward(&joints[..arm.axes()])))
        .is_some()
}

pub(super) fn inverse_kinematics(arm: &Arm, arguments: &[u64], out: &mut SlotWriter<'_>) -> bool {
    let hint = reals(arguments, 7, arm.axes());
    put_inverse(arm, arguments, hint, hint, out)
}

pub(super) fn inverse_kinematics_nullspace(
    arm: &Arm,
    arguments: &[u64],
    out: &mut SlotWriter<'_>,
) -> bool {
    let (hint, elbow) = (
        reals(arguments, 7, arm.axes()),
        reals(arguments, 7 + arm.axes(), arm.axes()),
    );
    put_inverse(arm, arguments, hint, elbow, out)
}

fn put_inverse(
    arm: &Arm,
    arguments: &[u64],
    hint: Option<PerAxis>,
    elbow: Option<PerAxis>,
    out: &mut SlotWriter<'_>,
) -> bool {
    let (Some(hint), Some(elbow)) = (hint, elbow) else {
        return false;
    };
    let axes = arm.axes();
    let found = arm
        .kinematics
        .inverse(&pose_from(arguments), &hint[..axes], &elbow[..axes]);
    found.map(|joints| put_joints(arm, joints, out)).is_ok()
}

pub(super) fn velocity_kinematics(arm: &Arm, arguments: &[u64], out: &mut SlotWriter<'_>) -> bool {
    let axes = arm.axes();
    let (Some(joints), Some(velocities)) =
        (reals(arguments, 0, axes), reals(arguments, axes, axes))
    else {
        return false;
    };
    out.put_reals(arm.kinematics.twist(&joints, &velocities).iter().copied());
    out.put_real(arm.kinematics.elbow_velocity(&joints, &velocities));
    true
}
