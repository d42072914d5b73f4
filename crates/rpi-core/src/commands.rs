//! The table of commands and what can be asked of it between ticks.

use crate::command::{Cause, Command};
use crate::lifecycle::{Event, Next, State};
use rpi_device::DeviceBank;

use alloc::boxed::Box;
use alloc::vec::Vec;

/// A command in the table. A number is not used again for another command.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub struct CommandId {
    place: u32,
    serial: u32,
}

/// Why a request was refused; nothing has changed then.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Refused {
    /// There is no such command.
    Unknown,
    /// The request does not fit the command's state.
    State(State),
    /// An actuator that it needs is held by another command.
    Held {
        /// The actuator.
        resource: u32,
        /// Who holds it.
        by: CommandId,
    },
    /// The predecessor has a successor already, or would follow itself.
    Successor,
    /// Its period is not a whole multiple of the tick.
    Period,
    /// The table is full.
    Full,
}

/// A command with its place in time and in the order of succession.
pub(crate) struct Entry {
    pub(crate) serial: u32,
    pub(crate) command: Box<Command>,
    /// Ticks per cycle.
    pub(crate) ticks: u64,
    /// The tick of its next cycle.
    pub(crate) due: u64,
    /// Logical time of its first cycle.
    pub(crate) start_ns: i64,
    /// Who is scheduled on it.
    pub(crate) successor: Option<usize>,
    /// On whom it is scheduled.
    pub(crate) predecessor: Option<usize>,
    /// Its owner wants it back if nothing can start it any more.
    pub(crate) kept: bool,
    /// It is no more, and waits to be freed off the cycle.
    pub(crate) gone: bool,
}

/// All commands of a control core, run tick by tick.
///
/// A table of fixed size: nothing but [`Core::with_capacity`] allocates, nothing frees. Commands are loaded elsewhere and
/// moved in, and moved out to be freed elsewhere.
pub struct Core {
    pub(crate) entries: Vec<Option<Entry>>,
    pub(crate) tick_ns: u64,
    pub(crate) tick: u64,
    serial: u32,
}

impl Core {
    /// An empty table for so many commands, ticking with this period in nanoseconds.
    #[must_use]
    pub fn with_capacity(commands: usize, tick_ns: u64) -> Self {
        let mut entries = Vec::new();
        entries.resize_with(commands, || None);
        Core {
            entries,
            tick_ns: tick_ns.max(1),
            tick: 0,
            serial: 0,
        }
    }

    /// Number of the next tick.
    #[must_use]
    pub fn now(&self) -> u64 {
        self.tick
    }

    /// Takes a loaded command in.
    ///
    /// # Errors
    /// Gives it back if the table is full or its period does not fit the tick.
    pub fn insert(&mut self, command: Box<Command>) -> Result<CommandId, (Box<Command>, Refused)> {
        let period = command.machine.image().period_ns;
        if !period.is_multiple_of(self.tick_ns) {
            return Err((command, Refused::Period));
        }
        let Some(place) = self.entries.iter().position(Option::is_none) else {
            return Err((command, Refused::Full));
        };
        self.serial = self.serial.wrapping_add(1);
        self.entries[place] = Some(Entry {
            serial: self.serial,
            command,
            ticks: period / self.tick_ns,
            due: 0,
            start_ns: 0,
            successor: None,
            predecessor: None,
            kept: false,
            gone: false,
        });
        Ok(self.id(place))
    }

    /// Starts a command: its first cycle is the next tick.
    ///
    /// # Errors
    /// If it is not ready, or an actuator that it needs is held.
    pub fn start(&mut self, id: CommandId, bank: &mut dyn DeviceBank) -> Result<(), Refused> {
        let place = self.place(id)?;
        self.fits(place, Event::Start)?;
        self.free_for(place, None)?;
        let tick = self.tick;
        self.begin(place, tick, Event::Start, bank);
        Ok(())
    }

    /// Lets a command follow another one: what it needs must be free or the predecessor's, and the free part is taken at
    /// once. `kept` says what becomes of it if the predecessor fails: ready again, or gone.
    ///
    /// # Errors
    /// If states, resources or the predecessor's successor do not allow it.
    pub fn schedule(&mut self, id: CommandId, after: CommandId, kept: bool) -> Result<(), Refused> {
        let (place, before) = (self.place(id)?, self.place(after)?);
        self.fits(place, Event::Schedule)?;
        let state = self.entry(before)?.command.state;
        if !matches!(state, State::Running | State::Scheduled) {
            return Err(Refused::State(state));
        }
        if self.entry(before)?.successor.is_some() || place == before {
            return Err(Refused::Successor);
        }
        self.free_for(place, Some(before))?;
        self.join(place, before, kept);
        Ok(())
    }

