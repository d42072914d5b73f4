//! Cell descriptions: valid contents, and the messages for errors.

use rpi_sim::cell::{ArmSpec, DeviceKind};
use rpi_sim::{Cell, FaultKind};

fn good(text: &str) -> Cell {
    Cell::parse("cell.toml", text).unwrap_or_else(|errors| panic!("{errors}"))
}

fn faults(text: &str) -> String {
    Cell::parse("cell.toml", text)
        .expect_err("a fault")
        .to_string()
}

fn arm(cell: &Cell, name: &str) -> ArmSpec {
    match &cell.device(name).expect("a device").kind {
        DeviceKind::Arm(arm) => arm.clone(),
        other => panic!("an arm, not {other:?}"),
    }
}

const EVERYTHING: &str = r#"
name = "workbench"
seed = 42

[devices.left]
kind = "arm"
model = "kuka-iiwa-7"
joints = [0, 0.5, 0, "-1.2 rad", 0, "50[deg]", 0]
base = { position = [0, "300 mm", 0], rpy = [0, 0, "90 deg"] }
tool = { position = [0, 0, 0.1], quaternion = [0, 0, 0, 1] }
enforce = ["position", "velocity"]
lag = "5 ms"
latency = 0.002
noise = 1e-5

[devices.left.limits]
velocity = 1.0
acceleration = [1, 2, 3, 4, 5, 6, 7]
jerk = "600 deg/s^3"
upper = 2.0
lower = -2.0

[[devices.left.faults]]
at = 1.5
for = "200 ms"
trouble = "joint-failure"
axis = 3

[[devices.left.faults]]
trouble = "contact"
force = [0, 0, -5]

[devices.valves]
kind = "digital-io"
inputs = [true, false]
outputs = 8
repeat = "2 s"
script = [{ at = 1, input = 1, value = true }, { at = 0.5, input = 0, value = false }]

[devices.gauges]
kind = "analogue-io"
inputs = 2
outputs = [0.5]

[devices.box]
kind = "io"
digital = { inputs = 1, outputs = 1 }
analogue = { inputs = [1.5], script = [{ at = "10 ms", input = 0, value = -1 }] }
"#;

#[test]
fn everything_that_may_be_said_is_understood() {
    let cell = good(EVERYTHING);
    assert_eq!((cell.name.as_str(), cell.seed), ("workbench", 42));
    let names: Vec<&str> = cell
        .devices
        .iter()
        .map(|device| device.name.as_str())
        .collect();
    assert_eq!(
        names,
        ["left", "valves", "gauges", "box"],
        "in the order of the text"
    );
    let left = arm(&cell, "left");
    assert_eq!(left.model.id, "kuka-iiwa-7");
    assert_eq!(left.joints[3], -1.2);
    assert!((left.joints[5] - 50_f64.to_radians()).abs() < 1e-15);
    assert!(
        (left.base * nalgebra::Point3::new(1.0, 0.0, 0.0) - nalgebra::Point3::new(0.0, 1.3, 0.0))
            .norm()
            < 1e-15
    );
    assert_eq!(left.tool.translation.z, 0.1);
    assert!(left.enforced.velocity && !left.enforced.jerk);
    assert_eq!(left.limits[6].acceleration, 7.0);
    assert_eq!(left.limits[2].velocity, 1.0);
    assert!((left.limits[0].jerk - 600_f64.to_radians()).abs() < 1e-12);
    assert_eq!((left.lag, left.latency, left.noise), (0.005, 0.002, 1e-5));
    assert_eq!(left.faults[0].kind, FaultKind::JointFailure(3));
    assert!(
        left.faults[0].is_active(1.6)
            && !left.faults[0].is_active(1.75)
            && left.faults[1].is_active(1e9)
    );
    let DeviceKind::Io(valves) = &cell.devices[1].kind else {
        panic!("valves are terminals")
    };
    assert_eq!(valves.digital.outputs.len(), 8);
    assert_eq!(valves.digital.script[0].at, 0.5, "in the order of time");
}

