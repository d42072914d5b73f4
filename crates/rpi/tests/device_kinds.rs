//! Every kind of device that a cell can name has a type in the standard library, a section in the manual, and a program
//! that runs on it.

use std::collections::BTreeSet;

use rpi_device::PortKind;
use rpi_diag::FileId;
use rpi_sim::Cell;
use rpi_sim::cell::KindInfo;
use rpi_syntax::ast::{self, DeviceDecl, ItemKind, TypeKind};
use rpi_syntax::{Dialect, parse};

mod support;
use support::{output_text, rpi};

/// A kind of device with keys of its cell, the type of a parameter, and the body of a command that ends with `done`.
struct Case {
    kind: &'static str,
    keys: &'static str,
    parameter: &'static str,
    body: &'static str,
}

const CASES: &[Case] = &[
    Case {
        kind: "arm",
        keys: "model = \"ur5e\"",
        parameter: "Arm<<6>>",
        body: "d.joints = d.commanded; finish done when time > 10[ms] and not d.error;",
    },
    Case {
        kind: "digital-io",
        keys: "inputs = [true]\noutputs = 1",
        parameter: "DigitalIo<<1, 1>>",
        body: "d.set = d.get; finish done when d.get[0];",
    },
    Case {
        kind: "analogue-io",
        keys: "inputs = [0.5]\noutputs = 1",
        parameter: "AnalogueIo<<1, 1>>",
        body: "d.set = d.get; finish done when d.get[0] > 0.4;",
    },
    Case {
        kind: "io",
        keys: "digital = { inputs = [true], outputs = 1 }",
        parameter: "DigitalIo<<1, 1>>",
        body: "d.set = d.get; finish done when d.get[0];",
    },
    Case {
        kind: "linear-unit",
        keys: "",
        parameter: "LinearUnit",
        body: "s = min(1.0, (0.0 -> pre s + 0.0005));
            d.axis = 100[mm] * s * s * s * (10.0 + s * (6.0 * s - 15.0));
            finish done when d.axis_position >= 99.999[mm] and abs(d.axis_velocity) < 1e-6[m/s]
                and d.axis_commanded > 99[mm];
            fail wrong when d.error or time > 3[s];",
    },
    Case {
        kind: "positioner",
        keys: "",
        parameter: "Positioner",
        body: "s = min(1.0, (0.0 -> pre s + 0.0005));
            turn = 10[deg] * s * s * s * (10.0 + s * (6.0 * s - 15.0));
            d.axes = [turn, turn];
            finish done when d.axis_position[1] > 9.99[deg] and d.axis_velocity[0] < 1[rad/s]
                and d.axis_commanded[0] > 9[deg];
            fail wrong when d.error or time > 3[s];",
    },
    Case {
        kind: "base",
        keys: "",
        parameter: "MobileBase",
        body: "v = if time < 1[s] then 0.1 * (time / 1[s]) * 1[m/s] else max(0[m/s], (2.0 - time / 1[s]) * 100[mm/s]);
            d.velocity = Twist{linear = vector(v, 0[m/s], 0[m/s]); angular = vector(0[rad/s], 0[rad/s], 0[rad/s])};
            finish done when time > 2.1[s];
            fail wrong when d.error;",
    },
    Case {
        kind: "gripper",
        keys: "object = \"30 mm\"",
        parameter: "Gripper",
        body: "d.width = 0[mm];
            finish done when d.holding and d.opening > 29[mm] and d.force > 10[N] and not d.moving and d.speed = 0[m/s];
            fail wrong when time > 2[s] or d.error;",
    },
    Case {
        kind: "gripper",
        keys: "object = \"30 mm\"\nscript = [{ at = \"1.5 s\", value = false }]",
        parameter: "Gripper",
        body: "d.width = 0[mm];
            held = (false -> pre held) or d.holding;
            finish done when held and time > 1.5[s] and not d.holding and d.opening < 1[mm];
            fail wrong when time > 3[s] or d.error;",
    },
    Case {
        kind: "force-torque",
        keys: "script = [{ at = 0.1, force = [0, 0, -5] }]",
        parameter: "ForceSensor",
        body: "finish done when d.wrench.force.z < -4[N]; fail wrong when time > 1[s];",
    },
    Case {
        kind: "light-barrier",
        keys: "script = [{ at = 0.1, value = true }]",
        parameter: "LightBarrier",
        body: "finish done when d.interrupted and time > 90[ms]; fail wrong when time > 110[ms];",
    },
    Case {
        kind: "conveyor",
        keys: "acceleration = 2",
        parameter: "Conveyor",
        body: "d.speed = if d.position < 100[mm] then 200[mm/s] else 0[mm/s];
            finish done when d.position > 100[mm] and not d.moving and d.velocity = 0[m/s];
            fail wrong when d.error or time > 2[s];",
    },
    Case {
        kind: "spindle",
        keys: "",
        parameter: "Spindle",
        body: "fast = time < 1[s];
            d.speed = if fast then 300[rad/s] else 0[rad/s];
            reached = (false -> pre reached) or d.at_speed;
            finish done when reached and not fast and d.velocity = 0[rad/s];
            fail wrong when d.error or time > 3[s];",
    },
    Case {
        kind: "spindle",
        keys: "seat = 30\ntorque = 2",
        parameter: "Spindle",
        body: "d.speed = 60[rad/s];
            finish done when d.torque > 1.999[N*m] and d.velocity = 0[rad/s] and d.angle > 30.39[rad] and d.angle < 30.41[rad];
            fail wrong when d.error or d.torque > 0[N*m] and d.angle < 30[rad] or time > 3[s];",
    },
];

