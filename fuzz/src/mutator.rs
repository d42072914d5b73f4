//! Reproducible mutations of inputs, a fuzzer for tests that must be short and repeatable.

use crate::Seed;
use crate::dictionary::dictionary_words;

/// Generator of mutated inputs for an entry point. Equal seeds give equal sequences of inputs.
#[derive(Clone, Debug)]
pub struct Mutator {
    state: u64,
    words: Vec<&'static str>,
}

/// Maximum length in bytes of a piece of an input that a mutation copies, replaces or removes.
const MAX_PIECE: usize = 64;
/// Maximum number of mutations that one input gets.
const MAX_MUTATIONS: usize = 4;

impl Mutator {
    /// Creates a generator whose inputs depend on `seed` and on the corpus only.
    #[must_use]
    pub fn new(seed: u64) -> Mutator {
        Mutator {
            state: seed,
            words: dictionary_words().collect(),
        }
    }

    /// Returns a random number from 0 to `end - 1`; `end` must not be 0. The generator is SplitMix64 (Steele, Lea,
    /// Flood 2014).
    fn below(&mut self, end: usize) -> usize {
        self.state = self.state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.state;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) % end.max(1) as u64) as usize
    }

    /// Returns one of the inputs `seeds` with one to four random mutations.
    pub fn next(&mut self, seeds: &[Seed]) -> Vec<u8> {
        let mut input = seeds[self.below(seeds.len())].bytes.clone();
        for _ in 0..=self.below(MAX_MUTATIONS) {
            self.mutate(&mut input, seeds);
        }
        input
    }

    fn word(&mut self) -> &'static str {
        let k = self.below(self.words.len());
        self.words[k]
    }

    fn mutate(&mut self, input: &mut Vec<u8>, seeds: &[Seed]) {
        let at = self.below(input.len() + 1);
        let end = (at + self.below(MAX_PIECE)).min(input.len());
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
                let to = (from + self.below(MAX_PIECE)).min(other.len());
                input.splice(at..end, other[from..to].iter().copied());
            }
        }
    }
}
