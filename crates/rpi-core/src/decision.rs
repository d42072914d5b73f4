//! The decision between two cycles: ends of commands, firing of rules, takeovers, braking.

use crate::command::{AbortReason, Cause, Ending};
use crate::error::CommandError;
use crate::ids::{CommandId, RuleId};
use crate::lifecycle::{CommandEvent, CommandState};
use crate::notice::{Notice, RuleOutcome};
use crate::rule::{Rule, ValueTransfer};
use crate::rule_table::PendingRule;
use crate::schedule::Schedule;
use rpi_device::DeviceBank;

/// The decision between two cycles. It collects ends and starts of commands; [`Decision::conclude`] makes the
/// consequences of all of them take effect.
pub(crate) struct Decision<'a> {
    pub(crate) schedule: &'a mut Schedule,
    bank: &'a mut dyn DeviceBank,
    /// Number of the tick that the notices of ended commands carry: the tick that has just run, or the next tick if the
    /// decision is made between two ticks.
    tick: u64,
    /// True if a command has started or ended in this decision.
    has_changed: bool,
}

impl<'a> Decision<'a> {
    pub(crate) fn new(schedule: &'a mut Schedule, bank: &'a mut dyn DeviceBank, tick: u64) -> Self {
        Decision {
            schedule,
            bank,
            tick,
            has_changed: false,
        }
    }

    /// Fires all rules whose condition is true, in the order in which they were added. All conditions are evaluated
    /// before the first rule fires. Started commands run from tick `next` on, or from the tick in which the next cycle
    /// of their predecessor would have been due.
    pub(crate) fn fire_all(&mut self, next: u64) {
        for at in 0..self.schedule.rules.pending.len() {
            self.schedule.rules.pending[at].is_firing =
                self.is_true(&self.schedule.rules.pending[at].rule);
        }
        let mut at = 0;
        while at < self.schedule.rules.pending.len() {
            match self.schedule.rules.pending[at].is_firing {
                true => self.fire(at, next),
                false => at += 1,
            }
        }
    }

    /// Fires a rule between two ticks if its condition is already true.
    pub(crate) fn fire_if_true(&mut self, id: RuleId) {
        let at = self.schedule.rules.position(id);
        if let Some(at) = at.filter(|at| self.is_true(&self.schedule.rules.pending[*at].rule)) {
            self.fire(at, self.tick);
        }
    }

    fn is_true(&self, rule: &Rule) -> bool {
        rule.condition
            .evaluate(|id, fact| self.schedule.commands.fact_truth(id, fact))
            .is_true()
    }

    /// Fires the pending rule with index `at` atomically: if one command cannot be started, the rule fails and has no
    /// effect. Commands without a predecessor start at tick `next`.
    fn fire(&mut self, at: usize, next: u64) {
        self.has_changed = true;
        if let Err(why) = self.can_fire(&self.schedule.rules.pending[at].rule) {
            self.schedule.drop_rule(at, RuleOutcome::Failed(why));
            return;
        }
        let PendingRule { id, rule, .. } = self.schedule.rules.pending.remove(at);
        self.schedule.notices.push(Notice::Rule {
            rule: id,
            outcome: RuleOutcome::Fired,
        });
        rule.stop.iter().for_each(|c| self.stop_by_rule(*c, id));
        rule.cancel
            .iter()
            .for_each(|c| self.schedule.cancel_if_running(*c));
        let (due, predecessor) = (self.due_after(&rule, next), self.predecessor_result(&rule));
        for command in &rule.start {
            self.take_over(*command, due, predecessor);
        }
        rule.transfers
            .iter()
            .for_each(|handed| self.transfer_value(handed));
        self.schedule.rules.finish(id, rule);
    }

    fn can_fire(&self, rule: &Rule) -> Result<(), CommandError> {
        rule.start.iter().try_for_each(|id| {
            let place = self
                .schedule
                .commands
                .find(*id)
                .ok_or(CommandError::Unknown)?;
            self.schedule
                .commands
                .check_event(place, CommandEvent::Fire)?;
            self.schedule.check_obtainable(rule, place)
        })
    }

    fn stop_by_rule(&mut self, command: CommandId, rule: RuleId) {
        let Some(place) = self.schedule.commands.find(command) else {
            return;
        };
        let state = self.schedule.commands.entry(place).map(|e| e.command.state);
        match state {
            Ok(state) if state.is_running() => self.end_command_by(place, Cause::Stopped(rule), 0),
            Ok(CommandState::Scheduled) => self.schedule.orphan(place, false),
            _ => {}
        }
    }

    fn take_over(&mut self, command: CommandId, due: u64, predecessor: Option<i64>) {
        let Some(place) = self.schedule.commands.find(command) else {
            return;
        };
        self.start_at(place, due, CommandEvent::Fire);
        if let Some(entry) = self.schedule.commands.get_mut(place) {
            entry.command.instance.enable_continuity_check();
            entry.command.context.predecessor = predecessor;
        }
    }

    /// Copies the latest value of an export of a predecessor to an input of its successor.
    fn transfer_value(&mut self, handed: &ValueTransfer) {
        let (Some(from), Some(to)) = (
            self.schedule.commands.find(handed.from),
            self.schedule.commands.find(handed.to),
        ) else {
            return;
        };
        let Ok([Some(from), Some(to)]) =
            self.schedule.commands.entries.get_disjoint_mut([from, to])
        else {
            return;
        };
        let machine = &from.command.instance;
        let export = machine.image().exports.get(handed.export as usize);
        if let Some(value) = export.and_then(|export| machine.value(export.value)) {
            // `set_input` ignores a value of the wrong size.
            to.command.set_input(handed.input as usize, value);
        }
    }

