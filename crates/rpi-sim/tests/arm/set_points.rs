//! Set-points that an arm accepts or rejects, and how it follows them.

use rpi_device::{DeviceBank, Rejection};
use rpi_sim::error_code::ErrorCode;

use crate::rig::{Rig, TICK, speed_up};

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

/// Checks a set-point of axis 0 against a limit: rejected with `code` if `exceeds`, else accepted.
fn check_limit(rig: &mut Rig, target: f64, code: ErrorCode, exceeds: bool) {
    let rejected = rig.check(0, target) != Rejection::NONE;
    assert_eq!(rejected, exceeds, "{code} at {target}");
    assert_eq!(rig.error(0), if exceeds { code } else { ErrorCode::OK });
}

#[test]
fn each_limit_is_kept_to_the_last_part_in_a_million() {
    let jerk = 20.0 * 112.5_f64.to_radians();
    for (share, exceeds) in [(1.0 - 1e-5, false), (1.0 + 1e-5, true)] {
        let step = share * jerk * TICK * TICK * TICK;
        check_limit(&mut Rig::new(""), step, ErrorCode::JERK, exceeds);

        let mut rig = Rig::new("enforce = [\"acceleration\"]");
        let step = share * 4.0 * TICK * TICK;
        check_limit(&mut rig, step, ErrorCode::ACCELERATION, exceeds);

        let full = 112.5_f64.to_radians() * TICK;
        let mut rig = Rig::new("enforce = [\"velocity\"]");
        rig.set(0, full * 0.5);
        rig.bank.step();
        check_limit(&mut rig, full * (0.5 + share), ErrorCode::VELOCITY, exceeds);

        let end = 170.0_f64.to_radians();
        let mut rig = Rig::new("enforce = [\"position\"]");
        check_limit(&mut rig, end * share, ErrorCode::POSITION, exceeds);
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
