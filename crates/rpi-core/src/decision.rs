//! The decision between two cycles: ends of commands, firing of rules, takeovers, braking.

use crate::command::{Cause, Ending};
use crate::condition::{Fact, Truth};
use crate::facts::fact_holds;
use crate::ids::{CommandId, RuleId};
use crate::lifecycle::{CommandEvent, CommandState};
use crate::notice::{Notice, RuleOutcome};
use crate::rule::{PendingRule, Rule, ValueTransfer};
use crate::table::{CommandError, Core};
use rpi_device::DeviceBank;

impl Core {
    /// Fires all rules whose condition is true, in the order of their creation. All conditions are evaluated before the
    /// first rule fires. Started commands run from tick `next` on, or from the tick at which their predecessor would
    /// have been due.
    pub(crate) fn fire_all(&mut self, next: u64, bank: &mut dyn DeviceBank) {
        for at in 0..self.rules.len() {
            self.rules[at].is_firing = self.is_true(&self.rules[at].rule);
        }
        let mut at = 0;
        while at < self.rules.len() {
            match self.rules[at].is_firing {
                true => self.fire(at, next),
                false => at += 1,
            }
        }
        self.conclude(bank);
    }

    /// Fires a rule between two ticks if its condition is already true.
    pub(crate) fn fire_if_true(&mut self, id: RuleId, bank: &mut dyn DeviceBank) {
        let at = self.rules.iter().position(|p| p.id == id);
        if let Some(at) = at.filter(|at| self.is_true(&self.rules[*at].rule)) {
            self.fire(at, self.tick);
            self.conclude(bank);
        }
    }

    fn is_true(&self, rule: &Rule) -> bool {
        rule.condition
            .evaluate(|id, fact| self.fact_truth(id, fact))
            .is_true()
    }

    /// Fires a rule atomically: if one command cannot be started, the rule fails and has no effect.
    fn fire(&mut self, at: usize, next: u64) {
        self.has_changed = true;
        if let Err(why) = self.can_fire(&self.rules[at].rule) {
            return self.drop_rule(at, RuleOutcome::Failed(why));
        }
        let PendingRule { id, rule, .. } = self.rules.remove(at);
        self.notices.push(Notice::Rule {
            rule: id,
            outcome: RuleOutcome::Fired,
        });
        rule.stop.iter().for_each(|c| self.stop_by_rule(*c, id));
        rule.cancel.iter().for_each(|c| self.cancel_if_running(*c));
        let (due, predecessor) = (self.due_after(&rule, next), self.predecessor_result(&rule));
        for command in &rule.start {
            self.take_over(*command, due, predecessor);
        }
        rule.transfers
            .iter()
            .for_each(|handed| self.transfer_value(handed));
        // `spent` has enough capacity: both lists together never exceed the capacity of one.
        self.finished_rules.push((id, rule));
    }

    fn can_fire(&self, rule: &Rule) -> Result<(), CommandError> {
        rule.start.iter().try_for_each(|id| {
            let place = self.find(*id).ok_or(CommandError::Unknown)?;
            self.check_event(place, CommandEvent::Fire)?;
            self.check_obtainable(rule, place)
        })
    }

    fn stop_by_rule(&mut self, command: CommandId, rule: RuleId) {
        let Some(place) = self.find(command) else {
            return;
        };
        let state = self.entry(place).map(|e| e.command.state);
        match state {
            Ok(state) if state.is_running() => self.end_command_by(place, Cause::Stopped(rule), 0),
            Ok(CommandState::Scheduled) => self.orphan(place, false),
            _ => {}
        }
    }

    /// Cancels a command if it is running.
    pub(crate) fn cancel_if_running(&mut self, command: CommandId) {
        let place = self.find(command);
        let entry = place.and_then(|p| self.entries[p].as_mut());
        if let Some(entry) = entry.filter(|e| e.command.state == CommandState::Running) {
            entry.command.apply_event(CommandEvent::Cancel);
            self.notices.push(Notice::Cancelling { command });
        }
    }

    fn take_over(&mut self, command: CommandId, due: u64, predecessor: Option<i64>) {
        let Some(place) = self.find(command) else {
            return;
        };
        self.start_at(place, due, CommandEvent::Fire);
        if let Some(entry) = self.entries[place].as_mut() {
            entry.command.instance.enable_continuity_check();
            entry.command.context.predecessor = predecessor;
        }
    }

    /// Copies the latest value of an export to an input of the successor.
    fn transfer_value(&mut self, handed: &ValueTransfer) {
        let (Some(from), Some(to)) = (self.find(handed.from), self.find(handed.to)) else {
            return;
        };
        let Ok([Some(from), Some(to)]) = self.entries.get_disjoint_mut([from, to]) else {
            return;
        };
        let machine = &from.command.instance;
        let export = machine.image().exports.get(handed.export as usize);
        if let Some(value) = export.and_then(|export| machine.value(export.value)) {
            // `set_input` ignores a value of the wrong size.
            to.command.set_input(handed.input as usize, value);
        }
    }

    /// Starts a command at tick `due` with all its resources.
    pub(crate) fn start_at(&mut self, place: usize, due: u64, event: CommandEvent) {
        self.has_changed = true;
        self.take_all(place);
        if let Some(entry) = self.entries[place].as_mut() {
            entry.command.apply_event(event);
            (entry.due, entry.just_started, entry.live) = (due, true, true);
        }
    }

