//! Curvature between two nodes of a path, and the acceleration and jerk of the tool that it causes.

use crate::node::Node;
use crate::path::Curvature;
use crate::time_law::PathState;

/// Curvature at a place between two nodes, as a bound: its derivative is known only up to a range.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CurveBound {
    /// Curvature, 1/m.
    value: f64,
    /// Two values between which the derivative of the curvature with respect to the arc length lies, 1/m².
    slopes: [f64; 2],
    /// Upper bound of the product of curvature and torsion, 1/m².
    twist: f64,
}

impl CurveBound {
    /// Returns the bound of several places: the largest curvature, and all derivatives. `None` if there are none.
    pub(crate) fn of_all(places: impl Iterator<Item = Curvature>) -> Option<Self> {
        let bounds = places.map(|at| Self {
            value: at.value,
            slopes: [at.slope; 2],
            twist: at.twist,
        });
        bounds.reduce(Self::join)
    }

    fn join(self, other: Self) -> Self {
        Self {
            value: self.value.max(other.value),
            slopes: [
                self.slopes[0].min(other.slopes[0]),
                self.slopes[1].max(other.slopes[1]),
            ],
            twist: self.twist.max(other.twist),
        }
    }

    /// Returns the curvature at the share `share` (0 to 1) of the way from the node `one` to the node `other`.
    ///
    /// It is interpolated linearly, except between slopes of different signs, as where a curve begins. Between nodes
    /// with a point of a spline between them, at which the derivatives jump, it is the largest one at all of these
    /// places.
    pub(crate) fn between(one: &Node, other: &Node, share: f64) -> Self {
        let (low, high) = (one.curvature, other.curvature);
        if let Some((_, kink)) = other.kink {
            return Self::of_all([low, high].into_iter()).map_or(kink, |ends| ends.join(kink));
        }
        let mix = |low: f64, high: f64| low + share * (high - low);
        let slope = mix(low.slope, high.slope);
        let largest = libm::fabs(low.slope).max(libm::fabs(high.slope));
        Self {
            value: mix(low.value, high.value),
            slopes: match low.slope * high.slope > 0.0 {
                true => [slope; 2],
                false => [-largest, largest],
            },
            twist: low.twist.max(high.twist),
        }
    }

    /// Returns true if the path is straight here.
    pub(crate) fn is_straight(&self) -> bool {
        self.value == 0.0 && self.slopes == [0.0; 2] && self.twist == 0.0
    }

    /// Returns the curvature with the largest derivative.
    pub(crate) fn largest(&self) -> Curvature {
        let [one, other] = self.slopes.map(libm::fabs);
        Curvature {
            value: self.value,
            slope: one.max(other),
            twist: self.twist,
        }
    }

    /// Returns the largest acceleration (m/s²) and jerk (m/s³) of the tool in this state of the motion with the jerk
    /// `jerk` along the path (m/s³).
    ///
    /// They are a t + k v² n and (j - k² v³) t + (3 k v a + k' v³) n + k w v³ b, with velocity v, acceleration a and
    /// jerk j along the path, its curvature k, torsion w, tangent t, normal n and binormal b.
    pub(crate) fn tool_motion(&self, state: &PathState, jerk: f64) -> (f64, f64) {
        let (k, v, a) = (self.value, state.velocity, state.acceleration);
        let cube = v * v * v;
        let along = rpi_math::hypot(jerk - k * k * cube, self.twist * cube);
        let bending = 3.0 * k * v * a;
        let across = |slope: f64| libm::fabs(bending + slope * cube);
        let [one, other] = self.slopes;
        (
            rpi_math::hypot(a, k * v * v),
            rpi_math::hypot(along, across(one).max(across(other))),
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn node(s: f64, value: f64, slope: f64) -> Node {
        Node {
            s,
            curvature: Curvature {
                value,
                slope,
                twist: 0.0,
            },
            ..Node::default()
        }
    }

    #[test]
    fn a_kink_between_two_nodes_is_within_the_bound() {
        let kink = [(4.4, 310.0), (4.4, -190.0)].map(|(value, slope)| Curvature {
            value,
            slope,
            twist: 0.0,
        });
        let mut other = node(1.002, 4.1, -200.0);
        other.kink = CurveBound::of_all(kink.into_iter()).map(|bound| (1.001, bound));
        let bound = CurveBound::between(&node(1.0, 4.0, 300.0), &other, 0.1);
        assert_eq!((bound.value, bound.slopes), (4.4, [-200.0, 310.0]));
    }

    #[test]
    fn either_slope_counts_across_the_path() {
        let bound = CurveBound {
            value: 2.0,
            slopes: [-5.0, 9.0],
            twist: 0.0,
        };
        let state = PathState {
            s: 0.0,
            velocity: 1.0,
            acceleration: -1.0,
        };
        // 3 k v a = -6 and k' v³ between -5 and 9: the largest magnitude is 11.
        let (acceleration, jerk) = bound.tool_motion(&state, 4.0 * 1.0);
        assert!((jerk - 11.0).abs() < 0.1, "{jerk}");
        assert!((acceleration - rpi_math::hypot(1.0, 2.0)).abs() < 0.1);
    }
}
