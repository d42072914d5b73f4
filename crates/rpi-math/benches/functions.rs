//! Time per call of the functions, beside those of the crate `libm`.

#![allow(clippy::disallowed_methods, reason = "compares the functions of libm")]

use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};

/// Arguments that no branch predictor learns, in an interval.
fn arguments(low: f64, high: f64) -> Vec<f64> {
    let mut state = 1_u64;
    let mut next = || {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1);
        low + (high - low) * (state >> 11) as f64 / (1_u64 << 53) as f64
    };
    (0..1024).map(|_| next()).collect()
}

fn compare(
    criterion: &mut Criterion,
    name: &str,
    range: (f64, f64),
    functions: [fn(f64) -> f64; 2],
) {
    let values = arguments(range.0, range.1);
    let mut group = criterion.benchmark_group(name);
    for (owner, function) in ["rpi-math", "libm"].into_iter().zip(functions) {
        group.bench_function(owner, |bencher| {
            bencher.iter(|| values.iter().map(|x| function(black_box(*x))).sum::<f64>());
        });
    }
}

fn compare_two(
    criterion: &mut Criterion,
    name: &str,
    range: (f64, f64),
    functions: [fn(f64, f64) -> f64; 2],
) {
    let values = arguments(range.0, range.1);
    let mut group = criterion.benchmark_group(name);
    for (owner, function) in ["rpi-math", "libm"].into_iter().zip(functions) {
        group.bench_function(owner, |bencher| {
            let pairs = values.iter().zip(values.iter().rev());
            bencher.iter(|| {
                pairs
                    .clone()
                    .map(|(x, y)| function(black_box(*x), black_box(*y)))
                    .sum::<f64>()
            });
        });
    }
}

/// Uses both results.
fn sum((sin, cos): (f64, f64)) -> f64 {
    sin + cos
}

fn functions(criterion: &mut Criterion) {
    compare(criterion, "sin", (-4.0, 4.0), [rpi_math::sin, libm::sin]);
    compare(criterion, "cos", (-4.0, 4.0), [rpi_math::cos, libm::cos]);
    compare(
        criterion,
        "sincos",
        (-4.0, 4.0),
        [|x| sum(rpi_math::sincos(x)), |x| sum(libm::sincos(x))],
    );
    compare(
        criterion,
        "sin of large angles",
        (-1e9, 1e9),
        [rpi_math::sin, libm::sin],
    );
    compare(criterion, "tan", (-4.0, 4.0), [rpi_math::tan, libm::tan]);
    compare(criterion, "asin", (-1.0, 1.0), [rpi_math::asin, libm::asin]);
    compare(criterion, "acos", (-1.0, 1.0), [rpi_math::acos, libm::acos]);
    compare(criterion, "atan", (-4.0, 4.0), [rpi_math::atan, libm::atan]);
    compare(criterion, "exp", (-10.0, 10.0), [rpi_math::exp, libm::exp]);
    compare(
        criterion,
        "expm1",
        (-2.0, 2.0),
        [rpi_math::expm1, libm::expm1],
    );
    compare(criterion, "tanh", (-4.0, 4.0), [rpi_math::tanh, libm::tanh]);
    compare(criterion, "log", (0.0, 10.0), [rpi_math::log, libm::log]);
    compare(
        criterion,
        "cbrt",
        (-10.0, 10.0),
        [rpi_math::cbrt, libm::cbrt],
    );
    compare_two(
        criterion,
        "atan2",
        (-4.0, 4.0),
        [rpi_math::atan2, libm::atan2],
    );
    compare_two(
        criterion,
        "hypot",
        (-4.0, 4.0),
        [rpi_math::hypot, libm::hypot],
    );
    compare_two(criterion, "pow", (0.1, 10.0), [rpi_math::pow, libm::pow]);
}

criterion_group!(benches, functions);
criterion_main!(benches);
