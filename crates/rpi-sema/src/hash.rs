//! Fast hash for names and small keys. Not resistant to collision attacks. No result may depend on its order.

use std::collections::{HashMap, HashSet};
use std::hash::{BuildHasherDefault, Hasher};

/// Hash map with a fast hash function. Where the order matters, it must not be iterated.
pub(crate) type FastMap<K, V> = HashMap<K, V, BuildHasherDefault<FastHasher>>;

/// Hash set with a fast hash function. Where the order matters, it must not be iterated.
pub(crate) type FastSet<K> = HashSet<K, BuildHasherDefault<FastHasher>>;

/// Hash function that multiplies and rotates, eight bytes of input at a time. It does not resist crafted keys.
#[derive(Default)]
pub(crate) struct FastHasher(u64);
// The integer nearest to 2^64 divided by the golden ratio, as in Fibonacci hashing (Knuth, TAOCP vol. 3).

const GOLDEN_RATIO: u64 = 0x9e37_79b9_7f4a_7c15;

impl FastHasher {
    fn mix(&mut self, word: u64) {
        self.0 = (self.0.rotate_left(5) ^ word).wrapping_mul(GOLDEN_RATIO);
    }
}

impl Hasher for FastHasher {
    fn write(&mut self, bytes: &[u8]) {
        let mut words = bytes.chunks_exact(8);
        for word in &mut words {
            let mut whole = [0; 8];
            whole.copy_from_slice(word);
            self.mix(u64::from_le_bytes(whole));
        }
        let rest = words.remainder();
        let tail = rest.iter().fold(0, |tail, &b| tail << 8 | u64::from(b));
        // The length distinguishes tails that differ only in leading zero bytes.
        self.mix(tail ^ (bytes.len() as u64) << 56);
    }

    fn write_u32(&mut self, word: u32) {
        self.mix(word.into());
    }

    fn write_u64(&mut self, word: u64) {
        self.mix(word);
    }

    fn write_usize(&mut self, word: usize) {
        self.mix(word as u64);
    }

    fn finish(&self) -> u64 {
        self.0 ^ self.0 >> 29
    }
}
