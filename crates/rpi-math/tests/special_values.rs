//! Special values by Annex F of the C standard, and the bits of results that are not numbers.

use std::f64::consts::{FRAC_PI_2, FRAC_PI_3, FRAC_PI_4, PI};

const INFINITY: f64 = f64::INFINITY;
const NEG_INFINITY: f64 = f64::NEG_INFINITY;
const NAN: f64 = f64::NAN;
const MAX: f64 = f64::MAX;
const TINIEST: f64 = 5e-324;

/// Compares the bits, so that the sign of a 0 and the bits of what is not a number count.
fn expect(call: &str, value: f64, expected: f64) {
    let bits = if expected.is_nan() {
        0x7ff8_0000_0000_0000
    } else {
        expected.to_bits()
    };
    assert_eq!(
        value.to_bits(),
        bits,
        "{call}: {value:e} instead of {expected:e}"
    );
}

/// One row: a function, its argument or arguments, and the value.
macro_rules! table {
    ($($name:ident($($argument:expr),+) = $value:expr;)+) => {
        $(expect(
            concat!(stringify!($name), stringify!(($($argument),+))),
            rpi_math::$name($($argument),+),
            $value,
        );)+
    };
}

#[test]
fn zeros_infinities_and_bounds_have_the_values_of_the_standard() {
    table! {
        sin(0.0) = 0.0; sin(-0.0) = -0.0; sin(INFINITY) = NAN; sin(NEG_INFINITY) = NAN; sin(TINIEST) = TINIEST;
        cos(0.0) = 1.0; cos(-0.0) = 1.0; cos(INFINITY) = NAN; cos(TINIEST) = 1.0;
        tan(0.0) = 0.0; tan(-0.0) = -0.0; tan(INFINITY) = NAN; tan(-TINIEST) = -TINIEST;
        asin(0.0) = 0.0; asin(-0.0) = -0.0; asin(1.0) = FRAC_PI_2; asin(-1.0) = -FRAC_PI_2; asin(1.0 + f64::EPSILON) = NAN;
        asin(INFINITY) = NAN;
        acos(1.0) = 0.0; acos(-1.0) = PI; acos(0.0) = FRAC_PI_2; acos(-0.0) = FRAC_PI_2; acos(-1.1) = NAN; acos(0.5) = FRAC_PI_3;
        acos(NEG_INFINITY) = NAN;
        atan(0.0) = 0.0; atan(-0.0) = -0.0; atan(INFINITY) = FRAC_PI_2; atan(NEG_INFINITY) = -FRAC_PI_2;
        atan(1.0) = FRAC_PI_4; atan(MAX) = FRAC_PI_2; atan(-TINIEST) = -TINIEST;
        exp(0.0) = 1.0; exp(-0.0) = 1.0; exp(INFINITY) = INFINITY; exp(NEG_INFINITY) = 0.0; exp(1.0) = std::f64::consts::E;
        exp(709.782712893384) = 1.7976931348622732e308; exp(709.7827128933841) = INFINITY; exp(710.0) = INFINITY;
        exp(-745.1332191019411) = TINIEST; exp(-745.1332191019412) = 0.0; exp(-800.0) = 0.0;
        expm1(0.0) = 0.0; expm1(-0.0) = -0.0; expm1(INFINITY) = INFINITY; expm1(NEG_INFINITY) = -1.0; expm1(710.0) = INFINITY;
        expm1(-100.0) = -1.0; expm1(TINIEST) = TINIEST;
        tanh(0.0) = 0.0; tanh(-0.0) = -0.0; tanh(INFINITY) = 1.0; tanh(NEG_INFINITY) = -1.0; tanh(30.0) = 1.0;
        log(0.0) = NEG_INFINITY; log(-0.0) = NEG_INFINITY; log(1.0) = 0.0; log(-1.0) = NAN; log(INFINITY) = INFINITY;
        log(NEG_INFINITY) = NAN; log(TINIEST) = -744.4400719213812;
        cbrt(0.0) = 0.0; cbrt(-0.0) = -0.0; cbrt(INFINITY) = INFINITY; cbrt(NEG_INFINITY) = NEG_INFINITY; cbrt(-27.0) = -3.0;
    }
}

