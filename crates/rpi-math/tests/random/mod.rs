//! Random bits that are the same in every run.

/// Returns a generator of random bits (G. Marsaglia, Xorshift RNGs, 2003).
pub(crate) fn random_bits() -> impl FnMut() -> u64 {
    let mut state = 88_172_645_463_325_252_u64;
    move || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        state
    }
}
