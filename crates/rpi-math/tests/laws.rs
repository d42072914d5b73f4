//! Laws of the functions: symmetry, monotony, and agreement of functions with each other.

use proptest::prelude::*;

/// Any real, with all exponents.
fn real() -> impl Strategy<Value = f64> {
    any::<u64>().prop_map(f64::from_bits)
}

/// A real of everyday size.
fn usual() -> impl Strategy<Value = f64> {
    prop_oneof![-10.0..10.0, -1.0..1.0, -1000.0..1000.0]
}

fn either() -> impl Strategy<Value = f64> {
    prop_oneof![real(), usual()]
}

/// The same bits, where all that is not a number is the same.
fn same(a: f64, b: f64) -> bool {
    a.to_bits() == b.to_bits() || (a.is_nan() && b.is_nan())
}

/// The next greater real.
fn next(x: f64) -> f64 {
    x.next_up()
}

/// Errors of less than one unit in the last place leave the order of neighbours to chance where a function is flat, so that
/// the values may decrease by one place.
fn not_decreasing(function: fn(f64) -> f64, x: f64) -> bool {
    let (here, there) = (function(x), function(next(x)));
    here.is_nan() || there.is_nan() || there >= here.next_down()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(20_000))]

    #[test]
    fn odd_functions_are_odd(x in either()) {
        let functions: [fn(f64) -> f64; 6] = [
            rpi_math::sin, rpi_math::tan, rpi_math::asin, rpi_math::atan, rpi_math::tanh, rpi_math::cbrt,
        ];
        for function in functions {
            prop_assert!(same(function(-x), -function(x)));
        }
    }

    #[test]
    fn even_functions_are_even(x in either(), y in either()) {
        prop_assert!(same(rpi_math::cos(-x), rpi_math::cos(x)));
        prop_assert!(same(rpi_math::hypot(-x, y), rpi_math::hypot(x, y)));
        prop_assert!(same(rpi_math::hypot(x, y), rpi_math::hypot(y, x)));
        prop_assert!(same(rpi_math::atan2(-y, x), -rpi_math::atan2(y, x)));
    }

    #[test]
    fn monotonous_functions_do_not_decrease(x in either()) {
        let functions: [fn(f64) -> f64; 6] = [
            rpi_math::exp, rpi_math::log, rpi_math::atan, rpi_math::asin, rpi_math::tanh, rpi_math::cbrt,
        ];
        for function in functions {
            prop_assert!(not_decreasing(function, x), "at {x:e}");
        }
    }

    #[test]
    fn results_keep_their_range(x in either(), y in either()) {
        use std::f64::consts::{FRAC_PI_2, PI};
        let within = |value: f64, bound: f64| value.is_nan() || value.abs() <= bound;
        prop_assert!(within(rpi_math::sin(x), 1.0) && within(rpi_math::cos(x), 1.0) && within(rpi_math::tanh(x), 1.0));
        prop_assert!(within(rpi_math::asin(x), FRAC_PI_2) && within(rpi_math::atan(x), FRAC_PI_2));
        prop_assert!(within(rpi_math::acos(x), PI) && within(rpi_math::atan2(y, x), PI));
    }

    #[test]
    fn sine_and_cosine_together_have_the_same_bits(x in either()) {
        let (sin, cos) = rpi_math::sincos(x);
        prop_assert!(same(sin, rpi_math::sin(x)) && same(cos, rpi_math::cos(x)));
    }

    #[test]
    fn exact_powers_are_exact(base in 1_u32..2000, exponent in 0_u32..5) {
        let Some(exact) = base.checked_pow(exponent) else { return Ok(()) };
        let power = rpi_math::pow(f64::from(base), f64::from(exponent));
        prop_assert_eq!(power.to_bits(), f64::from(exact).to_bits());
    }

    #[test]
    fn exact_cube_roots_are_exact(root in -200_000_i64..200_000) {
        prop_assert_eq!(rpi_math::cbrt((root * root * root) as f64), root as f64);
    }

    #[test]
    fn the_exponential_function_reverses_the_logarithm(x in 1e-300..1e300) {
        let log = rpi_math::log(x);
        let error = (rpi_math::exp(log) / x - 1.0).abs();
        prop_assert!(error <= (log.abs() + 2.0) * f64::EPSILON, "{x:e}: {error:e}");
    }
}
