//! A simulated arm accepts and rejects set-points as a real controller does, and never stays in motion without control.

use rpi_device::{DeviceBank, PortId, PortKind, PortQuery, Rejection};
use rpi_image::{Scalar, Type};
use rpi_sim::error_code::ErrorCode;
use rpi_sim::{Cell, FaultKind, Report, ScheduledFault, SimBank};

const TICK: f64 = 1e-3;

struct Rig {
    bank: SimBank,
    joints: [PortId; 7],
    positions: [PortId; 7],
}

impl Rig {
    fn new(extra: &str) -> Self {
        let text = format!("[devices.arm]\nkind = \"arm\"\nmodel = \"kuka-lwr4+\"\n{extra}");
        let cell = Cell::parse("cell.toml", &text).unwrap_or_else(|errors| panic!("{errors}"));
        let mut bank = SimBank::new(&cell, TICK);
        let real = Type::Scalar(Scalar::Real);
        let joints = std::array::from_fn(|axis| {
            port(&mut bank, "joint.position", axis, PortKind::Actuator, real)
        });
        let positions = std::array::from_fn(|axis| {
            port(
                &mut bank,
                "joint.measured_position",
                axis,
                PortKind::Sensor,
                real,
            )
        });
        Self {
            bank,
            joints,
            positions,
        }
    }

    fn sensor(&mut self, name: &str, axis: usize) -> PortId {
        port(
            &mut self.bank,
            name,
            axis,
            PortKind::Sensor,
            Type::Scalar(Scalar::Real),
        )
    }

    fn real(&mut self, port: PortId) -> Option<f64> {
        let mut cell = [0];
        self.bank
            .read(port, &mut cell)
            .then(|| f64::from_bits(cell[0]))
    }

    fn position(&mut self, axis: usize) -> f64 {
        self.real(self.positions[axis]).expect("a sample")
    }

    fn check(&mut self, axis: usize, target: f64) -> Rejection {
        self.bank
            .check_set_point(self.joints[axis], &[target.to_bits()])
    }

    fn error(&self, axis: usize) -> ErrorCode {
        ErrorCode(self.bank.error_code(self.joints[axis]))
    }

    /// Sends a set-point for one axis; the others hold their positions.
    fn set(&mut self, axis: usize, target: f64) {
        assert_eq!(
            self.check(axis, target),
            Rejection::NONE,
            "{target}: {}",
            self.error(axis)
        );
        self.bank.write(self.joints[axis], &[target.to_bits()]);
    }

    fn all(&mut self, targets: [f64; 7]) {
        (0..7).for_each(|axis| self.set(axis, targets[axis]));
        self.bank.step();
    }

    fn reports(&mut self) -> Vec<Report> {
        let mut all = Vec::new();
        self.bank.reports(|_, report| all.push(report));
        all
    }
}

fn port(bank: &mut SimBank, name: &str, index: usize, kind: PortKind, ty: Type) -> PortId {
    let name = PortQuery {
        device: "arm",
        port: name,
        index: index as u32,
        kind,
        ty,
    };
    bank.resolve(&name)
        .unwrap_or_else(|error| panic!("{name:?}: {error:?}"))
}

/// Positions of an axis, tick by tick from 0, that accelerates with constant jerk and then holds the speed.
fn speed_up(jerk: f64, ticks: i32) -> impl Iterator<Item = f64> {
    let (mut position, mut velocity, mut acceleration) = (0.0, 0.0, 0.0);
    (0..ticks).map(move |tick| {
        // Positive jerk in the first half and negative in the second, so that it ends at constant speed.
        acceleration += if tick < ticks / 2 {
            jerk * TICK
        } else {
            -jerk * TICK
        };
        velocity += acceleration * TICK;
        position += velocity * TICK;
        position
    })
}

#[test]
fn measured_follows_commanded_in_the_next_tick() {
    let mut rig = Rig::new("");
    for target in speed_up(30.0, 100) {
        rig.set(0, target);
        assert!(rig.position(0) < target, "not before the tick has passed");
        rig.bank.step();
        assert_eq!(rig.position(0), target);
    }
}

