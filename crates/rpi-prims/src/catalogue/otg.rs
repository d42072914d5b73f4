//! Online trajectory generation: one step per cycle towards a goal that may change at any time.
//!
//! Implements the second-order filter of Zanasi, Guarino Lo Bianco and Tonielli ("Nonlinear filters for the generation
//! of smooth trajectories", Automatica 36, 2000; Biagiotti and Melchiorri, Trajectory Planning, 2008, 4.6). The filter
//! is time-optimal in discrete time with bounded acceleration. As in the reference system, the position is integrated
//! with the velocity at the end of the period, while the filter assumes the velocity in the middle. At the goal, the
//! output therefore oscillates by a fraction of one step.

use crate::macros::primitive;
use crate::registry::Prim;

pub(super) const ALL: &[Prim] = &[OTG, OTG2];

primitive! {
    /// Online trajectory generation: one step towards position and velocity of a goal with bounded velocity
    /// (`inMaxVel`) and acceleration (`inMaxAcc`). Units are those of the position and s. The step starts at
    /// `inCurPos`; if absent, at the end of the last step (initially 0). It starts with `inCurVel`; if absent, with the
    /// velocity from the start of the last step to the current position (initially 0). `inCurAcc` is not used.
    OTG = "Core::OTG";
    in {
        inCurPos: f64 = absent;
        inCurVel: f64 = absent;
        inCurAcc: f64 = absent;
        inDestPos: f64;
        inDestVel: f64 = absent;
        inMaxVel: f64 = maxVel(Real(0.0));
        inMaxAcc: f64 = maxAcc(Real(0.0))
    }
    out { outPos: f64; outVel: f64; outAcc: f64 }
    state { bool, f64, f64 }
    presence if_all work 60;
    c Code(r"
const bool is_present = inDestPos_present && inMaxVel_present && inMaxAcc_present;
if (is_present) {
  const double position = inCurPos_present ? inCurPos : *s2;
  const double derived = *s0 ? (position - *s1) / rpi_dt : 0.0;
  rpi_otg(position, inCurVel_present ? inCurVel : derived, inDestPos, inDestVel_present ? inDestVel : 0.0, inMaxVel,
          inMaxAcc, rpi_dt, outPos, outVel, outAcc);
  *s0 = true;
  *s1 = position;
  *s2 = *outPos;
}
*outPos_present = is_present;
*outVel_present = is_present;
*outAcc_present = is_present;
");
    full |cx, _, (known, started, ended), (), (position, velocity, _, goal, goal_velocity, max_velocity, max_acceleration)| {
        let (Some(goal), Some(max_velocity), Some(max_acceleration)) = (goal, max_velocity, max_acceleration) else {
            return (None, None, None);
        };
        let dt = cx.time.dt;
        let position = position.unwrap_or(*ended);
        let derived = if *known { (position - *started) / dt } else { 0.0 };
        let from = (position, velocity.unwrap_or(derived));
        let to = (goal, goal_velocity.unwrap_or(0.0));
        let (end, velocity, acceleration) = step(from, to, max_velocity, max_acceleration, dt);
        (*known, *started, *ended) = (true, position, end);
        (Some(end), Some(velocity), Some(acceleration))
    }
}

primitive! {
    /// Online trajectory generation: one step towards a moving position with bounded velocity (`inMaxVel`) and
    /// acceleration (`inMaxAcc`). It works like `OTG`, but computes the velocity of the goal from its change since the
    /// last cycle.
    OTG2 = "Core::OTG2";
    in {
        inCurPos: f64;
        inCurVel: f64;
        inDesPos: f64;
        inMaxVel: f64 = maxVel(Real(0.0));
        inMaxAcc: f64 = maxAcc(Real(0.0))
    }
    out { outPos: f64; outVel: f64; outAcc: f64 }
    state { bool, f64 }
    presence strict work 60;
    c Code(r"
const double goal_velocity = *s0 ? (inDesPos - *s1) / rpi_dt : 0.0;
*s0 = true;
*s1 = inDesPos;
rpi_otg(inCurPos, inCurVel, inDesPos, goal_velocity, inMaxVel, inMaxAcc, rpi_dt, outPos, outVel, outAcc);
");
    full |cx, _, (known, last), (), (position, velocity, goal, max_velocity, max_acceleration): (f64, f64, f64, f64, f64)| {
        let dt = cx.time.dt;
        let goal_velocity = if *known { (goal - *last) / dt } else { 0.0 };
        (*known, *last) = (true, goal);
        step((position, velocity), (goal, goal_velocity), max_velocity, max_acceleration, dt)
    }
}

/// Returns position, velocity and acceleration after one period `dt` (s) of a motion from (position, velocity) towards
/// the goal (position, velocity). The acceleration is 0 if a full step with it could exceed the maximum velocity.
pub(crate) fn step(
    from: (f64, f64),
    to: (f64, f64),
    max_velocity: f64,
    max_acceleration: f64,
    dt: f64,
) -> (f64, f64, f64) {
    if max_acceleration == 0.0 {
        return (from.0 + from.1 * dt, from.1, 0.0);
    }
    let sigma = sliding_variable(from, to, max_acceleration, dt);
    // The sign of not-a-number depends on the processor and on the order of operands.
    let direction = if sigma.is_nan() {
        1.0
    } else {
        libm::copysign(1.0, sigma)
    };
    let room = max_velocity - max_acceleration * dt + from.1 * direction;
    let acceleration = if room < 0.0 {
        0.0
    } else {
        -max_acceleration * sigma.clamp(-1.0, 1.0)
    };
    let velocity = from.1 + acceleration * dt;
    (from.0 + velocity * dt, velocity, acceleration)
}

/// Returns the sliding variable σ (no unit) of the filter for a motion from (position, velocity) to a goal (position,
/// velocity). The acceleration has the opposite sign of σ; its magnitude is maximal for |σ| of 1 or more and
/// proportional to |σ| below.
fn sliding_variable(from: (f64, f64), to: (f64, f64), max_acceleration: f64, dt: f64) -> f64 {
    let speed = (from.1 - to.1) / (max_acceleration * dt);
    let z = (from.0 - to.0) / (max_acceleration * dt * dt) + speed / 2.0;
    let m = libm::floor((1.0 + libm::sqrt(1.0 + 8.0 * libm::fabs(z))) / 2.0);
    let sign = if z > 0.0 {
        1.0
    } else if z < 0.0 {
        -1.0
    } else {
        0.0
    };
    speed + z / m + (m - 1.0) / 2.0 * sign
}
