//! The table of commands and the requests that are accepted between ticks.

use crate::command::{AbortReason, Cause, Command};
use crate::ids::{CommandId, RuleId};
use crate::lifecycle::{CommandEvent, CommandState, Transition};
use crate::notice::{Notice, NoticeLog, RuleOutcome};
use crate::rule::{PendingRule, Rule};
use crate::scheduling::freeze_facts;
use rpi_device::DeviceBank;

use alloc::boxed::Box;
use alloc::vec::Vec;

/// Reason for rejecting a request. A rejected request changes nothing.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum CommandError {
    /// Unknown command or rule.
    Unknown,
    /// The command's state does not allow the request.
    InvalidState(CommandState),
    /// A needed resource is held by another command, or needed by another command that the same rule starts.
    ResourceHeld {
        /// The resource.
        resource: u32,
        /// The command that holds or needs the resource.
        by: CommandId,
    },
    /// A rule would start a command after itself, or start it twice.
    SelfSuccessor,
    /// The rule's condition can never become true.
    NeverFires,
    /// The rule's condition is nested too deeply.
    ConditionTooDeep,
    /// The command's period is not a whole multiple of the tick.
    PeriodMismatch,
    /// The table is full, or the requested slot is occupied.
    TableFull,
}

/// An occupied table slot: the command, its schedule and its role in the current decision.
pub(crate) struct Entry {
    pub(crate) serial: u32,
    pub(crate) command: Box<Command>,
    /// Period of the command, in ticks.
    pub(crate) period_ticks: u64,
    /// Tick of the next cycle.
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
    /// The command runs, or a rule may still start it.
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

/// Capacity for rules per command slot.
const RULES_PER_COMMAND: usize = 4;
/// Capacity for notices per command slot. One tick produces fewer for commands with up to ten actuators.
const NOTICES_PER_COMMAND: usize = 16;

/// The control core: runs all commands, tick by tick.
///
/// The table has a fixed size. Only [`Core::with_capacity`] allocates, and nothing is freed here. Commands are loaded
/// elsewhere and moved in; ended commands are moved out and freed elsewhere.
pub struct Core {
    /// Slots up to the last occupied one; unused slots after it cost no time in a tick.
    pub(crate) entries: Vec<Option<Entry>>,
    capacity: usize,
    /// Pending rules in the order of their creation.
    pub(crate) rules: Vec<PendingRule>,
    /// Fired and dropped rules that wait to be freed outside the cycle.
    pub(crate) finished_rules: Vec<(RuleId, Box<Rule>)>,
    pub(crate) rule_capacity: usize,
    pub(crate) notices: NoticeLog,
    pub(crate) tick_ns: u64,
    pub(crate) tick: u64,
    /// A command has started or ended in the current decision.
    pub(crate) has_changed: bool,
    pub(crate) last_rule_id: u64,
    serial: u32,
}

impl Core {
    /// An empty core with capacity for `commands` commands; `tick_ns` is the tick in nanoseconds.
    #[must_use]
    pub fn with_capacity(commands: usize, tick_ns: u64) -> Self {
        let most_rules = commands.saturating_mul(RULES_PER_COMMAND);
        Core {
            entries: Vec::with_capacity(commands),
            capacity: commands,
            rules: Vec::with_capacity(most_rules),
            finished_rules: Vec::with_capacity(most_rules),
            rule_capacity: most_rules,
            notices: NoticeLog::with_capacity(commands.saturating_mul(NOTICES_PER_COMMAND)),
            tick_ns: tick_ns.max(1),
            tick: 0,
            has_changed: false,
            last_rule_id: 0,
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
    pub fn insert(
        &mut self,
        command: Box<Command>,
    ) -> Result<CommandId, (Box<Command>, CommandError)> {
        let free = self.entries.iter().position(Option::is_none);
        let place = free.unwrap_or(self.entries.len());
        self.serial = self.serial.wrapping_add(1);
        let id = command_id(place, self.serial);
        self.insert_with_id(id, command).map(|()| id)
    }

    /// Inserts a loaded command under an id from [`crate::IdAllocator`].
    ///
    /// # Errors
    /// Returns the command if the slot is occupied or the command's period is not a multiple of the tick.
    pub fn insert_with_id(
        &mut self,
        id: CommandId,
        command: Box<Command>,
    ) -> Result<(), (Box<Command>, CommandError)> {
        let period = command.instance.image().period_ns;
        if !period.is_multiple_of(self.tick_ns) || period == 0 {
            return Err((command, CommandError::PeriodMismatch));
        }
        let ticks = period / self.tick_ns;
        match self.slot_mut(id.slot as usize) {
            Some(slot) if slot.is_none() => {
                *slot = Some(Entry {
                    serial: id.serial,
                    command,
                    period_ticks: ticks,
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
    pub fn start(&mut self, id: CommandId, bank: &mut dyn DeviceBank) -> Result<(), CommandError> {
        let place = self.slot_of(id)?;
        self.check_event(place, CommandEvent::Start)?;
        self.check_resources_free(place)?;
        self.start_at(place, self.tick, CommandEvent::Start);
        self.conclude(bank);
        Ok(())
    }

    /// Unschedules a command: it becomes ready, releases its resources, and the rules that would start it are dropped.
    ///
    /// # Errors
    /// The command is not scheduled.
    pub fn unschedule(&mut self, id: CommandId) -> Result<(), CommandError> {
        let place = self.slot_of(id)?;
        self.check_event(place, CommandEvent::Orphaned { kept: true })?;
        self.orphan(place, true);
        self.propagate_changes();
        Ok(())
    }

    /// Cancels a command. It sees `cancel` from its next cycle on. Successors scheduled on its regular end are not
    /// started.
    ///
    /// # Errors
    /// The command is not running.
    pub fn cancel(&mut self, id: CommandId) -> Result<(), CommandError> {
        let place = self.slot_of(id)?;
        self.check_event(place, CommandEvent::Cancel)?;
        self.cancel_if_running(id);
        self.propagate_changes();
        Ok(())
    }

    /// Aborts a command between two cycles. Its devices stop within their own limits.
    ///
    /// # Errors
    /// The command is not running.
    pub fn abort(
        &mut self,
        id: CommandId,
        why: AbortReason,
        bank: &mut dyn DeviceBank,
    ) -> Result<(), CommandError> {
        let place = self.slot_of(id)?;
        self.check_event(place, CommandEvent::End)?;
        self.end_command_by(place, Cause::Aborted(why), -1);
        self.conclude(bank);
        Ok(())
    }

    /// Aborts every command and drops every rule. All moving devices stop within their own limits.
    pub fn emergency_stop(&mut self, bank: &mut dyn DeviceBank) {
        self.abort_all(AbortReason::EmergencyStop, bank);
    }

    /// Aborts every command for the reason `why` and drops every rule; see [`Core::emergency_stop`].
    pub fn abort_all(&mut self, why: AbortReason, bank: &mut dyn DeviceBank) {
        while let Some(last) = self.rules.len().checked_sub(1) {
            self.drop_rule(last, RuleOutcome::Dropped);
        }
        for place in 0..self.entries.len() {
            if self
                .entry(place)
                .is_ok_and(|e| e.command.state.is_running())
            {
                self.end_command_by(place, Cause::Aborted(why), -1);
            }
        }
        self.has_changed = true;
        self.conclude(bank);
    }

    /// Moves a command out of the table, to be freed outside the cycle. A scheduled command is unscheduled first. Rules
    /// keep the command's final facts.
    ///
    /// # Errors
    /// The command is running.
    pub fn remove(&mut self, id: CommandId) -> Result<Box<Command>, CommandError> {
        let place = self.slot_of(id)?;
        self.check_event(place, CommandEvent::Unload)?;
        if self.entry(place)?.command.state == CommandState::Scheduled {
            self.unschedule(id)?;
        }
        let entry = self.take_out(place).ok_or(CommandError::Unknown)?;
        freeze_facts(&mut self.rules, id, &entry);
        self.propagate_changes();
        Ok(entry.command)
    }

    /// Moves an orphaned command out of the table, to be freed outside the cycle. A command is orphaned if nothing can
    /// start it any more.
    pub fn take_orphan(&mut self) -> Option<(CommandId, Box<Command>)> {
        let gone = |e: &Option<Entry>| e.as_ref().is_some_and(|e| e.orphaned);
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
            let entry = entry.as_ref().filter(|e| !e.orphaned)?;
            Some((self.id(place), &*entry.command))
        })
    }

    /// The rules that may still fire, in the order of their creation.
    pub fn rules(&self) -> impl Iterator<Item = (RuleId, &Rule)> + '_ {
        self.rules.iter().map(|p| (p.id, &*p.rule))
    }

    pub(crate) fn id(&self, place: usize) -> CommandId {
        let entry = self.entries.get(place).and_then(|e| e.as_ref());
        command_id(place, entry.map_or(0, |e| e.serial))
    }

    /// Slot index of a command; `None` if the id is unknown or stale.
    pub(crate) fn find(&self, id: CommandId) -> Option<usize> {
        let place = id.slot as usize;
        let entry = self.entries.get(place)?.as_ref()?;
        (entry.serial == id.serial && !entry.orphaned).then_some(place)
    }

    fn slot_of(&self, id: CommandId) -> Result<usize, CommandError> {
        self.find(id).ok_or(CommandError::Unknown)
    }

    pub(crate) fn entry(&self, place: usize) -> Result<&Entry, CommandError> {
        self.entries
            .get(place)
            .and_then(|e| e.as_ref())
            .ok_or(CommandError::Unknown)
    }

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
}
