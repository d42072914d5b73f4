//! Root of a monotone function between two bounds.

/// Maximum number of steps of the search. A step that does not halve the previous one is replaced by halving the
/// interval.
const STEPS: u32 = 130;

/// Returns the root of a monotone function between two points (argument, value) with values of different signs; if the
/// signs are equal, the argument whose value is smaller in magnitude. `function` returns value and derivative. Newton's
/// method, with a bisection whenever a step leaves the interval or shrinks it too slowly (Press et al., Numerical
/// Recipes, 9.4).
pub(super) fn root(low: (f64, f64), high: (f64, f64), function: impl Fn(f64) -> (f64, f64)) -> f64 {
    let ((mut low, low_value), (mut high, high_value)) = (low, high);
    if (low_value < 0.0) == (high_value < 0.0) || low_value == 0.0 || high_value == 0.0 {
        return if low_value.abs() <= high_value.abs() {
            low
        } else {
            high
        };
    }
    let rising = low_value < 0.0;
    let mut at = low + (high - low) * (low_value / (low_value - high_value));
    let mut width = high - low;
    for _ in 0..STEPS {
        let (value, slope) = function(at);
        if value == 0.0 {
            return at;
        }
        if (value < 0.0) == rising {
            low = at;
        } else {
            high = at;
        }
        let step = value / slope;
        let next = at - step;
        if step.abs() <= f64::EPSILON * at.abs() {
            return at;
        }
        let is_slow = 2.0 * step.abs() > width;
        width = step.abs();
        // The comparison is false for NaN also.
        if next > low && next < high && !is_slow {
            at = next;
            continue;
        }
        let middle = low + (high - low) / 2.0;
        if middle <= low || middle >= high {
            return at;
        }
        width = high - low;
        at = middle;
    }
    at
}
