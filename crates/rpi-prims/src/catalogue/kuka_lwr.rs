//! Primitives for KUKA light-weight arms: torques, impedance and elbow.
//!
//! `InvKin` and `ToolParameters` have the ports of the first generation of the reference system, because its nets use
//! them. The second generation uses the general primitives of [`super::arm`].

use super::devices::{actuator, function, sensor};
use crate::aggregates::Array;
use crate::macros::interface;
use crate::operand::Text;
use crate::registry::Prim;
use crate::value_types::{Pose, Twist, Vector, Wrench};
use rpi_image::DeviceResponse;

pub(super) const ALL: &[Prim] = &[
    CONTROL_STRATEGY,
    TOOL_PARAMETERS,
    KIN,
    INV_KIN,
    VEL_KIN,
    T_MONITOR,
    F_MONITOR,
    FT_MONITOR,
    JOINT_IMP_PARAMETERS,
    CART_IMP_PARAMETERS,
    CART_SIN_IMP_PARAMETERS,
];

interface! {
    /// Sets the control mode of the arm (position, joint impedance, Cartesian impedance) as a number defined by the
    /// device. `outCompleted` is true once the arm has accepted it.
    CONTROL_STRATEGY = "KUKA::LWR::ControlStrategy";
    in { inStrategy: i64 }
    param { Robot: Text = Str("") }
    out { outCompleted: bool; outError: i64 }
    presence strict work 8 faults;
    role actuator("Robot", None, &["control_strategy"], &[DeviceResponse::Completed, DeviceResponse::ErrorCode])
}

interface! {
    /// Sets the load of the arm: mass (kg), centre of mass (m; a pose, as in nets of the first generation), moments of
    /// inertia (kg m²) and tool centre point. `outCompleted` is true once the arm has accepted the load.
    TOOL_PARAMETERS = "KUKA::LWR::ToolParameters";
    in {
        inMass: f64 = Mass(Real(0.0));
        inCOM: Pose = COM(Neutral);
        inMOI: Vector = MOI(Neutral);
        inTCP: Pose = TCP(Neutral)
    }
    param { robot: Text = Str("") }
    out { outCompleted: bool; outError: i64 }
    presence strict work 16 faults;
    role actuator("robot", None, &["tool_and_tcp"], &[DeviceResponse::Completed, DeviceResponse::ErrorCode])
}

interface! {
    /// Forward kinematics: pose of the tool in the base frame of the arm. Joint positions are in rad.
    KIN = "KUKA::LWR::Kin";
    in { inJoints: Array<f64> }
    param { Robot: Text = Str("") }
    out { outFrame: Pose }
    presence strict work 200;
    role function("Robot", &["kinematics"])
}

interface! {
    /// Inverse kinematics: joint positions (rad) for a pose of the tool in the base frame of the arm. The solution is
    /// the one close to the hint joints, with the elbow angle of the null-space joints. All outputs are not a number if
    /// there is no solution. `Strategy` is not used.
    INV_KIN = "KUKA::LWR::InvKin";
    in {
        inFrame: Pose;
        inHintJ1: f64; inHintJ2: f64; inHintJ3: f64; inHintJ4: f64; inHintJ5: f64; inHintJ6: f64; inHintJ7: f64;
        inNullspaceJ1: f64; inNullspaceJ2: f64; inNullspaceJ3: f64; inNullspaceJ4: f64; inNullspaceJ5: f64;
        inNullspaceJ6: f64; inNullspaceJ7: f64
    }
    param { Robot: Text = Str(""); Strategy: i64 = Int(0) }
    out { outJ1: f64; outJ2: f64; outJ3: f64; outJ4: f64; outJ5: f64; outJ6: f64; outJ7: f64 }
    presence strict work 1000;
    role function("Robot", &["inverse_kinematics_nullspace"])
}

interface! {
    /// Velocity of the tool in the base frame of the arm (m/s, rad/s) and rate of the elbow angle (rad/s), for joint
    /// positions (rad) and joint velocities (rad/s).
    VEL_KIN = "KUKA::LWR::VelKin";
    in {
        inJ1: f64; inJ2: f64; inJ3: f64; inJ4: f64; inJ5: f64; inJ6: f64; inJ7: f64;
        inV1: f64; inV2: f64; inV3: f64; inV4: f64; inV5: f64; inV6: f64; inV7: f64
    }
    param { Robot: Text = Str("") }
    out { outTwist: Twist; outVAlpha: f64 }
    presence strict work 400;
    role function("Robot", &["velocity_kinematics"])
}

