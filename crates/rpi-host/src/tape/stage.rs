//! Where the entries of a tick are put together: fixed room, made before the first tick.

use super::entry::{Kind, head};

/// Entries of the tick under way.
pub(crate) struct Stage {
    words: Vec<u64>,
    /// Something did not fit: the tick cannot be recorded.
    full: bool,
}

impl Stage {
    /// Room for so many words.
    pub(crate) fn with_capacity(words: usize) -> Stage {
        Stage {
            words: Vec::with_capacity(words),
            full: false,
        }
    }

    /// Adds an entry whose words come in parts. It never allocates: what does not fit makes the tick one that is lost.
    pub(crate) fn put(&mut self, kind: Kind, key: u32, flag: bool, parts: &[&[u64]]) {
        let len: usize = parts.iter().map(|part| part.len()).sum();
        if self.words.capacity() - self.words.len() <= len {
            self.full = true;
            return;
        }
        self.words.push(head(kind, key, flag, len));
        parts
            .iter()
            .for_each(|part| self.words.extend_from_slice(part));
    }

    /// The words of this tick, unless some are missing.
    pub(crate) fn words(&self) -> Option<&[u64]> {
        (!self.full).then_some(&self.words)
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.words.is_empty() && !self.full
    }

    /// The next tick begins.
    pub(crate) fn clear(&mut self) {
        self.words.clear();
        self.full = false;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_does_not_fit_is_not_torn_and_loses_the_tick() {
        let mut stage = Stage::with_capacity(4);
        stage.put(Kind::Stop, 1, false, &[]);
        stage.put(Kind::Write, 1, false, &[&[1, 2], &[3]]);
        assert_eq!(stage.words(), None);
        stage.clear();
        stage.put(Kind::Write, 1, false, &[&[1], &[2, 3]]);
        assert_eq!(stage.words().map(<[u64]>::len), Some(4));
    }
}
