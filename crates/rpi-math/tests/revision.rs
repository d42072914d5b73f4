//! The results are those of the stated version: a change of any bit needs a new version.

mod random;

use random::random_bits;

/// Version of the results, and the digest of their bits.
const DIGEST: (u32, u64) = (1, 0x08ff_c3f3_7d93_cd3b);

/// Number of random pairs of arguments.
const COUNT: usize = 20_000;

#[test]
fn the_bits_of_results_change_with_the_version_only() {
    let mut bits = random_bits();
    let mut real = move || {
        let (kind, bits) = (bits() % 3, bits());
        let unit = (bits >> 11) as f64 / (1_u64 << 53) as f64;
        match kind {
            0 => f64::from_bits(bits),
            1 => 2.0 * unit - 1.0,
            _ => 200.0 * unit - 100.0,
        }
    };
    let mut digest = 0xcbf2_9ce4_8422_2325_u64;
    for _ in 0..COUNT {
        for value in results(real(), real()) {
            digest = (digest ^ value.to_bits()).wrapping_mul(0x0100_0000_01b3);
        }
    }
    assert_eq!(
        (rpi_math::REVISION, format!("{digest:016x}")),
        (DIGEST.0, format!("{:016x}", DIGEST.1)),
        "other bits: increase REVISION of rpi-math and write the digest here"
    );
}

fn results(x: f64, y: f64) -> [f64; 14] {
    [
        rpi_math::sin(x),
        rpi_math::cos(x),
        rpi_math::tan(x),
        rpi_math::asin(x),
        rpi_math::acos(x),
        rpi_math::atan(x),
        rpi_math::exp(x),
        rpi_math::expm1(x),
        rpi_math::tanh(x),
        rpi_math::log(x),
        rpi_math::cbrt(x),
        rpi_math::atan2(x, y),
        rpi_math::hypot(x, y),
        rpi_math::pow(x, y),
    ]
}
