//! Robot arms: joints, tool, kinematics.

use super::devices::{actuator, function, sensor};
use crate::bulk::Array;
use crate::flow::{Pose, Twist, Vector};
use crate::macros::interface;
use crate::operand::Text;
use crate::registry::Prim;
use rpi_image::{Answer, Shape};

pub(super) const ALL: &[Prim] = &[
    JOINT_MONITOR,
    JOINT_POSITION,
    TOOL_PARAMETERS,
    KIN,
    INV_KIN,
    CARTESIAN_MONITOR,
    CARTESIAN_POSITION,
];

interface! {
    /// State of one axis: position (rad, m for a linear axis), velocity and acceleration, as commanded and as measured,
    /// and its error code (0 if it is well).
    JOINT_MONITOR = "RobotArm::JointMonitor";
    in {}
    param { Robot: Text = Str(""); Axis: i64 = Int(0) }
    out {
        outCommandedPosition: f64;
        outMeasuredPosition: f64;
        outCommandedVelocity: f64;
        outMeasuredVelocity: f64;
        outCommandedAcceleration: f64;
        outMeasuredAcceleration: f64;
        outError: i64
    }
    presence always work 7;
    role sensor("Robot", Some("Axis"), &[
        "joint.commanded_position",
        "joint.measured_position",
        "joint.commanded_velocity",
        "joint.measured_velocity",
        "joint.commanded_acceleration",
        "joint.measured_acceleration",
        "joint.error",
    ])
}

interface! {
    /// Set-point of one axis in rad (m for a linear axis). The out-ports tell what the device says to it; nothing without a
    /// set-point.
    JOINT_POSITION = "RobotArm::JointPosition";
    in { inPosition: f64 }
    param { Robot: Text = Str(""); Axis: i64 = Int(0) }
    out {
        outErrorConcurrentAccess: bool;
        outErrorJointFailed: bool;
        outErrorIllegalPosition: bool;
        outError: i64
    }
    presence strict work 8 faults;
    role actuator("Robot", Some("Axis"), &["joint.position"], &[
        Answer::ConcurrentAccess,
        Answer::DeviceFailed,
        Answer::IllegalValue,
        Answer::ErrorCode,
    ])
}

interface! {
    /// Tells the arm its load: mass (kg), centre of mass (m) and moments of inertia (kg m²). Completed once the arm has
    /// taken it over.
    TOOL_PARAMETERS = "RobotArm::ToolParameters";
    in {
        inMass: f64 = Mass(Real(0.0));
        inCOM: Vector = COM(Neutral);
        inMOI: Vector = MOI(Neutral)
    }
    param { Robot: Text = Str(""); Axis: i64 = Int(0) }
    out { outCompleted: bool; outError: i64 }
    presence strict work 16 faults;
    role actuator("Robot", Some("Axis"), &["tool"], &[Answer::Completed, Answer::ErrorCode])
}

interface! {
    /// Pose of the tool in the arm's base for joint positions in rad.
    KIN = "ArmKinematics::Kin";
    in { inJoints: Array<f64> }
    param { Robot: Text = Str("") }
    out { outFrame: Pose }
    presence strict work 200;
    role function("Robot", &["kinematics"])
}

interface! {
    /// Joint positions in rad that bring the tool to a pose in the arm's base, near to the hint; all not a number where there
    /// are none.
    INV_KIN = "ArmKinematics::InvKin";
    in { inFrame: Pose; inHintJoints: Array<f64> }
    param { Robot: Text = Str("") }
    out { outJoints: Array<f64> }
    shape Shape::Like(1);
    presence strict work 1000;
    role function("Robot", &["inverse_kinematics"])
}

interface! {
    /// Pose and velocity of the tool in the device's base, as commanded and as measured, and the device's error code (0 if
    /// it is well).
    CARTESIAN_MONITOR = "CartesianPosition::CartesianMonitor";
    in {}
    param { Robot: Text = Str("") }
    out {
        outMeasuredPosition: Pose;
        outMeasuredVelocity: Twist;
        outCommandedPosition: Pose;
        outCommandedVelocity: Twist;
        outError: i64
    }
    presence always work 27;
    role sensor("Robot", None, &[
        "tcp.measured_position",
        "tcp.measured_velocity",
        "tcp.commanded_position",
        "tcp.commanded_velocity",
        "tcp.error",
    ])
}

interface! {
    /// Set-point for a device that takes poses of its tool in its base. The out-ports tell what the device says to it; nothing
    /// without a set-point.
    CARTESIAN_POSITION = "CartesianPosition::CartesianPosition";
    in { inPosition: Pose }
    param { Robot: Text = Str("") }
    out {
        outError: i64;
        outErrorConcurrentAccess: bool;
        outErrorDeviceFailed: bool;
        outErrorIllegalPosition: bool
    }
    presence strict work 14 faults;
    role actuator("Robot", None, &["tcp.position"], &[
        Answer::ErrorCode,
        Answer::ConcurrentAccess,
        Answer::DeviceFailed,
        Answer::IllegalValue,
    ])
}
