//! Tests of primitives by example: inputs and expected outputs. Primitives in the recorded traces are tested there;
//! matrices, arrays and bits are tested in `golden_bulk.rs`.

mod common;

use common::golden::check;
use common::{DT, Rig, get, of};
use rpi_image::Value;
use rpi_prims::FaultCode;
use rpi_prims::flow::{Pose, Rotation, Time, Twist, Vector, Wrench};
use rpi_prims::geometry;

rpi_testkit::trap_allocations!();

#[test]
fn reals_and_their_functions() {
    check(&[
        ("Core::DoubleModulo", &[of(7.5), of(2.0)], &[of(1.5)]),
        ("Core::DoubleModulo", &[of(-7.5), of(2.0)], &[of(-1.5)]),
        ("Core::DoubleLog", &[of(core::f64::consts::E)], &[of(1.0)]),
        ("Rpi::DoubleSubtract", &[of(1.0), of(3.0)], &[of(-2.0)]),
        ("Rpi::DoubleNegate", &[of(1.5)], &[of(-1.5)]),
        ("Rpi::DoubleAbsolute", &[of(-1.5)], &[of(1.5)]),
        ("Rpi::DoubleMinimum", &[of(f64::NAN), of(3.0)], &[of(3.0)]),
        ("Rpi::DoubleMaximum", &[of(1.0), of(3.0)], &[of(3.0)]),
        (
            "Rpi::DoubleGreaterOrEqual",
            &[of(3.0), of(3.0)],
            &[of(true)],
        ),
        (
            "Rpi::DoubleGreaterOrEqual",
            &[of(f64::NAN), of(3.0)],
            &[of(false)],
        ),
        ("Rpi::DoubleFloor", &[of(-1.5)], &[of(-2.0)]),
        ("Rpi::DoubleCeiling", &[of(-1.5)], &[of(-1.0)]),
        ("Rpi::DoubleRound", &[of(2.5)], &[of(3.0)]),
        ("Rpi::DoubleExponential", &[of(0.0)], &[of(1.0)]),
        (
            "Rpi::DoubleAtan",
            &[of(1.0)],
            &[of(core::f64::consts::FRAC_PI_4)],
        ),
    ]);
}

/// Operators of the SMT-LIB theory of bit vectors: `bvadd`, `bvudiv`, `bvsrem`, `bvashr` and others.
#[test]
fn machine_integers() {
    let (i8, u8, u64) = (-8_i64, 8_i64, 64_i64);
    let three = |name, a: i64, b: i64, width: i64, result: i64| {
        check(&[(name, &[of(a), of(b), of(width)], &[of(result)])]);
    };
    three("Rpi::MachineAdd", 127, 1, i8, -128);
    three("Rpi::MachineAdd", 255, 1, u8, 0);
    three("Rpi::MachineSubtract", 0, 1, u8, 255);
    three("Rpi::MachineSubtract", 0, -128, i8, -128);
    three("Rpi::MachineMultiply", 16, 17, u8, 16);
    three("Rpi::MachineDivide", -128, -1, i8, -128);
    three("Rpi::MachineDivide", -7, 2, i8, -3);
    three("Rpi::MachineDivide", 7, 0, u8, 255);
    three("Rpi::MachineDivide", 7, 0, i8, -1);
    three("Rpi::MachineDivide", -7, 0, i8, 1);
    three("Rpi::MachineDivide", -1, 10, u64, 1_844_674_407_370_955_161);
    three("Rpi::MachineModulo", -7, 3, i8, -1);
    three("Rpi::MachineModulo", 7, 0, u8, 7);
    three("Rpi::MachineModulo", -1, 10, u64, 5);
    three("Rpi::MachineShiftLeft", 129, 1, u8, 2);
    three("Rpi::MachineShiftLeft", 1, 8, u8, 0);
    three("Rpi::MachineShiftLeft", 1, -1, u64, 0);
    three("Rpi::MachineShiftRight", -128, 2, i8, -32);
    three("Rpi::MachineShiftRight", -1, 200, i8, -1);
    three("Rpi::MachineShiftRight", 255, 12, u8, 0);
    let two = |name, a: i64, b: i64, result: i64| check(&[(name, &[of(a), of(b)], &[of(result)])]);
    two("Rpi::MachineWrap", 300, u8, 44);
    two("Rpi::MachineWrap", 200, i8, -56);
    two("Rpi::MachineNot", 5, u8, 250);
    two("Rpi::MachineNot", 5, i8, -6);
    two("Rpi::MachineAnd", 12, 10, 8);
    two("Rpi::MachineOr", 12, 3, 15);
    two("Rpi::MachineToInt", 200, u8, 200);
    let compared = |name, a: i64, b: i64, width: i64, result: bool| {
        check(&[(name, &[of(a), of(b), of(width)], &[of(result)])]);
    };
    compared("Rpi::MachineGreater", -1, 1, u64, true);
    compared("Rpi::MachineGreater", -1, 1, i8, false);
    compared("Rpi::MachineGreaterOrEqual", 1, -1, u64, false);
    compared("Rpi::MachineGreaterOrEqual", 7, 7, u8, true);
}

