//! The table of commands and the requests that are accepted between ticks.

use crate::command::{Cause, Command, Why};
use crate::id::{CommandId, RuleId};
use crate::lifecycle::{Event, Next, State};
use crate::notice::{Notice, Notices, Outcome};
use crate::rule::{Pending, Rule};
use crate::scheduling::freeze;
use rpi_device::DeviceBank;

use alloc::boxed::Box;
use alloc::vec::Vec;

/// Reason for rejecting a request. A rejected request changes nothing.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Refused {
    /// Unknown command or rule.
    Unknown,
    /// The command's state does not allow the request.
    State(State),
    /// A needed resource is held by another command, or needed by another command that the same rule starts.
    Held {
        /// The resource.
        resource: u32,
        /// The command that holds or needs the resource.
        by: CommandId,
    },
    /// A rule would start a command after itself, or start it twice.
    Successor,
    /// The rule's condition can never become true.
    Never,
    /// The rule's condition is nested too deeply.
    Condition,
    /// The command's period is not a whole multiple of the tick.
    Period,
    /// The table is full, or the requested slot is occupied.
    Full,
}

/// An occupied table slot: the command, its schedule and its role in the current decision.
pub(crate) struct Entry {
    pub(crate) serial: u32,
    pub(crate) command: Box<Command>,
    /// Period of the command, in ticks.
    pub(crate) ticks: u64,
    /// Tick of the next cycle.
    pub(crate) due: u64,
    /// Logical time of the first cycle, nanoseconds since the Unix epoch.
    pub(crate) start_ns: i64,
    /// If nothing can start the command any more, it becomes ready again instead of being removed.
    pub(crate) kept: bool,
    /// The command was removed from the schedule and waits to be freed outside the cycle.
    pub(crate) gone: bool,
    /// The command ends in the current decision and may still hold resources.
    pub(crate) leaving: bool,
    /// The command was started in the current decision.
    pub(crate) fresh: bool,
    /// The command runs, or a rule may still start it.
    pub(crate) live: bool,
}

impl Entry {
    /// Id of the command in this slot; `place` is the index of the slot.
    pub(crate) fn id(&self, place: usize) -> CommandId {
        named(place, self.serial)
    }

    /// True if the command has not ended and may still run.
    pub(crate) fn is_live(&self) -> bool {
        self.live && self.command.ending.is_none() && !self.gone
    }
}

/// Id made of a slot index and a serial number.
fn named(place: usize, serial: u32) -> CommandId {
    // The table has fewer than 2^32 slots.
    let place = place as u32;
    CommandId { place, serial }
}

/// Capacity for rules per command slot.
const RULES: usize = 4;
/// Capacity for notices per command slot. One tick produces fewer for commands with up to ten actuators.
const NOTICES: usize = 16;

/// The control core: runs all commands, tick by tick.
///
/// The table has a fixed size. Only [`Core::with_capacity`] allocates, and nothing is freed here. Commands are loaded
/// elsewhere and moved in; ended commands are moved out and freed elsewhere.
pub struct Core {
    /// Slots up to the last occupied one; unused slots after it cost no time in a tick.
    pub(crate) entries: Vec<Option<Entry>>,
    places: usize,
    /// Pending rules in the order of their creation.
    pub(crate) rules: Vec<Pending>,
    /// Fired and dropped rules that wait to be freed outside the cycle.
    pub(crate) spent: Vec<(RuleId, Box<Rule>)>,
    pub(crate) most_rules: usize,
    pub(crate) notices: Notices,
    pub(crate) tick_ns: u64,
    pub(crate) tick: u64,
    /// A command has started or ended in the current decision.
    pub(crate) changed: bool,
    pub(crate) named: u64,
    serial: u32,
}

impl Core {
    /// An empty core with capacity for `commands` commands; `tick_ns` is the tick in nanoseconds.
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

