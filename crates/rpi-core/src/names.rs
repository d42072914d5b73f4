//! A fixed-size set of commands with fast membership tests, to skip rules that do not mention a command.

use crate::id::CommandId;

/// A set of commands by slot, like a Bloom filter with one hash: slots that are equal modulo 256 coincide. It may
/// report too many members, but never too few.
#[derive(Clone, Copy, PartialEq, Eq, Default, Debug)]
pub(crate) struct Names([u64; Names::WORDS]);

impl Names {
    const WORDS: usize = 4;

    pub(crate) fn add(&mut self, command: CommandId) {
        let place = command.place() % (Self::WORDS * 64);
        self.0[place / 64] |= 1 << (place % 64);
    }

    /// True if the sets may have a common member; false only if they are disjoint.
    pub(crate) fn meets(&self, other: &Names) -> bool {
        self.0.iter().zip(other.0).any(|(a, b)| a & b != 0)
    }

    /// Union of two sets.
    pub(crate) fn with(&self, other: &Names) -> Names {
        Names(core::array::from_fn(|k| self.0[k] | other.0[k]))
    }

    pub(crate) fn is_empty(&self) -> bool {
        *self == Names::default()
    }
}

impl FromIterator<CommandId> for Names {
    fn from_iter<I: IntoIterator<Item = CommandId>>(commands: I) -> Names {
        let mut names = Names::default();
        commands.into_iter().for_each(|command| names.add(command));
        names
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(places: &[u64]) -> Names {
        places.iter().map(|p| CommandId::from_number(*p)).collect()
    }

    #[test]
    fn sets_meet_in_what_is_in_both() {
        assert!(Names::default().is_empty() && !at(&[0]).is_empty());
        assert!(at(&[1, 70, 255]).meets(&at(&[2, 70])));
        assert!(!at(&[1, 70, 255]).meets(&at(&[2, 71, 254])));
        assert!(at(&[3]).meets(&at(&[256 + 3])), "more, never less");
    }
}
