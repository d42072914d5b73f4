//! Port table of an arm. `docs/src/devices.md` explains the ports; a test compares the two.
//!
//! The first part has the names used by the primitives of the reference system, the second part those of the device
//! type `Arm` of `.rpi`.

use super::{Arm, kinematics::PerAxis};
use crate::device::{Carries, Head, Put, pose_from};
use rpi_device::PortKind;
use rpi_image::Scalar::{Bool, Int, Pose, Real, Twist};

/// A row of the port table.
pub(super) struct Line {
    pub(super) head: Head,
    pub(super) act: Act,
}

/// Behaviour of a port.
pub(super) enum Act {
    /// Reads a value; the index selects the axis if the port is indexed.
    Sense(fn(&Arm, usize, &mut Put<'_>)),
    /// Moves axes.
    Move(Target),
    /// Sets a parameter; the index of the port selects among several.
    Parameter(Parameter),
    /// Computes a function; false if there is no result.
    Call(fn(&Arm, &[u64], &mut Put<'_>) -> bool),
}

/// Object that a set-point moves.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Target {
    /// One axis.
    Joint,
    /// All axes.
    Joints,
    /// The tool, in Cartesian space.
    Tool,
}

/// A parameter of the arm.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Parameter {
    Tool,
    /// Tool load with the centre of mass and the tool centre point given as poses.
    ToolAndTcp,
    Strategy,
    JointImpedance,
    ToolImpedance,
    ToolSine,
}

const fn sense(name: &'static str, carries: Carries, act: fn(&Arm, usize, &mut Put<'_>)) -> Line {
    Line {
        head: Head {
            name,
            kind: PortKind::Sensor,
            carries,
            indexed: false,
        },
        act: Act::Sense(act),
    }
}

const fn of_axis(name: &'static str, carries: Carries, act: fn(&Arm, usize, &mut Put<'_>)) -> Line {
    Line {
        head: Head {
            name,
            kind: PortKind::Sensor,
            carries,
            indexed: true,
        },
        act: Act::Sense(act),
    }
}

const fn actuator(name: &'static str, carries: Carries, indexed: bool, act: Act) -> Line {
    Line {
        head: Head {
            name,
            kind: PortKind::Actuator,
            carries,
            indexed,
        },
        act,
    }
}

