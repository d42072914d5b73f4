//! Valid descriptions with every key, and wrong descriptions.

/// Devices that are no arms, with every key of their kinds, and every type of the values.
const OTHERS: &str = r#"
name = "workbench"
seed = 42
robot_files = [{ path = "other.toml", text = "name = 'other'" }]

[devices.valves]
kind = "digital-io"
inputs = [true, false]
outputs = 8
safe = [{ output = 0, value = false }, { output = 7, value = true }]
repeat = "2 s"
script = [{ at = 1, input = 1, value = true }, { at = 0.5, input = 0, value = false }]

[devices.lamps]
kind = "digital-io"
inputs = 0
outputs = [false]

[devices.gauges]
kind = "analogue-io"
inputs = 2
outputs = [0.5]
safe = [{ output = 0, value = 0 }]
repeat = 2
script = [{ at = 1, input = 1, value = 0.5 }]

[devices.other]
kind = "analogue-io"
inputs = ["1.5", 2]
outputs = 3

[devices.box]
kind = "io"
digital = { inputs = 1, outputs = 1, safe = [{ output = 0, value = true }], repeat = 2, script = [{ at = "1 ms", input = 0, value = true }] }
analogue = { inputs = [1.5], outputs = [2], safe = [{ output = 0, value = "-1.5" }], repeat = 1, script = [{ at = "10 ms", input = 0, value = -1 }] }

[devices.box2]
kind = "io"
digital = { inputs = [true], outputs = [true] }
analogue = { inputs = 1, outputs = 1 }

[devices.cart]
kind = "base"
position = [1, "20 cm"]
heading = "90 deg"
track = 0.5
wheel_radius = "10 cm"
velocity = "800 mm/s"
turning_velocity = "90 deg/s"
acceleration = 1
turning_acceleration = "90 deg/s^2"
watchdog = 2

[devices.fingers]
kind = "gripper"
lower = 0
upper = "100 mm"
width = 0.05
speed = 0.1
force = "20 N"
object = "30 mm"
script = [{ at = 1, value = true }, { at = 2, value = false }]

[devices.probe]
kind = "force-torque"
script = [{ at = 2, force = [0, 0, -5], torque = [0, 0, 0] }, { at = 3 }]
repeat = 4
noise = 0.1

[devices.barrier]
kind = "light-barrier"
script = [{ at = 1, value = true }]
repeat = 3

[devices.belt]
kind = "conveyor"
velocity = "500 mm/s"
acceleration = 2
watchdog = 2

[devices.mill]
kind = "spindle"
velocity = "100 rad/s"
acceleration = 200
tolerance = 1
torque = 2
seat = 50
watchdog = 2
"#;

/// Keys of an arm after its head; `LIST` is a list with 0.1 for each axis.
const ARM: &str = r#"
joints = LIST
base = { position = [0, "300 mm", 0], rpy = [0, 0, "90 deg"] }
tool = { position = [0, 0, 0.1], quaternion = [0, 0, 0, 1] }
enforce = ["position", "velocity", "acceleration", "jerk"]
lag = "5 ms"
latency = 0.002
noise = 1e-5
watchdog = 3
limits = { velocity = 1.0, acceleration = 2, jerk = 600, upper = 2.0, lower = -2.0 }
tool_limits = { speed = "1 m/s", acceleration = 2, jerk = 30 }
surface = { height = "-1_0 mm", stiffness = 1000 }
faults = [
  { at = 1.5, for = "200 ms", trouble = "joint-failure", axis = 0 },
  { at = 1, for = 1, trouble = "contact", force = [0, 0, "-5 N"], torque = [0, 0, "1 N m"] },
  { at = 1, for = 1, trouble = "emergency-stop" },
  { at = 1, for = 1, trouble = "lost-samples" },
  { at = 1, for = 1, trouble = "lost-set-points" },
  { at = 1, for = 1, trouble = "latency", delay = "1 ms" },
  { at = 1, for = 1, trouble = "noise", deviation = 0.1 },
]
"#;

/// Keys of an arm whose values have other types than those in [`ARM`].
const OTHER_ARM: &str = r#"
base = { quaternion = [0, 0, 0, 1] }
tool = { rpy = [0, 0, 0] }
limits = { velocity = LIST, acceleration = LIST, jerk = LIST, lower = LOW, upper = LIST }
"#;

/// Key of an arm at the home position of its description.
const HOME_ARM: &str = "joints = 'home'\n";

/// Heads of arms, linear units and positioners, each with the number of axes.
const HEADS: &[(&str, usize)] = &[
    ("kind = 'arm'\nmodel = 'kuka-iiwa-7'", 7),
    ("kind = 'arm'\nmodel = 'scara-600.toml'", 4),
    (
        "kind = 'udp-arm'\nmodel = 'ur5e'\naddress = '127.0.0.1:5005'\ntimeout = 1",
        6,
    ),
    (
        "kind = 'udp-arm'\nmodel = 'ur5e.toml'\naddress = '127.0.0.1:5005'\ntimeout = '1 ms'",
        6,
    ),
    (
        "kind = 'ur-arm'\nmodel = 'ur5e'\naddress = '10.0.0.2'\ntimeout = 1\nlookahead = 0.1\ngain = 300",
        6,
    ),
    (
        "kind = 'ur-arm'\nmodel = 'ur5e.toml'\naddress = 'ur.local'\nrtde_port = 30004\nscript_port = 30002\nlookahead = '30 ms'",
        6,
    ),
    ("kind = 'linear-unit'", 1),
    ("kind = 'positioner'", 2),
];

