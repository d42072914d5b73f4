//! The devices of a cell through the interface of the core: names, resource numbers, functions, determinism, and no
//! allocation in a tick.

use rpi_device::{DeviceBank, PortId, PortKind, PortQuery, Rejection, ResolveError};
use rpi_image::{Scalar, Type};
use rpi_sim::{Cell, FaultKind, ScheduledFault, SimBank};

rpi_testkit::trap_allocations!();

const CELL: &str = "
[devices.left]
kind = \"arm\"
model = \"kuka-lwr4+\"
joints = [0.1, -0.5, 0.2, 1.5, -0.3, -1.0, 0.4]
noise = 1e-5
latency = 0.003
tool = { position = [0, 0, 0.15] }

[devices.right]
kind = \"arm\"
model = \"kuka-iiwa-7\"

[devices.io]
kind = \"io\"
digital = { inputs = [true, false], outputs = 3, repeat = 1, script = [{ at = 0.25, input = 1, value = true }] }
analogue = { inputs = [1.5], outputs = [2.5] }
";

const REAL: Type = Type::Scalar(Scalar::Real);
const BOOL: Type = Type::Scalar(Scalar::Bool);
const POSE: Type = Type::Scalar(Scalar::Pose);
const JOINTS: Type = Type::Array(Scalar::Real, 7);

fn bank() -> SimBank {
    let cell = Cell::parse("cell.toml", CELL).unwrap_or_else(|errors| panic!("{errors}"));
    SimBank::new(&cell, 1e-3)
}

fn find(
    bank: &mut SimBank,
    device: &str,
    port: &str,
    index: u32,
    kind: PortKind,
    ty: Type,
) -> Result<PortId, ResolveError> {
    bank.resolve(&PortQuery {
        device,
        port,
        index,
        kind,
        ty,
    })
}

fn sensor(bank: &mut SimBank, device: &str, port: &str, index: u32, ty: Type) -> PortId {
    find(bank, device, port, index, PortKind::Sensor, ty)
        .unwrap_or_else(|error| panic!("{device}.{port}: {error:?}"))
}

fn actuator(bank: &mut SimBank, device: &str, port: &str, index: u32, ty: Type) -> PortId {
    find(bank, device, port, index, PortKind::Actuator, ty)
        .unwrap_or_else(|error| panic!("{device}.{port}: {error:?}"))
}

fn reals(bank: &mut SimBank, port: PortId, count: usize) -> Vec<f64> {
    let mut cells = vec![0; count];
    assert!(bank.read(port, &mut cells));
    cells.into_iter().map(f64::from_bits).collect()
}

fn bits(values: &[f64]) -> Vec<u64> {
    values.iter().map(|value| value.to_bits()).collect()
}

#[test]
fn names_that_do_not_resolve_say_why() {
    let mut bank = bank();
    let cases = [
        (
            "middle",
            "joint.position",
            0,
            PortKind::Actuator,
            REAL,
            ResolveError::UnknownDevice,
        ),
        (
            "left",
            "joint.colour",
            0,
            PortKind::Sensor,
            REAL,
            ResolveError::UnknownPort,
        ),
        (
            "left",
            "joint.position",
            0,
            PortKind::Sensor,
            REAL,
            ResolveError::UnknownPort,
        ),
        (
            "left",
            "joint.position",
            7,
            PortKind::Actuator,
            REAL,
            ResolveError::IndexOutOfRange,
        ),
        (
            "left",
            "joint.position",
            0,
            PortKind::Actuator,
            BOOL,
            ResolveError::WrongType,
        ),
        (
            "left",
            "kinematics",
            0,
            PortKind::Function,
            JOINTS,
            ResolveError::WrongType,
        ),
        (
            "left",
            "joint8.measured_torque",
            0,
            PortKind::Sensor,
            REAL,
            ResolveError::IndexOutOfRange,
        ),
        (
            "left",
            "joint0.measured_torque",
            0,
            PortKind::Sensor,
            REAL,
            ResolveError::UnknownPort,
        ),
        (
            "io",
            "in.bool",
            2,
            PortKind::Sensor,
            BOOL,
            ResolveError::IndexOutOfRange,
        ),
        (
            "io",
            "in.bool",
            0,
            PortKind::Actuator,
            BOOL,
            ResolveError::UnknownPort,
        ),
    ];
    for (device, port, index, kind, ty, why) in cases {
        assert_eq!(
            find(&mut bank, device, port, index, kind, ty),
            Err(why),
            "{device}.{port}[{index}]"
        );
    }
    let one = sensor(&mut bank, "left", "pose", 0, POSE);
    assert_eq!(
        sensor(&mut bank, "left", "pose", 0, POSE),
        one,
        "the same port has the same number"
    );
}

