//! Tests of primitives by example: inputs and expected outputs. Primitives in the recorded traces are tested there;
//! geometry is tested in `golden_geometry.rs`, matrices, arrays and bits in `golden_bulk.rs`.

mod common;

use common::golden::check;
use common::{DT, TestBench, get, value_of};
use rpi_image::Value;
use rpi_prims::FaultCode;
use rpi_prims::geometry;
use rpi_prims::value_types::{Pose, Time, Twist, Vector};

rpi_testkit::trap_allocations!();

#[test]
fn reals_and_their_functions() {
    check(&[
        (
            "Core::DoubleModulo",
            &[value_of(7.5), value_of(2.0)],
            &[value_of(1.5)],
        ),
        (
            "Core::DoubleModulo",
            &[value_of(-7.5), value_of(2.0)],
            &[value_of(-1.5)],
        ),
        (
            "Core::DoubleLog",
            &[value_of(core::f64::consts::E)],
            &[value_of(1.0)],
        ),
        (
            "Rpi::DoubleSubtract",
            &[value_of(1.0), value_of(3.0)],
            &[value_of(-2.0)],
        ),
        ("Rpi::DoubleNegate", &[value_of(1.5)], &[value_of(-1.5)]),
        ("Rpi::DoubleAbsolute", &[value_of(-1.5)], &[value_of(1.5)]),
        (
            "Rpi::DoubleMinimum",
            &[value_of(f64::NAN), value_of(3.0)],
            &[value_of(3.0)],
        ),
        (
            "Rpi::DoubleMaximum",
            &[value_of(1.0), value_of(3.0)],
            &[value_of(3.0)],
        ),
        (
            "Rpi::DoubleGreaterOrEqual",
            &[value_of(3.0), value_of(3.0)],
            &[value_of(true)],
        ),
        (
            "Rpi::DoubleGreaterOrEqual",
            &[value_of(f64::NAN), value_of(3.0)],
            &[value_of(false)],
        ),
        ("Rpi::DoubleFloor", &[value_of(-1.5)], &[value_of(-2.0)]),
        ("Rpi::DoubleCeiling", &[value_of(-1.5)], &[value_of(-1.0)]),
        ("Rpi::DoubleRound", &[value_of(2.5)], &[value_of(3.0)]),
        ("Rpi::DoubleExponential", &[value_of(0.0)], &[value_of(1.0)]),
    ]);
}

/// Functions that the reference system lacks.
#[test]
fn further_functions_of_reals() {
    check(&[
        (
            "Rpi::DoubleHyperbolicTangent",
            &[value_of(0.0)],
            &[value_of(0.0)],
        ),
        (
            "Rpi::DoubleHyperbolicTangent",
            &[value_of(-40.0)],
            &[value_of(-1.0)],
        ),
        (
            "Rpi::DoubleAtan",
            &[value_of(1.0)],
            &[value_of(core::f64::consts::FRAC_PI_4)],
        ),
    ]);
}