    /// Starts the command in table slot `place` with all its resources; its first cycle runs in tick `due`. `event` is
    /// the cause: a start request or a rule.
    pub(crate) fn start_at(&mut self, place: usize, due: u64, event: CommandEvent) {
        self.has_changed = true;
        self.schedule.commands.take_all(place);
        if let Some(entry) = self.schedule.commands.get_mut(place) {
            entry.command.apply_event(event);
            (entry.due, entry.just_started, entry.live) = (due, true, true);
        }
    }

    /// Returns the tick of the first cycle of the commands that `rule` starts: the earliest tick in which a predecessor
    /// that ends in this decision would have been due, or `next` without such a predecessor.
    fn due_after(&self, rule: &Rule, next: u64) -> u64 {
        let named = rule
            .mentioned_commands()
            .filter_map(|id| self.schedule.commands.find(id));
        let ending = named
            .filter_map(|place| self.schedule.commands.get(place))
            .filter(|e| e.ending);
        ending.map(|e| e.due).min().unwrap_or(next)
    }

    /// Returns the hash of the name and result of the first command that `rule` mentions and that ended by a named
    /// result; `None` if there is none.
    fn predecessor_result(&self, rule: &Rule) -> Option<i64> {
        let mut named = rule
            .mentioned_commands()
            .filter_map(|id| self.schedule.commands.find(id));
        named.find_map(|place| self.schedule.commands.get(place)?.command.result_id())
    }

    /// Ends the command in table slot `place`. It holds its resources until the decision is concluded.
    pub(crate) fn end_command(&mut self, place: usize, ending: Ending) {
        self.has_changed = true;
        if let Some(entry) = self.schedule.commands.get_mut(place) {
            entry.command.apply_event(CommandEvent::End);
            entry.command.ending = Some(ending);
            entry.ending = true;
        }
    }

    /// Ends the command in table slot `place` from outside, with this cause and error number.
    pub(crate) fn end_command_by(&mut self, place: usize, cause: Cause, error: i64) {
        if let Some(entry) = self.schedule.commands.get(place) {
            let ending = entry.command.make_ending(cause, error);
            self.end_command(place, ending);
        }
    }

    /// Aborts every running command for the reason `why` and drops every rule.
    pub(crate) fn abort_all(&mut self, why: AbortReason) {
        while let Some(last) = self.schedule.rules.pending.len().checked_sub(1) {
            self.schedule.drop_rule(last, RuleOutcome::Dropped);
        }
        for place in 0..self.schedule.commands.len() {
            let entry = self.schedule.commands.get(place);
            if entry.is_some_and(|e| e.command.state.is_running()) {
                self.end_command_by(place, Cause::Aborted(why), -1);
            }
        }
        self.has_changed = true;
    }

    /// Concludes the decision: releases the resources that no successor took over and brakes the moving ones, reports
    /// starts and ends, and drops rules that can no longer fire.
    pub(crate) fn conclude(mut self) {
        if !self.has_changed {
            return;
        }
        (0..self.schedule.commands.len()).for_each(|place| self.release_resources(place));
        // Ends before starts, so that a reader of the notices never sees two holders of one resource.
        self.announce_ends(false);
        self.announce_starts();
        self.announce_ends(true);
        self.schedule.propagate_changes();
    }

    /// Releases the remaining resources of the command in table slot `place` if it has ended. The device brakes those
    /// that move, and sets those of a command that failed to their safe values. After a regular end, an output keeps its
    /// value: the next step of the program relies on a valve that the step before has opened.
    fn release_resources(&mut self, place: usize) {
        let (command, tick) = (self.schedule.commands.id(place), self.tick);
        let entry = self.schedule.commands.get_mut(place);
        let Some(entry) = entry.filter(|e| e.ending) else {
            return;
        };
        let ending = entry.command.ending.as_ref();
        let has_failed = ending.is_some_and(|ending| !ending.is_regular());
        for hold in entry.command.resource_uses.iter_mut().filter(|h| h.is_held) {
            hold.is_held = false;
            let resource = hold.resource;
            if has_failed {
                self.bank.make_safe(resource);
            }
            if self.bank.is_moving(resource) {
                self.bank.stop(resource);
                self.schedule.notices.push(Notice::Braked {
                    command,
                    resource,
                    tick,
                });
                if let Some(ending) = &mut entry.command.ending {
                    ending.left_moving = true;
                }
            }
        }
    }

    fn announce_starts(&mut self) {
        for place in 0..self.schedule.commands.len() {
            let command = self.schedule.commands.id(place);
            if let Some(entry) = self
                .schedule
                .commands
                .get_mut(place)
                .filter(|e| e.just_started)
            {
                let tick = entry.due;
                self.schedule
                    .notices
                    .push(Notice::Started { command, tick });
            }
        }
    }

    /// Reports ended commands: with `fresh` false, commands that ran before this decision; with `fresh` true, commands
    /// that were started and ended in this decision.
    fn announce_ends(&mut self, fresh: bool) {
        let tick = self.tick;
        for place in 0..self.schedule.commands.len() {
            let command = self.schedule.commands.id(place);
            let entry = self.schedule.commands.get_mut(place);
            let Some(entry) = entry.filter(|e| e.just_started == fresh) else {
                continue;
            };
            entry.just_started = false;
            if let Some(ending) = entry.command.ending.filter(|_| entry.ending) {
                entry.ending = false;
                self.schedule.notices.push(Notice::Ended {
                    command,
                    tick,
                    ending,
                });
            }
        }
    }
}
