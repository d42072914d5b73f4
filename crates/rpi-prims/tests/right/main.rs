//! Tests of the correct behaviour where the reference system is wrong, one for each entry of the table of differences.

#[path = "../common/mod.rs"]
mod common;
mod spatial;

use common::{TYPES, TestBench, array, get, near, reals, value_of};
use rpi_image::{Role, Scalar, Type, Value};
use rpi_prims::differences::DIFFERENCES;
use rpi_prims::value_types::{Time, Vector};
use rpi_prims::{FaultCode, PrimId, geometry};
use spatial::same_rotation;
use std::f64::consts::{FRAC_PI_2, FRAC_PI_4};

rpi_testkit::trap_allocations!();

#[test]
fn every_difference_has_its_test_here() {
    let tests = [include_str!("main.rs"), include_str!("spatial.rs")].concat();
    for entry in DIFFERENCES {
        let test = format!("fn {}()", entry.test);
        assert!(
            tests.contains(&test),
            "{}: no test {}",
            entry.name,
            entry.test
        );
        assert!(!entry.fault.is_empty() && !entry.correct.is_empty());
    }
}

#[test]
fn differences_name_ports_that_exist() {
    for entry in DIFFERENCES {
        let speaks = |desc: &rpi_image::PrimDesc| {
            (0..desc.outputs.len()).any(|port| rpi_prims::differences::has_difference(desc, port))
        };
        assert!(
            rpi_prims::registry().iter().any(|p| speaks(&p.desc)),
            "{}",
            entry.name
        );
        for name in entry.types.iter().filter(|name| !name.contains('*')) {
            assert!(PrimId::from_name(name).is_some(), "{name}");
        }
    }
}

fn one(name: &str, inputs: &[Value]) -> Value {
    TestBench::new(name, &[]).step_present(inputs).remove(0)
}

#[test]
fn sine_of_zero_is_zero() {
    assert_eq!(get::<f64>(&one("Core::DoubleSin", &[value_of(0.0)])), 0.0);
    near(
        &reals(&one("Core::DoubleSin", &[value_of(FRAC_PI_2)])),
        &[1.0],
    );
}

#[test]
fn cosine_of_zero_is_one() {
    assert_eq!(get::<f64>(&one("Core::DoubleCos", &[value_of(0.0)])), 1.0);
    near(
        &reals(&one("Core::DoubleCos", &[value_of(FRAC_PI_2)])),
        &[0.0],
    );
}

#[test]
fn the_mean_of_rotations_lies_between_them() {
    let duration = [("Duration", value_of(2.0 * common::DT))];
    let mut rig = TestBench::new("World::RotationAverage", &duration);
    let turned = |a: f64| value_of(geometry::from_abc(a, 0.0, 0.0));
    rig.step_present(&[turned(0.0), value_of(false)]);
    same_rotation(
        get(&rig.step_present(&[turned(0.4), value_of(false)])[0]),
        geometry::from_abc(0.2, 0.0, 0.0),
    );
    same_rotation(
        get(&rig.step_present(&[turned(0.8), value_of(false)])[0]),
        geometry::from_abc(0.6, 0.0, 0.0),
    );
    same_rotation(
        get(&rig.step_present(&[turned(FRAC_PI_4), value_of(true)])[0]),
        geometry::from_abc(FRAC_PI_4, 0.0, 0.0),
    );
}

#[test]
fn a_snapshot_starts_with_its_parameter() {
    let mut rig = TestBench::new("Core::DoubleSnapshot", &[("Value", value_of(0.65))]);
    let mut step = |snapshot: bool, value: Option<f64>| {
        let out = rig.step(&[Some(value_of(snapshot)), value.map(value_of)]);
        get::<f64>(out[0].as_ref().expect("always present"))
    };
    assert_eq!(step(false, Some(1.0)), 0.65);
    assert_eq!(step(true, Some(2.0)), 2.0);
    assert_eq!(step(true, None), 2.0);
    assert_eq!(step(false, Some(3.0)), 2.0);
}

