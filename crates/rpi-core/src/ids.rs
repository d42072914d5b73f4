//! Ids of commands and rules.

use alloc::vec::Vec;

/// Id of a command: its slot in the table of commands and a serial number. Ids are not reused.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub struct CommandId {
    pub(crate) slot: u32,
    pub(crate) serial: u32,
}

impl CommandId {
    /// Returns the index of the command's slot in the table of commands, less than the capacity of the core.
    #[must_use]
    pub const fn slot(self) -> usize {
        self.slot as usize
    }

    /// Returns the id as one number, for display and transmission: the serial number in the upper 32 bits, the slot in
    /// the lower 32 bits.
    #[must_use]
    pub const fn to_number(self) -> u64 {
        (self.serial as u64) << 32 | self.slot as u64
    }

    /// Returns the id from the number that [`CommandId::to_number`] made of it.
    #[must_use]
    pub const fn from_number(number: u64) -> CommandId {
        CommandId {
            slot: number as u32,
            serial: (number >> 32) as u32,
        }
    }
}

/// Id of a rule. Ids are not reused.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub struct RuleId(pub u64);

/// Allocator of ids for commands and rules, for the thread that loads commands. A command gets its id before it is sent
/// to the control cycle, so that later requests in the same queue can refer to it.
#[derive(Clone, Debug)]
pub struct IdAllocator {
    free: Vec<u32>,
    serial: u32,
    rules: u64,
}

impl IdAllocator {
    /// Creates an allocator for a table with `commands` slots, all of them free.
    #[must_use]
    pub fn new(commands: usize) -> Self {
        let commands = u32::try_from(commands).unwrap_or(u32::MAX);
        IdAllocator {
            free: (0..commands).rev().collect(),
            serial: 0,
            rules: 0,
        }
    }

    /// Allocates an id for a new command; `None` if all slots are occupied.
    pub fn allocate(&mut self) -> Option<CommandId> {
        let place = self.free.pop()?;
        self.serial = self.serial.wrapping_add(1);
        Some(CommandId {
            slot: place,
            serial: self.serial,
        })
    }

    /// Frees the slot of a command that has left the core, for the id of another command.
    pub fn release(&mut self, id: CommandId) {
        self.free.push(id.slot);
    }

    /// Returns a new rule id. Ids are never used twice, so that a late reference to a removed rule cannot reach another
    /// rule.
    pub fn allocate_rule(&mut self) -> RuleId {
        self.rules += 1;
        RuleId(self.rules)
    }

    /// Returns the number of free slots for commands.
    #[must_use]
    pub fn free_slots(&self) -> usize {
        self.free.len()
    }
}
