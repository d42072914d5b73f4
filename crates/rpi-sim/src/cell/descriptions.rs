//! Descriptions of the keys of cell and robot descriptions, for the schemas. Keys of small devices have theirs in the
//! tables of their kinds.

/// Ends of the paths of keys, each with the description of the key: meaning and default. The longest end of a path
/// counts. A test holds the list complete.
pub(super) const DESCRIPTIONS: &[(&str, &str)] = &[
    // The whole cell.
    ("cell.name", "Name of the cell for people"),
    (
        "seed",
        "Seed of all noise; the same seed yields the same bits. Default: 0",
    ),
    (
        "devices",
        "The devices of the cell by name, one table for each",
    ),
    (
        "robot_files",
        "Files that the cell carries itself. Recordings use it, so that they replay without the files",
    ),
    (
        "robot_files.path",
        "Path of the file, as the key `model` of a device names it",
    ),
    ("robot_files.text", "Text of the file"),
    ("kind", "Kind of the device"),
    // Arms, linear units and positioners.
    (
        "model",
        "Built-in robot model, or the path of a robot description (.urdf, .xml, .toml) relative to the cell",
    ),
    (
        "joints",
        "Initial positions of the axes, one number for each; or `home`: those of the robot description. Default: 0, or the end of the range nearest to it",
    ),
    ("base", "Pose of the base in the cell. Default: the origin"),
    (
        "tool",
        "Pose of the tool in the flange; all `tcp` ports refer to the tool. Default: the flange",
    ),
    ("position", "Position, x, y, z. Default: 0"),
    (
        "rpy",
        "Rotation by roll, pitch and yaw; cannot be combined with `quaternion`. Default: 0",
    ),
    (
        "quaternion",
        "Rotation as a unit quaternion x, y, z, w; cannot be combined with `rpy`",
    ),
    (
        "limits",
        "Limits of the axes: one number for all axes, or one for each. Default: those of the model",
    ),
    (
        "lower",
        "Lower end of the range of an axis: one number for all axes, or one for each",
    ),
    (
        "upper",
        "Upper end of the range of an axis: one number for all axes, or one for each",
    ),
    (
        "limits.velocity",
        "Velocity limit of an axis: one number for all axes, or one for each",
    ),
    (
        "limits.acceleration",
        "Acceleration limit of an axis: one number for all axes, or one for each",
    ),
    (
        "limits.jerk",
        "Jerk limit of an axis: one number for all axes, or one for each",
    ),
    (
        "tool_limits",
        "Greatest speed, acceleration and jerk of the tool in motions along its paths. Default: none",
    ),
    ("tool_limits.speed", "Greatest speed of the tool"),
    (
        "tool_limits.acceleration",
        "Greatest acceleration of the tool",
    ),
    ("tool_limits.jerk", "Greatest jerk of the tool"),
    (
        "enforce",
        "Limits that the arm checks. Default: all of them",
    ),
    ("lag", "Time constant of the drives. Default: 0"),
    ("latency", "Age of samples when they are read. Default: 0"),
    (
        "noise",
        "Standard deviation of measured positions of the axes. Default: 0",
    ),
    (
        "watchdog",
        "Number of periods without set-points after which the moving device brakes. Default: 1",
    ),
    (
        "surface",
        "Horizontal surface under the tool that pushes back like a spring. Default: none",
    ),
    (
        "height",
        "Height of the surface in base coordinates. Default: 0",
    ),
    ("stiffness", "Stiffness of the surface in N/m"),
    (
        "address",
        "Address and port of the controller, such as `192.168.1.2:5005`",
    ),
    (
        "timeout",
        "Time without a state of the controller after which the connection counts as lost. Default: 0.1",
    ),
    ("rtde_port", "TCP port of RTDE. Default: 30004"),
    (
        "script_port",
        "TCP port that accepts URScript programs. Default: 30002",
    ),
    (
        "lookahead",
        "Time by which the controller looks ahead (`servoj`), 0.03 to 0.2 s. Default: 0.1",
    ),
    (
        "gain",
        "Proportional gain of the controller (`servoj`), 100 to 2000. Default: 300",
    ),
    // Injected faults.
    ("faults", "Faults that the simulation injects"),
    ("faults.at", "Time at which the fault begins. Default: 0"),
    ("for", "Duration of the fault. Default: without end"),
    ("trouble", "Kind of the fault"),
    (
        "axis",
        "Axis that rejects set-points, counted from 0; the arm brakes",
    ),
    ("delay", "Time by which samples are older"),
    (
        "deviation",
        "Standard deviation of additional noise on measured positions of the axes",
    ),
    (
        "contact.force",
        "Force of the contact, x, y, z in base coordinates. Default: 0",
    ),
    (
        "contact.torque",
        "Torque of the contact, x, y, z in base coordinates. Default: 0",
    ),
    // Inputs and outputs.
    (
        "inputs",
        "Number of inputs, or a list of their initial values. Default: none",
    ),
    (
        "outputs",
        "Number of outputs, or a list of their initial values. Default: none",
    ),
    (
        "safe",
        "Safe values of outputs, when the command that drove them has failed or the run ends. Default: outputs keep their values",
    ),
    ("safe.output", "Index of the output, from 0"),
    ("safe.value", "Safe value of the output"),
    ("script", "Changes of the inputs. Default: none"),
    ("script.at", "Time of the change"),
    ("script.input", "Index of the input, from 0"),
    ("script.value", "New value"),
    (
        "repeat",
        "Time after which the script restarts with the initial values. Default: never",
    ),
    ("digital", "Digital inputs and outputs. Default: none"),
    ("analogue", "Analogue inputs and outputs. Default: none"),
    // Mobile bases.
    (
        "devices.base.position",
        "Initial position in the cell, x and y. Default: 0",
    ),
    ("heading", "Initial heading. Default: 0"),
    ("track", "Distance between the wheels. Default: 0.4"),
    ("wheel_radius", "Radius of the wheels. Default: 0.1"),
    ("devices.base.velocity", "Velocity limit. Default: 1"),
    ("turning_velocity", "Turning velocity limit. Default: 1.5"),
    (
        "devices.base.acceleration",
        "Acceleration limit. Default: 1",
    ),
    (
        "turning_acceleration",
        "Turning acceleration limit. Default: 3",
    ),
    // Scripts of small devices.
    (
        "force-torque.script.at",
        "Time at which the values begin. Default: 0",
    ),
    ("script.force", "Measured force, x, y, z. Default: 0"),
    ("script.torque", "Measured torque, x, y, z. Default: 0"),
    (
        "light-barrier.script.at",
        "Time at which the value begins. Default: 0",
    ),
    // Robot descriptions.
    ("robot.name", "Name to which cells refer"),
    ("title", "Name of the robot for people. Default: `name`"),
    ("source", "Source of the numbers"),
    (
        "home",
        "Joint positions within the ranges, one number for each axis, at which arms of a cell start by `joints = \"home\"`",
    ),
    (
        "held_axis",
        "Axis, counted from 0, that keeps its value in the inverse of an arm with seven axes and no closed form. Default: the last",
    ),
    (
        "robot.dh",
        "Kinematics as a Denavit-Hartenberg table. A description has one of `dh`, `opw` and `urdf`",
    ),
    (
        "convention",
        "Convention of Denavit and Hartenberg: `standard` (1955) or `modified` (Craig)",
    ),
    (
        "dh.joints",
        "Rows of the table, one for each axis from the base",
    ),
    (
        "dh.flange",
        "Fixed rows after those of the axes. Default: none",
    ),
    ("dh.base", "Pose before the rows. Default: the origin"),
    (
        "dh.end",
        "Pose after the rows. Default: the end of the last row",
    ),
    ("joints.name", "Name of the axis"),
    ("type", "Type of the axis. Default: `revolute`"),
    ("a", "Length a of the row. Default: 0"),
    ("alpha", "Twist alpha of the row. Default: 0"),
    ("d", "Offset d of the row. Default: 0"),
    ("theta", "Angle theta of the row. Default: 0"),
    (
        "joints.offset",
        "Value of theta, or for a prismatic axis the fixed angle, at position 0. Default: 0",
    ),
    ("joints.sign", "Direction of the axis, 1 or -1. Default: 1"),
    (
        "robot.opw",
        "Kinematics of a six-axis arm by its lengths (ortho-parallel basis, spherical wrist), as in the parameter files of ROS-Industrial",
    ),
    ("a1", "Length a1. Default: 0"),
    ("a2", "Length a2. Default: 0"),
    ("b", "Length b. Default: 0"),
    ("c1", "Length c1. Default: 0"),
    ("c2", "Length c2 of the upper arm, greater than 0"),
    ("c3", "Length c3 of the forearm, greater than 0"),
    ("c4", "Length c4. Default: 0"),
    ("opw.sign", "Direction of each axis, 1 or -1. Default: 1"),
    (
        "opw.offset",
        "Offset of each axis: canonical angle = `sign` * joint - `offset`. Default: 0",
    ),
    ("robot.urdf", "Kinematics from a URDF"),
    ("urdf.file", "Path of the URDF relative to this file"),
    ("urdf.base", "Link before the first axis. Default: the root"),
    (
        "urdf.tip",
        "Link after the last axis. Default: the end of the longest chain",
    ),
    (
        "robot.limits",
        "Limits of the axes: one number for all axes, or one for each. They take precedence over those of a URDF",
    ),
    (
        "acceleration_per_velocity",
        "Acceleration limit as a multiple of the velocity limit, in 1/s: one number for all axes, or one for each",
    ),
    (
        "jerk_per_velocity",
        "Jerk limit as a multiple of the velocity limit, in 1/s²: one number for all axes, or one for each",
    ),
    ("assumed", "Limits that are not published"),
];

/// Returns the description of the key at a path, such as `cell.devices.arm.limits.lower`; `None` if there is none.
pub(super) fn of(path: &str) -> Option<&'static str> {
    let is_end = |end: &str| {
        let before = path.strip_suffix(end);
        before.is_some_and(|before| before.is_empty() || before.ends_with('.'))
    };
    let fitting = DESCRIPTIONS.iter().filter(|(end, _)| is_end(end));
    let best = fitting.max_by_key(|(end, _)| end.split('.').count());
    best.map(|(_, text)| *text)
}