interface! {
    /// Measured and estimated external torque of one axis, in N m.
    T_MONITOR = "KUKA::LWR::TMonitor";
    in {}
    param { Robot: Text = Str(""); Axis: i64 = Int(0) }
    out { outMsr: f64; outEst: f64 }
    presence always work 2;
    role sensor("Robot", Some("Axis"), &["joint.measured_torque", "joint.external_torque"])
}

interface! {
    /// Estimated external force (N) and torque (N m) at the tool.
    F_MONITOR = "KUKA::LWR::FMonitor";
    in {}
    param { Robot: Text = Str("") }
    out { outTcpFx: f64; outTcpFy: f64; outTcpFz: f64; outTcpTz: f64; outTcpTy: f64; outTcpTx: f64 }
    presence always work 6;
    role sensor("Robot", None, &[
        "tcp.force_x", "tcp.force_y", "tcp.force_z", "tcp.torque_z", "tcp.torque_y", "tcp.torque_x",
    ])
}

interface! {
    /// Measured and estimated external torques of the seven axes (N m), and estimated external force (N) and torque (N
    /// m) at the tool.
    FT_MONITOR = "KUKA::LWR::FTMonitor";
    in {}
    param { Robot: Text = Str("") }
    out {
        outMsrJ1: f64; outMsrJ2: f64; outMsrJ3: f64; outMsrJ4: f64; outMsrJ5: f64; outMsrJ6: f64; outMsrJ7: f64;
        outEstJ1: f64; outEstJ2: f64; outEstJ3: f64; outEstJ4: f64; outEstJ5: f64; outEstJ6: f64; outEstJ7: f64;
        outTcpFx: f64; outTcpFy: f64; outTcpFz: f64; outTcpTz: f64; outTcpTy: f64; outTcpTx: f64
    }
    presence always work 20;
    role sensor("Robot", None, &[
        "joint1.measured_torque", "joint2.measured_torque", "joint3.measured_torque", "joint4.measured_torque",
        "joint5.measured_torque", "joint6.measured_torque", "joint7.measured_torque",
        "joint1.external_torque", "joint2.external_torque", "joint3.external_torque", "joint4.external_torque",
        "joint5.external_torque", "joint6.external_torque", "joint7.external_torque",
        "tcp.force_x", "tcp.force_y", "tcp.force_z", "tcp.torque_z", "tcp.torque_y", "tcp.torque_x",
    ])
}

interface! {
    /// Sets the impedance of one axis: stiffness (N m/rad), damping (fraction of critical damping), additional torque
    /// and maximum torque (N m). `outSuccess` is true once the arm has accepted it.
    JOINT_IMP_PARAMETERS = "KUKA::LWR::JointImpParameters";
    in {
        inStiffness: f64 = Stiffness(Real(0.0));
        inDamping: f64 = Damping(Real(0.0));
        inAddTorque: f64 = AddTorque(Real(0.0));
        inMaxTorque: f64 = MaxTorque(Real(0.0))
    }
    param { JointIndex: i64 = Int(0); Robot: Text = Str("") }
    out { outSuccess: bool }
    presence strict work 12 faults;
    role actuator("Robot", Some("JointIndex"), &["joint.impedance"], &[DeviceResponse::Completed])
}

interface! {
    /// Sets the Cartesian impedance at the tool: stiffness (N/m, N m/rad), damping (fraction of critical damping),
    /// additional force (N) and torque (N m).
    CART_IMP_PARAMETERS = "KUKA::LWR::CartImpParameters";
    in { inStiffness: Wrench; inDamping: Wrench; inAddTorque: Wrench }
    param { Robot: Text = Str("") }
    out {}
    presence strict work 24 faults;
    role actuator("Robot", None, &["tcp.impedance"], &[])
}

interface! {
    /// Sets a sinusoidal force overlaid at the tool: amplitude (N, N m) and frequency (Hz) for each direction.
    CART_SIN_IMP_PARAMETERS = "KUKA::IIWA::CartSinImpParameters";
    in { inAmplitude: Wrench; inFrequency: Wrench }
    param { Robot: Text = Str("") }
    out {}
    presence strict work 16 faults;
    role actuator("Robot", None, &["tcp.sine"], &[])
}