#[test]
fn functions_of_two_arguments_have_the_values_of_the_standard() {
    table! {
        atan2(0.0, 0.0) = 0.0; atan2(-0.0, 0.0) = -0.0; atan2(0.0, -0.0) = PI; atan2(-0.0, -0.0) = -PI;
        atan2(0.0, -1.0) = PI; atan2(-0.0, -1.0) = -PI; atan2(0.0, 1.0) = 0.0; atan2(-0.0, 1.0) = -0.0;
        atan2(-1.0, 0.0) = -FRAC_PI_2; atan2(1.0, -0.0) = FRAC_PI_2; atan2(1.0, NEG_INFINITY) = PI;
        atan2(-1.0, NEG_INFINITY) = -PI; atan2(1.0, INFINITY) = 0.0; atan2(-1.0, INFINITY) = -0.0;
        atan2(INFINITY, 1.0) = FRAC_PI_2; atan2(NEG_INFINITY, -1.0) = -FRAC_PI_2; atan2(INFINITY, INFINITY) = FRAC_PI_4;
        atan2(INFINITY, NEG_INFINITY) = 3.0 * FRAC_PI_4; atan2(NEG_INFINITY, INFINITY) = -FRAC_PI_4;
        atan2(MAX, INFINITY) = 0.0; atan2(INFINITY, MAX) = FRAC_PI_2; atan2(MAX, MAX) = FRAC_PI_4;
        atan2(TINIEST, TINIEST) = FRAC_PI_4; atan2(TINIEST, -MAX) = PI; atan2(TINIEST, MAX) = 0.0; atan2(MAX, -TINIEST) = FRAC_PI_2;
        hypot(INFINITY, NAN) = INFINITY; hypot(NAN, NEG_INFINITY) = INFINITY; hypot(0.0, -0.0) = 0.0; hypot(-3.0, 4.0) = 5.0;
        hypot(MAX, MAX) = INFINITY; hypot(TINIEST, 0.0) = TINIEST; hypot(3.0 * TINIEST, 4.0 * TINIEST) = 5.0 * TINIEST; hypot(NAN, 1.0) = NAN;
        pow(NAN, 0.0) = 1.0; pow(1.0, NAN) = 1.0; pow(2.0, NAN) = NAN; pow(NAN, 1.0) = NAN; pow(0.0, -0.0) = 1.0;
        pow(0.0, 3.0) = 0.0; pow(-0.0, 3.0) = -0.0; pow(-0.0, 2.0) = 0.0; pow(0.0, -3.0) = INFINITY;
        pow(-0.0, -3.0) = NEG_INFINITY; pow(-0.0, -2.0) = INFINITY; pow(-0.0, 0.5) = 0.0; pow(-0.0, NEG_INFINITY) = INFINITY;
        pow(-1.0, INFINITY) = 1.0; pow(-1.0, NEG_INFINITY) = 1.0; pow(0.5, INFINITY) = 0.0; pow(0.5, NEG_INFINITY) = INFINITY;
        pow(2.0, INFINITY) = INFINITY; pow(-2.0, NEG_INFINITY) = 0.0; pow(INFINITY, 0.5) = INFINITY; pow(INFINITY, -0.5) = 0.0;
        pow(NEG_INFINITY, 3.0) = NEG_INFINITY; pow(NEG_INFINITY, 2.0) = INFINITY; pow(NEG_INFINITY, -3.0) = -0.0;
        pow(NEG_INFINITY, -2.0) = 0.0; pow(NEG_INFINITY, 0.5) = INFINITY; pow(-8.0, 1.0 / 3.0) = NAN; pow(-2.0, 3.0) = -8.0;
        pow(-2.0, -1074.0) = TINIEST; pow(-2.0, -1075.0) = -0.0; pow(2.0, 1023.0) = 2.0_f64 * 4.49423283715579e307; pow(2.0, 1024.0) = INFINITY;
        pow(-2.0, 1025.0) = NEG_INFINITY; pow(10.0, 22.0) = 1e22; pow(TINIEST, 0.5) = 2.2227587494850775e-162;
        pow(-1.0, 9007199254740993.0) = 1.0; pow(-1.0, 4503599627370497.0) = -1.0; pow(9.0, 0.5) = 3.0;
    }
}

#[test]
fn what_is_not_a_number_has_one_bit_pattern() {
    for bits in [
        0x7ff8_0000_0000_0000_u64,
        0xfff8_0000_0000_0000,
        0x7ff0_0000_0000_0001,
        0xffff_ffff_ffff_ffff,
    ] {
        let x = f64::from_bits(bits);
        table! {
            sin(x) = NAN; cos(x) = NAN; tan(x) = NAN; asin(x) = NAN; acos(x) = NAN; atan(x) = NAN; exp(x) = NAN;
            expm1(x) = NAN; tanh(x) = NAN; log(x) = NAN; cbrt(x) = NAN; atan2(x, 1.0) = NAN; atan2(INFINITY, x) = NAN;
            hypot(0.0, x) = NAN; pow(x, 2.0) = NAN; pow(2.0, x) = NAN;
        }
        let (sin, cos) = rpi_math::sincos(x);
        expect("the sine of sincos", sin, NAN);
        expect("the cosine of sincos", cos, NAN);
    }
}
