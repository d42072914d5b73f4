//! Difference of one axis from the curve of a new chunk, which decays along a polynomial.
//!
//! The difference begins with the position, velocity and acceleration that the axis has and the curve does not have, and ends
//! with all three 0: `r = (1 - t/T)³ (a + b t/T + c (t/T)²)`. Unlike the fastest decay, whose jerk switches between its limits,
//! it has little jerk, and its duration T is chosen so that the sum of curve and difference keeps the limits of the axis.

use rpi_kin::state_to_rest::AxisState;

/// Difference of one axis from a curve. Default: no difference.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Residual {
    /// Coefficients of the powers of the share of the duration that has passed, rad.
    coefficients: [f64; 6],
    /// Duration of the decay, s; 0 without a difference.
    duration: f64,
}

/// State of a difference with its jerk: rad, rad/s, rad/s², rad/s³.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct ResidualState {
    pub(super) state: AxisState,
    pub(super) jerk: f64,
}

impl Residual {
    /// Creates the decay of the difference `start` (axis minus curve) in `duration` seconds.
    pub(super) fn new(start: AxisState, duration: f64) -> Self {
        let a = start.position;
        let b = start.velocity * duration + 3.0 * a;
        let c = (start.acceleration * duration * duration - 6.0 * a + 6.0 * b) / 2.0;
        Self {
            coefficients: [
                a,
                b - 3.0 * a,
                c - 3.0 * b + 3.0 * a,
                3.0 * b - 3.0 * c - a,
                3.0 * c - b,
                -c,
            ],
            duration,
        }
    }

    /// Returns the duration of the decay, s.
    pub(super) fn duration(&self) -> f64 {
        self.duration
    }

    /// Returns the difference `time` seconds (not negative) after its start; 0 after the duration.
    pub(super) fn at(&self, time: f64) -> ResidualState {
        if time >= self.duration {
            return ResidualState::default();
        }
        let x = time / self.duration;
        let [p0, p1, p2, p3, p4, p5] = self.coefficients;
        let per = 1.0 / self.duration;
        let first = p1 + x * (2.0 * p2 + x * (3.0 * p3 + x * (4.0 * p4 + x * 5.0 * p5)));
        let second = 2.0 * p2 + x * (6.0 * p3 + x * (12.0 * p4 + x * 20.0 * p5));
        let third = 6.0 * p3 + x * (24.0 * p4 + x * 60.0 * p5);
        ResidualState {
            state: AxisState {
                position: p0 + x * (p1 + x * (p2 + x * (p3 + x * (p4 + x * p5)))),
                velocity: first * per,
                acceleration: second * per * per,
            },
            jerk: third * per * per * per,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_difference_begins_as_given_and_ends_at_rest() {
        let start = AxisState {
            position: 0.3,
            velocity: -1.2,
            acceleration: 4.0,
        };
        let residual = Residual::new(start, 0.4);
        let at = residual.at(0.0).state;
        assert!((at.position - 0.3).abs() + (at.velocity + 1.2).abs() < 1e-12);
        assert!((at.acceleration - 4.0).abs() < 1e-12);
        let end = residual.at(0.4 - 1e-9).state;
        let size = end.position.abs() + end.velocity.abs() + end.acceleration.abs();
        assert!(size < 1e-6, "{end:?}");
        let (one, other) = (residual.at(0.2), residual.at(0.2 + 1e-6));
        let jerk = (other.state.acceleration - one.state.acceleration) / 1e-6;
        assert!((jerk - one.jerk).abs() < 1e-2);
    }
}