    /// Takes a scheduled command back; it is ready again and holds nothing.
    ///
    /// # Errors
    /// If it is not scheduled.
    pub fn unschedule(&mut self, id: CommandId) -> Result<(), Refused> {
        let place = self.place(id)?;
        self.fits(place, Event::Orphan { kept: true })?;
        self.orphan(place, true);
        Ok(())
    }

    /// Asks a command to end; it sees `cancel` from its next cycle on. Whoever was scheduled on it is not started.
    ///
    /// # Errors
    /// If it does not run.
    pub fn cancel(&mut self, id: CommandId) -> Result<(), Refused> {
        let place = self.place(id)?;
        self.fits(place, Event::Cancel)?;
        if let Some(entry) = self.entries[place].as_mut() {
            entry.command.happen(Event::Cancel);
        }
        self.orphan_successor(place);
        Ok(())
    }

    /// Ends a command by force between two cycles; its devices stop on their own limits.
    ///
    /// # Errors
    /// If it does not run.
    pub fn abort(&mut self, id: CommandId, bank: &mut dyn DeviceBank) -> Result<(), Refused> {
        let place = self.place(id)?;
        self.fits(place, Event::End)?;
        if let Some(entry) = self.entries[place].as_ref() {
            let ending = entry.command.ending_by(Cause::Aborted, -1);
            self.end(place, ending, bank);
        }
        Ok(())
    }

    /// Moves a command out, to be freed off the cycle. Who is scheduled is unscheduled first.
    ///
    /// # Errors
    /// If it runs.
    pub fn remove(&mut self, id: CommandId) -> Result<Box<Command>, Refused> {
        let place = self.place(id)?;
        self.fits(place, Event::Unload)?;
        self.orphan(place, true);
        self.orphan_successor(place);
        let entry = self.entries[place].take().ok_or(Refused::Unknown)?;
        Ok(entry.command)
    }

    /// Moves out a command that is no more because nothing could start it, to be freed off the cycle.
    pub fn take_gone(&mut self) -> Option<(CommandId, Box<Command>)> {
        let gone = |e: &Option<Entry>| e.as_ref().is_some_and(|e| e.gone);
        let place = self.entries.iter().position(gone)?;
        let id = self.id(place);
        self.entries[place].take().map(|e| (id, e.command))
    }

    /// A command, to look at.
    #[must_use]
    pub fn command(&self, id: CommandId) -> Option<&Command> {
        let place = self.place(id).ok()?;
        self.entries[place].as_ref().map(|e| &*e.command)
    }

    /// A command, to set its inputs between ticks.
    pub fn command_mut(&mut self, id: CommandId) -> Option<&mut Command> {
        let place = self.place(id).ok()?;
        self.entries[place].as_mut().map(|e| &mut *e.command)
    }

    pub(crate) fn id(&self, place: usize) -> CommandId {
        let serial = self
            .entries
            .get(place)
            .and_then(|e| e.as_ref())
            .map_or(0, |e| e.serial);
        CommandId {
            // The table has fewer than 2^32 places.
            place: place as u32,
            serial,
        }
    }

    fn place(&self, id: CommandId) -> Result<usize, Refused> {
        let place = id.place as usize;
        let entry = self.entries.get(place).and_then(|e| e.as_ref());
        entry
            .filter(|e| e.serial == id.serial && !e.gone)
            .map(|_| place)
            .ok_or(Refused::Unknown)
    }

    pub(crate) fn entry(&self, place: usize) -> Result<&Entry, Refused> {
        self.entries
            .get(place)
            .and_then(|e| e.as_ref())
            .ok_or(Refused::Unknown)
    }

    fn fits(&self, place: usize, event: Event) -> Result<(), Refused> {
        let state = self.entry(place)?.command.state;
        match state.next(event) {
            Next::Refused => Err(Refused::State(state)),
            Next::To(_) | Next::Gone => Ok(()),
        }
    }
}
