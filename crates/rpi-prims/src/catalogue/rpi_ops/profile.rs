//! Motion along a path. Inputs are read in the first cycle. The first output is one period along the path, so that a
//! switch between motions does not repeat a set-point. Durations are rounded up to whole periods. `outDone` is true
//! from the cycle after the end, in which the next motion provides the set-point.

use crate::context::FaultCode;
use crate::double_s::{Bounds, DoubleSProfile, MotionState};
use crate::macros::primitive;
use crate::registry::Prim;

pub(in crate::catalogue) const ALL: &[Prim] = &[TRAVEL, TRANSITION];

primitive! {
    /// Motion over a distance (m) in the shortest time with bounded speed (m/s), acceleration (m/s²) and jerk (m/s³): a
    /// double-S profile. `inEntry` and `inLeave` are the speeds at the start and at the end, limited to the maximum
    /// speed. A distance too short for the bounds is covered with a quartic polynomial that exceeds them. Inputs are
    /// read in the first cycle. Position and speed stay constant after the end. `outDuration` is a whole number of
    /// periods, in s. `outDone` is true from the cycle after the end. Bounds that are not positive are a fault.
    TRAVEL = "Rpi::Travel";
    in {
        inDistance: f64 = Distance(Real(0.0));
        inEntry: f64 = Entry(Real(0.0));
        inLeave: f64 = Leave(Real(0.0));
        inSpeed: f64 = Speed(Real(0.25));
        inAcceleration: f64 = Acceleration(Real(1.0));
        inJerk: f64 = Jerk(Real(10.0))
    }
    out { outTravelled: f64; outSpeed: f64; outAcceleration: f64; outDuration: f64; outDone: bool }
    state { f64, f64, f64, f64, f64, f64, f64, f64, f64 }
    presence strict work 150 faults;
    full |cx, place, memory, _, (distance, entry, leave, speed, acceleration, jerk)| {
        let dt = cx.time.dt;
        let cycle = memory.0 + 1.0;
        let (travel, periods) = if memory.0 > 0.0 {
            from_memory(memory)
        } else {
            DoubleSProfile::plan_periods(distance, entry, leave, Bounds { speed, acceleration, jerk }, dt)
        };
        if !travel.bounds.are_positive() {
            cx.fault(FaultCode::AssertionFailed, place);
        }
        *memory = to_memory(cycle, &travel, periods);
        let now = state_in_cycle(&travel, cycle, periods, dt);
        (now.position, now.speed, now.acceleration, periods * dt, cycle > periods)
    }
}

primitive! {
    /// Weights of a transition between two states of motion during `inDuration` seconds (quintic Hermite basis with
    /// zero acceleration at both ends). A path from `p0` with velocity `v0` to `p1` with velocity `v1` is `p0 + (p1 -
    /// p0) * outTo + v0 * outEntry + v1 * outLeave`. Its velocity is `(p1 - p0) * outToRate + v0 * outEntryRate + v1 *
    /// outLeaveRate`. `outDone` is true from the cycle after the end.
    TRANSITION = "Rpi::Transition";
    in { inDuration: f64 = Duration(Real(0.0)) }
    out {
        outTo: f64;
        outEntry: f64;
        outLeave: f64;
        outToRate: f64;
        outEntryRate: f64;
        outLeaveRate: f64;
        outDone: bool
    }
    state { f64, f64 }
    presence strict work 40;
    full |cx, _, (cycle, periods), (), (duration,)| {
        let dt = cx.time.dt;
        if *cycle < 1.0 {
            // The tolerance avoids an extra period if rounding puts the quotient just above a whole number.
            *periods = libm::fmax(libm::ceil(duration / dt - 1e-6), 1.0);
        }
        *cycle += 1.0;
        let (way, rate) = hermite(libm::fmin(*cycle / *periods, 1.0), *periods * dt);
        (way.0, way.1, way.2, rate.0, rate.1, rate.2, *cycle > *periods)
    }
}

type Memory = (f64, f64, f64, f64, f64, f64, f64, f64, f64);

fn to_memory(cycle: f64, t: &DoubleSProfile, periods: f64) -> Memory {
    let b = t.bounds;
    (
        cycle,
        t.distance,
        t.start_speed,
        t.end_speed,
        t.peak_speed,
        b.speed,
        b.acceleration,
        b.jerk,
        periods,
    )
}

fn from_memory(m: &Memory) -> (DoubleSProfile, f64) {
    let bounds = Bounds {
        speed: m.5,
        acceleration: m.6,
        jerk: m.7,
    };
    (
        DoubleSProfile {
            distance: m.1,
            start_speed: m.2,
            end_speed: m.3,
            peak_speed: m.4,
            bounds,
        },
        m.8,
    )
}

fn state_in_cycle(travel: &DoubleSProfile, cycle: f64, periods: f64, dt: f64) -> MotionState {
    if cycle >= periods {
        return MotionState {
            position: travel.distance,
            speed: travel.end_speed,
            acceleration: 0.0,
        };
    }
    // The plan may end a rounding error before or after the last whole period, so it is stretched to that period.
    travel.state_at(cycle / periods * libm::fmin(travel.duration(), periods * dt))
}

/// Returns the weights (goal, start velocity, end velocity) and their rates (1/s) at the fraction `u` of a duration in
/// s.
fn hermite(u: f64, duration: f64) -> ((f64, f64, f64), (f64, f64, f64)) {
    let (u2, u3) = (u * u, u * u * u);
    let way = (
        u3 * (10.0 - u * (15.0 - 6.0 * u)),
        duration * u * (1.0 - u2 * (6.0 - u * (8.0 - 3.0 * u))),
        duration * u3 * (u * (7.0 - 3.0 * u) - 4.0),
    );
    let rate = (
        30.0 * u2 * (1.0 - u) * (1.0 - u) / duration,
        1.0 - u2 * (18.0 - u * (32.0 - 15.0 * u)),
        u2 * (u * (28.0 - 15.0 * u) - 12.0),
    );
    (way, rate)
}

#[cfg(test)]
mod tests {
    use super::hermite;

    #[test]
    fn weights_join_both_ends() {
        assert_eq!(hermite(0.0, 2.0), ((0.0, 0.0, 0.0), (0.0, 1.0, 0.0)));
        assert_eq!(hermite(1.0, 2.0), ((1.0, 0.0, 0.0), (0.0, 0.0, 1.0)));
    }

    #[test]
    fn rates_are_the_slopes_of_the_weights() {
        let (duration, h) = (0.7, 1e-5);
        for k in 1..100 {
            let u = f64::from(k) / 100.0;
            let ((a, b), (_, rate)) = (
                (hermite(u - h, duration).0, hermite(u + h, duration).0),
                hermite(u, duration),
            );
            let slope = |a: f64, b: f64| (b - a) / (2.0 * h * duration);
            for (slope, rate) in [
                (slope(a.0, b.0), rate.0),
                (slope(a.1, b.1), rate.1),
                (slope(a.2, b.2), rate.2),
            ] {
                assert!((slope - rate).abs() < 1e-7, "at {u}: {slope} {rate}");
            }
        }
    }
}