#[test]
fn what_is_not_said_is_the_models() {
    let cell = good("[devices.a]\nkind = \"arm\"\nmodel = \"kuka-iiwa-14\"\n");
    let arm = self::arm(&cell, "a");
    assert_eq!(arm.joints, [0.0; 7]);
    assert_eq!(arm.limits, arm.model.limits);
    assert!(
        arm.enforced.position
            && arm.enforced.velocity
            && arm.enforced.acceleration
            && arm.enforced.jerk
    );
    assert!(arm.faults.is_empty() && arm.lag == 0.0);
    assert!(good("").devices.is_empty());
    let panda = good("[devices.a]\nkind = \"arm\"\nmodel = \"franka-panda\"\n");
    assert_eq!(
        self::arm(&panda, "a").joints[3],
        -0.0698,
        "the end of its range, which has no zero"
    );
}

#[test]
fn every_fault_is_told_in_one_run() {
    let text = "[devices.left]\nkind = \"arm\"\nmodel = \"kuka-iiwa-77\"\njoint = [1]\n[devices.right]\nkind = \"leg\"\n";
    let expected = "\
cell.toml:3:9: unknown value \"kuka-iiwa-77\" for `model`
 3 | model = \"kuka-iiwa-77\"
   |         ^^^^^^^^^^^^^^
   = did you mean `kuka-iiwa-7`?
cell.toml:4:1: unknown key `joint`
 4 | joint = [1]
   | ^^^^^
   = did you mean `joints`?
cell.toml:6:8: unknown value \"leg\" for `kind`
 6 | kind = \"leg\"
   |        ^^^^^
   = expected one of arm, udp-arm, ur-arm, digital-io, analogue-io, io, linear-unit, positioner, base, gripper, force-torque, light-barrier, conveyor, spindle
";
    assert_eq!(faults(text), expected);
}