    /// First tick of the commands that a rule starts: the earliest due tick of its predecessors that end now, else
    /// `next`.
    fn due_after(&self, rule: &Rule, next: u64) -> u64 {
        let named = rule.mentioned_commands().filter_map(|id| self.find(id));
        let ending = named
            .filter_map(|place| self.entries[place].as_ref())
            .filter(|e| e.ending);
        ending.map(|e| e.due).min().unwrap_or(next)
    }

    /// Identity of the result of the first command that the rule mentions and that ended by a result.
    fn predecessor_result(&self, rule: &Rule) -> Option<i64> {
        let mut named = rule.mentioned_commands().filter_map(|id| self.find(id));
        named.find_map(|place| self.entries[place].as_ref()?.command.result_id())
    }

    /// Ends a command. It keeps its resources until the decision is concluded.
    pub(crate) fn end_command(&mut self, place: usize, ending: Ending) {
        self.has_changed = true;
        if let Some(entry) = self.entries[place].as_mut() {
            entry.command.apply_event(CommandEvent::End);
            entry.command.ending = Some(ending);
            entry.ending = true;
        }
    }

    pub(crate) fn end_command_by(&mut self, place: usize, cause: Cause, error: i64) {
        if let Some(entry) = self.entries[place].as_ref() {
            let ending = entry.command.make_ending(cause, error);
            self.end_command(place, ending);
        }
    }

    /// Concludes a decision: releases and brakes what nobody took over, reports starts and ends, and drops rules that
    /// can no longer fire.
    pub(crate) fn conclude(&mut self, bank: &mut dyn DeviceBank) {
        if !core::mem::take(&mut self.has_changed) {
            return;
        }
        (0..self.entries.len()).for_each(|place| self.release_resources(place, bank));
        // Ends before starts, so that a reader of the notices never sees two holders of one resource.
        self.announce_ends(false);
        self.announce_starts();
        self.announce_ends(true);
        self.propagate_changes();
    }

    /// Releases the remaining resources of an ended command. Moving ones are braked by their device.
    fn release_resources(&mut self, place: usize, bank: &mut dyn DeviceBank) {
        let (command, tick) = (self.id(place), self.tick);
        let entry = self.entries[place].as_mut();
        let Some(entry) = entry.filter(|e| e.ending) else {
            return;
        };
        for hold in entry.command.resource_uses.iter_mut().filter(|h| h.is_held) {
            hold.is_held = false;
            let resource = hold.resource;
            if bank.is_moving(resource) {
                bank.stop(resource);
                self.notices.push(Notice::Braked {
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
        for place in 0..self.entries.len() {
            let command = self.id(place);
            if let Some(entry) = self.entries[place].as_mut().filter(|e| e.just_started) {
                let tick = entry.due;
                self.notices.push(Notice::Started { command, tick });
            }
        }
    }

    /// Reports ended commands. With `fresh` false, those that had run before; with `fresh` true, those that were
    /// started and ended in the same decision.
    fn announce_ends(&mut self, fresh: bool) {
        let tick = self.tick;
        for place in 0..self.entries.len() {
            let command = self.id(place);
            let entry = self.entries[place].as_mut();
            let Some(entry) = entry.filter(|e| e.just_started == fresh) else {
                continue;
            };
            entry.just_started = false;
            if let Some(ending) = entry.command.ending.filter(|_| entry.ending) {
                entry.ending = false;
                self.notices.push(Notice::Ended {
                    command,
                    tick,
                    ending,
                });
            }
        }
    }

    /// Computes, for each `yield` of a command or for its port `terminate`, whether ending now would certainly start a
    /// successor that takes every moving actuator. Returns true if this holds for any of them.
    pub(crate) fn latch_takeover(&mut self, place: usize, bank: &dyn DeviceBank) -> bool {
        let results = self.entries[place]
            .as_ref()
            .map_or(0, |e| e.command.has_successor.len());
        if results == 0 {
            return self.has_certain_successor(place, Cause::Terminate, bank);
        }
        let mut any = false;
        for k in 0..results {
            let yields = self.entries[place]
                .as_ref()
                .is_some_and(|e| e.command.yields(k));
            let covered = yields && self.has_certain_successor(place, Cause::Result(k), bank);
            if let Some(entry) = self.entries[place].as_mut() {
                entry.command.has_successor[k] = covered;
            }
            any |= covered;
        }
        any
    }

    fn has_certain_successor(&self, place: usize, cause: Cause, bank: &dyn DeviceBank) -> bool {
        let Some(entry) = self.entries[place].as_ref() else {
            return false;
        };
        let (id, ending) = (self.id(place), entry.command.make_ending(cause, 0));
        let know = |of: CommandId, fact: Fact| match fact {
            Fact::Export(_) if of == id => Truth::UNKNOWN,
            _ if of == id => Truth::fixed(fact_holds(fact, &ending)),
            // Values that may change later in this cycle must not promise a takeover.
            _ => self.fact_truth(of, fact).fixed_part(),
        };
        self.rules.iter().any(|p| {
            let after = p.rule.predecessors.contains(&id);
            after
                && p.rule.condition.evaluate(know).is_true()
                && self.takes_all_moving(&p.rule, place, bank)
        })
    }

    /// True if the commands that a rule starts take every moving actuator of a command.
    fn takes_all_moving(&self, rule: &Rule, place: usize, bank: &dyn DeviceBank) -> bool {
        let takes = |resource: u32| {
            let mut starts = rule.start.iter().filter_map(|id| self.find(*id));
            starts.any(|p| self.entry(p).is_ok_and(|e| e.command.needs(resource)))
        };
        let entry = self.entries[place].as_ref();
        let mut moving = entry
            .into_iter()
            .flat_map(|e| e.command.resources())
            .filter(|r| bank.is_moving(*r));
        moving.all(takes)
    }
}
