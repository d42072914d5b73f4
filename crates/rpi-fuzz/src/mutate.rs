//! Small damage to inputs, the same for the same seed: a fuzzer for tests that must be short and repeatable.

use crate::Seed;
use crate::words::words;

/// Damages inputs.
#[derive(Clone, Debug)]
pub struct Mutator {
    state: u64,
    words: Vec<&'static str>,
}

/// The longest piece that is moved or removed at a time, in bytes.
const PIECE: usize = 64;
/// The most places that are damaged in one input.
const PLACES: usize = 4;

impl Mutator {
    /// All that follows depends on this number alone.
    #[must_use]
    pub fn new(seed: u64) -> Mutator {
        Mutator {
            state: seed,
            words: words().collect(),
        }
    }

    /// A number below `end`, which is not 0. SplitMix64 (Steele, Lea, Flood 2014).
    fn below(&mut self, end: usize) -> usize {
        self.state = self.state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.state;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) % end.max(1) as u64) as usize
    }

    /// One of the seeds with some damage.
    pub fn next(&mut self, seeds: &[Seed]) -> Vec<u8> {
        let mut input = seeds[self.below(seeds.len())].bytes.clone();
        for _ in 0..=self.below(PLACES) {
            self.damage(&mut input, seeds);
        }
        input
    }

    fn word(&mut self) -> &'static str {
        let k = self.below(self.words.len());
        self.words[k]
    }

    fn damage(&mut self, input: &mut Vec<u8>, seeds: &[Seed]) {
        let at = self.below(input.len() + 1);
        let end = (at + self.below(PIECE)).min(input.len());
        match self.below(6) {
            0 => drop(input.drain(at..end)),
            1 => {
                let piece = input[at..end].to_vec();
                let to = self.below(input.len() + 1);
                input.splice(to..to, piece);
            }
            2 => {
                let word = self.word();
                input.splice(at..at, word.bytes());
            }
            3 => {
                let word = self.word();
                input.splice(at..end, word.bytes());
            }
            4 if at < input.len() => input[at] ^= 1 << self.below(8),
            _ => {
                let other = &seeds[self.below(seeds.len())].bytes;
                let from = self.below(other.len() + 1);
                let to = (from + self.below(PIECE)).min(other.len());
                input.splice(at..end, other[from..to].iter().copied());
            }
        }
    }
}
