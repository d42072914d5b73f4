//! Ids of commands and rules.

use alloc::vec::Vec;

/// Id of a command: a slot of the table and a serial number. Ids are not reused.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub struct CommandId {
    pub(crate) slot: u32,
    pub(crate) serial: u32,
}

impl CommandId {
    /// Index of the command's slot, less than the capacity of the core.
    #[must_use]
    pub const fn slot(self) -> usize {
        self.slot as usize
    }

    /// The id as one number, for display and transmission: the serial number in the upper, the slot in the lower 32
    /// bits.
    #[must_use]
    pub const fn to_number(self) -> u64 {
        (self.serial as u64) << 32 | self.slot as u64
    }

    /// The id encoded by [`CommandId::to_number`].
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

/// Allocator of command slots, for the thread that loads commands. A command has its id before it reaches the cycle, so
/// later requests in the same queue can refer to it.
#[derive(Clone, Debug)]
pub struct IdAllocator {
    free: Vec<u32>,
    serial: u32,
    rules: u64,
}

impl IdAllocator {
    /// An allocator with all slots of a table for `commands` commands free.
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

    /// Frees the slot of a command that has left the cycle.
    pub fn release(&mut self, id: CommandId) {
        self.free.push(id.slot);
    }

    /// Reserves the next rule id. Ids are never used twice, so that a late reference cannot meet another rule.
    pub fn allocate_rule(&mut self) -> RuleId {
        self.rules += 1;
        RuleId(self.rules)
    }

    /// Number of free slots.
    #[must_use]
    pub fn free_slots(&self) -> usize {
        self.free.len()
    }
}