/// Invalid descriptions, each with a part of the expected message.
const BROKEN: &[(&str, &str)] = &[
    (
        "devices = 3",
        "1:11: expected a table for `devices`, found integer",
    ),
    ("[devices]\narm = 3", "2:1: device `arm` must be a table"),
    ("[device.arm]\nkind = \"arm\"", "1:2: unknown key `device`"),
    (
        "[devices.a]\nmodel = \"kuka-lwr4+\"",
        "1:1: device `a` has no `kind`",
    ),
    ("[devices.a]\nkind = \"arm\"", "1:1: `model` is missing"),
    (
        "[devices.a]\nkind = 7",
        "2:8: expected a string for `kind`, found integer",
    ),
    ("seed = -1", "1:8: `seed` is -1, out of range"),
    ("name = \"a", "1:10: invalid basic string"),
    (
        "[devices.a]\nkind = \"arm\"\nmodel = \"kuka-lwr4+\"\njoints = [0, 0]",
        "4:10: `joints` has 2 entries, expected 7",
    ),
    (
        "[devices.a]\nkind = \"arm\"\nmodel = \"kuka-lwr4+\"\njoints = [0, 0, \"3 mm\", 0, 0, 0, 0]",
        "4:17: `joints[2]` is not a valid number",
    ),
    (
        "[devices.a]\nkind = \"arm\"\nmodel = \"kuka-lwr4+\"\njoints = [0, 0, nan, 0, 0, 0, 0]",
        "4:17: `joints[2]` is not a finite number",
    ),
    (
        "[devices.a]\nkind = \"arm\"\nmodel = \"kuka-lwr4+\"\njoints = [0, 2.5, 0, 0, 0, 0, 0]",
        "4:14: initial position 2.5 rad of joint 1 is out of range",
    ),
    (
        "[devices.a]\nkind = \"arm\"\nmodel = \"kuka-lwr4+\"\nlag = -1",
        "4:7: `lag` is -1 s, expected 0 s or more",
    ),
    (
        "[devices.a]\nkind = \"arm\"\nmodel = \"kuka-lwr4+\"\nenforce = [\"speed\"]",
        "4:12: unknown value \"speed\" for `enforce[0]`",
    ),
    (
        "[devices.a]\nkind = \"arm\"\nmodel = \"kuka-lwr4+\"\nlimits = { velocity = 0 }",
        "4:23: velocity limit of axis 0 is 0 rad/s, expected more than 0 rad/s",
    ),
    (
        "[devices.a]\nkind = \"arm\"\nmodel = \"kuka-lwr4+\"\ntool = { quaternion = [1, 1, 0, 0] }",
        "4:23: `quaternion` has length 1.4142, expected 1",
    ),
    (
        "[devices.a]\nkind = \"arm\"\nmodel = \"kuka-lwr4+\"\ntool = { rpy = [0, 0, 0], quaternion = [0, 0, 0, 1] }",
        "4:16: `rpy` and `quaternion` cannot be combined",
    ),
    (
        "[devices.a]\nkind = \"arm\"\nmodel = \"kuka-lwr4+\"\nfaults = [{ trouble = \"joint-failure\" }]",
        "4:11: `axis` is missing",
    ),
    (
        "[devices.a]\nkind = \"arm\"\nmodel = \"kuka-lwr4+\"\nfaults = [{ trouble = \"joint-failure\", axis = 7 }]",
        "4:47: `axis` is 7, out of range",
    ),
    (
        "[devices.a]\nkind = \"ur-arm\"\nmodel = \"ur5e\"",
        "1:1: `address` is missing",
    ),
    (
        "[devices.a]\nkind = \"ur-arm\"\nmodel = \"ur5e\"\naddress = \"10.0.0.2:30004\"",
        "4:11: `10.0.0.2:30004` is not a name or an IP address",
    ),
    (
        "[devices.a]\nkind = \"ur-arm\"\nmodel = \"kuka-lwr4+\"\naddress = \"ur\"",
        "3:9: model `kuka-lwr4+` has 7 axes, expected 6",
    ),
    (
        "[devices.a]\nkind = \"ur-arm\"\nmodel = \"kuka-kr6-r900\"\naddress = \"ur\"",
        "3:9: model `kuka-kr6-r900` is a KUKA",
    ),
    (
        "[devices.a]\nkind = \"ur-arm\"\nmodel = \"ur5e\"\naddress = \"ur\"\ntimeout = 1e30",
        "5:11: `timeout` is",
    ),
    (
        "[devices.a]\nkind = \"ur-arm\"\nmodel = \"ur5e\"\naddress = \"ur\"\ntimeout = \"5 ms\"",
        "5:11: `timeout` is 0.005 s",
    ),
    (
        "[devices.a]\nkind = \"ur-arm\"\nmodel = \"ur5e\"\naddress = \"ur\"\nlookahead = 0.3",
        "5:13: `lookahead` is 0.3 s",
    ),
    (
        "[devices.a]\nkind = \"ur-arm\"\nmodel = \"ur5e\"\naddress = \"ur\"\ngain = 99",
        "5:8: `gain` is 99",
    ),
    (
        "[devices.a]\nkind = \"digital-io\"\ninputs = [1]",
        "3:11: expected true or false for `inputs[0]`, found integer",
    ),
    (
        "[devices.a]\nkind = \"analogue-io\"\ninputs = [true]",
        "3:11: expected a number for `inputs[0]`, found boolean",
    ),
    (
        "[devices.a]\nkind = \"digital-io\"\ninputs = 1\nscript = [{ at = 0, input = 1, value = true }]",
        "4:29: `input` is 1, out of range",
    ),
    (
        "[devices.a]\nkind = \"digital-io\"\ninputs = 1\nscript = [{ at = 0, input = 0 }]",
        "4:11: `value` is missing",
    ),
    (
        "[devices.a]\nkind = \"digital-io\"\ninputs = 1\nrepeat = 1\nscript = [{ at = 1, input = 0, value = true }]",
        "4:10: `repeat` is 1 s, expected more than 1 s",
    ),
    (
        "[devices.a]\nkind = \"digital-io\"\noutputs = 1\nsafe = [{ output = 1, value = true }]",
        "4:20: `output` is 1, out of range",
    ),
    (
        "[devices.a]\nkind = \"digital-io\"\noutputs = 1\nsafe = [{ output = 0, value = true }, { output = 0, value = false }]",
        "4:50: this output has a safe value already",
    ),
];