#[test]
fn each_limit_is_kept_to_the_last_part_in_a_million() {
    let jerk = 20.0 * 112.5_f64.to_radians();
    for (share, refused) in [(1.0 - 1e-5, false), (1.0 + 1e-5, true)] {
        let step = share * jerk * TICK * TICK * TICK;
        let mut rig = Rig::new("");
        assert_eq!(
            rig.check(0, step) != Rejection::NONE,
            refused,
            "jerk at {share}"
        );
        assert_eq!(
            rig.error(0),
            if refused {
                ErrorCode::JERK
            } else {
                ErrorCode::OK
            }
        );

        let mut rig = Rig::new("enforce = [\"acceleration\"]");
        assert_eq!(
            rig.check(0, share * 4.0 * TICK * TICK) != Rejection::NONE,
            refused,
            "acceleration at {share}"
        );
        assert_eq!(
            rig.error(0),
            if refused {
                ErrorCode::ACCELERATION
            } else {
                ErrorCode::OK
            }
        );

        let full = 112.5_f64.to_radians() * TICK;
        let mut rig = Rig::new("enforce = [\"velocity\"]");
        rig.set(0, full * 0.5);
        rig.bank.step();
        assert_eq!(
            rig.check(0, full * (0.5 + share)) != Rejection::NONE,
            refused,
            "velocity at {share}"
        );
        assert_eq!(
            rig.error(0),
            if refused {
                ErrorCode::VELOCITY
            } else {
                ErrorCode::OK
            }
        );

        let end = 170.0_f64.to_radians();
        let mut rig = Rig::new("enforce = [\"position\"]");
        assert_eq!(
            rig.check(0, end * share) != Rejection::NONE,
            refused,
            "position at {share}"
        );
        assert_eq!(
            rig.error(0),
            if refused {
                ErrorCode::POSITION
            } else {
                ErrorCode::OK
            }
        );
    }
}

#[test]
fn nonsense_and_jumps_are_refused_and_reported_once() {
    let mut rig = Rig::new("");
    for _ in 0..3 {
        assert!(rig.check(2, f64::NAN).intersects(Rejection::ILLEGAL_VALUE));
        assert_eq!(rig.error(2), ErrorCode::NOT_A_NUMBER);
        rig.bank.step();
    }
    assert!(rig.check(2, 0.5).intersects(Rejection::ILLEGAL_VALUE));
    assert_eq!(rig.error(2), ErrorCode::DISCONTINUITY);
    let reports = rig.reports();
    let seen: Vec<(Option<usize>, ErrorCode)> = reports
        .iter()
        .map(|report| (report.axis, report.code))
        .collect();
    assert_eq!(
        seen,
        [
            (Some(2), ErrorCode::NOT_A_NUMBER),
            (Some(2), ErrorCode::DISCONTINUITY)
        ]
    );
    assert_eq!(reports[1].value, 500.0);
    assert!((reports[1].limit - 112.5_f64.to_radians()).abs() < 1e-12);
    rig.set(2, 0.0);
    assert_eq!(
        rig.error(2),
        ErrorCode::OK,
        "an accepted set-point makes it well"
    );
}

#[test]
fn a_refused_set_point_that_is_written_anyway_moves_nothing() {
    let mut rig = Rig::new("");
    let target = rig.joints[3];
    rig.bank.write(target, &[1.0_f64.to_bits()]);
    rig.bank.step();
    assert_eq!(rig.position(3), 0.0);
}

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

/// A new command does not see the errors of set-points that were rejected before.
#[test]
fn who_begins_sees_no_refusals_of_others() {
    let mut rig = Rig::new("");
    assert_eq!(rig.check(0, 0.5), Rejection::ILLEGAL_VALUE);
    assert_eq!(rig.error(0), ErrorCode::DISCONTINUITY);
    rig.bank.begin_command(0, 1);
    assert_eq!(rig.error(0), ErrorCode::OK);
}

#[test]
fn a_command_with_a_longer_period_is_followed_evenly() {
    let mut rig = Rig::new("enforce = [\"velocity\", \"position\"]");
    (0..7).for_each(|axis| rig.bank.begin_command(axis, 5));
    let mut before = 0.0;
    for set_point in 1..=20 {
        let target = 0.005 * f64::from(set_point);
        rig.set(0, target);
        for _ in 0..5 {
            rig.bank.step();
            let now = rig.position(0);
            assert!((now - before - 0.001).abs() < 1e-12, "{before} to {now}");
            before = now;
        }
        assert!((before - target).abs() < 1e-12);
    }
    rig.bank.step();
    assert_eq!(
        rig.error(0),
        ErrorCode::SET_POINT_MISSING,
        "the sixth tick without one is too late"
    );
}

