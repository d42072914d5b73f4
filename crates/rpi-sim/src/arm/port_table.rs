//! Port table of an arm. `docs/src/devices.md` explains the ports; a test compares the two.
//!
//! The first part has the names used by the primitives of the reference system, the second part those of the device
//! type `Arm` of `.rpi`.

use super::Arm;
use super::axes_motion::AxesMotionKind;
use super::chunks::{CHUNK_SLOTS, RowKind};
use super::follower::FOLLOW_SLOTS;
use super::kinematic_functions::{
    inverse_kinematics, inverse_kinematics_nullspace, kinematics, put_joints, velocity_kinematics,
};
use super::motion::{EVENT_SLOTS, RESULT_SLOTS};
use super::motion::{MotionKind, PathKind};
use super::tool_path::ToolPathKind;
use crate::device::{PortSpec, PortValue, SlotWriter};
use rpi_device::PortKind;
use rpi_image::Scalar::{Bool, Int, Pose, Real, Twist};
use rpi_motion::path::TwistFrame;

/// Row of the port table of an arm: name, type and behaviour of a port.
pub(super) struct PortRow {
    pub(super) spec: PortSpec,
    pub(super) action: PortAction,
}

/// Action of the arm at a port: the value that it measures, accepts or computes.
pub(super) enum PortAction {
    /// The port is a sensor. The function writes its value to the slots; the number is the axis if the port is indexed.
    Sense(fn(&Arm, usize, &mut SlotWriter<'_>)),
    /// The port is an actuator that moves this part of the arm.
    Move(Target),
    /// The port is an actuator that sets this parameter of the arm.
    Parameter(Parameter),
    /// The port is a function: it computes a result from arguments, both given as slots. It returns false if there is
    /// no result.
    Call(fn(&Arm, &[u64], &mut SlotWriter<'_>) -> bool),
    /// The port is a function that plans a motion of this kind, called in each cycle.
    Plan(MotionKind),
    /// The port is the function that tells when a motion passes a place on its path.
    PathEvent,
    /// The port is the function that follows poses of the tool, called in each cycle.
    FollowPose,
}

/// Part of an arm that a set-point moves.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Target {
    /// The set-point moves one axis, chosen by the index of the port.
    Joint,
    /// The set-point moves all axes.
    Joints,
    /// The set-point is a pose of the tool, to which the axes move.
    Tool,
}

/// Parameter of an arm that programs can set.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Parameter {
    Tool,
    /// Tool load in which the centre of mass and the tool centre point are given as poses.
    ToolAndTcp,
    Strategy,
    JointImpedance,
    ToolImpedance,
    ToolSine,
}

const fn sensor(
    name: &'static str,
    carries: PortValue,
    act: fn(&Arm, usize, &mut SlotWriter<'_>),
) -> PortRow {
    PortRow {
        spec: PortSpec {
            name,
            kind: PortKind::Sensor,
            value: carries,
            indexed: false,
        },
        action: PortAction::Sense(act),
    }
}

const fn axis_sensor(
    name: &'static str,
    carries: PortValue,
    act: fn(&Arm, usize, &mut SlotWriter<'_>),
) -> PortRow {
    PortRow {
        spec: PortSpec {
            name,
            kind: PortKind::Sensor,
            value: carries,
            indexed: true,
        },
        action: PortAction::Sense(act),
    }
}

const fn actuator(
    name: &'static str,
    carries: PortValue,
    indexed: bool,
    act: PortAction,
) -> PortRow {
    PortRow {
        spec: PortSpec {
            name,
            kind: PortKind::Actuator,
            value: carries,
            indexed,
        },
        action: act,
    }
}

const fn function(
    name: &'static str,
    carries: PortValue,
    act: fn(&Arm, &[u64], &mut SlotWriter<'_>) -> bool,
) -> PortRow {
    called(name, carries, PortAction::Call(act))
}

const fn motion(name: &'static str, kind: MotionKind) -> PortRow {
    let value = PortValue::PerAxisAnd(RESULT_SLOTS);
    called(name, value, PortAction::Plan(kind))
}

const fn called(name: &'static str, value: PortValue, action: PortAction) -> PortRow {
    PortRow {
        spec: PortSpec {
            name,
            kind: PortKind::Function,
            value,
            indexed: false,
        },
        action,
    }
}

const fn tool_motion(name: &'static str, kind: ToolPathKind) -> PortRow {
    motion(name, MotionKind::Path(PathKind::Tool(kind)))
}

const fn axes_motion(name: &'static str, kind: AxesMotionKind) -> PortRow {
    motion(name, MotionKind::Axes(kind))
}

const fn chunks(name: &'static str, rows: RowKind) -> PortRow {
    let kind = MotionKind::Axes(AxesMotionKind::Chunks(rows));
    let value = PortValue::PerAxisAnd(RESULT_SLOTS + CHUNK_SLOTS);
    called(name, value, PortAction::Plan(kind))
}

const REAL: PortValue = PortValue::One(Real);
const POSE: PortValue = PortValue::One(Pose);
const TWIST: PortValue = PortValue::One(Twist);
const VECTOR: PortValue = PortValue::One(rpi_image::Scalar::Vector);
const INT: PortValue = PortValue::One(Int);
const BOOL: PortValue = PortValue::One(Bool);
const JOINTS: PortValue = PortValue::PerAxis;

/// Table of all ports of an arm.
pub(super) const PORTS: &[PortRow] = &[
    axis_sensor("joint.commanded_position", REAL, |arm, axis, out| {
        out.put_real(arm.commanded_at(axis).position)
    }),
    axis_sensor("joint.commanded_velocity", REAL, |arm, axis, out| {
        out.put_real(arm.commanded_at(axis).velocity)
    }),
    axis_sensor("joint.commanded_acceleration", REAL, |arm, axis, out| {
        out.put_real(arm.commanded_at(axis).acceleration)
    }),
    axis_sensor("joint.measured_position", REAL, |arm, axis, out| {
        out.put_real(arm.measured_at(axis).position)
    }),
    axis_sensor("joint.measured_velocity", REAL, |arm, axis, out| {
        out.put_real(arm.measured_at(axis).velocity)
    }),
    axis_sensor("joint.measured_acceleration", REAL, |arm, axis, out| {
        out.put_real(arm.measured_at(axis).acceleration)
    }),
    axis_sensor("joint.measured_torque", REAL, |arm, axis, out| {
        out.put_real(arm.external_torques()[axis])
    }),
    axis_sensor("joint.external_torque", REAL, |arm, axis, out| {
        out.put_real(arm.external_torques()[axis])
    }),
    axis_sensor("joint.error", INT, |arm, axis, out| {
        out.put_bits(arm.axis_code(axis).0.cast_unsigned())
    }),
    sensor("tcp.commanded_position", POSE, |arm, _, out| {
        out.put_pose(&arm.pose())
    }),
    sensor("tcp.commanded_velocity", TWIST, commanded_twist),
    sensor("tcp.measured_position", POSE, measured_pose),
    sensor("tcp.measured_velocity", TWIST, measured_twist),
    sensor("tcp.error", INT, |arm, _, out| {
        out.put_bits(arm.any_code().0.cast_unsigned())
    }),
    sensor("tcp.force_x", REAL, |arm, _, out| {
        out.put_real(arm.faults.effects.contact[0])
    }),
    sensor("tcp.force_y", REAL, |arm, _, out| {
        out.put_real(arm.faults.effects.contact[1])
    }),
    sensor("tcp.force_z", REAL, |arm, _, out| {
        out.put_real(arm.faults.effects.contact[2])
    }),
    sensor("tcp.torque_x", REAL, |arm, _, out| {
        out.put_real(arm.faults.effects.contact[3])
    }),
    sensor("tcp.torque_y", REAL, |arm, _, out| {
        out.put_real(arm.faults.effects.contact[4])
    }),
    sensor("tcp.torque_z", REAL, |arm, _, out| {
        out.put_real(arm.faults.effects.contact[5])
    }),
    actuator(
        "joint.position",
        REAL,
        true,
        PortAction::Move(Target::Joint),
    ),
    actuator("tcp.position", POSE, false, PortAction::Move(Target::Tool)),
    actuator(
        "tool",
        PortValue::Reals(7),
        true,
        PortAction::Parameter(Parameter::Tool),
    ),
    actuator(
        "tool_and_tcp",
        PortValue::Reals(18),
        false,
        PortAction::Parameter(Parameter::ToolAndTcp),
    ),
    actuator(
        "control_strategy",
        INT,
        false,
        PortAction::Parameter(Parameter::Strategy),
    ),
    actuator(
        "joint.impedance",
        PortValue::Reals(4),
        true,
        PortAction::Parameter(Parameter::JointImpedance),
    ),
    actuator(
        "tcp.impedance",
        PortValue::Reals(18),
        false,
        PortAction::Parameter(Parameter::ToolImpedance),
    ),
    actuator(
        "tcp.sine",
        PortValue::Reals(12),
        false,
        PortAction::Parameter(Parameter::ToolSine),
    ),
    function("kinematics", POSE, kinematics),
    function("inverse_kinematics", JOINTS, inverse_kinematics),
    function(
        "inverse_kinematics_nullspace",
        JOINTS,
        inverse_kinematics_nullspace,
    ),
    function(
        "velocity_kinematics",
        PortValue::Reals(7),
        velocity_kinematics,
    ),
    tool_motion("move_line", ToolPathKind::Line),
    tool_motion("move_arc", ToolPathKind::Arc),
    tool_motion("move_arc_by_centre", ToolPathKind::ArcByCentre),
    tool_motion("move_arc_by_angle", ToolPathKind::ArcByAngle),
    tool_motion("move_corner", ToolPathKind::Corner),
    tool_motion("move_spline", ToolPathKind::Spline),
    motion("move_joints", MotionKind::Path(PathKind::Joints)),
    axes_motion("move_axes", AxesMotionKind::ToPosition),
    axes_motion("follow_joints", AxesMotionKind::Follow),
    axes_motion("move_at_velocity", AxesMotionKind::AtVelocity),
    axes_motion("hold", AxesMotionKind::Hold),
    chunks("follow_chunks", RowKind::Joints),
    chunks("follow_pose_chunks", RowKind::Poses),
    motion("move_tool_in_base", MotionKind::Jog(TwistFrame::Base)),
    motion("move_tool_in_tool", MotionKind::Jog(TwistFrame::Tool)),
    called(
        "path_event",
        PortValue::Reals(EVENT_SLOTS),
        PortAction::PathEvent,
    ),
    called(
        "follow_pose",
        PortValue::PerAxisAnd(FOLLOW_SLOTS),
        PortAction::FollowPose,
    ),
    // Ports of the device type `Arm` of `.rpi`.
    actuator("tcp", POSE, false, PortAction::Move(Target::Tool)),
    actuator("joints", JOINTS, false, PortAction::Move(Target::Joints)),
    // Ports of the device types `LinearUnit` and `Positioner`: an axis or several.
    actuator("axes", JOINTS, false, PortAction::Move(Target::Joints)),
    actuator("axes", REAL, true, PortAction::Move(Target::Joint)),
    actuator("axis", REAL, true, PortAction::Move(Target::Joint)),
    axis_sensor("axis_position", REAL, |arm, axis, out| {
        out.put_real(arm.measured(|s| s.position)[axis])
    }),
    axis_sensor("axis_velocity", REAL, |arm, axis, out| {
        out.put_real(arm.measured(|s| s.velocity)[axis])
    }),
    axis_sensor("axis_commanded", REAL, |arm, axis, out| {
        out.put_real(arm.commanded_at(axis).position)
    }),
    // Programs access arrays element by element.
    actuator("joints", REAL, true, PortAction::Move(Target::Joint)),
    axis_sensor("joints", REAL, |arm, axis, out| {
        out.put_real(arm.commanded(|s| s.position)[axis])
    }),
    axis_sensor("commanded", REAL, |arm, axis, out| {
        out.put_real(arm.commanded_at(axis).position)
    }),
    axis_sensor("commanded_velocity", REAL, |arm, axis, out| {
        out.put_real(arm.commanded_at(axis).velocity)
    }),
    axis_sensor("commanded_acceleration", REAL, |arm, axis, out| {
        out.put_real(arm.commanded_at(axis).acceleration)
    }),
    axis_sensor("position", REAL, |arm, axis, out| {
        out.put_real(arm.measured(|s| s.position)[axis])
    }),
    axis_sensor("velocity", REAL, |arm, axis, out| {
        out.put_real(arm.measured(|s| s.velocity)[axis])
    }),
    axis_sensor("torque", REAL, |arm, axis, out| {
        out.put_real(arm.external_torques()[axis])
    }),
    sensor("pose", POSE, |arm, _, out| out.put_pose(&arm.pose())),
    sensor("twist", TWIST, commanded_twist),
    sensor("moving", BOOL, |arm, _, out| {
        out.put_bits(u64::from(arm.is_moving()))
    }),
    sensor("measured", POSE, measured_pose),
    sensor("measured_twist", TWIST, measured_twist),
    sensor("singularity_distance", REAL, |arm, _, out| {
        let joints = arm.commanded(|s| s.position);
        out.put_real(arm.kinematics.distance_to_singularity(&joints))
    }),
    sensor("joints", JOINTS, |arm, _, out| {
        put_joints(arm, arm.commanded(|s| s.position), out)
    }),
    sensor("position", JOINTS, |arm, _, out| {
        put_joints(arm, arm.measured(|s| s.position), out)
    }),
    sensor("velocity", JOINTS, |arm, _, out| {
        put_joints(arm, arm.measured(|s| s.velocity), out)
    }),
    sensor("acceleration", JOINTS, |arm, _, out| {
        put_joints(arm, arm.measured(|s| s.acceleration), out)
    }),
    sensor("torque", JOINTS, |arm, _, out| {
        put_joints(arm, arm.external_torques(), out)
    }),
    sensor(
        "force",
        PortValue::One(rpi_image::Scalar::Wrench),
        |arm, _, out| out.put_reals(arm.faults.effects.contact.iter().copied()),
    ),
    sensor("error", BOOL, |arm, _, out| {
        out.put_bits(u64::from(arm.any_code().0 != 0))
    }),
    sensor("code", INT, |arm, _, out| {
        out.put_bits(arm.any_code().0.cast_unsigned())
    }),
    sensor("state.pose", POSE, |arm, _, out| out.put_pose(&arm.pose())),
    sensor("state.twist", TWIST, commanded_twist),
    sensor("state.linear_acceleration", VECTOR, |arm, _, out| {
        out.put_reals(commanded_acceleration(arm).iter().take(3).copied())
    }),
    sensor("state.angular_acceleration", VECTOR, |arm, _, out| {
        out.put_reals(commanded_acceleration(arm).iter().skip(3).copied())
    }),
    axis_sensor("state.joints", REAL, |arm, axis, out| {
        out.put_real(arm.commanded_at(axis).position)
    }),
    axis_sensor("state.joint_velocity", REAL, |arm, axis, out| {
        out.put_real(arm.commanded_at(axis).velocity)
    }),
    axis_sensor("state.joint_acceleration", REAL, |arm, axis, out| {
        out.put_real(arm.commanded_at(axis).acceleration)
    }),
    axis_sensor("limits.lower", REAL, |arm, axis, out| {
        out.put_real(arm.kinematics.limits()[axis].position.lower)
    }),
    axis_sensor("limits.upper", REAL, |arm, axis, out| {
        out.put_real(arm.kinematics.limits()[axis].position.upper)
    }),
    axis_sensor("limits.velocity", REAL, |arm, axis, out| {
        out.put_real(arm.kinematics.limits()[axis].velocity)
    }),
    axis_sensor("limits.acceleration", REAL, |arm, axis, out| {
        out.put_real(arm.kinematics.limits()[axis].acceleration)
    }),
    axis_sensor("limits.jerk", REAL, |arm, axis, out| {
        out.put_real(arm.kinematics.limits()[axis].jerk)
    }),
    sensor("tool_limits.speed", REAL, |arm, _, out| {
        out.put_real(arm.motion.tool_limits().speed)
    }),
    sensor("tool_limits.acceleration", REAL, |arm, _, out| {
        out.put_real(arm.motion.tool_limits().acceleration)
    }),
    sensor("tool_limits.jerk", REAL, |arm, _, out| {
        out.put_real(arm.motion.tool_limits().jerk)
    }),
];

fn commanded_twist(arm: &Arm, _: usize, out: &mut SlotWriter<'_>) {
    let twist = arm.kinematics.twist(
        &arm.commanded(|s| s.position),
        &arm.commanded(|s| s.velocity),
    );
    out.put_reals(twist.iter().copied());
}

fn commanded_acceleration(arm: &Arm) -> nalgebra::Vector6<f64> {
    arm.kinematics.acceleration(
        &arm.commanded(|s| s.position),
        &arm.commanded(|s| s.velocity),
        &arm.commanded(|s| s.acceleration),
    )
}

fn measured_twist(arm: &Arm, _: usize, out: &mut SlotWriter<'_>) {
    let twist = arm
        .kinematics
        .twist(&arm.measured(|s| s.position), &arm.measured(|s| s.velocity));
    out.put_reals(twist.iter().copied());
}

fn measured_pose(arm: &Arm, _: usize, out: &mut SlotWriter<'_>) {
    out.put_pose(
        &arm.kinematics
            .forward(&arm.measured(|s| s.position)[..arm.axes()]),
    );
}