#[test]
fn integers_booleans_and_times() {
    check(&[
        ("Rpi::IntSubtract", &[of(1_i64), of(3_i64)], &[of(-2_i64)]),
        ("Rpi::IntNegate", &[of(5_i64)], &[of(-5_i64)]),
        ("Rpi::IntModulo", &[of(-7_i64), of(3_i64)], &[of(-1_i64)]),
        ("Rpi::IntPower", &[of(-2_i64), of(3_i64)], &[of(-8_i64)]),
        ("Rpi::IntPower", &[of(-1_i64), of(i64::MAX)], &[of(-1_i64)]),
        ("Rpi::IntAbsolute", &[of(-5_i64)], &[of(5_i64)]),
        ("Rpi::IntMinimum", &[of(-5_i64), of(2_i64)], &[of(-5_i64)]),
        ("Rpi::IntMaximum", &[of(-5_i64), of(2_i64)], &[of(2_i64)]),
        (
            "Rpi::IntGreaterOrEqual",
            &[of(2_i64), of(2_i64)],
            &[of(true)],
        ),
        (
            "Core::IntEquals",
            &[of(i64::MIN), of(i64::MAX)],
            &[of(false)],
        ),
        ("Rpi::BooleanXor", &[of(true), of(true)], &[of(false)]),
        ("Rpi::BooleanImplies", &[of(false), of(false)], &[of(true)]),
        ("Rpi::BooleanEquals", &[of(false), of(false)], &[of(true)]),
        ("Rpi::TimeEquals", &[of(Time(5)), of(Time(5))], &[of(true)]),
        (
            "Rpi::TimeGreater",
            &[of(Time(5)), of(Time(5))],
            &[of(false)],
        ),
        (
            "Rpi::TimeGreaterOrEqual",
            &[of(Time(5)), of(Time(5))],
            &[of(true)],
        ),
    ]);
}

#[test]
fn faults_have_their_codes() {
    let cases: [(&str, &[Value], FaultCode); 10] = [
        (
            "Rpi::IntSubtract",
            &[of(i64::MIN), of(1_i64)],
            FaultCode::IntegerOverflow,
        ),
        (
            "Rpi::IntNegate",
            &[of(i64::MIN)],
            FaultCode::IntegerOverflow,
        ),
        (
            "Rpi::IntAbsolute",
            &[of(i64::MIN)],
            FaultCode::IntegerOverflow,
        ),
        (
            "Rpi::IntPower",
            &[of(2_i64), of(63_i64)],
            FaultCode::IntegerOverflow,
        ),
        (
            "Rpi::IntModulo",
            &[of(1_i64), of(0_i64)],
            FaultCode::DivisionByZero,
        ),
        (
            "Core::TimeAdd",
            &[of(Time(i64::MAX)), of(1.0)],
            FaultCode::IntegerOverflow,
        ),
        ("Rpi::Assert", &[of(false)], FaultCode::AssertionFailed),
        ("Rpi::AssertIndex", &[of(false)], FaultCode::IndexOutOfRange),
        ("Rpi::Assume", &[of(false)], FaultCode::AssertionFailed),
        ("EStop", &[of(true)], FaultCode::EmergencyStop),
    ];
    for (name, inputs, code) in cases {
        let mut rig = Rig::new(name, &[]);
        rig.give(inputs);
        assert_eq!(rig.fault, Some(code), "{name}");
    }
}

fn wrench(force: Vector, torque: Vector) -> Wrench {
    Wrench { force, torque }
}

