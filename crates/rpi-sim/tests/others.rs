//! Mobile bases, grippers, force sensors and linear units.

use rpi_device::{DeviceBank, PortId, PortKind, PortQuery, Rejection};
use rpi_image::{Scalar, Type};
use rpi_sim::error_code::ErrorCode;
use rpi_sim::{Cell, SimBank};

const TICK: f64 = 0.01;

fn bank(text: &str) -> SimBank {
    let cell = Cell::parse("cell.toml", text).unwrap_or_else(|errors| panic!("{errors}"));
    SimBank::new(&cell, TICK)
}

fn port(bank: &mut SimBank, port: &str, index: u32, kind: PortKind, scalar: Scalar) -> PortId {
    let name = PortQuery {
        device: "it",
        port,
        index,
        kind,
        ty: Type::Scalar(scalar),
    };
    bank.resolve(&name)
        .unwrap_or_else(|error| panic!("{port}: {error:?}"))
}

fn sensor(bank: &mut SimBank, name: &str, scalar: Scalar) -> PortId {
    port(bank, name, 0, PortKind::Sensor, scalar)
}

fn reals<const N: usize>(bank: &mut SimBank, port: PortId) -> [f64; N] {
    let mut cells = [0; N];
    assert!(bank.read(port, &mut cells));
    cells.map(f64::from_bits)
}

fn twist(forwards: f64, turning: f64) -> [u64; 6] {
    [forwards, 0.0, 0.0, 0.0, 0.0, turning].map(f64::to_bits)
}

const BASE: &str = "[devices.it]\nkind = \"base\"\ntrack = 0.5\nwheel_radius = 0.1\n";

/// Accelerates, then drives at constant velocity until `ticks` have passed.
fn drive(bank: &mut SimBank, forwards: f64, turning: f64, ticks: u32) {
    let velocity = port(bank, "base.velocity", 0, PortKind::Actuator, Scalar::Twist);
    for tick in 1..=ticks {
        let share = (f64::from(tick) / 100.0).min(1.0);
        let wanted = twist(forwards * share, turning * share);
        assert_eq!(
            bank.check_set_point(velocity, &wanted),
            Rejection::NONE,
            "{}",
            bank.error_code(velocity)
        );
        bank.write(velocity, &wanted);
        bank.step();
    }
}

#[test]
fn a_platform_drives_straight_on_and_on_a_circle() {
    let mut straight = bank(BASE);
    drive(&mut straight, 0.5, 0.0, 200);
    let position = sensor(&mut straight, "base.position", Scalar::Pose);
    let wheel = sensor(&mut straight, "wheel.position", Scalar::Real);
    let driven: f64 = (1..=200)
        .map(|tick| 0.5 * (f64::from(tick) / 100.0).min(1.0) * TICK)
        .sum();
    let pose: [f64; 7] = reals(&mut straight, position);
    assert!((pose[0] - driven).abs() < 1e-12 && pose[1] == 0.0 && pose[6] == 1.0);
    assert!((reals::<1>(&mut straight, wheel)[0] - driven / 0.1).abs() < 1e-9);

    let mut circle = bank(BASE);
    drive(&mut circle, 0.5, 1.0, 300);
    let position = sensor(&mut circle, "base.position", Scalar::Pose);
    let pose: [f64; 7] = reals(&mut circle, position);
    let radius = rpi_math::hypot(pose[0], pose[1] - 0.5);
    assert!(
        (radius - 0.5).abs() < 1e-9,
        "it stays on its circle: {radius}"
    );
}

#[test]
fn a_platform_left_alone_slows_down_on_its_arc() {
    let mut bank = bank(BASE);
    drive(&mut bank, 0.5, 1.0, 150);
    let (position, velocity) = (
        sensor(&mut bank, "base.position", Scalar::Pose),
        sensor(&mut bank, "base.measured_velocity", Scalar::Twist),
    );
    let mut before = 0.5;
    while bank.is_moving(0) {
        bank.step();
        let [forwards, _, _, _, _, turning] = reals::<6>(&mut bank, velocity);
        assert!(
            before - forwards <= 1.0 * TICK + 1e-9,
            "no harder than it may: {before} to {forwards}"
        );
        assert!((turning - 2.0 * forwards).abs() < 1e-9);
        before = forwards;
    }
    let pose: [f64; 7] = reals(&mut bank, position);
    assert!((rpi_math::hypot(pose[0], pose[1] - 0.5) - 0.5).abs() < 1e-9);
    let codes: Vec<ErrorCode> = bank.status().map(|status| status.code).collect();
    assert_eq!(codes, [ErrorCode::SET_POINT_MISSING]);
}

