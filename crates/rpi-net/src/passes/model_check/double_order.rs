//! Order-preserving map from doubles to integers: adjacent doubles map to adjacent integers, and both zeros map to 0.

/// Returns the rank of a double in the order of all doubles: an integer that grows by 1 from one double to the next.
/// `value` must not be NaN.
pub(super) fn position(value: f64) -> i64 {
    let bits = value.to_bits().cast_signed();
    if bits < 0 { -(bits & i64::MAX) } else { bits }
}

/// Returns the double with this rank in the order of all doubles, in which neighbours differ by 1.
pub(super) fn double_at(place: i64) -> f64 {
    let size = f64::from_bits(place.unsigned_abs());
    if place < 0 { -size } else { size }
}

/// Returns the rank of positive infinity in the order of all doubles. The rank of negative infinity is its negation.
pub(super) fn max_position() -> i64 {
    position(f64::INFINITY)
}

/// Returns the greatest number from `low` to `high` for which `holds` is true, by binary search; `None` if it is false
/// for `low`. `holds` must be true up to some number and false beyond.
pub(super) fn last_where(low: i64, high: i64, holds: impl Fn(i64) -> bool) -> Option<i64> {
    if !holds(low) {
        return None;
    }
    let (mut low, mut high) = (i128::from(low), i128::from(high));
    while low < high {
        let middle = low + (high - low + 1) / 2;
        match i64::try_from(middle).is_ok_and(&holds) {
            true => low = middle,
            false => high = middle - 1,
        }
    }
    i64::try_from(low).ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_are_ordered_as_the_doubles_are() {
        let values = [
            f64::NEG_INFINITY,
            -1e300,
            -1.0,
            -5e-324,
            0.0,
            5e-324,
            1.0,
            f64::INFINITY,
        ];
        assert!(values.windows(2).all(|w| position(w[0]) < position(w[1])));
        assert_eq!(position(-0.0), position(0.0));
        assert!(values.iter().all(|v| double_at(position(*v)) == *v));
        assert_eq!(double_at(position(1.0) + 1), 1.0 + f64::EPSILON);
    }

    #[test]
    fn the_last_place_is_found_at_the_ends_and_between() {
        assert_eq!(last_where(i64::MIN, i64::MAX, |k| k <= 17), Some(17));
        assert_eq!(last_where(-3, 3, |_| true), Some(3));
        assert_eq!(last_where(-3, 3, |_| false), None);
    }
}