fn twist(linear: Vector, angular: Vector) -> Twist {
    Twist { linear, angular }
}

#[test]
fn vectors_twists_and_wrenches() {
    let (a, b) = (Vector::new(1.0, 2.0, 3.0), Vector::new(-4.0, 5.0, 0.5));
    let quarter: Rotation = geometry::from_abc(core::f64::consts::FRAC_PI_2, 0.0, 0.0);
    let parts = [1.0, 2.0, 3.0, 0.1, 0.2, 0.3].map(of);
    let about_zyx = Vector::new(0.3, 0.2, 0.1);
    check(&[
        ("Rpi::VectorSubtract", &[of(a), of(b)], &[of(a - b)]),
        ("Rpi::VectorNegate", &[of(a)], &[of(-a)]),
        (
            "Rpi::VectorNorm",
            &[of(Vector::new(2.0, 3.0, 6.0))],
            &[of(7.0)],
        ),
        (
            "World::VectorRotate",
            &[of(Vector::x()), of(quarter)],
            &[of(Vector::y())],
        ),
        (
            "World::TwistRotate",
            &[of(twist(Vector::x(), Vector::z())), of(quarter)],
            &[of(twist(Vector::y(), Vector::z()))],
        ),
        (
            "World::TwistChangeCenter",
            &[of(twist(Vector::x(), Vector::z())), of(Vector::x())],
            &[of(twist(Vector::new(1.0, 1.0, 0.0), Vector::z()))],
        ),
        ("World::TwistFromXYZ", &parts, &[of(twist(a, about_zyx))]),
        ("World::TwistToXYZ", &[of(twist(a, about_zyx))], &parts),
        ("World::WrenchFromXYZ", &parts, &[of(wrench(a, about_zyx))]),
        (
            "Rpi::TwistScale",
            &[of(twist(a, b)), of(2.0)],
            &[of(twist(a * 2.0, b * 2.0))],
        ),
        (
            "Rpi::WrenchAdd",
            &[of(wrench(a, b)), of(wrench(b, a))],
            &[of(wrench(a + b, a + b))],
        ),
        ("Rpi::WrenchToParts", &[of(wrench(a, b))], &[of(a), of(b)]),
        ("Rpi::WrenchFromParts", &[of(a), of(b)], &[of(wrench(a, b))]),
        (
            "Rpi::RotationExponential",
            &[of(Vector::z() * core::f64::consts::FRAC_PI_2)],
            &[of(quarter)],
        ),
        (
            "Rpi::RotationLogarithm",
            &[of(quarter)],
            &[of(Vector::z() * core::f64::consts::FRAC_PI_2)],
        ),
    ]);
}

#[test]
fn poses() {
    let turned = geometry::from_abc(core::f64::consts::FRAC_PI_2, 0.0, 0.0);
    let pose = Pose::from_parts(Vector::new(1.0, 2.0, 3.0).into(), turned);
    check(&[
        (
            "World::FrameFromXYZ",
            &[of(1.0), of(2.0), of(3.0), of(turned)],
            &[of(pose)],
        ),
        (
            "World::FrameToXYZ",
            &[of(pose)],
            &[of(1.0), of(2.0), of(3.0), of(turned)],
        ),
        (
            "Rpi::FrameApply",
            &[of(pose), of(Vector::x())],
            &[of(Vector::new(1.0, 3.0, 3.0))],
        ),
        (
            "World::FrameTransform",
            &[of(pose), of(pose.inverse())],
            &[of(Pose::identity())],
        ),
    ]);
}

#[test]
fn euler_angles_at_the_gimbal_lock() {
    let lock = core::f64::consts::FRAC_PI_2;
    for (a, b, c) in [(0.3, lock, 0.1), (0.3, -lock, 0.1), (-2.0, lock, 1.0)] {
        let rotation = geometry::from_abc(a, b, c);
        let (a, b, c) = geometry::to_abc(rotation);
        assert_eq!(c, 0.0);
        assert!((b.abs() - lock).abs() < 1e-7);
        let angle = geometry::to_axis_angle(rotation.inverse() * geometry::from_abc(a, b, c)).1;
        assert!(angle < 1e-7, "{angle}");
    }
}