#[test]
fn a_platform_refuses_what_it_cannot_drive() {
    let mut bank = bank(BASE);
    let velocity = port(
        &mut bank,
        "base.velocity",
        0,
        PortKind::Actuator,
        Scalar::Twist,
    );
    let mut aside = twist(0.0, 0.0);
    aside[1] = 0.1_f64.to_bits();
    let cases = [
        (twist(f64::NAN, 0.0), ErrorCode::NOT_A_NUMBER),
        (twist(1.1, 0.0), ErrorCode::VELOCITY),
        (twist(0.5, 0.0), ErrorCode::ACCELERATION),
        (aside, ErrorCode::NOT_DRIVABLE),
    ];
    for (wanted, code) in cases {
        assert_eq!(
            bank.check_set_point(velocity, &wanted),
            Rejection::ILLEGAL_VALUE
        );
        assert_eq!(bank.error_code(velocity), code.0);
        bank.write(velocity, &wanted);
        bank.step();
        assert!(!bank.is_moving(0));
    }
    let mut reports = 0;
    bank.reports(|_, _| reports += 1);
    assert_eq!(reports, 4);
}

#[test]
fn a_gripper_closes_until_it_holds_something() {
    let mut bank = bank(
        "[devices.it]\nkind = \"gripper\"\nupper = \"80 mm\"\nspeed = 0.1\nforce = 15\nobject = 0.03\n",
    );
    let target = port(
        &mut bank,
        "gripper.width",
        0,
        PortKind::Actuator,
        Scalar::Real,
    );
    let [width, speed, force] = ["gripper.width", "gripper.speed", "gripper.force"]
        .map(|name| sensor(&mut bank, name, Scalar::Real));
    let holding = sensor(&mut bank, "gripper.holding", Scalar::Bool);
    bank.write(target, &[0.0_f64.to_bits()]);
    bank.step();
    assert!((reals::<1>(&mut bank, width)[0] - 0.079).abs() < 1e-12);
    assert!((reals::<1>(&mut bank, speed)[0] + 0.1).abs() < 1e-9);
    (0..100).for_each(|_| bank.step());
    let mut cell = [0];
    assert!(bank.read(holding, &mut cell));
    assert_eq!(
        (
            reals::<1>(&mut bank, width)[0],
            reals::<1>(&mut bank, force)[0],
            cell[0]
        ),
        (0.03, 15.0, 1)
    );
    bank.write(target, &[0.08_f64.to_bits()]);
    (0..100).for_each(|_| bank.step());
    assert_eq!(reals::<1>(&mut bank, width)[0], 0.08);
    assert_eq!(reals::<1>(&mut bank, force)[0], 0.0);
    assert_eq!(
        bank.check_set_point(target, &[0.09_f64.to_bits()]),
        Rejection::ILLEGAL_VALUE
    );
    assert_eq!(bank.error_code(target), ErrorCode::POSITION.0);
}

#[test]
fn a_force_sensor_feels_its_script() {
    let text = "[devices.it]\nkind = \"force-torque\"\nrepeat = 1\nscript = [{ at = 0.5, force = [0, 0, -7] }]\n";
    let mut bank = bank(text);
    let force = sensor(&mut bank, "tcp.force_z", Scalar::Real);
    let wrench = sensor(&mut bank, "wrench", Scalar::Wrench);
    let mut felt = Vec::new();
    for _ in 0..160 {
        felt.push(reals::<1>(&mut bank, force)[0]);
        bank.step();
    }
    assert!(
        felt[..50].iter().all(|one| *one == 0.0) && felt[51..99].iter().all(|one| *one == -7.0)
    );
    assert!(felt[101..149].iter().all(|one| *one == 0.0));
    assert_eq!(
        reals::<6>(&mut bank, wrench),
        [0.0, 0.0, -7.0, 0.0, 0.0, 0.0]
    );
}

#[test]
fn a_linear_unit_is_an_arm_of_one_axis() {
    let text = "[devices.it]\nkind = \"linear-unit\"\njoints = [\"200 mm\"]\nlimits = { upper = 3, velocity = \"500 mm/s\" }\n
        enforce = [\"position\", \"velocity\"]\n";
    let mut bank = bank(text);
    let joint = port(
        &mut bank,
        "joint.position",
        0,
        PortKind::Actuator,
        Scalar::Real,
    );
    let pose = sensor(&mut bank, "pose", Scalar::Pose);
    bank.write(joint, &[0.204_f64.to_bits()]);
    bank.step();
    assert_eq!(
        reals::<7>(&mut bank, pose),
        [0.0, 0.0, 0.204, 0.0, 0.0, 0.0, 1.0]
    );
    assert_eq!(
        bank.check_set_point(joint, &[0.21_f64.to_bits()]),
        Rejection::ILLEGAL_VALUE
    );
    assert_eq!(bank.error_code(joint), ErrorCode::VELOCITY.0);
    while bank.is_moving(0) {
        bank.step();
    }
    assert!(reals::<7>(&mut bank, pose)[2] > 0.204, "it braked");
}
