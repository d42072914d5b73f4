//! Buffer for the entries of a tick, allocated before the first tick.

use super::entry::{EntryKind, encode_head};

/// Buffer for the tick log entries of the current tick. It is allocated before the first tick and never grows.
pub struct EntryBuffer {
    words: Vec<u64>,
    /// Whether an entry did not fit into the buffer. The tick is then not recorded.
    full: bool,
}

impl EntryBuffer {
    /// Creates a buffer for `words` 64-bit words. It never grows, because the cycle writes to it.
    #[must_use]
    pub fn with_capacity(words: usize) -> EntryBuffer {
        EntryBuffer {
            words: Vec::with_capacity(words),
            full: false,
        }
    }

    /// Appends an entry, whose words are given in parts. It never allocates: if the entry does not fit, the whole tick
    /// is not recorded.
    pub fn push(&mut self, kind: EntryKind, key: u32, flag: bool, parts: &[&[u64]]) {
        let len: usize = parts.iter().map(|part| part.len()).sum();
        if self.words.capacity() - self.words.len() <= len {
            self.full = true;
            return;
        }
        self.words.push(encode_head(kind, key, flag, len));
        parts
            .iter()
            .for_each(|part| self.words.extend_from_slice(part));
    }

    /// Returns the words of the entries of this tick; `None` if an entry did not fit.
    #[must_use]
    pub fn words(&self) -> Option<&[u64]> {
        (!self.full).then_some(&self.words)
    }

    /// Returns true if no entry was appended since the last call of [`EntryBuffer::clear`].
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.words.is_empty() && !self.full
    }

    /// Removes all entries, before the next tick.
    pub fn clear(&mut self) {
        self.words.clear();
        self.full = false;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_does_not_fit_is_not_torn_and_loses_the_tick() {
        let mut stage = EntryBuffer::with_capacity(4);
        stage.push(EntryKind::Stop, 1, false, &[]);
        stage.push(EntryKind::Write, 1, false, &[&[1, 2], &[3]]);
        assert_eq!(stage.words(), None);
        stage.clear();
        stage.push(EntryKind::Write, 1, false, &[&[1], &[2, 3]]);
        assert_eq!(stage.words().map(<[u64]>::len), Some(4));
    }
}
