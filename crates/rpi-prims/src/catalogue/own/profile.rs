//! Motion along a way.

use crate::cx::FaultCode;
use crate::macros::primitive;
use crate::registry::Prim;
use crate::travel::{Bounds, Travel};

pub(in crate::catalogue) const ALL: &[Prim] = &[TRAVEL, FADE];

primitive! {
    /// Travels a distance in the shortest time that speed, acceleration and jerk allow (double-S profile). Inputs are read in
    /// the first cycle; the first output is one period along the way, so that a switch repeats no set-point.
    /// Speeds at the ends are cut to the bounds; a way too short for them is travelled by a polynomial.
    /// After the end position and speed stay those of the end. Bounds that are not positive are a fault.
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
    state { f64, f64, f64, f64, f64, f64, f64, f64 }
    presence strict work 120 faults;
    full |cx, place, state, _, (distance, entry, leave, speed, acceleration, jerk)| {
        let elapsed = state.0 + cx.clock.dt;
        let travel = if state.0 > 0.0 {
            recall(state)
        } else {
            Travel::plan(distance, entry, leave, Bounds { speed, acceleration, jerk })
        };
        if !(travel.bounds.speed > 0.0 && travel.bounds.acceleration > 0.0 && travel.bounds.jerk > 0.0) {
            cx.fault(FaultCode::AssertionFailed, place);
        }
        keep(state, elapsed, &travel);
        let duration = travel.duration();
        let done = elapsed >= duration || travel.distance <= 0.0;
        let now = travel.at(elapsed);
        if done {
            (travel.distance, travel.leave, 0.0, duration, true)
        } else {
            (now.position, now.speed, now.acceleration, duration, false)
        }
    }
}

primitive! {
    /// A way that starts with speed 1 and comes back to 0 at rest after `Duration`: what is left of a foreign speed at the start
    /// of a motion. Times a speed it is the way to add. First output one period after its start; 0 from `Duration` on.
    FADE = "Rpi::Fade";
    in { inDuration: f64 = Duration(Real(0.0)) }
    out { outWay: f64; outSpeed: f64 }
    state { f64, f64 }
    presence strict work 20;
    full |cx, _, (elapsed, duration), (), (wanted,)| {
        if *elapsed <= 0.0 {
            *duration = wanted;
        }
        *elapsed += cx.clock.dt;
        fade(*elapsed, *duration)
    }
}

type Memory = (f64, f64, f64, f64, f64, f64, f64, f64);

fn keep(state: &mut Memory, elapsed: f64, t: &Travel) {
    let b = t.bounds;
    *state = (
        elapsed,
        t.distance,
        t.entry,
        t.leave,
        t.peak,
        b.speed,
        b.acceleration,
        b.jerk,
    );
}

fn recall(s: &Memory) -> Travel {
    let bounds = Bounds {
        speed: s.5,
        acceleration: s.6,
        jerk: s.7,
    };
    Travel {
        distance: s.1,
        entry: s.2,
        leave: s.3,
        peak: s.4,
        bounds,
    }
}

/// Quintic Hermite basis of the initial slope: value, slope and curvature are 0 at its end, value and curvature at its start.
fn fade(t: f64, duration: f64) -> (f64, f64) {
    if t >= duration {
        return (0.0, 0.0);
    }
    let u = t / duration;
    let way = u * (1.0 - u * u * (6.0 - u * (8.0 - 3.0 * u)));
    let speed = 1.0 - u * u * (18.0 - u * (32.0 - 15.0 * u));
    (way * duration, speed)
}
