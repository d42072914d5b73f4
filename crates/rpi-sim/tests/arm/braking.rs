//! Braking: an arm never stays in motion without control.

use rpi_device::{DeviceBank, Rejection};
use rpi_sim::error_code::ErrorCode;

use crate::rig::{Rig, TICK, speed_up};

/// Runs until the arm is at rest and returns the positions of an axis. Checks its limits on the way.
fn come_to_rest(
    rig: &mut Rig,
    axis: usize,
    mut trail: Vec<f64>,
    acceleration: f64,
    jerk: f64,
) -> Vec<f64> {
    for _ in 0..5_000 {
        rig.bank.step();
        trail.push(rig.position(axis));
        let [.., p3, p2, p1, p0] = trail[..] else {
            continue;
        };
        let a = |newest: f64, middle: f64, oldest: f64| {
            (newest - 2.0 * middle + oldest) / (TICK * TICK)
        };
        let (now, before) = (a(p0, p1, p2), a(p1, p2, p3));
        assert!(now.abs() <= acceleration * 1.0001, "acceleration {now}");
        assert!(
            ((now - before) / TICK).abs() <= jerk * 1.001,
            "jerk {}",
            (now - before) / TICK
        );
        if !rig.bank.is_moving(0) && trail.len() > 4 {
            return trail;
        }
    }
    panic!("it never comes to rest");
}

#[test]
fn left_alone_while_moving_it_brakes_within_its_limits() {
    let mut rig = Rig::new("");
    let mut trail = vec![0.0];
    for target in speed_up(39.0, 200) {
        rig.set(1, target);
        rig.bank.step();
        trail.push(target);
    }
    assert!(rig.bank.is_moving(0) && rig.bank.is_moving(6) && !rig.bank.is_moving(7));
    let trail = come_to_rest(&mut rig, 1, trail, 4.0, 39.3);
    assert_eq!(rig.error(1), ErrorCode::SET_POINT_MISSING);
    assert_eq!(
        rig.reports()
            .iter()
            .map(|report| report.code)
            .collect::<Vec<_>>(),
        [ErrorCode::SET_POINT_MISSING]
    );
    let end = *trail.last().expect("positions");
    (0..5).for_each(|_| rig.bank.step());
    assert_eq!(rig.position(1), end, "it stays where it stands");
    rig.set(1, end);
    assert_eq!(rig.error(1), ErrorCode::OK);
}

#[test]
fn a_brake_that_runs_over_the_end_of_a_range_is_reported() {
    let mut rig = Rig::new("limits = { upper = [0.05, 1, 1, 1, 1, 1, 1] }");
    for target in speed_up(39.0, 200).take_while(|target| *target < 0.05) {
        rig.set(0, target);
        rig.bank.step();
    }
    while rig.bank.is_moving(0) {
        rig.bank.step();
    }
    assert!(rig.position(0) > 0.05);
    let codes: Vec<ErrorCode> = rig.reports().iter().map(|report| report.code).collect();
    assert_eq!(codes, [ErrorCode::SET_POINT_MISSING, ErrorCode::POSITION]);
}

#[test]
fn a_stop_on_request_keeps_the_straight_line() {
    let mut rig = Rig::new("");
    let direction = [0.3, -0.5, 0.2, 1.0, -0.7, 0.4, 0.0];
    for at in speed_up(30.0, 150) {
        rig.all(direction.map(|part| part * at));
    }
    rig.bank.stop(0);
    assert!(rig.bank.is_moving(0));
    while rig.bank.is_moving(0) {
        rig.bank.step();
        let along = rig.position(3);
        for (axis, part) in direction.iter().enumerate() {
            let off = rig.position(axis) - part * along;
            assert!(off.abs() < 1e-12, "axis {axis} is {off} off the line");
        }
    }
    assert!(
        rig.reports().is_empty(),
        "nobody is to blame for a stop on request"
    );
}

#[test]
fn set_points_that_join_take_over_from_the_brake() {
    let mut rig = Rig::new("");
    let mut last = [0.0; 2];
    for target in speed_up(30.0, 150) {
        rig.set(0, target);
        rig.bank.step();
        last = [last[1], target];
    }
    (0..10).for_each(|_| {
        last = [last[1], rig.position(0)];
        rig.bank.step();
    });
    let velocity = rig.sensor("joint.commanded_velocity", 0);
    let acceleration = rig.sensor("joint.commanded_acceleration", 0);
    let (p, v, a) = (
        rig.position(0),
        rig.real(velocity).expect("one"),
        rig.real(acceleration).expect("one"),
    );
    rig.set(0, p + TICK * (v + TICK * a));
    rig.bank.step();
    assert_eq!(rig.error(0), ErrorCode::OK);
    assert!((rig.real(acceleration).expect("one") - a).abs() < 1e-6);
}

