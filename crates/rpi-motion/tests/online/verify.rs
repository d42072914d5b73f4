//! Verification of a planned motion by integration of its phases.

use crate::cases::Case;
use rpi_kin::state_to_rest::AxisState;
use rpi_motion::online::AxisProfile;

/// Largest errors of a motion.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Errors {
    /// Distance of the end of the integrated phases from the target: position, velocity and acceleration.
    pub(crate) end: [f64; 3],
    /// Excess over the limits of velocity, acceleration and jerk, as a share of the limit, after the limits have been
    /// reached once.
    pub(crate) excess: [f64; 3],
    /// Error at the end that rounding explains.
    pub(crate) rounding: f64,
}

impl Errors {
    /// Largest excess over a limit.
    pub(crate) fn worst_excess(&self) -> f64 {
        largest(&self.excess)
    }

    /// Largest distance from the target.
    pub(crate) fn worst_end(&self) -> f64 {
        largest(&self.end)
    }
}

/// Largest number; infinite if one is not a number, so that no comparison passes.
fn largest(numbers: &[f64]) -> f64 {
    let sized = |number: &f64| {
        if number.is_nan() {
            f64::INFINITY
        } else {
            *number
        }
    };
    numbers.iter().map(sized).fold(0.0, f64::max)
}

fn share_beyond(value: f64, low: f64, high: f64) -> f64 {
    if value > high {
        value / high - 1.0
    } else if value < low {
        value / low - 1.0
    } else {
        0.0
    }
}

/// Rounding of the accelerations and velocities of a motion, integrated to a velocity.
fn rounding_of_velocity(case: &Case, profile: &AxisProfile) -> f64 {
    let (limits, state) = (&case.limits, profile.start());
    let fastest = limits.max_velocity.max(-limits.min_velocity);
    let steepest = limits.max_acceleration.max(-limits.min_acceleration);
    let fastest = fastest.max(state.velocity.abs());
    let steepest = steepest.max(state.acceleration.abs());
    1e-15 * (fastest + profile.duration() * steepest)
}

/// Integrates the phases of a motion. Velocity and acceleration are checked at the ends of phases and at each extremum
/// of the velocity, from the moment at which they are within the limits.
pub(crate) fn errors(case: &Case, profile: &AxisProfile) -> Errors {
    let Case { limits, target, .. } = case;
    let mut errors = Errors::default();
    let mut state = profile.start();
    let rounding = rounding_of_velocity(case, profile);
    errors.rounding = rounding * profile.duration().max(1.0);
    let (mut is_inside_v, mut is_inside_a) = (false, false);
    let mut check = |state: &AxisState, errors: &mut Errors| {
        let v = share_beyond(state.velocity, limits.min_velocity, limits.max_velocity);
        let a = share_beyond(
            state.acceleration,
            limits.min_acceleration,
            limits.max_acceleration,
        );
        // A start within the velocity limits, whose acceleration carries it beyond them, is outside of the limits.
        let change = state.acceleration * state.acceleration.abs() / (2.0 * limits.max_jerk);
        let coasting = share_beyond(
            state.velocity + change,
            limits.min_velocity,
            limits.max_velocity,
        );
        is_inside_a |= a <= 1e-9;
        is_inside_v |= v <= 1e-9 && coasting <= 1e-9;
        if is_inside_v && !case.is_velocity {
            let rounding = rounding / limits.max_velocity.min(-limits.min_velocity);
            errors.excess[0] = largest(&[errors.excess[0], v - rounding]);
        }
        if is_inside_a {
            errors.excess[1] = largest(&[errors.excess[1], a]);
        }
    };
    check(&state, &mut errors);
    for phase in profile.phases() {
        let turn = -state.acceleration / phase.jerk;
        if turn > 0.0 && turn < phase.duration {
            check(&state.advanced(turn, phase.jerk), &mut errors);
        }
        state = state.advanced(phase.duration, phase.jerk);
        check(&state, &mut errors);
        errors.excess[2] = errors.excess[2].max(phase.jerk.abs() / limits.max_jerk - 1.0);
    }
    errors.end = [
        if case.is_velocity {
            0.0
        } else {
            (state.position - target.position).abs()
        },
        (state.velocity - target.velocity).abs(),
        (state.acceleration - target.acceleration).abs(),
    ];
    errors
}
