//! The table of commands: a slot for each command, with its schedule and the resources that it holds.

use crate::command::Command;
use crate::condition::{Fact, Truth};
use crate::error::CommandError;
use crate::ids::CommandId;
use crate::lifecycle::{CommandEvent, Transition};

use alloc::boxed::Box;
use alloc::vec::Vec;

/// An occupied table slot: the command, its schedule and its role in the current decision.
pub(crate) struct Entry {
    pub(crate) serial: u32,
    pub(crate) command: Box<Command>,
    /// Number of ticks from one cycle of the command to the next.
    pub(crate) period_ticks: u64,
    /// Tick in which the next cycle of the command runs.
    pub(crate) due: u64,
    /// Logical time of the first cycle, nanoseconds since the Unix epoch.
    pub(crate) start_ns: i64,
    /// If nothing can start the command any more, it becomes ready again instead of being removed.
    pub(crate) keep_if_orphaned: bool,
    /// The command was removed from the schedule and waits to be freed outside the cycle.
    pub(crate) orphaned: bool,
    /// The command ends in the current decision and may still hold resources.
    pub(crate) ending: bool,
    /// The command was started in the current decision.
    pub(crate) just_started: bool,
    /// The command runs, or a rule that has not fired may still start it.
    pub(crate) live: bool,
}

impl Entry {
    /// Id of the command in this slot; `place` is the index of the slot.
    pub(crate) fn id(&self, place: usize) -> CommandId {
        command_id(place, self.serial)
    }

    /// True if the command has not ended and may still run.
    pub(crate) fn is_live(&self) -> bool {
        self.live && self.command.ending.is_none() && !self.orphaned
    }
}

/// Id made of a slot index and a serial number.
fn command_id(place: usize, serial: u32) -> CommandId {
    // The table has fewer than 2^32 slots.
    let place = place as u32;
    CommandId {
        slot: place,
        serial,
    }
}

/// The commands of a core, each in a slot. The table has a fixed size and does not allocate after its creation.
pub(crate) struct CommandTable {
    /// Slots up to the last occupied one; unused slots after it cost no time in a tick.
    pub(crate) entries: Vec<Option<Entry>>,
    capacity: usize,
    /// Serial number of the latest id that the table chose.
    serial: u32,
}

impl CommandTable {
    pub(crate) fn with_capacity(capacity: usize) -> Self {
        CommandTable {
            entries: Vec::with_capacity(capacity),
            capacity,
            serial: 0,
        }
    }

    /// A new id for the first free slot.
    pub(crate) fn new_id(&mut self) -> CommandId {
        let free = self.entries.iter().position(Option::is_none);
        let place = free.unwrap_or(self.entries.len());
        self.serial = self.serial.wrapping_add(1);
        command_id(place, self.serial)
    }

    /// Inserts a command with a period of `period_ticks` ticks into the slot of `id`.
    ///
    /// # Errors
    ///
    /// Returns the command and the reason if the slot is occupied or beyond the capacity.
    pub(crate) fn insert(
        &mut self,
        id: CommandId,
        command: Box<Command>,
        period_ticks: u64,
    ) -> Result<(), (Box<Command>, CommandError)> {
        match self.slot_mut(id.slot as usize) {
            Some(slot) if slot.is_none() => {
                *slot = Some(Entry {
                    serial: id.serial,
                    command,
                    period_ticks,
                    due: 0,
                    start_ns: 0,
                    keep_if_orphaned: false,
                    orphaned: false,
                    ending: false,
                    just_started: false,
                    live: true,
                });
                Ok(())
            }
            _ => Err((command, CommandError::TableFull)),
        }
    }

    /// The table slot with this index; `None` beyond the capacity.
    fn slot_mut(&mut self, place: usize) -> Option<&mut Option<Entry>> {
        if place >= self.capacity {
            return None;
        }
        while self.entries.len() <= place {
            self.entries.push(None);
        }
        self.entries.get_mut(place)
    }

    /// Moves the command in this slot out of the table.
    pub(crate) fn take_out(&mut self, place: usize) -> Option<Entry> {
        let entry = self.entries.get_mut(place)?.take();
        while let Some(None) = self.entries.last() {
            self.entries.pop();
        }
        entry
    }

