//! Elementary functions with the same bits on every machine.
//!
//! The library of a platform differs from others in the last bit, and so does the library of a language from one version
//! to the next. The functions here use only `+`, `-`, `*`, `/`, the square root and integers. IEEE 754 defines the
//! results of these operations, so that the functions have the same bits in Rust and in C: [`C_SOURCES`] has the same
//! functions in the same order of operations.
//!
//! All functions follow the same plan. The argument is reduced to a small interval around a point of a table, where a
//! short polynomial is accurate. The parts of the result are then added as an unevaluated sum of two reals (T. J. Dekker,
//! A floating-point technique for extending the available precision, 1971), so that nearly all of the error is that of
//! the last rounding. The error is less than 0.7 units in the last place, and less than 0.9 for [`hypot`]; a subnormal
//! result is rounded once more. The tests check this against values of high precision. `tools/generate.py` computes the
//! polynomials and tables.
//!
//! Special values are those of Annex F of the C standard. A result that is not a number is always [`f64::NAN`] with the
//! bits `7ff8000000000000`, whatever the bits of the argument are.
#![no_std]

mod arctangent;
#[allow(clippy::approx_constant, reason = "high parts of exact values")]
#[rustfmt::skip]
mod circle_tables;
#[allow(clippy::approx_constant, reason = "high parts of exact values")]
#[rustfmt::skip]
mod constants;
mod exponential;
mod large_angle;
mod logarithm;
mod pair;
mod power;
#[allow(clippy::approx_constant, reason = "high parts of exact values")]
#[rustfmt::skip]
mod power_tables;
mod ratio;
mod real;
mod root;
mod sine;

pub use arctangent::{atan, atan2};
pub use exponential::{exp, expm1, tanh};
pub use logarithm::log;
pub use power::pow;
pub use ratio::{acos, asin};
pub use root::{cbrt, hypot};
pub use sine::{cos, sin, sincos, tan};

/// Version of the results of the functions. It is one more after each change of a bit of any result, because recordings of
/// runs contain it. Version 0 is the crate `libm`, which was used before.
pub const REVISION: u32 = 1;

/// The functions in C99 that is also C++17, as texts of definitions. Each definition follows a line `/*# name */` and
/// uses only definitions before it.
///
/// The functions are `rpi_sin`, `rpi_cos`, `rpi_sincos`, `rpi_tan`, `rpi_asin`, `rpi_acos`, `rpi_atan`, `rpi_atan2`,
/// `rpi_exp`, `rpi_expm1`, `rpi_tanh`, `rpi_log`, `rpi_pow`, `rpi_cbrt`, `rpi_hypot` and `rpi_sqrt`. The text needs
/// `stdbool.h`, `stdint.h` and `string.h`. It must be compiled without contraction of products and sums
/// (`-ffp-contract=off`) and without options that change the meaning of reals (`-ffast-math`).
pub const C_SOURCES: &[&str] = &[
    include_str!("c/real.c"),
    include_str!("c/constants.c"),
    include_str!("c/circle_tables.c"),
    include_str!("c/power_tables.c"),
    include_str!("c/pair.c"),
    include_str!("c/large_angle.c"),
    include_str!("c/sine.c"),
    include_str!("c/arctangent.c"),
    include_str!("c/ratio.c"),
    include_str!("c/exponential.c"),
    include_str!("c/logarithm.c"),
    include_str!("c/power.c"),
    include_str!("c/root.c"),
];