#[test]
fn each_fault_has_its_place_and_its_words() {
    for (text, expected) in BROKEN {
        let errors = faults(text);
        assert!(
            errors.contains(&format!("cell.toml:{expected}")),
            "{text}\n--- expected {expected}, got\n{errors}"
        );
    }
}

/// Invalid descriptions of an arm, each with a part of the expected message and the expected help.
const BROKEN_WITH_HELP: &[(&str, &str, &str)] = &[
    (
        "joints = [0, 0]",
        "4:10: `joints` has 2 entries, expected 7",
        "expected a number in rad, or a string with one of the units rad, deg",
    ),
    (
        "joints = [0, 0, \"3 mm\", 0, 0, 0, 0]",
        "4:17: `joints[2]` is not a valid number",
        "expected one of the units rad, deg",
    ),
    (
        "joints = [0, 2.5, 0, 0, 0, 0, 0]",
        "4:14: initial position 2.5 rad of joint 1",
        "the range is -2.0944 to 2.0944 rad",
    ),
    (
        "limits = { lower = [1, 1, 1, 1, 1, 1, 1], upper = 0 }",
        "4:51: axis 0 has an empty range: 1 to 0 rad",
        "`lower` must be less than `upper`",
    ),
    (
        "watchdog = 0",
        "4:12: `watchdog` is 0, out of range",
        "the range is 1 to 1000 periods",
    ),
    (
        "watchdog = 1.5",
        "4:12: expected an integer for `watchdog`, found float",
        "the range is 1 to 1000 periods",
    ),
    (
        "faults = [{ trouble = \"noise\" }]",
        "4:11: `deviation` is missing",
        "expected an angle in rad",
    ),
    (
        "faults = [{ at = 1 }]",
        "4:11: `trouble` is missing",
        "expected one of joint-failure, emergency-stop",
    ),
    (
        "tool = { position = [0, 0] }",
        "4:21: `position` has 2 entries, expected 3",
        "expected a number in m, or a string with one of the units m, cm, mm, um",
    ),
    (
        "jionts = [0]",
        "4:1: unknown key `jionts`",
        "did you mean `joints`?",
    ),
];

#[test]
fn each_fault_states_what_is_expected() {
    for (line, message, help) in BROKEN_WITH_HELP {
        let text = format!("[devices.a]\nkind = \"arm\"\nmodel = \"kuka-lwr4+\"\n{line}");
        let errors = faults(&text);
        let expected = format!("cell.toml:{message}");
        assert!(
            errors.contains(&expected) && errors.contains(help),
            "{line}\n--- expected {message}, {help}, got\n{errors}"
        );
    }
}

/// Only the part of a long line around the error is shown.
#[test]
fn a_fault_far_to_the_right_is_shown() {
    let errors = faults(&format!("a = {}", "[".repeat(100_000)));
    assert!(errors.contains("cell.toml:1:"), "{errors}");
    assert!(errors.lines().all(|line| line.len() < 300), "{errors}");
    let (_, marked) = errors.split_once('^').expect("the fault is marked");
    assert!(!marked.is_empty());
}

#[test]
fn no_prefix_of_a_description_panics() {
    for end in 0..EVERYTHING.len() {
        let text = &EVERYTHING[..end];
        if let Err(errors) = Cell::parse("cell.toml", text) {
            assert!(!errors.errors.is_empty() && !errors.to_string().is_empty());
        }
    }
}

#[test]
fn the_cells_of_the_examples_are_good() {
    let cells = rpi_testkit::files_below("examples", &["cell.toml"]);
    assert!(!cells.is_empty());
    for path in cells {
        let text = std::fs::read_to_string(&path).expect("a readable file");
        let cell = Cell::parse(&path.to_string_lossy(), &text);
        assert!(
            cell.is_ok_and(|cell| !cell.devices.is_empty()),
            "{}",
            path.display()
        );
    }
}