#[test]
fn conversions_to_integers_are_exact_or_faults() {
    let convert = |x: f64| {
        let mut rig = TestBench::new("Core::IntFromDouble", &[]);
        let out = rig.step_present(&[value_of(x)]);
        (get::<i64>(&out[0]), rig.fault)
    };
    assert_eq!(convert(1e10), (10_000_000_000, None));
    assert_eq!(convert(-1.9), (-1, None));
    for x in [f64::NAN, f64::INFINITY, 9.3e18, -9.3e18] {
        assert_eq!(convert(x).1, Some(FaultCode::LossyConversion), "{x}");
    }
}

#[test]
fn integer_overflow_is_a_fault() {
    let run = |name: &str, a: i64, b: i64| {
        let mut rig = TestBench::new(name, &[]);
        (
            get::<i64>(&rig.step_present(&[value_of(a), value_of(b)])[0]),
            rig.fault,
        )
    };
    let large = 3_000_000_000;
    assert_eq!(run("Core::IntAdd", large, large), (2 * large, None));
    assert_eq!(run("Core::IntMultiply", large, 2), (2 * large, None));
    assert_eq!(
        run("Core::IntAdd", i64::MAX, 1).1,
        Some(FaultCode::IntegerOverflow)
    );
    assert_eq!(
        run("Core::IntMultiply", i64::MIN, -1).1,
        Some(FaultCode::IntegerOverflow)
    );
    assert_eq!(run("Core::IntDivide", 7, -2), (-3, None));
    assert_eq!(
        run("Core::IntDivide", 7, 0).1,
        Some(FaultCode::DivisionByZero)
    );
    assert_eq!(
        run("Core::IntDivide", i64::MIN, -1).1,
        Some(FaultCode::IntegerOverflow)
    );
}

#[test]
fn times_have_nanoseconds() {
    let later = one(
        "Core::TimeAdd",
        &[value_of(Time(1_000_000_000)), value_of(0.000_000_5)],
    );
    assert_eq!(get::<Time>(&later), Time(1_000_000_500));
    let between = one("Core::TimeDiff", &[value_of(Time(1_000_000_000)), later]);
    assert_eq!(get::<f64>(&between), 0.000_000_5);
}

fn otg(position: f64, goal: f64, max_velocity: f64, max_acceleration: f64) -> [Option<Value>; 7] {
    let [p, g, v, a] = [position, goal, max_velocity, max_acceleration].map(|x| Some(value_of(x)));
    [p, None, None, g, None, v, a]
}

#[test]
fn online_trajectories_start_at_rest() {
    let mut rig = TestBench::new("Core::OTG", &[]);
    let out = rig.step(&otg(0.2, 0.2, 1.0, 2.0));
    let out: Vec<f64> = out.into_iter().map(|v| get(&v.expect("present"))).collect();
    assert_eq!(out, [0.2, 0.0, 0.0]);
    let mut at = 0.2;
    for _ in 0..300 {
        at = get(rig.step(&otg(at, 1.0, 1.0, 2.0))[0]
            .as_ref()
            .expect("present"));
    }
    assert!((at - 1.0).abs() < 2.0 * common::DT * common::DT, "{at}");
}

#[test]
fn online_trajectories_without_acceleration_keep_their_velocity() {
    let mut inputs = otg(0.2, 1.0, 1.0, 0.0);
    inputs[1] = Some(value_of(0.5));
    let out = TestBench::new("Core::OTG", &[]).step(&inputs);
    let out: Vec<f64> = out.into_iter().map(|v| get(&v.expect("present"))).collect();
    near(&out, &[0.2 + 0.5 * common::DT, 0.5, 0.0]);
}

#[test]
fn curves_take_their_parameters() {
    for (name, names) in [
        ("Core::CubicBezier", ["From", "Control1", "Control2", "To"]),
        ("Core::DoubleBezier", ["From", "FromVel", "ToVel", "To"]),
    ] {
        let desc = PrimId::from_name(name).expect("registered").desc();
        let stands_in = |param: &str| desc.in_port_of_param(param).is_some();
        assert!(names.into_iter().all(stands_in), "{name}");
        let ends = |t: f64| get::<f64>(&one(name, &[t, 1.0, 5.0, -7.0, 3.0].map(value_of)));
        near(&[ends(0.0), ends(1.0)], &[1.0, 3.0]);
    }
    let slope = |t: f64| {
        get::<f64>(&one(
            "Core::DoubleBezier",
            &[t, 1.0, 5.0, -7.0, 3.0].map(value_of),
        ))
    };
    assert!(((slope(1e-7) - 1.0) / 1e-7 - 5.0).abs() < 1e-5);
    assert!(((3.0 - slope(1.0 - 1e-7)) / 1e-7 + 7.0).abs() < 1e-5);
}

