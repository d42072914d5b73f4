//! Robot arms: joints, tool and kinematics.

use super::devices::{actuator, function, sensor};
use crate::aggregates::Array;
use crate::macros::interface;
use crate::operand::Text;
use crate::registry::Prim;
use crate::value_types::{Pose, Twist, Vector};
use rpi_image::{DeviceResponse, ShapeRule};

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
    /// State of one axis as commanded and as measured: position (rad), velocity (rad/s) and acceleration (rad/s²); m,
    /// m/s and m/s² for a linear axis. `outError` is the error code of the axis, 0 if there is no error.
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
    /// Sets the position of one axis, in rad (m for a linear axis). The out-ports are the response of the device in
    /// this cycle; they are absent if there is no set-point.
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
        DeviceResponse::ConcurrentAccess,
        DeviceResponse::DeviceFailed,
        DeviceResponse::IllegalValue,
        DeviceResponse::ErrorCode,
    ])
}

interface! {
    /// Sets the load of the arm: mass (kg), centre of mass (m) and moments of inertia (kg m²). `outCompleted` is true
    /// once the arm has accepted the load.
    TOOL_PARAMETERS = "RobotArm::ToolParameters";
    in {
        inMass: f64 = Mass(Real(0.0));
        inCOM: Vector = COM(Neutral);
        inMOI: Vector = MOI(Neutral)
    }
    param { Robot: Text = Str(""); Axis: i64 = Int(0) }
    out { outCompleted: bool; outError: i64 }
    presence strict work 16 faults;
    role actuator("Robot", Some("Axis"), &["tool"], &[DeviceResponse::Completed, DeviceResponse::ErrorCode])
}

interface! {
    /// Forward kinematics: pose of the tool in the base frame of the arm. Joint positions are in rad.
    KIN = "ArmKinematics::Kin";
    in { inJoints: Array<f64> }
    param { Robot: Text = Str("") }
    out { outFrame: Pose }
    presence strict work 200;
    role function("Robot", &["kinematics"])
}

interface! {
    /// Inverse kinematics: joint positions (rad) for a pose of the tool in the base frame of the arm. The solution is
    /// the one closest to `inHintJoints`. All elements are not a number if there is no solution.
    INV_KIN = "ArmKinematics::InvKin";
    in { inFrame: Pose; inHintJoints: Array<f64> }
    param { Robot: Text = Str("") }
    out { outJoints: Array<f64> }
    shape ShapeRule::SameAsInput(1);
    presence strict work 1000;
    role function("Robot", &["inverse_kinematics"])
}

interface! {
    /// Pose (m) and velocity (m/s, rad/s) of the tool in the base frame of the device, as commanded and as measured.
    /// `outError` is the error code of the device, 0 if there is no error.
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
    /// Sets the pose of the tool in the base frame of the device. The out-ports are the response of the device in this
    /// cycle; they are absent if there is no set-point.
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
        DeviceResponse::ErrorCode,
        DeviceResponse::ConcurrentAccess,
        DeviceResponse::DeviceFailed,
        DeviceResponse::IllegalValue,
    ])
}
