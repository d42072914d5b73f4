//! Angles on the circle and on the line: wrapping and choice among angles that differ by full turns.

use crate::Range;
use core::f64::consts::{PI, TAU};

/// Half a turn (π), in rad. For callers that should not import `core::f64::consts` themselves.
pub const HALF_TURN: f64 = PI;

/// Returns `angle` (rad) moved by full turns into [-π, π].
#[must_use]
pub fn wrap(angle: f64) -> f64 {
    if (-PI..=PI).contains(&angle) {
        return angle;
    }
    angle - TAU * libm::rint(angle / TAU)
}

/// Returns `angle` (rad) moved by full turns to the value nearest to `near` (rad).
#[must_use]
pub fn nearest_turn(angle: f64, near: f64) -> f64 {
    angle + TAU * libm::rint((near - angle) / TAU)
}

/// Returns `angle` (rad) moved by full turns into `range`, as near to `near` (rad) as possible; `None` if no such angle
/// lies in `range`.
#[must_use]
pub fn turn_within(angle: f64, near: f64, range: Range) -> Option<f64> {
    let nearest = nearest_turn(angle, near);
    if range.contains(nearest) {
        return Some(nearest);
    }
    // Beyond a limit of the range, the best angle is the one nearest to that limit.
    let target = if nearest > range.upper {
        range.upper
    } else {
        range.lower
    };
    let inward = if nearest > range.upper { -TAU } else { TAU };
    let close = nearest_turn(angle, target);
    [close, close + inward]
        .into_iter()
        .find(|turn| range.contains(*turn))
}

/// Sine and cosine of an angle, stored together because every user needs both.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SinCos {
    /// Sine of the angle, from -1 to 1.
    pub sin: f64,
    /// Cosine of the angle, from -1 to 1.
    pub cos: f64,
}

impl SinCos {
    /// Computes sine and cosine of an angle in rad.
    #[must_use]
    pub fn from_angle(angle: f64) -> Self {
        let (sin, cos) = rpi_math::sincos(angle);
        Self { sin, cos }
    }

    /// Returns the angle of this sine and cosine in rad, from -π to π.
    #[must_use]
    pub fn angle(self) -> f64 {
        rpi_math::atan2(self.sin, self.cos)
    }

    /// Returns sine and cosine of the difference: the angle of `self` minus the angle of `other`.
    #[must_use]
    pub fn difference(self, other: Self) -> Self {
        Self {
            sin: self.sin * other.cos - self.cos * other.sin,
            cos: self.cos * other.cos + self.sin * other.sin,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_wrapped_angle_is_within_half_a_turn_and_the_same_direction() {
        for k in -50..50 {
            let angle = 0.37 * f64::from(k);
            let wrapped = wrap(angle);
            assert!((-PI..=PI).contains(&wrapped), "{angle} -> {wrapped}");
            assert!((rpi_math::sin(angle) - rpi_math::sin(wrapped)).abs() < 1e-14);
            assert!((rpi_math::cos(angle) - rpi_math::cos(wrapped)).abs() < 1e-14);
        }
    }

    #[test]
    fn the_turn_within_a_range_is_the_nearest_one_that_fits() {
        let wide = Range::symmetric(2.0 * TAU);
        assert_eq!(turn_within(0.5, 6.5, wide), Some(0.5 + TAU));
        let narrow = Range::symmetric(3.0);
        assert_eq!(turn_within(3.1, 3.0, narrow), None);
        assert_eq!(
            turn_within(-2.9, 3.0, narrow),
            Some(-2.9),
            "the hint's turn, 3.38, is outside"
        );
        assert_eq!(turn_within(2.9, -3.0, narrow), Some(2.9));
        assert_eq!(turn_within(f64::NAN, 0.0, narrow), None);
    }
}