    /// Moves an orphaned command out of the table.
    pub(crate) fn take_orphan(&mut self) -> Option<(CommandId, Box<Command>)> {
        let gone = |e: &Option<Entry>| e.as_ref().is_some_and(|e| e.orphaned);
        let place = self.entries.iter().position(gone)?;
        let id = self.id(place);
        self.take_out(place).map(|e| (id, e.command))
    }

    /// Number of slots up to the last occupied one.
    pub(crate) fn len(&self) -> usize {
        self.entries.len()
    }

    /// The entry in this slot; `None` if the slot is free.
    pub(crate) fn get(&self, place: usize) -> Option<&Entry> {
        self.entries.get(place)?.as_ref()
    }

    /// The entry in this slot, to change it; `None` if the slot is free.
    pub(crate) fn get_mut(&mut self, place: usize) -> Option<&mut Entry> {
        self.entries.get_mut(place)?.as_mut()
    }

    /// Id of the command in this slot.
    pub(crate) fn id(&self, place: usize) -> CommandId {
        command_id(place, self.get(place).map_or(0, |e| e.serial))
    }

    /// Slot index of a command; `None` if the id is unknown or stale.
    pub(crate) fn find(&self, id: CommandId) -> Option<usize> {
        let place = id.slot as usize;
        let entry = self.get(place)?;
        (entry.serial == id.serial && !entry.orphaned).then_some(place)
    }

    /// Slot index of a command.
    pub(crate) fn slot_of(&self, id: CommandId) -> Result<usize, CommandError> {
        self.find(id).ok_or(CommandError::Unknown)
    }

    /// The entry in this slot.
    pub(crate) fn entry(&self, place: usize) -> Result<&Entry, CommandError> {
        self.get(place).ok_or(CommandError::Unknown)
    }

    /// Checks that the lifecycle allows an event for the command in this slot.
    pub(crate) fn check_event(
        &self,
        place: usize,
        event: CommandEvent,
    ) -> Result<(), CommandError> {
        let state = self.entry(place)?.command.state;
        match state.next(event) {
            Transition::Rejected => Err(CommandError::InvalidState(state)),
            Transition::To(_) | Transition::Removed => Ok(()),
        }
    }

    /// Known truth value of a fact, and the values that it may still take. A scheduled command that is not marked as
    /// live counts as one that never runs.
    pub(crate) fn fact_truth(&self, id: CommandId, fact: Fact) -> Truth {
        match self.find(id).and_then(|place| self.get(place)) {
            Some(entry) => entry.fact_truth(fact),
            None => Truth::UNKNOWN_FOREVER,
        }
    }

    /// Slot indices of all commands that hold a resource: one running command, or several scheduled alternatives.
    pub(crate) fn holders(&self, resource: u32) -> impl Iterator<Item = usize> + '_ {
        let holds = move |(place, entry): (usize, &Option<Entry>)| {
            let holds = entry.as_ref().is_some_and(|e| e.command.holds(resource));
            holds.then_some(place)
        };
        self.entries.iter().enumerate().filter_map(holds)
    }

    /// Checks that no command holds a resource that the command in slot `place` needs. The error names a holder.
    pub(crate) fn check_resources_free(&self, place: usize) -> Result<(), CommandError> {
        let mut needs = self.entry(place)?.command.resources();
        needs.try_for_each(|resource| match self.holders(resource).next() {
            Some(by) => Err(self.resource_held_error(resource, by)),
            None => Ok(()),
        })
    }

    /// The error for a resource that the command in slot `by` holds or needs.
    pub(crate) fn resource_held_error(&self, resource: u32, by: usize) -> CommandError {
        CommandError::ResourceHeld {
            resource,
            by: self.id(by),
        }
    }

    /// Assigns all needed resources to a command and takes them from every other command.
    pub(crate) fn take_all(&mut self, place: usize) {
        let Some(entry) = self.get_mut(place) else {
            return;
        };
        // Moved out for the loop: the command itself then has no holds that `release_to` could release.
        let mut holds = core::mem::take(&mut entry.command.resource_uses);
        for other in self.entries.iter_mut().flatten() {
            other.command.release_to(&holds);
        }
        holds.iter_mut().for_each(|hold| hold.is_held = true);
        if let Some(entry) = self.get_mut(place) {
            entry.command.resource_uses = holds;
        }
    }
}