/// Returns a cell with every key of every kind of devices, and every type of their values.
pub(crate) fn cell() -> String {
    let mut text = OTHERS.to_owned();
    for (number, (head, axes)) in HEADS.iter().enumerate() {
        let list = |value: &str| format!("[{}]", vec![value; *axes].join(", "));
        for (name, keys) in [("one", ARM), ("other", OTHER_ARM), ("home", HOME_ARM)] {
            let keys = keys
                .replace("LOW", &list("-0.1"))
                .replace("LIST", &list("0.1"));
            text += &format!("\n[devices.{name}-{number}]\n{head}\n{keys}");
        }
    }
    text
}

/// Robot descriptions that use every key together.
pub(crate) const ROBOTS: &[&str] = &[
    r#"
name = "schema-sample-1"
title = "Arm of the workshop"
source = "drawing"
held_axis = 0
home = ["10 deg", 0.5]

[dh]
convention = "modified"
base = { position = [0, 0, "1 m"], rpy = [0, 0, 0] }
end = { position = [0, 0, 0.1], quaternion = [0, 0, 0, 1] }
joints = [
  { name = "first", type = "revolute", a = 0, alpha = 0, d = 0.333, offset = "1 deg", sign = -1 },
  { type = "prismatic", alpha = "-90 deg", d = "316 mm" },
]
flange = [{ a = 0, alpha = 0, d = 0.107, theta = "-45 deg" }]

[limits]
lower = ["-170 deg", 0]
upper = ["170 deg", "1 m"]
velocity = ["120 deg/s", "1 m/s"]
acceleration = [1, 2]
jerk = [10, 20]
assumed = ["range", "velocity", "acceleration", "jerk"]
"#,
    r#"
name = "schema-sample-2"

[dh]
convention = "standard"
base = { quaternion = [0, 0, 0, 1] }
end = { rpy = [0, 0, 0] }
joints = [{ d = 1 }]

[limits]
lower = -1
upper = "1 rad"
velocity = 1
acceleration = 1
jerk = 1
acceleration_per_velocity = 3
jerk_per_velocity = 60
"#,
    r#"
name = "schema-sample-3"
opw = { a1 = 0, a2 = 0, b = 0, c1 = 1, c2 = "1 m", c3 = 1, c4 = 0, sign = [1, 1, 1, 1, 1, -1], offset = [0, 0, 0, 0, 0, "1 deg"] }
limits = { lower = -1, upper = 1, velocity = 1, acceleration_per_velocity = [1, 2, 3, 4, 5, 6], jerk_per_velocity = [1, 2, 3, 4, 5, 6] }
"#,
    r#"
name = "schema-sample-4"
urdf = { file = "portal-3.urdf", base = "base_link", tip = "flange" }
limits = { velocity = 1 }
"#,
];