/// The arm brakes as a whole: a set-point for a single other joint is rejected with an error, and a command that sets
/// all moving joints can take over.
#[test]
fn who_sets_one_joint_hears_that_the_arm_brakes_for_another() {
    let mut rig = Rig::new("");
    let mut last = [0.0; 2];
    for target in speed_up(30.0, 150) {
        rig.set(0, target);
        rig.set(1, target);
        rig.bank.step();
        last = [last[1], target];
    }
    rig.bank.stop(1);
    let next = 2.0 * last[1] - last[0];
    rig.set(0, next);
    rig.bank.step();
    let target = rig_follows(&mut rig, 0);
    rig.set(0, target);
    rig.bank.step();
    assert_eq!(rig.error(0), ErrorCode::BRAKING);
    let target = rig_follows(&mut rig, 0);
    assert_eq!(rig.check(0, target), Rejection::DEVICE_FAILED);
    rig.bank.step();
    (0..7).for_each(|axis| rig.bank.begin_command(axis, 1));
    let targets: [f64; 7] = std::array::from_fn(|axis| rig_follows(&mut rig, axis));
    rig.all(targets);
    let codes: Vec<ErrorCode> = (0..7).map(|axis| rig.error(axis)).collect();
    assert_eq!(codes, [ErrorCode::OK; 7]);
}

/// The set-point with which an axis continues at its present acceleration.
fn rig_follows(rig: &mut Rig, axis: usize) -> f64 {
    let [velocity, acceleration] = ["joint.commanded_velocity", "joint.commanded_acceleration"]
        .map(|name| {
            let port = rig.sensor(name, axis);
            rig.real(port).expect("one")
        });
    rig.position(axis) + TICK * (velocity + TICK * acceleration)
}

/// Moves an axis at constant speed and loses set-points from tick 100 on. Returns the number of ticks until it brakes.
fn ticks_until_brake(cell: &str, lost: i32) -> Option<i32> {
    let mut rig = Rig::new(cell);
    let mut last = [0.0; 2];
    for position in speed_up(20.0, 100) {
        last = [last[1], position];
        rig.all(std::array::from_fn(
            |axis| if axis == 0 { position } else { 0.0 },
        ));
    }
    let step = last[1] - last[0];
    for tick in 0..lost {
        rig.bank.step();
        if rig.error(0) == ErrorCode::SET_POINT_MISSING {
            return Some(tick + 1);
        }
        last = [last[1], last[1] + step];
        let bridged = rig.position(0);
        assert!((bridged - last[1]).abs() < 1e-9, "{bridged} {}", last[1]);
    }
    // The next set-point of the same motion is accepted, and the count starts again.
    rig.all(std::array::from_fn(|axis| {
        if axis == 0 { last[1] + step } else { 0.0 }
    }));
    None
}

#[test]
fn a_watchdog_bridges_as_many_periods_as_the_cell_says() {
    assert_eq!(ticks_until_brake("", 1), Some(1), "one by default");
    let three = "watchdog = 3";
    assert_eq!(ticks_until_brake(three, 2), None);
    assert_eq!(ticks_until_brake(three, 10), Some(3));
}

#[test]
fn a_watchdog_does_not_bridge_beyond_a_limit() {
    let mut rig = Rig::new("watchdog = 1000\nlimits = { upper = 0.05 }");
    for position in speed_up(20.0, 100) {
        rig.all(std::array::from_fn(
            |axis| if axis == 0 { position } else { 0.0 },
        ));
    }
    (0..1100).for_each(|_| rig.bank.step());
    let reports = rig.reports();
    let missing = |report: &&rpi_sim::Report| report.code == ErrorCode::SET_POINT_MISSING;
    let braked = reports.iter().find(missing).expect("it brakes");
    assert!((0.9..1.1).contains(&braked.time), "{braked:?}");
    // The brake begins at the end of the range, so that only its own way is beyond.
    assert!((0.05..0.053).contains(&rig.position(0)));
}
