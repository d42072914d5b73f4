//! Names of commands and rules.

use alloc::vec::Vec;

/// A command in the table. It is not used again for another command.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub struct CommandId {
    pub(crate) place: u32,
    pub(crate) serial: u32,
}

impl CommandId {
    /// Its place in the table: less than the number of commands that the core has room for.
    #[must_use]
    pub const fn place(self) -> usize {
        self.place as usize
    }

    /// As one number, for those who show it or send it.
    #[must_use]
    pub const fn number(self) -> u64 {
        (self.serial as u64) << 32 | self.place as u64
    }

    /// The command of this number: see [`CommandId::number`].
    #[must_use]
    pub const fn from_number(number: u64) -> CommandId {
        CommandId {
            place: number as u32,
            serial: (number >> 32) as u32,
        }
    }
}

/// A rule. It is not used again for another rule.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub struct RuleId(pub u64);

/// Gives out the places of a table, for whoever loads commands beside the cycle: so a command has its name before it
/// arrives, and requests that name it can follow in the same queue.
#[derive(Clone, Debug)]
pub struct Places {
    free: Vec<u32>,
    serial: u32,
    rules: u64,
}

impl Places {
    /// All places of a table for so many commands.
    #[must_use]
    pub fn new(commands: usize) -> Self {
        let commands = u32::try_from(commands).unwrap_or(u32::MAX);
        Places {
            free: (0..commands).rev().collect(),
            serial: 0,
            rules: 0,
        }
    }

    /// A name for a new command; none if all places are taken.
    pub fn take(&mut self) -> Option<CommandId> {
        let place = self.free.pop()?;
        self.serial = self.serial.wrapping_add(1);
        Some(CommandId {
            place,
            serial: self.serial,
        })
    }

    /// The command has come back from the cycle: its place is free again.
    pub fn give_back(&mut self, id: CommandId) {
        self.free.push(id.place);
    }

    /// A name for a new rule.
    pub fn rule(&mut self) -> RuleId {
        self.rules += 1;
        RuleId(self.rules)
    }

    /// How many commands can still be taken in.
    #[must_use]
    pub fn left(&self) -> usize {
        self.free.len()
    }
}