/// Operators of the SMT-LIB theory of bit vectors: `bvadd`, `bvudiv`, `bvsrem`, `bvashr` and others.
#[test]
fn machine_integers() {
    let (i8, u8, u64) = (-8_i64, 8_i64, 64_i64);
    let three = |name, a: i64, b: i64, width: i64, result: i64| {
        check(&[(
            name,
            &[value_of(a), value_of(b), value_of(width)],
            &[value_of(result)],
        )]);
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
    let two = |name, a: i64, b: i64, result: i64| {
        check(&[(name, &[value_of(a), value_of(b)], &[value_of(result)])])
    };
    two("Rpi::MachineWrap", 300, u8, 44);
    two("Rpi::MachineWrap", 200, i8, -56);
    two("Rpi::MachineNot", 5, u8, 250);
    two("Rpi::MachineNot", 5, i8, -6);
    two("Rpi::MachineAnd", 12, 10, 8);
    two("Rpi::MachineOr", 12, 3, 15);
    two("Rpi::MachineToInt", 200, u8, 200);
    let compared = |name, a: i64, b: i64, width: i64, result: bool| {
        check(&[(
            name,
            &[value_of(a), value_of(b), value_of(width)],
            &[value_of(result)],
        )]);
    };
    compared("Rpi::MachineGreater", -1, 1, u64, true);
    compared("Rpi::MachineGreater", -1, 1, i8, false);
    compared("Rpi::MachineGreaterOrEqual", 1, -1, u64, false);
    compared("Rpi::MachineGreaterOrEqual", 7, 7, u8, true);
}

fn check_integers() {
    check(&[
        (
            "Rpi::IntSubtract",
            &[value_of(1_i64), value_of(3_i64)],
            &[value_of(-2_i64)],
        ),
        ("Rpi::IntNegate", &[value_of(5_i64)], &[value_of(-5_i64)]),
        (
            "Rpi::IntModulo",
            &[value_of(-7_i64), value_of(3_i64)],
            &[value_of(-1_i64)],
        ),
        (
            "Rpi::IntPower",
            &[value_of(-2_i64), value_of(3_i64)],
            &[value_of(-8_i64)],
        ),
        (
            "Rpi::IntPower",
            &[value_of(-1_i64), value_of(i64::MAX)],
            &[value_of(-1_i64)],
        ),
        ("Rpi::IntAbsolute", &[value_of(-5_i64)], &[value_of(5_i64)]),
        (
            "Rpi::IntMinimum",
            &[value_of(-5_i64), value_of(2_i64)],
            &[value_of(-5_i64)],
        ),
        (
            "Rpi::IntMaximum",
            &[value_of(-5_i64), value_of(2_i64)],
            &[value_of(2_i64)],
        ),
        (
            "Rpi::IntGreaterOrEqual",
            &[value_of(2_i64), value_of(2_i64)],
            &[value_of(true)],
        ),
        (
            "Core::IntEquals",
            &[value_of(i64::MIN), value_of(i64::MAX)],
            &[value_of(false)],
        ),
    ]);
}

fn check_booleans_and_times() {
    check(&[
        (
            "Rpi::BooleanXor",
            &[value_of(true), value_of(true)],
            &[value_of(false)],
        ),
        (
            "Rpi::BooleanImplies",
            &[value_of(false), value_of(false)],
            &[value_of(true)],
        ),
        (
            "Rpi::BooleanEquals",
            &[value_of(false), value_of(false)],
            &[value_of(true)],
        ),
        (
            "Rpi::TimeEquals",
            &[value_of(Time(5)), value_of(Time(5))],
            &[value_of(true)],
        ),
        (
            "Rpi::TimeGreater",
            &[value_of(Time(5)), value_of(Time(5))],
            &[value_of(false)],
        ),
        (
            "Rpi::TimeGreaterOrEqual",
            &[value_of(Time(5)), value_of(Time(5))],
            &[value_of(true)],
        ),
    ]);
}

#[test]
fn integers_booleans_and_times() {
    check_integers();
    check_booleans_and_times();
}

#[test]
fn faults_have_their_codes() {
    let cases: [(&str, &[Value], FaultCode); 10] = [
        (
            "Rpi::IntSubtract",
            &[value_of(i64::MIN), value_of(1_i64)],
            FaultCode::IntegerOverflow,
        ),
        (
            "Rpi::IntNegate",
            &[value_of(i64::MIN)],
            FaultCode::IntegerOverflow,
        ),
        (
            "Rpi::IntAbsolute",
            &[value_of(i64::MIN)],
            FaultCode::IntegerOverflow,
        ),
        (
            "Rpi::IntPower",
            &[value_of(2_i64), value_of(63_i64)],
            FaultCode::IntegerOverflow,
        ),
        (
            "Rpi::IntModulo",
            &[value_of(1_i64), value_of(0_i64)],
            FaultCode::DivisionByZero,
        ),
        (
            "Core::TimeAdd",
            &[value_of(Time(i64::MAX)), value_of(1.0)],
            FaultCode::IntegerOverflow,
        ),
        (
            "Rpi::Assert",
            &[value_of(false)],
            FaultCode::AssertionFailed,
        ),
        (
            "Rpi::AssertIndex",
            &[value_of(false), value_of(3), value_of(3)],
            FaultCode::IndexOutOfRange,
        ),
        (
            "Rpi::Assume",
            &[value_of(false)],
            FaultCode::AssertionFailed,
        ),
        ("EStop", &[value_of(true)], FaultCode::EmergencyStop),
    ];
    for (name, inputs, code) in cases {
        let mut rig = TestBench::new(name, &[]);
        rig.step_present(inputs);
        assert_eq!(rig.fault, Some(code), "{name}");
    }
}

#[test]
fn latches_and_holds() {
    let mut trigger = TestBench::new("Core::Trigger", &[]);
    let mut step = |on: bool, off: bool, reset: bool| {
        get::<bool>(&trigger.step_present(&[value_of(on), value_of(off), value_of(reset)])[0])
    };
    assert!(!step(false, false, false));
    assert!(step(true, false, false));
    assert!(step(false, false, false));
    assert!(!step(true, true, false));
    assert!(!step(true, false, false), "off for good");
    assert!(step(true, false, true), "armed again");

    let mut hold = TestBench::new("Rpi::DoubleHold", &[]);
    let mut step = |value: Option<f64>| {
        hold.step(&[value.map(value_of), Some(value_of(9.0))])
            .remove(0)
    };
    assert_eq!(step(None), Some(value_of(9.0)));
    assert_eq!(step(Some(1.0)), Some(value_of(1.0)));
    assert_eq!(step(None), Some(value_of(1.0)));
}

#[test]
fn a_mean_forgets_what_has_left_the_window() {
    let mut mean = TestBench::new("Core::DoubleAverage", &[("Duration", value_of(3.0 * DT))]);
    let mut push = |x: f64| get::<f64>(&mean.step_present(&[value_of(x), value_of(false)])[0]);
    push(1e300);
    push(f64::INFINITY);
    for _ in 0..6 {
        push(1.0);
    }
    assert_eq!(push(1.0), 1.0);
}

#[test]
fn ranges_of_time_line_up() {
    let mut rig = TestBench::new(
        "Core::TimeConsistentRange",
        &[("MaxSize", value_of(1e-6)), ("MaxAge", value_of(2.0 * DT))],
    );
    let mut step = |first: (i64, i64), second: (i64, i64)| {
        let times = [first.0, first.1, second.0, second.1].map(|t| Some(value_of(Time(t))));
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
    let mut rig = TestBench::new("Core::OTG2", &[]);
    let (mut position, mut velocity, mut goal) = (0.0, 0.0, 0.1);
    for _ in 0..400 {
        goal += 0.2 * DT;
        let out = rig.step_present(&[position, velocity, goal, 1.0, 2.0].map(value_of));
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
        let mut rig = TestBench::new(name, &[]);
        for _ in 0..3000 {
            let inputs = [value_of(at), value_of(velocity), value_of(goal)];
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