/// Runs a command on a device. Returns the exit status and the output.
fn run(kind: &str, keys: &str, parameter: &str, body: &str) -> (Option<i32>, String) {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    let cell = format!("[devices.d]\nkind = \"{kind}\"\n{keys}\n");
    std::fs::write(path("cell.toml"), cell).unwrap();
    let program =
        format!("use devices, io, motion;\ncommand Use (d: {parameter})\nlet\n{body}\ntel\n");
    std::fs::write(path("use.rpi"), program).unwrap();
    let output = rpi(&["run", path("use.rpi").to_str().unwrap(), "--time", "5s"]);
    (output.status.code(), output_text(&output))
}

#[test]
fn a_program_runs_on_every_kind() {
    let kinds: BTreeSet<&str> = Cell::kinds().map(|kind| kind.name).collect();
    // These kinds need a controller: their programs are in `udp_arm` and `rtde`.
    let driven = ["udp-arm", "ur-arm"];
    let tested = CASES.iter().map(|case| case.kind).chain(driven);
    let tested: BTreeSet<&str> = tested.collect();
    assert_eq!(kinds, tested, "each kind has a case");
    for case in CASES {
        let (code, output) = run(case.kind, case.keys, case.parameter, case.body);
        assert_eq!(code, Some(0), "{}: {output}", case.kind);
        assert!(output.contains("done"), "{}: {output}", case.kind);
    }
}

/// Device types of the standard library.
fn library_devices() -> Vec<DeviceDecl> {
    let root = rpi_testkit::workspace_root().join("stdlib");
    let read = |file: &str| {
        let text = std::fs::read_to_string(root.join(file)).unwrap();
        parse(FileId(0), &text, Dialect::Rpi).file.items
    };
    let items = ["devices.rpi", "io.rpi", "motion.rpi"]
        .into_iter()
        .flat_map(read);
    items
        .filter_map(|item| match item.kind {
            ItemKind::Device(device) => Some(*device),
            _ => None,
        })
        .collect()
}

/// Names of the ports of a device type with their kinds; those of a struct with a dot.
fn ports(device: &DeviceDecl) -> BTreeSet<(String, bool)> {
    let mut all = BTreeSet::new();
    for section in &device.sections {
        let is_actuator = section.kind == ast::PortKind::Actuator;
        let variables = section.ports.iter().flat_map(|port| &port.alternatives);
        for variable in variables {
            for name in &variable.names {
                match &variable.ty.kind {
                    TypeKind::Struct(parts) => all.extend(parts.iter().flat_map(|part| {
                        part.names
                            .iter()
                            .map(|part| (format!("{}.{}", name.name, part.name), is_actuator))
                    })),
                    _ => drop(all.insert((name.name.to_string(), is_actuator))),
                }
            }
        }
    }
    all
}

/// Names of the ports of all devices of a kind, with their kinds.
fn simulated_ports(kind: &KindInfo) -> BTreeSet<(String, bool)> {
    let ports = kind.ports().into_iter();
    ports
        .map(|port| (port.name.to_owned(), port.kind == PortKind::Actuator))
        .collect()
}

#[test]
fn every_kind_has_its_type_and_every_type_its_ports() {
    let library = library_devices();
    let mut used = BTreeSet::new();
    for kind in Cell::kinds() {
        for ty in kind.device_types {
            let device = library
                .iter()
                .find(|device| device.name.name.as_str() == *ty);
            let device = device.unwrap_or_else(|| panic!("`{}` has no type `{ty}`", kind.name));
            used.insert(device.name.name.to_string());
            let missing: Vec<_> = ports(device)
                .difference(&simulated_ports(&kind))
                .cloned()
                .collect();
            assert!(
                missing.is_empty(),
                "`{}` lacks {missing:?} of `{ty}`",
                kind.name
            );
        }
    }
    let all: BTreeSet<String> = library
        .iter()
        .map(|device| device.name.name.to_string())
        .collect();
    assert_eq!(used, all, "each type has a kind");
}

#[test]
fn drives_brake_when_their_command_ends() {
    let body = "d.speed = 500[mm/s]; finish done when time > 1[s];";
    let (code, output) = run("conveyor", "", "Conveyor", body);
    assert_eq!(code, Some(0), "{output}");
    assert!(output.contains("brak"), "{output}");
}

#[test]
fn set_points_out_of_range_are_rejected_with_the_limit() {
    let body = "d.speed = 2[m/s]; finish done when time > 1[s];";
    let (code, output) = run("conveyor", "", "Conveyor", body);
    assert_eq!(code, Some(3), "{output}");
    assert!(
        output.contains("velocity") && output.contains('1'),
        "{output}"
    );
    let body = "d.width = 200[mm]; finish done when time > 1[s];";
    let (code, output) = run("gripper", "", "Gripper", body);
    assert_eq!(code, Some(3), "{output}");
    assert!(output.contains("position"), "{output}");
}
