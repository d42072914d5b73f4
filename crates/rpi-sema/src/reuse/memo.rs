//! Results by version, of which those are kept that recent checks have used.

use crate::hash::FastMap;

/// Number of checks after which a result is dropped that none of them has used.
const MAX_AGE: u32 = 8;

/// Results of earlier checks, by a number that stands for everything that they depend on.
#[derive(Debug)]
pub struct Memo<T> {
    known: FastMap<u64, (T, u32)>,
    round: u32,
}

impl<T> Default for Memo<T> {
    fn default() -> Memo<T> {
        Memo {
            known: FastMap::default(),
            round: 0,
        }
    }
}

impl<T: Clone> Memo<T> {
    /// Returns the known result for a version, or computes it. The version 0 has no known result.
    pub fn get_or_compute(&mut self, version: u64, compute: impl FnOnce() -> T) -> T {
        if version == 0 {
            return compute();
        }
        let round = self.round;
        let (found, last_use) = self
            .known
            .entry(version)
            .or_insert_with(|| (compute(), round));
        *last_use = round;
        found.clone()
    }

    /// Ends a check, and drops the results that were not used for some checks.
    pub fn end_round(&mut self) {
        self.round = self.round.wrapping_add(1);
        let round = self.round;
        self.known
            .retain(|_, (_, last_use)| round.wrapping_sub(*last_use) <= MAX_AGE);
    }

    /// Number of known results.
    #[must_use]
    pub fn len(&self) -> usize {
        self.known.len()
    }

    /// Whether no result is known.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.known.is_empty()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn results_are_computed_once_and_dropped_when_unused() {
        let mut memo = Memo::default();
        assert_eq!(memo.get_or_compute(1, || 'a'), 'a');
        assert_eq!(memo.get_or_compute(1, || 'b'), 'a');
        assert_eq!(memo.get_or_compute(0, || 'c'), 'c');
        assert_eq!(memo.get_or_compute(0, || 'd'), 'd');
        for _ in 0..MAX_AGE {
            memo.end_round();
        }
        assert_eq!(memo.get_or_compute(1, || 'e'), 'a');
        for _ in 0..=MAX_AGE {
            memo.end_round();
        }
        assert!(memo.is_empty());
        assert_eq!(memo.get_or_compute(1, || 'e'), 'e');
    }
}
