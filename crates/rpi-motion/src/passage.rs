//! Time at which a position that does not decrease reaches a place.

/// Number of times that the interval is halved: a motion of 1000 s is divided to less than 1 ns.
const STEPS: u32 = 42;

/// Returns the time between `early` and `late` (s) at which `position`, which does not decrease between them, reaches
/// `place`; `late` if it does not.
pub fn time_of_passage(
    position: impl Fn(f64) -> f64,
    (early, late): (f64, f64),
    place: f64,
) -> f64 {
    match position(early) >= place {
        true => early,
        false => bisect(position, (early, late), place, STEPS),
    }
}

/// Halves the interval from `early` to `late` (s) `steps` times, so that `position` reaches `place` within it. Returns its
/// end.
pub(crate) fn bisect(
    position: impl Fn(f64) -> f64,
    (mut early, mut late): (f64, f64),
    place: f64,
    steps: u32,
) -> f64 {
    for _ in 0..steps {
        let middle = f64::midpoint(early, late);
        match position(middle) < place {
            true => early = middle,
            false => late = middle,
        }
    }
    late
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_time_of_passage_is_that_of_the_inverse_function() {
        let square = |time: f64| time * time;
        for place in [0.01, 0.25, 3.9] {
            let time = time_of_passage(square, (0.0, 2.0), place);
            assert!((time - place.sqrt()).abs() < 1e-11, "{place}: {time}");
        }
        assert_eq!(time_of_passage(square, (1.0, 2.0), 0.5), 1.0);
        assert_eq!(time_of_passage(square, (0.0, 2.0), 5.0), 2.0);
    }
}