#[test]
fn a_failed_joint_refuses_and_the_arm_brakes() {
    let mut rig = Rig::new(
        "[[devices.arm.faults]]\nat = 0.1\nfor = 2.0\ntrouble = \"joint-failure\"\naxis = 4\n",
    );
    let mut last = 0.0;
    for target in speed_up(30.0, 99) {
        rig.set(0, target);
        rig.bank.step();
        last = target;
    }
    rig.bank.step();
    rig.bank.step();
    assert_eq!(rig.error(4), ErrorCode::JOINT_FAILED);
    assert_eq!(rig.check(4, 0.0), Rejection::DEVICE_FAILED);
    assert!(
        rig.position(0) > last && rig.bank.is_moving(0),
        "it brakes, it does not freeze"
    );
    (0..1500).for_each(|_| rig.bank.step());
    assert!(!rig.bank.is_moving(0));
    (0..1000).for_each(|_| rig.bank.step());
    assert_eq!(rig.error(4), ErrorCode::OK, "the fault is over");
    assert_eq!(rig.check(4, 0.0), Rejection::NONE);
}

#[test]
fn an_emergency_stop_refuses_everything() {
    let mut rig = Rig::new("");
    let fault = ScheduledFault {
        from: 0.0,
        until: 0.5,
        kind: FaultKind::EmergencyStop,
    };
    assert!(rig.bank.inject("arm", fault));
    rig.bank.step();
    for axis in 0..7 {
        assert_eq!(rig.check(axis, 0.0), Rejection::DEVICE_FAILED);
        assert_eq!(rig.error(axis), ErrorCode::EMERGENCY_STOP);
    }
    assert!(!rig.bank.inject("leg", fault), "there is no such device");
}

/// M8.2.
#[test]
fn lost_samples_are_absent_and_lost_set_points_do_not_arrive() {
    let text = "[[devices.arm.faults]]\nat = 0.01\nfor = \"10 ms\"\ntrouble = \"lost-samples\"\n
        [[devices.arm.faults]]\nat = 0.03\ntrouble = \"lost-set-points\"\n";
    let mut rig = Rig::new(text);
    let mut absent = 0;
    let mut targets = speed_up(30.0, 200);
    for _ in 0..29 {
        let target = targets.next().expect("enough");
        rig.set(0, target);
        rig.bank.step();
        let port = rig.positions[0];
        absent += usize::from(rig.real(port).is_none());
    }
    assert_eq!(absent, 10);
    rig.set(0, targets.next().expect("enough"));
    rig.bank.step();
    assert_eq!(rig.error(0), ErrorCode::SET_POINT_MISSING);
}

#[test]
fn latency_lag_and_noise_change_what_is_measured_only() {
    let ramp: Vec<f64> = speed_up(30.0, 100).collect();
    let mut late = Rig::new("latency = \"7 ms\"");
    let mut slow = Rig::new("lag = \"10 ms\"");
    let mut noisy = Rig::new("noise = 1e-4");
    let commanded = noisy.sensor("joint.commanded_position", 0);
    let mut off = Vec::new();
    for (tick, target) in ramp.iter().enumerate() {
        for rig in [&mut late, &mut slow, &mut noisy] {
            rig.set(0, *target);
            rig.bank.step();
        }
        let old = if tick < 7 { 0.0 } else { ramp[tick - 7] };
        assert_eq!(late.position(0), old);
        assert!(slow.position(0) < *target);
        assert_eq!(noisy.real(commanded), Some(*target));
        off.push(noisy.position(0) - target);
    }
    (0..200).for_each(|_| {
        let last = ramp[99];
        slow.bank.write(slow.joints[0], &[last.to_bits()]);
        slow.bank.step();
    });
    let spread = (off.iter().map(|one| one * one).sum::<f64>() / off.len() as f64).sqrt();
    assert!(spread > 0.5e-4 && spread < 2e-4, "{spread}");
}

#[test]
fn a_contact_is_felt_at_the_tool_and_in_the_joints() {
    let text = "joints = [0, 0, 0, \"90 deg\", 0, 0, 0]\n
        [[devices.arm.faults]]\ntrouble = \"contact\"\nforce = [0, 0, \"-10 N\"]\n";
    let mut rig = Rig::new(text);
    rig.bank.step();
    let (force, torque) = (
        rig.sensor("tcp.force_z", 0),
        rig.sensor("joint.external_torque", 3),
    );
    assert_eq!(rig.real(force), Some(-10.0));
    // The forearm and hand extend horizontally by 0.468 m, and axis 4 of an LWR counts upwards.
    let felt = rig.real(torque).expect("a sample");
    assert!((felt.abs() - 4.68).abs() < 1e-9, "{felt}");
    let numbered = rig.sensor("joint4.external_torque", 0);
    assert_eq!(rig.real(numbered), Some(felt));
}
