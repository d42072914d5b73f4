//! The control core and the requests that it accepts between ticks.

use crate::command::{AbortReason, Cause, Command};
use crate::cycle_context::MotionControls;
use crate::decision::Decision;
use crate::error::CommandError;
use crate::ids::{CommandId, RuleId};
use crate::lifecycle::{CommandEvent, CommandState};
use crate::notice::{Notice, RuleOutcome};
use crate::rule::Rule;
use crate::schedule::Schedule;
use rpi_device::DeviceBank;

use alloc::boxed::Box;

/// The control core: runs all commands, tick by tick.
///
/// The table has a fixed size. Only [`Core::with_capacity`] allocates, and nothing is freed here. Commands are loaded
/// elsewhere and moved in; ended commands are moved out and freed elsewhere.
///
/// A clone is a copy of the whole state between two ticks, from which a replay can go on. It allocates.
#[derive(Clone)]
pub struct Core {
    /// The commands, the rules, and the notices about both.
    pub(crate) schedule: Schedule,
    /// Duration of a tick in nanoseconds. A tick is the smallest time step; the period of each command is a multiple of
    /// it.
    tick_ns: u64,
    /// Number of the next tick, counted from the creation of the core.
    pub(crate) tick: u64,
    /// Speed override and pause that apply to the motions of all commands.
    pub(crate) controls: MotionControls,
}

impl Core {
    /// Creates an empty core with capacity for `commands` commands; `tick_ns` is the duration of a tick in nanoseconds.
    #[must_use]
    pub fn with_capacity(commands: usize, tick_ns: u64) -> Self {
        Core {
            schedule: Schedule::with_capacity(commands),
            tick_ns: tick_ns.max(1),
            tick: 0,
            controls: MotionControls::default(),
        }
    }

    /// Begins a decision between two ticks: it collects starts and ends of commands, which take effect together.
    fn decision<'a>(&'a mut self, bank: &'a mut dyn DeviceBank) -> Decision<'a> {
        Decision::new(&mut self.schedule, bank, self.tick)
    }

    /// Sets the speed override and the pause of the motions of all commands, from their next cycle on. An override
    /// outside of 0 to 1 is limited to this range.
    pub fn set_controls(&mut self, controls: MotionControls) {
        self.controls = controls.limited();
    }

    /// Returns the speed override and the pause of the motions of all commands.
    #[must_use]
    pub fn controls(&self) -> MotionControls {
        self.controls
    }