    /// Inserts a loaded command and returns its new id.
    ///
    /// # Errors
    /// Returns the command if the table is full or the command's period is not a multiple of the tick.
    pub fn insert(&mut self, command: Box<Command>) -> Result<CommandId, (Box<Command>, Refused)> {
        let free = self.entries.iter().position(Option::is_none);
        let place = free.unwrap_or(self.entries.len());
        self.serial = self.serial.wrapping_add(1);
        let id = named(place, self.serial);
        self.insert_as(id, command).map(|()| id)
    }

    /// Inserts a loaded command under an id from [`crate::Places`].
    ///
    /// # Errors
    /// Returns the command if the slot is occupied or the command's period is not a multiple of the tick.
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

    /// The table slot with this index; `None` beyond the capacity.
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

    /// Starts a command. Its first cycle runs in the next tick.
    ///
    /// # Errors
    /// The command is not ready, or another command holds a resource that it needs.
    pub fn start(&mut self, id: CommandId, bank: &mut dyn DeviceBank) -> Result<(), Refused> {
        let place = self.place(id)?;
        self.fits(place, Event::Start)?;
        self.free_for(place)?;
        self.begin(place, self.tick, Event::Start);
        self.conclude(bank);
        Ok(())
    }

    /// Unschedules a command: it becomes ready, releases its resources, and the rules that would start it are dropped.
    ///
    /// # Errors
    /// The command is not scheduled.
    pub fn unschedule(&mut self, id: CommandId) -> Result<(), Refused> {
        let place = self.place(id)?;
        self.fits(place, Event::Orphan { kept: true })?;
        self.orphan(place, true);
        self.settle();
        Ok(())
    }

    /// Cancels a command. It sees `cancel` from its next cycle on. Successors scheduled on its regular end are not
    /// started.
    ///
    /// # Errors
    /// The command is not running.
    pub fn cancel(&mut self, id: CommandId) -> Result<(), Refused> {
        let place = self.place(id)?;
        self.fits(place, Event::Cancel)?;
        self.cancel_by(id);
        self.settle();
        Ok(())
    }

    /// Aborts a command between two cycles. Its devices stop within their own limits.
    ///
    /// # Errors
    /// The command is not running.
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

    /// Aborts every command and drops every rule. All moving devices stop within their own limits.
    pub fn emergency_stop(&mut self, bank: &mut dyn DeviceBank) {
        self.stop_all(Why::EmergencyStop, bank);
    }

    /// Aborts every command for the reason `why` and drops every rule; see [`Core::emergency_stop`].
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

    /// Moves a command out of the table, to be freed outside the cycle. A scheduled command is unscheduled first. Rules
    /// keep the command's final facts.
    ///
    /// # Errors
    /// The command is running.
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

    /// Moves an orphaned command out of the table, to be freed outside the cycle. A command is orphaned if nothing can
    /// start it any more.
    pub fn take_gone(&mut self) -> Option<(CommandId, Box<Command>)> {
        let gone = |e: &Option<Entry>| e.as_ref().is_some_and(|e| e.gone);
        let place = self.entries.iter().position(gone)?;
        let id = self.id(place);
        self.take_out(place).map(|e| (id, e.command))
    }

    /// Returns the oldest notice. Drain the log after each tick and each request.
    pub fn next_notice(&mut self) -> Option<Notice> {
        self.notices.pop()
    }

    /// Number of notices lost because the log was full.
    #[must_use]
    pub fn notices_lost(&self) -> u64 {
        self.notices.lost
    }

    /// The command with this id.
    #[must_use]
    pub fn command(&self, id: CommandId) -> Option<&Command> {
        self.entries[self.find(id)?].as_ref().map(|e| &*e.command)
    }

    /// Mutable access to the command with this id, to set its inputs between ticks.
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

    /// The rules that may still fire, in the order of their creation.
    pub fn rules(&self) -> impl Iterator<Item = (RuleId, &Rule)> + '_ {
        self.rules.iter().map(|p| (p.id, &*p.rule))
    }

    pub(crate) fn id(&self, place: usize) -> CommandId {
        let entry = self.entries.get(place).and_then(|e| e.as_ref());
        named(place, entry.map_or(0, |e| e.serial))
    }

    /// Slot index of a command; `None` if the id is unknown or stale.
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
