//! The table of commands and what can be asked of it between ticks.

use crate::command::{Cause, Command, Why};
use crate::id::{CommandId, RuleId};
use crate::lifecycle::{Event, Next, State};
use crate::notice::{Notice, Notices, Outcome};
use crate::rule::{Pending, Rule};
use crate::scheduling::freeze;
use rpi_device::DeviceBank;

use alloc::boxed::Box;
use alloc::vec::Vec;

/// Why a request was refused; nothing has changed then.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Refused {
    /// There is no such command, or no such rule.
    Unknown,
    /// The request does not fit the command's state.
    State(State),
    /// An actuator that it needs is held by another command, or needed by another one that is started together with it.
    Held {
        /// The actuator.
        resource: u32,
        /// Who holds it.
        by: CommandId,
    },
    /// A command would follow itself, or be started twice.
    Successor,
    /// The rule could never fire.
    Never,
    /// The rule's condition is nested too deeply.
    Condition,
    /// Its period is not a whole multiple of the tick.
    Period,
    /// The table is full, or the place is taken.
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
    /// Its owner wants it back if nothing can start it any more.
    pub(crate) kept: bool,
    /// It is no more, and waits to be freed off the cycle.
    pub(crate) gone: bool,
    /// It ends in this decision and has not let go of everything yet.
    pub(crate) leaving: bool,
    /// It was started in this decision.
    pub(crate) fresh: bool,
    /// It runs or may run yet.
    pub(crate) live: bool,
}

impl Entry {
    /// The name of what is at this place.
    pub(crate) fn id(&self, place: usize) -> CommandId {
        named(place, self.serial)
    }

    /// True if it has not ended and may still do something.
    pub(crate) fn is_live(&self) -> bool {
        self.live && self.command.ending.is_none() && !self.gone
    }
}

/// The name of the command that came to a place with a number of its own.
fn named(place: usize, serial: u32) -> CommandId {
    // The table has fewer than 2^32 places.
    let place = place as u32;
    CommandId { place, serial }
}

/// Rules for each command that there is room for.
const RULES: usize = 4;
/// Notices for each command that there is room for; more than one tick can bring where a command has up to ten actuators.
const NOTICES: usize = 16;

/// All commands of a control core, run tick by tick.
///
/// A table of fixed size: nothing but [`Core::with_capacity`] allocates, nothing frees. Commands are loaded elsewhere and
/// moved in, and moved out to be freed elsewhere.
pub struct Core {
    /// Up to the last place that is taken: what nobody uses costs nothing in a tick.
    pub(crate) entries: Vec<Option<Entry>>,
    places: usize,
    /// In the order in which they were made.
    pub(crate) rules: Vec<Pending>,
    /// Over, and waiting to be freed off the cycle.
    pub(crate) spent: Vec<(RuleId, Box<Rule>)>,
    pub(crate) most_rules: usize,
    pub(crate) notices: Notices,
    pub(crate) tick_ns: u64,
    pub(crate) tick: u64,
    /// Something has begun or ended in this decision.
    pub(crate) changed: bool,
    pub(crate) named: u64,
    serial: u32,
}

impl Core {
    /// An empty table for so many commands, ticking with this period in nanoseconds.
    #[must_use]
    pub fn with_capacity(commands: usize, tick_ns: u64) -> Self {
        let most_rules = commands.saturating_mul(RULES);
        Core {
            entries: Vec::with_capacity(commands),
            places: commands,
            rules: Vec::with_capacity(most_rules),
            spent: Vec::with_capacity(most_rules),
            most_rules,
            notices: Notices::with_capacity(commands.saturating_mul(NOTICES)),
            tick_ns: tick_ns.max(1),
            tick: 0,
            changed: false,
            named: 0,
            serial: 0,
        }
    }

    /// Number of the next tick.
    #[must_use]
    pub fn now(&self) -> u64 {
        self.tick
    }

