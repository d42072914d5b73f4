//! A fixed-size set of commands with fast membership tests, to skip rules that do not mention a command.

use crate::ids::CommandId;

/// Set of commands by table slot, like a Bloom filter with one hash: slots that are equal modulo 256 coincide. A test
/// of membership may be wrongly true, but never wrongly false.
#[derive(Clone, Copy, PartialEq, Eq, Default, Debug)]
pub(crate) struct CommandSet([u64; CommandSet::WORDS]);

impl CommandSet {
    const WORDS: usize = 4;

    pub(crate) fn add(&mut self, command: CommandId) {
        let place = command.slot() % (Self::WORDS * 64);
        self.0[place / 64] |= 1 << (place % 64);
    }

    /// True if the sets may have a common member; false only if they are disjoint.
    pub(crate) fn intersects(&self, other: &CommandSet) -> bool {
        self.0.iter().zip(other.0).any(|(a, b)| a & b != 0)
    }

    /// Returns the commands that are in at least one of the two sets.
    pub(crate) fn union(&self, other: &CommandSet) -> CommandSet {
        CommandSet(core::array::from_fn(|k| self.0[k] | other.0[k]))
    }

    pub(crate) fn is_empty(&self) -> bool {
        *self == CommandSet::default()
    }
}

impl FromIterator<CommandId> for CommandSet {
    fn from_iter<I: IntoIterator<Item = CommandId>>(commands: I) -> CommandSet {
        let mut names = CommandSet::default();
        commands.into_iter().for_each(|command| names.add(command));
        names
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(places: &[u64]) -> CommandSet {
        places.iter().map(|p| CommandId::from_number(*p)).collect()
    }

    #[test]
    fn sets_meet_in_what_is_in_both() {
        assert!(CommandSet::default().is_empty() && !at(&[0]).is_empty());
        assert!(at(&[1, 70, 255]).intersects(&at(&[2, 70])));
        assert!(!at(&[1, 70, 255]).intersects(&at(&[2, 71, 254])));
        assert!(at(&[3]).intersects(&at(&[256 + 3])), "more, never less");
    }
}