#[test]
fn ports_of_one_motion_share_actuators_and_others_do_not() {
    let mut bank = bank();
    let joint = |bank: &mut SimBank, axis| actuator(bank, "left", "joint.position", axis, REAL);
    let (first, third) = (joint(&mut bank, 0), joint(&mut bank, 2));
    let tcp = actuator(&mut bank, "left", "tcp.position", 0, POSE);
    let joints = actuator(&mut bank, "left", "joints", 0, JOINTS);
    let tool = actuator(&mut bank, "left", "tool", 0, Type::Array(Scalar::Real, 7));
    let other = actuator(&mut bank, "right", "tcp", 0, POSE);
    let outputs: Vec<PortId> = (0..3)
        .map(|index| actuator(&mut bank, "io", "out.bool", index, BOOL))
        .collect();
    let overlap = |one: PortId, two: PortId| {
        let (one, two) = (bank.resources(one), bank.resources(two));
        one.start.max(two.start) < one.end.min(two.end)
    };
    assert!(overlap(tcp, first) && overlap(tcp, third) && overlap(tcp, joints));
    assert!(
        !overlap(first, third)
            && !overlap(tool, tcp)
            && !overlap(tool, first)
            && !overlap(other, tcp)
    );
    assert!(!overlap(outputs[0], outputs[1]) && !overlap(outputs[2], other));
}

#[test]
fn the_tool_can_be_set_as_a_pose_and_stands_where_it_was_told() {
    let mut bank = bank();
    let (tcp, pose) = (
        actuator(&mut bank, "left", "tcp", 0, POSE),
        sensor(&mut bank, "left", "pose", 0, POSE),
    );
    let twist = sensor(&mut bank, "left", "twist", 0, Type::Scalar(Scalar::Twist));
    let start = reals(&mut bank, pose, 7);
    let (mut velocity, mut acceleration) = (0.0, 0.0_f64);
    let mut target = start.clone();
    for _ in 0..300 {
        acceleration = (acceleration + 1e-3).min(0.05);
        velocity += 1e-3 * acceleration;
        target[0] += 1e-3 * velocity;
        assert_eq!(
            bank.check_set_point(tcp, &bits(&target)),
            Rejection::NONE,
            "{}",
            bank.error_code(tcp)
        );
        bank.write(tcp, &bits(&target));
        bank.step();
        let now = reals(&mut bank, pose, 7);
        assert!(
            now.iter()
                .zip(&target)
                .all(|(now, target)| (now - target).abs() < 1e-9),
            "{now:?} {target:?}"
        );
    }
    let moving = reals(&mut bank, twist, 6);
    assert!(
        (moving[0] - velocity).abs() < 1e-4,
        "{moving:?} at {velocity}"
    );
    assert!(moving[1..].iter().all(|part| part.abs() < 1e-4));
}

#[test]
fn a_pose_that_cannot_be_reached_is_refused() {
    let mut bank = bank();
    let tcp = actuator(&mut bank, "left", "tcp.position", 0, POSE);
    let far = bits(&[3.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0]);
    assert_eq!(bank.check_set_point(tcp, &far), Rejection::ILLEGAL_VALUE);
    assert_eq!(
        bank.error_code(tcp),
        rpi_sim::error_code::ErrorCode::OUT_OF_REACH.0
    );
    assert_eq!(
        bank.check_set_point(tcp, &bits(&[f64::NAN; 7])),
        Rejection::ILLEGAL_VALUE
    );
    assert_eq!(
        bank.error_code(tcp),
        rpi_sim::error_code::ErrorCode::NOT_A_NUMBER.0
    );
    let mut reports = Vec::new();
    bank.reports(|device, report| reports.push((device.to_owned(), report.code.to_string())));
    let told: Vec<(&str, &str)> = reports
        .iter()
        .map(|(device, code)| (device.as_str(), code.as_str()))
        .collect();
    assert_eq!(told, [("left", "out-of-reach"), ("left", "not-a-number")]);
}