    /// Takes a loaded command in and gives it a name.
    ///
    /// # Errors
    /// Gives it back if the table is full or its period does not fit the tick.
    pub fn insert(&mut self, command: Box<Command>) -> Result<CommandId, (Box<Command>, Refused)> {
        let free = self.entries.iter().position(Option::is_none);
        let place = free.unwrap_or(self.entries.len());
        self.serial = self.serial.wrapping_add(1);
        let id = named(place, self.serial);
        self.insert_as(id, command).map(|()| id)
    }

    /// Takes a loaded command in under a name that [`crate::Places`] gave.
    ///
    /// # Errors
    /// Gives it back if the place is taken or its period does not fit the tick.
    pub fn insert_as(
        &mut self,
        id: CommandId,
        command: Box<Command>,
    ) -> Result<(), (Box<Command>, Refused)> {
        let period = command.machine.image().period_ns;
        if !period.is_multiple_of(self.tick_ns) || period == 0 {
            return Err((command, Refused::Period));
        }
        let ticks = period / self.tick_ns;
        match self.slot(id.place as usize) {
            Some(slot) if slot.is_none() => {
                *slot = Some(Entry {
                    serial: id.serial,
                    command,
                    ticks,
                    due: 0,
                    start_ns: 0,
                    kept: false,
                    gone: false,
                    leaving: false,
                    fresh: false,
                    live: true,
                });
                Ok(())
            }
            _ => Err((command, Refused::Full)),
        }
    }

    /// A place of the table, if it has so many.
    fn slot(&mut self, place: usize) -> Option<&mut Option<Entry>> {
        if place >= self.places {
            return None;
        }
        while self.entries.len() <= place {
            self.entries.push(None);
        }
        self.entries.get_mut(place)
    }

    fn take_out(&mut self, place: usize) -> Option<Entry> {
        let entry = self.entries.get_mut(place)?.take();
        while let Some(None) = self.entries.last() {
            self.entries.pop();
        }
        entry
    }

    /// Starts a command: its first cycle is the next tick.
    ///
    /// # Errors
    /// If it is not ready, or an actuator that it needs is held.
    pub fn start(&mut self, id: CommandId, bank: &mut dyn DeviceBank) -> Result<(), Refused> {
        let place = self.place(id)?;
        self.fits(place, Event::Start)?;
        self.free_for(place)?;
        self.begin(place, self.tick, Event::Start);
        self.conclude(bank);
        Ok(())
    }

    /// Takes a scheduled command back; it is ready again and holds nothing. The rules that were to start it are dropped.
    ///
    /// # Errors
    /// If it is not scheduled.
    pub fn unschedule(&mut self, id: CommandId) -> Result<(), Refused> {
        let place = self.place(id)?;
        self.fits(place, Event::Orphan { kept: true })?;
        self.orphan(place, true);
        self.settle();
        Ok(())
    }

    /// Asks a command to end; it sees `cancel` from its next cycle on. What is scheduled on its regular end is not started.
    ///
    /// # Errors
    /// If it does not run.
    pub fn cancel(&mut self, id: CommandId) -> Result<(), Refused> {
        let place = self.place(id)?;
        self.fits(place, Event::Cancel)?;
        self.cancel_by(id);
        self.settle();
        Ok(())
    }

    /// Ends a command by force between two cycles; its devices stop on their own limits.
    ///
    /// # Errors
    /// If it does not run.
    pub fn abort(
        &mut self,
        id: CommandId,
        why: Why,
        bank: &mut dyn DeviceBank,
    ) -> Result<(), Refused> {
        let place = self.place(id)?;
        self.fits(place, Event::End)?;
        self.leave_by(place, Cause::Aborted(why), -1);
        self.conclude(bank);
        Ok(())
    }

    /// Ends every command by force and drops every rule; all devices that they moved stop on their own limits.
    pub fn emergency_stop(&mut self, bank: &mut dyn DeviceBank) {
        self.stop_all(Why::EmergencyStop, bank);
    }