const fn function(
    name: &'static str,
    carries: Carries,
    act: fn(&Arm, &[u64], &mut Put<'_>) -> bool,
) -> Line {
    Line {
        head: Head {
            name,
            kind: PortKind::Function,
            carries,
            indexed: false,
        },
        act: Act::Call(act),
    }
}

const REAL: Carries = Carries::One(Real);
const POSE: Carries = Carries::One(Pose);
const TWIST: Carries = Carries::One(Twist);
const INT: Carries = Carries::One(Int);
const BOOL: Carries = Carries::One(Bool);
const JOINTS: Carries = Carries::PerAxis;

/// All ports.
pub(super) const PORTS: &[Line] = &[
    of_axis("joint.commanded_position", REAL, |arm, axis, out| {
        out.real(arm.commanded_at(axis).position)
    }),
    of_axis("joint.commanded_velocity", REAL, |arm, axis, out| {
        out.real(arm.commanded_at(axis).velocity)
    }),
    of_axis("joint.commanded_acceleration", REAL, |arm, axis, out| {
        out.real(arm.commanded_at(axis).acceleration)
    }),
    of_axis("joint.measured_position", REAL, |arm, axis, out| {
        out.real(arm.measured_at(axis).position)
    }),
    of_axis("joint.measured_velocity", REAL, |arm, axis, out| {
        out.real(arm.measured_at(axis).velocity)
    }),
    of_axis("joint.measured_acceleration", REAL, |arm, axis, out| {
        out.real(arm.measured_at(axis).acceleration)
    }),
    of_axis("joint.measured_torque", REAL, |arm, axis, out| {
        out.real(arm.external_torques()[axis])
    }),
    of_axis("joint.external_torque", REAL, |arm, axis, out| {
        out.real(arm.external_torques()[axis])
    }),
    of_axis("joint.error", INT, |arm, axis, out| {
        out.bits(arm.axis_code(axis).0.cast_unsigned())
    }),
    sense("tcp.commanded_position", POSE, |arm, _, out| {
        out.pose(&arm.pose())
    }),
    sense("tcp.commanded_velocity", TWIST, commanded_twist),
    sense("tcp.measured_position", POSE, measured_pose),
    sense("tcp.measured_velocity", TWIST, measured_twist),
    sense("tcp.error", INT, |arm, _, out| {
        out.bits(arm.any_code().0.cast_unsigned())
    }),
    sense("tcp.force_x", REAL, |arm, _, out| {
        out.real(arm.state.contact[0])
    }),
    sense("tcp.force_y", REAL, |arm, _, out| {
        out.real(arm.state.contact[1])
    }),
    sense("tcp.force_z", REAL, |arm, _, out| {
        out.real(arm.state.contact[2])
    }),
    sense("tcp.torque_x", REAL, |arm, _, out| {
        out.real(arm.state.contact[3])
    }),
    sense("tcp.torque_y", REAL, |arm, _, out| {
        out.real(arm.state.contact[4])
    }),
    sense("tcp.torque_z", REAL, |arm, _, out| {
        out.real(arm.state.contact[5])
    }),
    actuator("joint.position", REAL, true, Act::Move(Target::Joint)),
    actuator("tcp.position", POSE, false, Act::Move(Target::Tool)),
    actuator(
        "tool",
        Carries::Reals(7),
        true,
        Act::Parameter(Parameter::Tool),
    ),
    actuator(
        "tool_and_tcp",
        Carries::Reals(18),
        false,
        Act::Parameter(Parameter::ToolAndTcp),
    ),
    actuator(
        "control_strategy",
        INT,
        false,
        Act::Parameter(Parameter::Strategy),
    ),
    actuator(
        "joint.impedance",
        Carries::Reals(4),
        true,
        Act::Parameter(Parameter::JointImpedance),
    ),
    actuator(
        "tcp.impedance",
        Carries::Reals(18),
        false,
        Act::Parameter(Parameter::ToolImpedance),
    ),
    actuator(
        "tcp.sine",
        Carries::Reals(12),
        false,
        Act::Parameter(Parameter::ToolSine),
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
        Carries::Reals(7),
        velocity_kinematics,
    ),
    // Ports of the device type `Arm` of `.rpi`.
    actuator("tcp", POSE, false, Act::Move(Target::Tool)),
    actuator("joints", JOINTS, false, Act::Move(Target::Joints)),
    // Programs access arrays element by element.
    actuator("joints", REAL, true, Act::Move(Target::Joint)),
    of_axis("joints", REAL, |arm, axis, out| {
        out.real(arm.commanded(|s| s.position)[axis])
    }),
    of_axis("commanded", REAL, |arm, axis, out| {
        out.real(arm.commanded_at(axis).position)
    }),
    of_axis("commanded_velocity", REAL, |arm, axis, out| {
        out.real(arm.commanded_at(axis).velocity)
    }),
    of_axis("commanded_acceleration", REAL, |arm, axis, out| {
        out.real(arm.commanded_at(axis).acceleration)
    }),
    of_axis("position", REAL, |arm, axis, out| {
        out.real(arm.measured(|s| s.position)[axis])
    }),
    of_axis("velocity", REAL, |arm, axis, out| {
        out.real(arm.measured(|s| s.velocity)[axis])
    }),
    of_axis("torque", REAL, |arm, axis, out| {
        out.real(arm.external_torques()[axis])
    }),
    sense("pose", POSE, |arm, _, out| out.pose(&arm.pose())),
    sense("twist", TWIST, commanded_twist),
    sense("measured", POSE, measured_pose),
    sense("measured_twist", TWIST, measured_twist),
    sense("joints", JOINTS, |arm, _, out| {
        put_joints(arm, arm.commanded(|s| s.position), out)
    }),
    sense("position", JOINTS, |arm, _, out| {
        put_joints(arm, arm.measured(|s| s.position), out)
    }),
    sense("velocity", JOINTS, |arm, _, out| {
        put_joints(arm, arm.measured(|s| s.velocity), out)
    }),
    sense("acceleration", JOINTS, |arm, _, out| {
        put_joints(arm, arm.measured(|s| s.acceleration), out)
    }),
    sense("torque", JOINTS, |arm, _, out| {
        put_joints(arm, arm.external_torques(), out)
    }),
    sense(
        "force",
        Carries::One(rpi_image::Scalar::Wrench),
        |arm, _, out| out.reals(arm.state.contact.iter().copied()),
    ),
    sense("error", BOOL, |arm, _, out| {
        out.bits(u64::from(arm.any_code().0 != 0))
    }),
    sense("code", INT, |arm, _, out| {
        out.bits(arm.any_code().0.cast_unsigned())
    }),
];

fn put_joints(arm: &Arm, values: PerAxis, out: &mut Put<'_>) {
    out.reals(values.into_iter().take(arm.axes()));
}

fn commanded_twist(arm: &Arm, _: usize, out: &mut Put<'_>) {
    let twist = arm.twist(
        &arm.commanded(|s| s.position),
        &arm.commanded(|s| s.velocity),
    );
    out.reals(twist.iter().copied());
}

fn measured_twist(arm: &Arm, _: usize, out: &mut Put<'_>) {
    let twist = arm.twist(&arm.measured(|s| s.position), &arm.measured(|s| s.velocity));
    out.reals(twist.iter().copied());
}

fn measured_pose(arm: &Arm, _: usize, out: &mut Put<'_>) {
    out.pose(&arm.forward(&arm.measured(|s| s.position)[..arm.axes()]));
}

/// Reads `count` reals from slot `from` on; `None` if there are too few.
fn reals(cells: &[u64], from: usize, count: usize) -> Option<PerAxis> {
    let part = cells.get(from..from + count)?;
    let mut all = PerAxis::default();
    all.iter_mut()
        .zip(part)
        .for_each(|(slot, bits)| *slot = f64::from_bits(*bits));
    Some(all)
}

fn kinematics(arm: &Arm, arguments: &[u64], out: &mut Put<'_>) -> bool {
    let joints = reals(arguments, 0, arm.axes());
    joints
        .map(|joints| out.pose(&arm.forward(&joints[..arm.axes()])))
        .is_some()
}

fn inverse_kinematics(arm: &Arm, arguments: &[u64], out: &mut Put<'_>) -> bool {
    let hint = reals(arguments, 7, arm.axes());
    put_inverse(arm, arguments, hint, hint, out)
}

fn inverse_kinematics_nullspace(arm: &Arm, arguments: &[u64], out: &mut Put<'_>) -> bool {
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
    out: &mut Put<'_>,
) -> bool {
    let (Some(hint), Some(elbow)) = (hint, elbow) else {
        return false;
    };
    let axes = arm.axes();
    let found = arm.inverse(&pose_from(arguments), &hint[..axes], &elbow[..axes]);
    found.map(|joints| put_joints(arm, joints, out)).is_ok()
}

fn velocity_kinematics(arm: &Arm, arguments: &[u64], out: &mut Put<'_>) -> bool {
    let axes = arm.axes();
    let (Some(joints), Some(velocities)) =
        (reals(arguments, 0, axes), reals(arguments, axes, axes))
    else {
        return false;
    };
    out.reals(arm.twist(&joints, &velocities).iter().copied());
    out.real(arm.elbow_velocity(&joints, &velocities));
    true
}