#[test]
fn kinematics_and_its_inverse_undo_each_other() {
    let mut bank = bank();
    let joints = [0.3, -0.6, 0.2, 1.2, -0.4, -0.8, 0.5];
    let forward =
        find(&mut bank, "left", "kinematics", 0, PortKind::Function, POSE).expect("a function");
    let inverse = find(
        &mut bank,
        "left",
        "inverse_kinematics",
        0,
        PortKind::Function,
        JOINTS,
    )
    .expect("a function");
    let elbow = find(
        &mut bank,
        "left",
        "inverse_kinematics_nullspace",
        0,
        PortKind::Function,
        JOINTS,
    )
    .expect("one");
    let mut pose = vec![0; 7];
    assert!(bank.call(forward, &bits(&joints), &mut pose));
    let with = |more: &[f64]| [pose.clone(), bits(more)].concat();
    let mut found = vec![0; 7];
    assert!(bank.call(
        inverse,
        &with(&joints.map(|joint| joint + 0.001)),
        &mut found
    ));
    let off = |found: &[u64]| {
        let each = found
            .iter()
            .zip(&joints)
            .map(|(bits, joint)| (f64::from_bits(*bits) - joint).abs());
        each.fold(0.0, f64::max)
    };
    assert!(off(&found) < 0.01);
    assert!(bank.call(elbow, &with(&[[0.0; 7], joints].concat()), &mut found));
    assert!(
        off(&found) < 1e-9,
        "the elbow of the joints, not of the hint"
    );
    assert!(
        !bank.call(inverse, &with(&[0.0; 3]), &mut found),
        "a hint too short"
    );
    let far = bits(&[9.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0]);
    assert!(!bank.call(inverse, &[far, bits(&joints)].concat(), &mut found));
}

