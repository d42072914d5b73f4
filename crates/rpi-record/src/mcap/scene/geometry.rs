//! Geometry of the arms of a cell in plain numbers, from which a viewer computes the poses of all links.

use rpi_kin::Pose;
use rpi_kin::chain::JointType;
use rpi_sim::Cell;
use rpi_sim::cell::DeviceKind;

use super::arm_view::ArmView;

/// Pose as position x, y, z in m and unit quaternion x, y, z, w.
pub type PoseNumbers = [f64; 7];

/// Geometry and limits of an arm when all its joints are at 0.
#[derive(Clone, PartialEq, Debug)]
pub struct ArmGeometry {
    /// Name of the arm in the cell description.
    pub name: String,
    /// Name of the model for people, such as `KUKA LWR 4+`.
    pub model: String,
    /// Pose of the base in the cell.
    pub base: PoseNumbers,
    /// Joints from the base to the flange.
    pub joints: Vec<JointGeometry>,
    /// Pose of the flange in the base frame when all joints are at 0.
    pub flange: PoseNumbers,
    /// Pose of the tool in the flange frame.
    pub tool: PoseNumbers,
    /// Maximum speed (m/s), acceleration (m/s²) and jerk (m/s³) of the tool; infinite without a limit.
    pub tool_limits: [f64; 3],
}

/// Axis of a joint in the base frame when all joints are at 0, and its limits.
#[derive(Clone, PartialEq, Debug)]
pub struct JointGeometry {
    /// True for a joint that moves along its axis, false for one that rotates about it.
    pub prismatic: bool,
    /// Point on the axis in m.
    pub point: [f64; 3],
    /// Unit vector of the axis, in the positive sense of the joint value.
    pub direction: [f64; 3],
    /// Lowest and highest position, in rad or m.
    pub range: [f64; 2],
    /// Maximum velocity, acceleration and jerk, in rad or m and s; infinite without a limit.
    pub limits: [f64; 3],
}

/// Returns the geometry of all arms of a cell, in the order of the cell description.
pub(in crate::mcap) fn arm_geometry(cell: &Cell) -> Vec<ArmGeometry> {
    let arms = cell.devices.iter().filter_map(|device| match &device.kind {
        DeviceKind::Arm(arm) => Some(ArmView::new(&device.name, arm, Vec::new())),
        _ => None,
    });
    arms.map(|arm| geometry(&arm)).collect()
}

fn geometry(arm: &ArmView) -> ArmGeometry {
    let spec = &arm.spec;
    let joints = arm.axes.iter().zip(&spec.limits);
    let tool = spec.tool_limits;
    ArmGeometry {
        name: arm.name.clone(),
        model: spec.model.display_name.to_owned(),
        base: numbers(&spec.base),
        joints: joints
            .map(|(axis, limits)| JointGeometry {
                prismatic: axis.joint == JointType::Prismatic,
                point: axis.point.into(),
                direction: axis.direction.into(),
                range: [limits.position.lower, limits.position.upper],
                limits: [limits.velocity, limits.acceleration, limits.jerk],
            })
            .collect(),
        flange: numbers(&spec.model.forward(&vec![0.0; arm.axes.len()])),
        tool: numbers(&spec.tool),
        tool_limits: [tool.speed, tool.acceleration, tool.jerk],
    }
}

fn numbers(pose: &Pose) -> PoseNumbers {
    let (at, turn) = (pose.translation.vector, pose.rotation.coords);
    [at.x, at.y, at.z, turn.x, turn.y, turn.z, turn.w]
}