    /// As [`Core::emergency_stop`], for another reason.
    pub fn stop_all(&mut self, why: Why, bank: &mut dyn DeviceBank) {
        while let Some(last) = self.rules.len().checked_sub(1) {
            self.drop_rule(last, Outcome::Dropped);
        }
        for place in 0..self.entries.len() {
            if self.entry(place).is_ok_and(|e| e.command.state.runs()) {
                self.leave_by(place, Cause::Aborted(why), -1);
            }
        }
        self.changed = true;
        self.conclude(bank);
    }

    /// Moves a command out, to be freed off the cycle. Who is scheduled is unscheduled first; what rules asked about it is
    /// settled as it stands.
    ///
    /// # Errors
    /// If it runs.
    pub fn remove(&mut self, id: CommandId) -> Result<Box<Command>, Refused> {
        let place = self.place(id)?;
        self.fits(place, Event::Unload)?;
        if self.entry(place)?.command.state == State::Scheduled {
            self.unschedule(id)?;
        }
        let entry = self.take_out(place).ok_or(Refused::Unknown)?;
        freeze(&mut self.rules, id, &entry);
        self.settle();
        Ok(entry.command)
    }

    /// Moves out a command that is no more because nothing could start it, to be freed off the cycle.
    pub fn take_gone(&mut self) -> Option<(CommandId, Box<Command>)> {
        let gone = |e: &Option<Entry>| e.as_ref().is_some_and(|e| e.gone);
        let place = self.entries.iter().position(gone)?;
        let id = self.id(place);
        self.take_out(place).map(|e| (id, e.command))
    }

    /// What has happened, in order; to be asked after each tick and request.
    pub fn next_notice(&mut self) -> Option<Notice> {
        self.notices.pop()
    }

    /// How many notices were lost because nobody asked for them.
    #[must_use]
    pub fn notices_lost(&self) -> u64 {
        self.notices.lost
    }

    /// A command, to look at.
    #[must_use]
    pub fn command(&self, id: CommandId) -> Option<&Command> {
        self.entries[self.find(id)?].as_ref().map(|e| &*e.command)
    }

    /// A command, to set its inputs between ticks.
    pub fn command_mut(&mut self, id: CommandId) -> Option<&mut Command> {
        let place = self.find(id)?;
        self.entries[place].as_mut().map(|e| &mut *e.command)
    }

    /// All commands in the table.
    pub fn commands(&self) -> impl Iterator<Item = (CommandId, &Command)> + '_ {
        let entries = self.entries.iter().enumerate();
        entries.filter_map(|(place, entry)| {
            let entry = entry.as_ref().filter(|e| !e.gone)?;
            Some((self.id(place), &*entry.command))
        })
    }

    /// The rules that may still fire, in the order in which they were made.
    pub fn rules(&self) -> impl Iterator<Item = (RuleId, &Rule)> + '_ {
        self.rules.iter().map(|p| (p.id, &*p.rule))
    }

    pub(crate) fn id(&self, place: usize) -> CommandId {
        let entry = self.entries.get(place).and_then(|e| e.as_ref());
        named(place, entry.map_or(0, |e| e.serial))
    }

    /// Where a command stands, if it is there.
    pub(crate) fn find(&self, id: CommandId) -> Option<usize> {
        let place = id.place as usize;
        let entry = self.entries.get(place)?.as_ref()?;
        (entry.serial == id.serial && !entry.gone).then_some(place)
    }

    fn place(&self, id: CommandId) -> Result<usize, Refused> {
        self.find(id).ok_or(Refused::Unknown)
    }

    pub(crate) fn entry(&self, place: usize) -> Result<&Entry, Refused> {
        self.entries
            .get(place)
            .and_then(|e| e.as_ref())
            .ok_or(Refused::Unknown)
    }

    pub(crate) fn fits(&self, place: usize, event: Event) -> Result<(), Refused> {
        let state = self.entry(place)?.command.state;
        match state.next(event) {
            Next::Refused => Err(Refused::State(state)),
            Next::To(_) | Next::Gone => Ok(()),
        }
    }
}