    /// Returns the number of the next tick, counted from the creation of the core.
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
        let id = self.schedule.commands.new_id();
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
        self.schedule.commands.insert(id, command, ticks)
    }

    /// Starts a command. Its first cycle runs in the next tick.
    ///
    /// # Errors
    /// The command is not ready, or another command holds a resource that it needs.
    pub fn start(&mut self, id: CommandId, bank: &mut dyn DeviceBank) -> Result<(), CommandError> {
        let commands = &self.schedule.commands;
        let place = commands.slot_of(id)?;
        commands.check_event(place, CommandEvent::Start)?;
        commands.check_resources_free(place)?;
        let due = self.tick;
        let mut decision = self.decision(bank);
        decision.start_at(place, due, CommandEvent::Start);
        decision.conclude();
        Ok(())
    }

    /// Unschedules a command: it becomes ready, releases its resources, and the rules that would start it are dropped.
    ///
    /// # Errors
    /// The command is not scheduled.
    pub fn unschedule(&mut self, id: CommandId) -> Result<(), CommandError> {
        let place = self.schedule.commands.slot_of(id)?;
        let orphaned = CommandEvent::Orphaned { kept: true };
        self.schedule.commands.check_event(place, orphaned)?;
        self.schedule.orphan(place, true);
        self.schedule.propagate_changes();
        Ok(())
    }

    /// Cancels a command: its flow `cancel` is true from its next cycle on. Successors scheduled on its regular end are
    /// not started.
    ///
    /// # Errors
    /// The command is not running.
    pub fn cancel(&mut self, id: CommandId) -> Result<(), CommandError> {
        let place = self.schedule.commands.slot_of(id)?;
        let commands = &self.schedule.commands;
        commands.check_event(place, CommandEvent::Cancel)?;
        self.schedule.cancel_if_running(id);
        self.schedule.propagate_changes();
        Ok(())
    }

    /// Aborts a running command between two cycles, for the reason `why`. Its devices stop within their own limits.
    ///
    /// # Errors
    /// The command is not running.
    pub fn abort(
        &mut self,
        id: CommandId,
        why: AbortReason,
        bank: &mut dyn DeviceBank,
    ) -> Result<(), CommandError> {
        let place = self.schedule.commands.slot_of(id)?;
        let commands = &self.schedule.commands;
        commands.check_event(place, CommandEvent::End)?;
        let mut decision = self.decision(bank);
        decision.end_command_by(place, Cause::Aborted(why), -1);
        decision.conclude();
        Ok(())
    }

    /// Aborts every command and drops every rule. All moving devices stop within their own limits, and all outputs take their safe
    /// values, also those that commands have set that ended before.
    pub fn emergency_stop(&mut self, bank: &mut dyn DeviceBank) {
        self.abort_all(AbortReason::EmergencyStop, bank);
    }

    /// Aborts every command for the reason `why` and drops every rule, as [`emergency_stop`](Self::emergency_stop) does.
    pub fn abort_all(&mut self, why: AbortReason, bank: &mut dyn DeviceBank) {
        bank.make_all_safe();
        let mut decision = self.decision(bank);
        decision.abort_all(why);
        decision.conclude();
    }

    /// Sets these resources (actuators) to their safe values, except those that a running command holds: the program whose
    /// commands have set them will not go on.
    pub fn make_safe(&mut self, resources: &[u32], bank: &mut dyn DeviceBank) {
        let commands = &self.schedule.commands;
        let runs = |place: usize| {
            commands
                .get(place)
                .is_some_and(|e| e.command.state.is_running())
        };
        let is_free = |resource: &&u32| !commands.holders(**resource).any(runs);
        for resource in resources.iter().filter(is_free) {
            bank.make_safe(*resource);
        }
    }

    /// Removes and returns a command, to be freed outside the cycle. A scheduled command is unscheduled first.
    /// Conditions of rules keep the final values of the facts about the command.
    ///
    /// # Errors
    /// The command is running.
    pub fn remove(&mut self, id: CommandId) -> Result<Box<Command>, CommandError> {
        let place = self.schedule.commands.slot_of(id)?;
        let commands = &self.schedule.commands;
        commands.check_event(place, CommandEvent::Unload)?;
        if commands.entry(place)?.command.state == CommandState::Scheduled {
            self.unschedule(id)?;
        }
        let entry = self.schedule.commands.take_out(place);
        let entry = entry.ok_or(CommandError::Unknown)?;
        self.schedule.rules.freeze_facts(id, &entry);
        self.schedule.propagate_changes();
        Ok(entry.command)
    }

    /// Removes and returns a command that no rule can start any more, to be freed outside the cycle; `None` if there is
    /// none.
    pub fn take_orphan(&mut self) -> Option<(CommandId, Box<Command>)> {
        self.schedule.commands.take_orphan()
    }

    /// Returns and removes the oldest notice (event of a command or rule); `None` if there is none. The caller reads
    /// all notices after each tick and each request.
    pub fn next_notice(&mut self) -> Option<Notice> {
        self.schedule.notices.pop()
    }

    /// Returns the number of notices (events of commands and rules) that were lost because the log was full.
    #[must_use]
    pub fn notices_lost(&self) -> u64 {
        self.schedule.notices.lost
    }

    /// Returns a loaded command; `None` if the id is unknown or the command was unloaded.
    #[must_use]
    pub fn command(&self, id: CommandId) -> Option<&Command> {
        let commands = &self.schedule.commands;
        Some(&commands.get(commands.find(id)?)?.command)
    }

    /// Returns the command with this id for changes, such as setting its inputs between ticks; `None` if the id is
    /// unknown or the command was unloaded.
    pub fn command_mut(&mut self, id: CommandId) -> Option<&mut Command> {
        let place = self.schedule.commands.find(id)?;
        Some(&mut self.schedule.commands.get_mut(place)?.command)
    }

    /// Returns all loaded commands with their ids, whether they run or not, in the order of the table.
    pub fn commands(&self) -> impl Iterator<Item = (CommandId, &Command)> + '_ {
        let entries = self.schedule.commands.entries.iter().enumerate();
        entries.filter_map(|(place, entry)| {
            let entry = entry.as_ref().filter(|e| !e.orphaned)?;
            Some((entry.id(place), &*entry.command))
        })
    }

    /// Returns the rules that may still fire, in the order in which they were added.
    pub fn rules(&self) -> impl Iterator<Item = (RuleId, &Rule)> + '_ {
        self.schedule.rules.pending.iter().map(|p| (p.id, &*p.rule))
    }

    /// Adds a rule. The commands that it starts are scheduled. They take their free resources at once, except those
    /// that a predecessor passes on. If the condition is already true, the rule fires at once.
    ///
    /// # Errors
    /// Returns the rule, and changes nothing, if a command to start is neither ready nor scheduled, needs a resource
    /// that another command holds, or would follow itself; if the rule can never fire; if its condition is too deep; or
    /// if the table is full.
    pub fn schedule_with_id(
        &mut self,
        id: RuleId,
        rule: Box<Rule>,
        bank: &mut dyn DeviceBank,
    ) -> Result<(), (Box<Rule>, CommandError)> {
        self.schedule.add_rule(id, rule)?;
        let mut decision = self.decision(bank);
        decision.fire_if_true(id);
        decision.conclude();
        Ok(())
    }

    /// Adds a rule under an id that the core chooses; see [`Core::schedule_with_id`] for its effect.
    ///
    /// # Errors
    /// Returns the rule, and changes nothing, if a command to start is neither ready nor scheduled, needs a resource
    /// that another command holds, or would follow itself; if the rule can never fire; if its condition is too deep; or
    /// if the table is full.
    pub fn schedule(
        &mut self,
        rule: Box<Rule>,
        bank: &mut dyn DeviceBank,
    ) -> Result<RuleId, (Box<Rule>, CommandError)> {
        let id = self.schedule.rules.new_id();
        self.schedule_with_id(id, rule, bank).map(|()| id)
    }

    /// Drops a rule that has not fired. Commands that only this rule could start are unscheduled.
    ///
    /// # Errors
    /// The rule has fired or was dropped already, or never existed.
    pub fn withdraw_rule(&mut self, id: RuleId) -> Result<(), CommandError> {
        let at = self.schedule.rules.position(id);
        let at = at.ok_or(CommandError::Unknown)?;
        self.schedule.drop_rule(at, RuleOutcome::Dropped);
        self.schedule.propagate_changes();
        Ok(())
    }

    /// Returns the cost of one evaluation of all pending rules: number of words of their conditions plus number of
    /// their actions.
    #[must_use]
    pub fn rules_cost(&self) -> usize {
        self.schedule
            .rules
            .pending
            .iter()
            .map(|p| p.rule.cost())
            .sum()
    }

    /// Removes and returns a rule that has fired or was dropped, to be freed outside the cycle; `None` if there is
    /// none.
    pub fn take_finished_rule(&mut self) -> Option<(RuleId, Box<Rule>)> {
        self.schedule.rules.take_finished()
    }
}