#[test]
fn velocities_of_joints_are_those_of_the_tool_and_the_elbow() {
    let mut bank = bank();
    let ty = Type::Array(Scalar::Real, 7);
    let function = find(
        &mut bank,
        "right",
        "velocity_kinematics",
        0,
        PortKind::Function,
        ty,
    )
    .expect("a function");
    let still = [0.0, 0.5, 0.0, -1.2, 0.0, 0.9, 0.0];
    let mut result = vec![0; 7];
    // Rotating the base rotates the tool about z and moves the elbow along.
    let turning = [1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
    assert!(bank.call(function, &bits(&[still, turning].concat()), &mut result));
    let result: Vec<f64> = result.into_iter().map(f64::from_bits).collect();
    assert!(
        result[1] > 0.5 && (result[5] - 1.0).abs() < 1e-12 && result[6].abs() < 1e-9,
        "{result:?}"
    );
}

#[test]
fn terminals_follow_their_script_and_keep_their_outputs() {
    let mut bank = bank();
    let input = sensor(&mut bank, "io", "in.bool", 1, BOOL);
    let (set, shown) = (
        actuator(&mut bank, "io", "out.real", 0, REAL),
        sensor(&mut bank, "io", "out.real", 0, REAL),
    );
    let mut seen = Vec::new();
    for tick in 0..2_000 {
        let mut cell = [7];
        assert!(bank.read(input, &mut cell));
        if seen.last().is_none_or(|(_, last)| *last != cell[0]) {
            seen.push((tick, cell[0]));
        }
        bank.step();
    }
    assert_eq!(seen, [(0, 0), (250, 1), (1000, 0), (1250, 1)]);
    assert_eq!(reals(&mut bank, shown, 1), [2.5]);
    bank.write(set, &bits(&[-4.0]));
    assert_eq!(reals(&mut bank, shown, 1), [-4.0]);
    assert_eq!(
        bank.check_set_point(set, &bits(&[f64::NAN])),
        Rejection::ILLEGAL_VALUE
    );
    bank.write(set, &bits(&[f64::NAN]));
    assert_eq!(reals(&mut bank, shown, 1), [-4.0]);
}

#[test]
fn all_terminals_can_be_read_and_set_at_once() {
    let mut bank = bank();
    let all = |scalar, count| Type::Array(scalar, count);
    let get = sensor(&mut bank, "io", "get", 0, all(Scalar::Bool, 2));
    let mut cells = [7, 7];
    assert!(bank.read(get, &mut cells));
    assert_eq!(cells, [1, 0]);
    let set = actuator(&mut bank, "io", "set", 0, all(Scalar::Bool, 2));
    let third = actuator(&mut bank, "io", "out.bool", 2, BOOL);
    assert!(bank.resources(set).contains(&bank.resource(third)));
    bank.write(set, &[1, 1]);
    let shown: Vec<PortId> = (0..3)
        .map(|index| sensor(&mut bank, "io", "out.bool", index, BOOL))
        .collect();
    let outputs: Vec<f64> = shown
        .iter()
        .flat_map(|port| reals(&mut bank, *port, 1))
        .collect();
    assert_eq!(bits(&outputs), [1, 1, 0], "the third is not among the two");
    let analogue = actuator(&mut bank, "io", "set", 0, all(Scalar::Real, 1));
    assert_eq!(
        bank.check_set_point(analogue, &bits(&[f64::NAN])),
        Rejection::ILLEGAL_VALUE
    );
    let too_many = find(
        &mut bank,
        "io",
        "get",
        0,
        PortKind::Sensor,
        all(Scalar::Bool, 3),
    );
    assert_eq!(too_many, Err(ResolveError::WrongType));
}

#[test]
fn a_tool_and_a_way_of_control_are_checked() {
    let mut bank = bank();
    let tool = actuator(&mut bank, "left", "tool", 3, Type::Array(Scalar::Real, 7));
    assert_eq!(
        bank.check_set_point(tool, &bits(&[2.0, 0.0, 0.0, 0.1, 0.0, 0.0, 0.0])),
        Rejection::NONE
    );
    assert_eq!(
        bank.check_set_point(tool, &bits(&[-2.0, 0.0, 0.0, 0.1, 0.0, 0.0, 0.0])),
        Rejection::ILLEGAL_VALUE
    );
    assert_eq!(
        bank.check_set_point(tool, &bits(&[f64::NAN; 7])),
        Rejection::ILLEGAL_VALUE
    );
    let strategy = actuator(
        &mut bank,
        "left",
        "control_strategy",
        0,
        Type::Scalar(Scalar::Int),
    );
    assert_eq!(bank.check_set_point(strategy, &[20]), Rejection::NONE);
    assert_eq!(
        bank.check_set_point(strategy, &[21]),
        Rejection::ILLEGAL_VALUE
    );
}

/// A random scenario of one minute: valid and invalid set-points, faults, stops. Returns every bit that was read.
fn wild(bank: &mut SimBank) -> Vec<u64> {
    let joint = actuator(bank, "left", "joint.position", 1, REAL);
    let ports = [
        (sensor(bank, "left", "joints", 0, JOINTS), 7),
        (sensor(bank, "left", "position", 0, JOINTS), 7),
        (
            sensor(
                bank,
                "left",
                "measured_twist",
                0,
                Type::Scalar(Scalar::Twist),
            ),
            6,
        ),
        (
            sensor(bank, "left", "code", 0, Type::Scalar(Scalar::Int)),
            1,
        ),
    ];
    bank.inject(
        "left",
        ScheduledFault {
            from: 1.0,
            until: 1.5,
            kind: FaultKind::Noise(1e-4),
        },
    );
    bank.inject(
        "left",
        ScheduledFault {
            from: 2.0,
            until: 2.2,
            kind: FaultKind::JointFailure(1),
        },
    );
    let mut seen = vec![0_u64; 21 * 3_000];
    let mut at = -0.5_f64;
    let mut speed = 0.0;
    rpi_testkit::no_alloc(|| {
        for (tick, row) in seen.chunks_exact_mut(21).enumerate() {
            speed = if tick % 1000 < 100 {
                speed + 2e-6
            } else {
                speed * 0.999
            };
            at += if tick % 700 < 650 { speed } else { 0.1 };
            if bank.check_set_point(joint, &[at.to_bits()]) == Rejection::NONE && tick % 900 != 899
            {
                bank.write(joint, &[at.to_bits()]);
            }
            bank.step();
            let mut rest = row;
            for (port, cells) in ports {
                let (own, after) = rest.split_at_mut(cells);
                bank.read(port, own);
                rest = after;
            }
        }
    });
    seen
}

#[test]
fn the_same_cell_gives_the_same_bits_and_allocates_nothing() {
    let (one, two) = (wild(&mut bank()), wild(&mut bank()));
    assert_eq!(one, two);
    let codes: std::collections::BTreeSet<u64> = one.chunks_exact(21).map(|row| row[20]).collect();
    assert!(codes.len() >= 4, "it was wild: {codes:?}");
}

#[test]
fn every_port_number_is_answered_without_a_panic() {
    let mut bank = bank();
    // Every table row of every device with a few indices each. Some numbers are valid ports; none may panic.
    for number in (0..=u32::MAX).step_by(0x3ff3) {
        let port = PortId(number & !0x3f_0000);
        let mut value = [0; 16];
        bank.read(port, &mut value);
        bank.check_set_point(port, &value);
        bank.write(port, &value);
        bank.call(port, &value, &mut [0; 16]);
        bank.error_code(port);
    }
    for port in [PortId(0x7fff), PortId(u32::MAX)] {
        assert!(!bank.read(port, &mut [0]));
        assert_eq!(bank.check_set_point(port, &[0]), Rejection::DEVICE_FAILED);
        bank.write(port, &[0]);
        assert!(!bank.call(port, &[], &mut []));
        assert!(bank.resources(port).is_empty());
        assert_eq!(bank.error_code(port), 0);
    }
    let tcp = actuator(&mut bank, "left", "tcp", 0, POSE);
    bank.write(tcp, &[]);
    assert_eq!(bank.check_set_point(tcp, &[]), Rejection::ILLEGAL_VALUE);
    bank.stop(u32::MAX);
    assert!(!bank.is_moving(u32::MAX));
}

#[test]
fn banks_with_the_same_devices_in_the_same_places_give_the_same_numbers() {
    let (mut one, mut other) = (bank(), bank());
    sensor(&mut one, "left", "pose", 0, POSE);
    for (device, port) in [("right", "tcp"), ("left", "tcp")] {
        let number = actuator(&mut one, device, port, 0, POSE);
        assert_eq!(number, actuator(&mut other, device, port, 0, POSE));
        assert_eq!(one.resources(number), other.resources(number));
    }
}

#[test]
fn devices_come_and_go_between_two_ticks() {
    let mut bank = bank();
    let tcp = actuator(&mut bank, "left", "tcp", 0, POSE);
    let left = bank.swap(0, None);
    assert_eq!(left.as_ref().map(rpi_sim::NamedDevice::name), Some("left"));
    assert_eq!(bank.check_set_point(tcp, &[0; 7]), Rejection::DEVICE_FAILED);
    bank.step();
    assert!(bank.swap(0, left).is_none());
    assert_eq!(actuator(&mut bank, "left", "tcp", 0, POSE), tcp);
}

#[test]
fn arms_of_six_axes_and_without_a_closed_form_work_too() {
    let text = "[devices.ur]\nkind = \"arm\"\nmodel = \"ur5e\"\njoints = [0, -1.2, 1.4, -1.5, -1.5, 0]\n
        [devices.panda]\nkind = \"arm\"\nmodel = \"franka-panda\"\njoints = [0, 0, 0, -1.5, 0, 1.5, 0]\n";
    let mut bank = SimBank::new(
        &Cell::parse("cell.toml", text).unwrap_or_else(|errors| panic!("{errors}")),
        1e-3,
    );
    for (device, axes) in [("ur", 6), ("panda", 7)] {
        let pose = sensor(&mut bank, device, "pose", 0, POSE);
        let tcp = actuator(&mut bank, device, "tcp", 0, POSE);
        let joints = Type::Array(Scalar::Real, axes);
        let torque = sensor(&mut bank, device, "torque", 0, joints);
        assert_eq!(
            reals(&mut bank, torque, axes as usize),
            vec![0.0; axes as usize]
        );
        let here = reals(&mut bank, pose, 7);
        let refusal = bank.check_set_point(tcp, &bits(&here));
        assert_eq!(
            refusal,
            if device == "ur" {
                Rejection::NONE
            } else {
                Rejection::ILLEGAL_VALUE
            },
            "{}",
            bank.error_code(tcp)
        );
        let joint = actuator(&mut bank, device, "joint.position", axes - 1, REAL);
        let last = actuator(&mut bank, device, "joint.position", 0, REAL);
        assert_eq!(bank.check_set_point(joint, &bits(&[0.0])), Rejection::NONE);
        assert_eq!(bank.check_set_point(last, &bits(&[1e-10])), Rejection::NONE);
        assert!(
            find(
                &mut bank,
                device,
                "joint.position",
                axes,
                PortKind::Actuator,
                REAL
            )
            .is_err()
        );
    }
}
