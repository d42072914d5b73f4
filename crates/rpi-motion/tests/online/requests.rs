//! Requests that are rejected, and motions outside of the common case.

use rpi_kin::state_to_rest::{AxisState, Bounds};
use rpi_motion::online::{AxisLimits, MotionOptions, OnlineError, OnlineErrorKind, OnlineMotion};

fn limits() -> AxisLimits {
    AxisLimits::from(Bounds {
        speed: 1.0,
        acceleration: 2.0,
        jerk: 4.0,
    })
}

fn state(position: f64, velocity: f64, acceleration: f64) -> AxisState {
    AxisState {
        position,
        velocity,
        acceleration,
    }
}

fn error_of(start: AxisState, target: AxisState, limits: AxisLimits) -> OnlineErrorKind {
    let still = state(0.0, 0.0, 0.0);
    let result = OnlineMotion::to_position(
        &[still, start],
        &[still, target],
        &[self::limits(), limits],
        MotionOptions::default(),
    );
    let OnlineError { axis, kind } = result.expect_err("the request is invalid");
    assert_eq!(axis, 1);
    kind
}

#[test]
fn invalid_requests_are_rejected() {
    let still = state(0.0, 0.0, 0.0);
    for value in [f64::NAN, f64::INFINITY, 1e300] {
        assert_eq!(
            error_of(state(value, 0.0, 0.0), still, limits()),
            OnlineErrorKind::NotFinite
        );
        assert_eq!(
            error_of(still, state(0.0, value, 0.0), limits()),
            OnlineErrorKind::NotFinite
        );
        let jerk = AxisLimits {
            max_jerk: value,
            ..limits()
        };
        assert_eq!(error_of(still, still, jerk), OnlineErrorKind::Limits);
    }
    let same_sign = AxisLimits {
        min_velocity: 0.5,
        ..limits()
    };
    assert_eq!(error_of(still, still, same_sign), OnlineErrorKind::Limits);
    let zero = AxisLimits {
        max_acceleration: 0.0,
        ..limits()
    };
    assert_eq!(error_of(still, still, zero), OnlineErrorKind::Limits);
    assert_eq!(
        error_of(still, state(0.0, 1.1, 0.0), limits()),
        OnlineErrorKind::TargetVelocity
    );
    assert_eq!(
        error_of(still, state(0.0, 0.0, -2.1), limits()),
        OnlineErrorKind::TargetAcceleration
    );
    // The velocity was 1.3 half a second before.
    assert_eq!(
        error_of(still, state(0.0, 0.8, -2.0), limits()),
        OnlineErrorKind::TargetApproach
    );
}

#[test]
fn a_minimum_duration_must_be_finite_and_not_negative() {
    let still = [state(0.0, 0.0, 0.0)];
    for minimum_duration in [f64::NAN, f64::INFINITY, -1.0] {
        let options = MotionOptions {
            minimum_duration,
            ..MotionOptions::default()
        };
        let result = OnlineMotion::to_velocity(&still, &still, &[limits()], options);
        let kind = OnlineErrorKind::NotFinite;
        assert_eq!(result, Err(OnlineError { axis: 0, kind }));
    }
}

#[test]
fn a_start_outside_the_limits_is_brought_back_first() {
    let start = [state(0.0, 3.0, 5.0)];
    let target = [state(-2.0, 0.0, 0.0)];
    let motion = OnlineMotion::to_position(&start, &target, &[limits()], MotionOptions::default())
        .expect("the request is valid");
    let profile = &motion.axes()[0];
    // From 5 to the minimum acceleration, then down to the maximum velocity with it.
    let [fall, hold, ..] = profile.phases() else {
        panic!("too few phases");
    };
    assert!((fall.duration - 1.75).abs() < 1e-12 && fall.jerk == -4.0);
    let end_of_fall = start[0].advanced(fall.duration, fall.jerk);
    assert_eq!(hold.jerk, 0.0);
    assert!((end_of_fall.acceleration + 2.0).abs() < 1e-12);
    assert_eq!(profile.jerk_at(0.1), -4.0);
    assert_eq!(profile.jerk_at(motion.duration() + 1.0), 0.0);
}

#[test]
fn a_motion_without_distance_has_no_duration() {
    let there = [state(3.0, 0.4, 0.0)];
    let motion = OnlineMotion::to_position(&there, &there, &[limits()], MotionOptions::default())
        .expect("the request is valid");
    assert_eq!(motion.duration(), 0.0);
    assert_eq!(motion.state_at(0.0), there);
    // Afterwards the axis goes on with its velocity.
    assert!((motion.state_at(2.0)[0].position - 3.8).abs() < 1e-12);
}

#[test]
fn errors_name_the_axis_in_words() {
    let error = OnlineError {
        axis: 2,
        kind: OnlineErrorKind::TargetVelocity,
    };
    assert_eq!(
        error.to_string(),
        "the target velocity of axis 3 is outside its limits"
    );
}
