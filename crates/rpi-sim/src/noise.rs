//! Seeded noise. The same seed gives the same bits on every machine.

use core::f64::consts::TAU;

/// Pseudo-random number generator: SplitMix64 (Steele, Lea, Flood 2014).
#[derive(Clone, Debug)]
pub(crate) struct Noise(u64);

impl Noise {
    /// Creates the generator for the device with index `device` of a cell with the seed `seed`.
    pub(crate) fn new(seed: u64, device: usize) -> Self {
        Self(seed ^ (device as u64).wrapping_mul(0xd1b5_4a32_d192_ed03))
    }

    fn next_bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut mixed = self.0;
        mixed = (mixed ^ (mixed >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        mixed ^ (mixed >> 31)
    }

    /// Returns a random number that is uniformly distributed in (0, 1].
    pub(crate) fn uniform(&mut self) -> f64 {
        ((self.next_bits() >> 11) + 1) as f64 / (1_u64 << 53) as f64
    }

    /// Returns a random number that is normally distributed with mean 0 and the standard deviation `deviation` (Box and
    /// Muller 1958). With the deviation 0, the result is 0 and the generator does not advance.
    pub(crate) fn normal(&mut self, deviation: f64) -> f64 {
        if deviation == 0.0 {
            return 0.0;
        }
        let radius = libm::sqrt(-2.0 * rpi_math::log(self.uniform()));
        deviation * radius * rpi_math::cos(TAU * self.uniform())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn noise_has_its_deviation_and_repeats() {
        let mut noise = Noise::new(7, 0);
        let all: Vec<f64> = (0..20_000).map(|_| noise.normal(0.5)).collect();
        let mean = all.iter().sum::<f64>() / all.len() as f64;
        let variance = all
            .iter()
            .map(|one| (one - mean) * (one - mean))
            .sum::<f64>()
            / all.len() as f64;
        assert!(
            mean.abs() < 0.02 && (variance - 0.25).abs() < 0.01,
            "{mean} {variance}"
        );
        let mut again = Noise::new(7, 0);
        assert!(all.iter().all(|one| *one == again.normal(0.5)));
        assert_ne!(Noise::new(7, 1).normal(1.0), Noise::new(7, 0).normal(1.0));
    }
}