#[test]
fn windows_count_and_average() {
    let mut last = TestBench::new("Core::BooleanLastN", &[("Count", value_of(3_i64))]);
    let mut count = |value: bool| {
        let out = last.step_present(&[value_of(value), value_of(false)]);
        (
            get::<bool>(&out[0]),
            get::<bool>(&out[1]),
            get::<i64>(&out[2]),
        )
    };
    assert_eq!(count(false), (true, false, 0));
    assert_eq!(count(true), (false, false, 1));
    assert_eq!(count(true), (false, false, 2));
    assert_eq!(count(true), (false, true, 3));
    assert_eq!(count(false), (false, false, 2));

    let mut history = TestBench::new(
        "Core::BooleanHistory",
        &[("Duration", value_of(2.0 * common::DT))],
    );
    history.step_present(&[value_of(true), value_of(false)]);
    assert_eq!(
        get::<f64>(&history.step_present(&[value_of(false), value_of(false)])[2]),
        0.5
    );

    let mut mean = TestBench::new(
        "World::VectorAverage",
        &[("Duration", value_of(2.0 * common::DT))],
    );
    let mut push = |x: f64| {
        reals(&mean.step_present(&[value_of(Vector::new(x, 0.0, 1.0)), value_of(false)])[0])
    };
    near(&push(1.0), &[1.0, 0.0, 1.0]);
    near(&push(3.0), &[2.0, 0.0, 1.0]);
    near(&push(5.0), &[4.0, 0.0, 1.0]);
}

#[test]
fn delays_delay_every_type() {
    for (prefix, scalar) in TYPES {
        let desc = PrimId::from_name(&format!("{prefix}Pre"))
            .expect("registered")
            .desc();
        assert_eq!(desc.role, Role::Delay, "{prefix}");
        let mut rig = TestBench::new(
            &format!("{prefix}AtTime"),
            &[("MaxAge", value_of(5.0 * common::DT))],
        );
        let value = |k: u64| Value::Slots {
            ty: Type::Scalar(scalar),
            cells: (0..u64::from(scalar.slots()))
                .map(|c| if scalar == Scalar::Bool { k % 2 } else { k + c })
                .collect(),
        };
        for k in 0..20_u64 {
            let out = rig
                .step(&[Some(value(k)), Some(value_of(2.5 * common::DT))])
                .remove(0);
            assert_eq!(out, (k >= 3).then(|| value(k - 3)), "{prefix} {k}");
        }
    }
}

#[test]
fn edges_are_seen() {
    let mut rig = TestBench::new("Core::EdgeDetection", &[]);
    let seen: Vec<bool> = [false, true, true, false, true]
        .into_iter()
        .map(|v| get(&rig.step_present(&[value_of(v)])[0]))
        .collect();
    assert_eq!(seen, [false, true, false, false, true]);
}

#[test]
fn an_array_with_an_absent_value_is_absent() {
    let mut rig = TestBench::new("Core::DoubleArraySet", &[("Index", value_of(1_i64))]);
    let start = array(&[1.0, 2.0, 3.0]);
    assert_eq!(rig.step(&[Some(start.clone()), None]), [None]);
    assert_eq!(
        rig.step_present(&[start, value_of(7.0)]),
        [array(&[1.0, 7.0, 3.0])]
    );
}

#[test]
fn absence_is_told() {
    for (prefix, _) in TYPES {
        for name in [format!("{prefix}IsNull"), format!("{prefix}ArrayIsNull")] {
            let desc = PrimId::from_name(&name).expect("registered").desc();
            assert_eq!(
                (desc.role, desc.outputs[0].ty),
                (Role::IsAbsent, rpi_image::PortType::Scalar(Scalar::Bool))
            );
        }
    }
}
