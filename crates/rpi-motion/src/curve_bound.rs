//! Curvature between two nodes of a path, and the acceleration and jerk of the tool that it causes.

use crate::node::Node;
use crate::path::Curvature;
use crate::time_law::PathState;

/// Curvature at a place between two nodes, as a bound: its derivative is known only up to a range.
#[derive(Clone, Copy, Debug)]
pub(crate) struct CurveBound {
    /// Curvature, 1/m.
    value: f64,
    /// Two values between which the derivative of the curvature with respect to the arc length lies, 1/m².
    slopes: [f64; 2],
    /// Upper bound of the product of curvature and torsion, 1/m².
    twist: f64,
}

impl CurveBound {
    /// Returns the curvature at the share `share` (0 to 1) of the way from the node `one` to the node `other`.
    ///
    /// The curvature of a spline has a kink at each of its points (`has_kinks`), which may lie between the nodes: then
    /// the tangents at both nodes bound a curvature that rises less and less, its chord bounds the other ones, and the
    /// derivative may be that of either node. Elsewhere it is interpolated linearly, except between slopes of different
    /// signs, as where a curve begins.
    pub(crate) fn between(one: &Node, other: &Node, share: f64, has_kinks: bool) -> Self {
        let mix = |low: f64, high: f64| low + share * (high - low);
        let (low, high) = (one.curvature, other.curvature);
        let chord = mix(low.value, high.value);
        let slope = mix(low.slope, high.slope);
        let largest = libm::fabs(low.slope).max(libm::fabs(high.slope));
        let twist = low.twist.max(high.twist);
        match (has_kinks, low.slope * high.slope > 0.0) {
            (true, _) => {
                let width = other.s - one.s;
                let from_low = low.value + low.slope * share * width;
                let from_high = high.value - high.slope * (1.0 - share) * width;
                Self {
                    value: chord.max(from_low.min(from_high)),
                    slopes: [low.slope, high.slope],
                    twist,
                }
            }
            (false, true) => Self {
                value: chord,
                slopes: [slope; 2],
                twist,
            },
            (false, false) => Self {
                value: chord,
                slopes: [-largest, largest],
                twist,
            },
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
        let along = libm::hypot(jerk - k * k * cube, self.twist * cube);
        let bending = 3.0 * k * v * a;
        let across = |slope: f64| libm::fabs(bending + slope * cube);
        let [one, other] = self.slopes;
        (
            libm::hypot(a, k * v * v),
            libm::hypot(along, across(one).max(across(other))),
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
        let (one, other) = (node(1.0, 4.0, 300.0), node(1.002, 4.1, -200.0));
        // The lines from both nodes meet here, which is the true maximum of the curvature.
        let kink = (4.1 - 4.0 + 200.0 * 0.002) / 500.0;
        let top = CurveBound::between(&one, &other, kink / 0.002, true);
        assert!((top.value - (4.0 + 300.0 * kink)).abs() < 1e-12, "{top:?}");
        assert_eq!(top.slopes, [300.0, -200.0]);
        let chord = CurveBound::between(&other, &one, 0.5, true);
        assert!(chord.value >= 4.05, "{chord:?}");
    }

    #[test]
    fn either_slope_counts_across_the_path() {
        let bound = CurveBound::between(&node(0.0, 2.0, -5.0), &node(1e-3, 2.0, 9.0), 0.5, true);
        let state = PathState {
            s: 0.0,
            velocity: 1.0,
            acceleration: -1.0,
        };
        // 3 k v a = -6 and k' v³ between -5 and 9: the largest magnitude is 11.
        let (acceleration, jerk) = bound.tool_motion(&state, 4.0 * 1.0);
        assert!((jerk - 11.0).abs() < 0.1, "{jerk}");
        assert!((acceleration - libm::hypot(1.0, 2.0)).abs() < 0.1);
    }
}