/// Wrong cells that the schema can reject.
pub(crate) const WRONG_CELLS: &[&str] = &[
    "devices = 3",
    "[devices]\narm = 3",
    "[device.arm]\nkind = \"arm\"",
    "[devices.a]\nmodel = \"kuka-lwr4+\"",
    "[devices.a]\nkind = \"leg\"",
    "[devices.a]\nkind = 7",
    "seed = -1",
    "seed = 1.5",
    "name = 3",
    "robot_files = [{ path = \"a.toml\" }]",
    "[devices.a]\nkind = \"arm\"",
    "[devices.a]\nkind = \"arm\"\nmodel = \"kuka-iiwa-77\"",
    "[devices.a]\nkind = \"arm\"\nmodel = \"arm.yaml\"",
    "[devices.a]\nkind = \"arm\"\nmodel = \"kuka-lwr4+\"\njoint = [1]",
    "[devices.a]\nkind = \"arm\"\nmodel = \"kuka-lwr4+\"\njoints = [0, 0, 0, 0, 0, 0, 0, 0]",
    "[devices.a]\nkind = \"arm\"\nmodel = \"kuka-lwr4+\"\njoints = [0, 0, \"3 kg\", 0, 0, 0, 0]",
    "[devices.a]\nkind = \"arm\"\nmodel = \"kuka-lwr4+\"\njoints = 0",
    "[devices.a]\nkind = \"arm\"\nmodel = \"kuka-lwr4+\"\nlag = -1",
    "[devices.a]\nkind = \"arm\"\nmodel = \"kuka-lwr4+\"\nlag = \"3 mm\"",
    "[devices.a]\nkind = \"arm\"\nmodel = \"kuka-lwr4+\"\nlag = \"fast\"",
    "[devices.a]\nkind = \"arm\"\nmodel = \"kuka-lwr4+\"\nwatchdog = 0",
    "[devices.a]\nkind = \"arm\"\nmodel = \"kuka-lwr4+\"\nwatchdog = 1001",
    "[devices.a]\nkind = \"arm\"\nmodel = \"kuka-lwr4+\"\nenforce = [\"speed\"]",
    "[devices.a]\nkind = \"arm\"\nmodel = \"kuka-lwr4+\"\nlimits = { speed = 1 }",
    "[devices.a]\nkind = \"arm\"\nmodel = \"kuka-lwr4+\"\ntool = { quaternion = [1, 0, 0] }",
    "[devices.a]\nkind = \"arm\"\nmodel = \"kuka-lwr4+\"\nsurface = { stiffness = 0 }",
    "[devices.a]\nkind = \"arm\"\nmodel = \"kuka-lwr4+\"\nfaults = [{ trouble = \"joint-failure\" }]",
    "[devices.a]\nkind = \"arm\"\nmodel = \"kuka-lwr4+\"\nfaults = [{ trouble = \"latency\", axis = 1 }]",
    "[devices.a]\nkind = \"arm\"\nmodel = \"kuka-lwr4+\"\nfaults = [{ at = 1 }]",
    "[devices.a]\nkind = \"arm\"\nmodel = \"kuka-lwr4+\"\nfaults = [{ trouble = \"joint-failure\", axis = 7 }]",
    "[devices.a]\nkind = \"udp-arm\"\nmodel = \"ur5e\"",
    "[devices.a]\nkind = \"ur-arm\"\nmodel = \"ur5e\"",
    "[devices.a]\nkind = \"ur-arm\"\nmodel = \"ur5e\"\naddress = \"a\"\nrtde_port = 0",
    "[devices.a]\nkind = \"linear-unit\"\njoints = [0, 0]",
    "[devices.a]\nkind = \"linear-unit\"\nlimits = { upper = \"30 deg\" }",
    "[devices.a]\nkind = \"linear-unit\"\nmodel = \"ur5e\"",
    "[devices.a]\nkind = \"digital-io\"\ninputs = [1]",
    "[devices.a]\nkind = \"digital-io\"\ninputs = 5000",
    "[devices.a]\nkind = \"analogue-io\"\ninputs = [true]",
    "[devices.a]\nkind = \"digital-io\"\ninputs = 1\nscript = [{ at = 0, input = 0 }]",
    "[devices.a]\nkind = \"digital-io\"\ninputs = 1\nscript = [{ at = 0, input = 0, value = 1 }]",
    "[devices.a]\nkind = \"base\"\ntrack = 0",
    "[devices.a]\nkind = \"base\"\nposition = [0, 0, 0]",
    "[devices.a]\nkind = \"gripper\"\nforce = \"3 m\"",
    "[devices.a]\nkind = \"light-barrier\"\nscript = [{ at = 1 }]",
];

/// Wrong robot descriptions that the schema can reject.
pub(crate) const WRONG_ROBOTS: &[&str] = &[
    "title = \"no name\"\ndh = { convention = \"standard\", joints = [{}] }\nlimits = { lower = -1, upper = 1, velocity = 1 }",
    "name = \"a\"\ndh = { convention = \"other\", joints = [{}] }\nlimits = { lower = -1, upper = 1, velocity = 1 }",
    "name = \"a\"\ndh = { joints = [{}] }\nlimits = { lower = -1, upper = 1, velocity = 1 }",
    "name = \"a\"\ndh = { convention = \"standard\", joints = [] }\nlimits = { lower = -1, upper = 1, velocity = 1 }",
    "name = \"a\"\ndh = { convention = \"standard\", joints = [{ aplha = 1 }] }\nlimits = { lower = -1, upper = 1, velocity = 1 }",
    "name = \"a\"\ndh = { convention = \"standard\", joints = [{ d = \"30 deg\" }] }\nlimits = { lower = -1, upper = 1, velocity = 1 }",
    "name = \"a\"\ndh = { convention = \"standard\", joints = [{}] }\nlimits = { lower = -1, upper = 1, speed = 1 }",
    "name = \"a\"\ndh = { convention = \"standard\", joints = [{}] }\nlimits = { lower = -1, upper = 1, velocity = true }",
    "name = \"a\"\ndh = { convention = \"standard\", joints = [{}] }\nlimits = { lower = -1, upper = 1, velocity = 1, assumed = [\"lag\"] }",
    "name = \"a\"\nheld_axis = 7\ndh = { convention = \"standard\", joints = [{}] }\nlimits = { lower = -1, upper = 1, velocity = 1 }",
    "name = \"a\"\nopw = { c2 = 1, c3 = 1, sign = [1, 1, 1] }\nlimits = { lower = -1, upper = 1, velocity = 1 }",
    "name = \"a\"\nurdf = { tip = \"tool0\" }",
];