#[test]
fn latches_and_holds() {
    let mut trigger = Rig::new("Core::Trigger", &[]);
    let mut step = |on: bool, off: bool, reset: bool| {
        get::<bool>(&trigger.give(&[of(on), of(off), of(reset)])[0])
    };
    assert!(!step(false, false, false));
    assert!(step(true, false, false));
    assert!(step(false, false, false));
    assert!(!step(true, true, false));
    assert!(!step(true, false, false), "off for good");
    assert!(step(true, false, true), "armed again");

    let mut hold = Rig::new("Rpi::DoubleHold", &[]);
    let mut step = |value: Option<f64>| hold.step(&[value.map(of), Some(of(9.0))]).remove(0);
    assert_eq!(step(None), Some(of(9.0)));
    assert_eq!(step(Some(1.0)), Some(of(1.0)));
    assert_eq!(step(None), Some(of(1.0)));
}

#[test]
fn a_mean_forgets_what_has_left_the_window() {
    let mut mean = Rig::new("Core::DoubleAverage", &[("Duration", of(3.0 * DT))]);
    let mut push = |x: f64| get::<f64>(&mean.give(&[of(x), of(false)])[0]);
    push(1e300);
    push(f64::INFINITY);
    for _ in 0..6 {
        push(1.0);
    }
    assert_eq!(push(1.0), 1.0);
}

#[test]
fn ranges_of_time_line_up() {
    let mut rig = Rig::new(
        "Core::TimeConsistentRange",
        &[("MaxSize", of(1e-6)), ("MaxAge", of(2.0 * DT))],
    );
    let mut step = |first: (i64, i64), second: (i64, i64)| {
        let times = [first.0, first.1, second.0, second.1].map(|t| Some(of(Time(t))));
        let out = rig.step(&times);
        out[0]
            .clone()
            .zip(out[1].clone())
            .map(|(a, b)| (get::<Time>(&a).0, get::<Time>(&b).0))
    };
    assert_eq!(step((0, 100), (50, 200)), Some((0, 200)));
    assert_eq!(
        step((5000, 5100), (300, 400)),
        Some((0, 400)),
        "the new second with the old first"
    );
    assert_eq!(
        step((9000, 9100), (5200, 5300)),
        Some((5000, 5300)),
        "the new second with the old first"
    );
    assert_eq!(
        step((90_000, 90_100), (50_000, 50_100)),
        Some((5000, 5300)),
        "the last one, kept"
    );
    for t in 1..5 {
        step((1_000_000 * t, 1_000_000 * t), (0, 0));
    }
    assert_eq!(step((90_000, 90_100), (0, 0)), None, "older than allowed");
}

#[test]
fn following_a_moving_goal() {
    let mut rig = Rig::new("Core::OTG2", &[]);
    let (mut position, mut velocity, mut goal) = (0.0, 0.0, 0.1);
    for _ in 0..400 {
        goal += 0.2 * DT;
        let out = rig.give(&[position, velocity, goal, 1.0, 2.0].map(of));
        (position, velocity) = (get(&out[0]), get(&out[1]));
    }
    assert!(
        (position - goal - 0.2 * DT).abs() < 1e-4 && (velocity - 0.2).abs() < 0.03,
        "{position} {velocity}"
    );
}

#[test]
fn platforms_drive_to_their_goals() {
    for (name, tolerance) in [
        ("RobotBase::OmnidirectionalBaseController", 2e-3),
        ("RobotBase::DifferentialDriveController", 2e-2),
    ] {
        let goal = Pose::from_parts(
            Vector::new(-0.4, 0.3, 0.0).into(),
            geometry::from_abc(0.5, 0.0, 0.0),
        );
        let (mut at, mut velocity) = (Pose::identity(), Twist::default());
        let mut rig = Rig::new(name, &[]);
        for _ in 0..3000 {
            let inputs = [of(at), of(velocity), of(goal)];
            let out = rig.step(&inputs.map(Some)).remove(0).expect("present");
            velocity = get::<Twist>(&out);
            let turned = geometry::exp(velocity.angular * DT);
            at *= Pose::from_parts((velocity.linear * DT).into(), turned);
        }
        let left = goal.inverse() * at;
        assert!(left.translation.vector.norm() < tolerance, "{name} {left}");
        assert!(
            geometry::log(left.rotation).norm() < tolerance,
            "{name} {left}"
        );
    }
}
