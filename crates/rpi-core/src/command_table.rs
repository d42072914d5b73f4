//! The table of commands: a slot for each command, with its schedule and the resources that it holds.

use crate::command::Command;
use crate::condition::{Fact, Truth};
use crate::error::CommandError;
use crate::ids::CommandId;
use crate::lifecycle::{CommandEvent, Transition};

use alloc::boxed::Box;
use alloc::vec::Vec;

/// An occupied table slot: the command, its schedule and its role in the current decision.
#[derive(Clone)]
pub(crate) struct Entry {
    pub(crate) serial: u32,
    pub(crate) command: Box<Command>,
    /// Number of ticks from one cycle of the command to the next.
    pub(crate) period_ticks: u64,
    /// Tick in which the next cycle of the command runs.
    pub(crate) due: u64,
    /// Logical time of the first cycle, nanoseconds since the Unix epoch.
    pub(crate) start_ns: i64,
    /// True if the command becomes ready again, instead of being removed, once no rule can start it any more.
    pub(crate) keep_if_orphaned: bool,
    /// True if no rule could start the command any more and it waits to be freed outside the cycle.
    pub(crate) orphaned: bool,
    /// True if the command ends in the current decision; it may still hold resources.
    pub(crate) ending: bool,
    /// True if the command was started in the current decision.
    pub(crate) just_started: bool,
    /// True if the command runs, or if a rule that has not fired may still start it.
    pub(crate) live: bool,
}

impl Entry {
    /// Returns the id of the command in this slot; `place` is the index of the slot.
    pub(crate) fn id(&self, place: usize) -> CommandId {
        command_id(place, self.serial)
    }

    /// True if the command has not ended and may still run.
    pub(crate) fn is_live(&self) -> bool {
        self.live && self.command.ending.is_none() && !self.orphaned
    }
}

/// Returns the id made of the slot index `place` and a serial number.
fn command_id(place: usize, serial: u32) -> CommandId {
    // The table has fewer than 2^32 slots.
    let place = place as u32;
    CommandId {
        slot: place,
        serial,
    }
}

/// The commands of a core, each in a slot. The table has a fixed size and does not allocate after its creation.
#[derive(Clone)]
pub(crate) struct CommandTable {
    /// Slots up to the last occupied one, `None` for a free slot. The unused slots after it cost no time in a tick.
    pub(crate) entries: Vec<Option<Entry>>,
    capacity: usize,
    /// Serial number of the latest id that the table made.
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

    /// Returns a new id for the first free slot, with a serial number that no earlier id had.
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

    /// Returns the slot with index `place`, which may be free; `None` beyond the capacity.
    fn slot_mut(&mut self, place: usize) -> Option<&mut Option<Entry>> {
        if place >= self.capacity {
            return None;
        }
        while self.entries.len() <= place {
            self.entries.push(None);
        }
        self.entries.get_mut(place)
    }

    /// Removes and returns the entry of slot `place`; `None` if the slot is free.
    pub(crate) fn take_out(&mut self, place: usize) -> Option<Entry> {
        let entry = self.entries.get_mut(place)?.take();
        while let Some(None) = self.entries.last() {
            self.entries.pop();
        }
        entry
    }

    /// Removes and returns one orphaned command, which no rule can start any more; `None` if there is none.
    pub(crate) fn take_orphan(&mut self) -> Option<(CommandId, Box<Command>)> {
        let gone = |e: &Option<Entry>| e.as_ref().is_some_and(|e| e.orphaned);
        let place = self.entries.iter().position(gone)?;
        let id = self.id(place);
        self.take_out(place).map(|e| (id, e.command))
    }

    /// Returns the number of slots up to the last occupied one.
    pub(crate) fn len(&self) -> usize {
        self.entries.len()
    }

    /// Returns the entry in slot `place`; `None` if the slot is free.
    pub(crate) fn get(&self, place: usize) -> Option<&Entry> {
        self.entries.get(place)?.as_ref()
    }

    /// Returns the entry in slot `place` for changes; `None` if the slot is free.
    pub(crate) fn get_mut(&mut self, place: usize) -> Option<&mut Entry> {
        self.entries.get_mut(place)?.as_mut()
    }

    /// Returns the id of the command in slot `place`.
    pub(crate) fn id(&self, place: usize) -> CommandId {
        command_id(place, self.get(place).map_or(0, |e| e.serial))
    }

    /// Returns the slot index of a command; `None` if the command is not in the table any more or never was.
    pub(crate) fn find(&self, id: CommandId) -> Option<usize> {
        let place = id.slot as usize;
        let entry = self.get(place)?;
        (entry.serial == id.serial && !entry.orphaned).then_some(place)
    }

    /// Returns the slot index of a command. The error is [`CommandError::Unknown`] if the command is not in the table.
    pub(crate) fn slot_of(&self, id: CommandId) -> Result<usize, CommandError> {
        self.find(id).ok_or(CommandError::Unknown)
    }

    /// Returns the entry in slot `place`. The error is [`CommandError::Unknown`] if the slot is free.
    pub(crate) fn entry(&self, place: usize) -> Result<&Entry, CommandError> {
        self.get(place).ok_or(CommandError::Unknown)
    }

    /// Checks that the lifecycle allows `event` for the command in slot `place`. The error holds the present state.
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

    /// Returns the present truth value of a fact about a command and the values that the fact may still take. A
    /// scheduled command that no rule can start any more counts as one that never runs.
    pub(crate) fn fact_truth(&self, id: CommandId, fact: Fact) -> Truth {
        match self.find(id).and_then(|place| self.get(place)) {
            Some(entry) => entry.fact_truth(fact),
            None => Truth::UNKNOWN_FOREVER,
        }
    }

    /// Returns the slot indices of all commands that hold a resource: one running command, or several scheduled
    /// commands of which at most one will run.
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

    /// Makes the error for a resource that the command in slot `by` holds or needs.
    pub(crate) fn resource_held_error(&self, resource: u32, by: usize) -> CommandError {
        CommandError::ResourceHeld {
            resource,
            by: self.id(by),
        }
    }

    /// Assigns all needed resources to the command in slot `place` and takes them from every other command.
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
