//! The schedule: commands, the rules that will start them, and the resources that both need. Rules that can no longer
//! fire are dropped, together with the commands that only they could start.

use crate::command_set::CommandSet;
use crate::command_table::CommandTable;
use crate::condition::{Fact, Truth};
use crate::error::CommandError;
use crate::ids::{CommandId, RuleId};
use crate::lifecycle::{CommandEvent, CommandState};
use crate::notice::{Notice, NoticeLog, RuleOutcome};
use crate::rule::Rule;
use crate::rule_table::RuleTable;

use alloc::boxed::Box;

/// Capacity of the table of rules, per slot of the table of commands.
const RULES_PER_COMMAND: usize = 4;
/// Capacity of the log of notices (events for the host), per slot of the table of commands. One tick produces fewer
/// notices for commands with up to ten actuators.
const NOTICES_PER_COMMAND: usize = 16;

/// The commands and rules of a core, consistent with one another: every pending rule may still fire, and some rule may
/// start each scheduled command. Changes are reported to the log of notices.
#[derive(Clone)]
pub(crate) struct Schedule {
    pub(crate) commands: CommandTable,
    pub(crate) rules: RuleTable,
    pub(crate) notices: NoticeLog,
}

impl Schedule {
    pub(crate) fn with_capacity(commands: usize) -> Self {
        Schedule {
            commands: CommandTable::with_capacity(commands),
            rules: RuleTable::with_capacity(commands.saturating_mul(RULES_PER_COMMAND)),
            notices: NoticeLog::with_capacity(commands.saturating_mul(NOTICES_PER_COMMAND)),
        }
    }

    /// Adds a rule and schedules the commands that it starts.
    ///
    /// # Errors
    /// Returns the rule, and changes nothing, for the reasons of [`crate::Core::schedule_with_id`].
    pub(crate) fn add_rule(
        &mut self,
        id: RuleId,
        rule: Box<Rule>,
    ) -> Result<(), (Box<Rule>, CommandError)> {
        if let Err(why) = self.check_rule(&rule) {
            return Err((rule, why));
        }
        rule.start
            .iter()
            .for_each(|c| self.mark_scheduled(*c, rule.keeps_orphans));
        self.rules.add(id, rule);
        self.propagate_changes();
        Ok(())
    }

    /// Cancels a command that is running; has no effect on other commands.
    pub(crate) fn cancel_if_running(&mut self, command: CommandId) {
        let place = self.commands.find(command);
        let entry = place.and_then(|p| self.commands.get_mut(p));
        if let Some(entry) = entry.filter(|e| e.command.state == CommandState::Running) {
            entry.command.apply_event(CommandEvent::Cancel);
            self.notices.push(Notice::Cancelling { command });
        }
    }

    /// Marks a command as scheduled by a new rule. `kept` is true if the command becomes ready again, instead of being
    /// removed, once no rule can start it any more.
    fn mark_scheduled(&mut self, command: CommandId, kept: bool) {
        let place = self.commands.find(command);
        let Some(entry) = place.and_then(|p| self.commands.get_mut(p)) else {
            return;
        };
        if entry.command.state == CommandState::Ready {
            self.notices.push(Notice::Scheduled { command });
        }
        entry.command.apply_event(CommandEvent::Schedule);
        (entry.keep_if_orphaned, entry.live) = (entry.keep_if_orphaned | kept, true);
    }

    /// Checks that the rule can be added; the error is the reason why not.
    fn check_rule(&self, rule: &Rule) -> Result<(), CommandError> {
        if self.rules.is_full() {
            return Err(CommandError::TableFull);
        }
        if !rule.condition.fits_stack() {
            return Err(CommandError::ConditionTooDeep);
        }
        for (k, id) in rule.start.iter().enumerate() {
            if rule.start[..k].contains(id) || rule.predecessors.contains(id) {
                return Err(CommandError::SelfSuccessor);
            }
            let place = self.commands.find(*id).ok_or(CommandError::Unknown)?;
            self.commands.check_event(place, CommandEvent::Schedule)?;
        }
        self.check_all_reachable(rule)?;
        match self.may_come_true(rule) {
            true => Ok(()),
            false => Err(CommandError::NeverFires),
        }
    }

    /// True if the condition of the rule may become true before the commands that the rule starts have run.
    fn may_come_true(&self, rule: &Rule) -> bool {
        let know = |id: CommandId, fact: Fact| match fact {
            Fact::Export(_) if rule.start.contains(&id) => Truth::UNKNOWN_FOREVER,
            _ if rule.start.contains(&id) => Truth::fixed(false),
            _ => self.commands.fact_truth(id, fact),
        };
        rule.condition.evaluate(know).may_be_true()
    }

    /// Checks that the commands that the rule starts can get all their resources.
    fn check_all_reachable(&self, rule: &Rule) -> Result<(), CommandError> {
        for (k, id) in rule.start.iter().enumerate() {
            let place = self.commands.find(*id).ok_or(CommandError::Unknown)?;
            for resource in self.commands.entry(place)?.command.resources() {
                self.check_reachable(rule, place, resource)?;
                let earlier = rule.start[..k]
                    .iter()
                    .filter_map(|s| self.commands.find(*s));
                let needs = |p: &usize| {
                    self.commands
                        .entry(*p)
                        .is_ok_and(|e| e.command.needs(resource))
                };
                if let Some(by) = earlier.into_iter().find(needs) {
                    return Err(self.commands.resource_held_error(resource, by));
                }
            }
        }
        Ok(())
    }

    /// Drops the rules that can no longer fire, removes or makes ready again the commands that no rule can start any
    /// more, and lets the remaining scheduled commands take freed resources. Called after every change of a command's
    /// state.
    pub(crate) fn propagate_changes(&mut self) {
        // A resource taken by one command may be out of reach for another, so iterate to a fixed point. Every iteration
        // but the last takes a resource, which bounds the loop.
        while self.propagate_once() {}
    }

    /// Makes one pass of [`Schedule::propagate_changes`]. Returns true if a scheduled command took a resource: others
    /// may then be unable to get it, so the caller repeats the pass.
    fn propagate_once(&mut self) -> bool {
        self.mark_live();
        self.rules.drop_unfirable(&mut self.notices);
        for place in 0..self.commands.len() {
            if self.is_orphan(place) {
                self.orphan(place, false);
            }
        }
        self.take_free()
    }

    /// Computes which scheduled commands may still run and which rules may still fire. The result is a least fixed
    /// point, so commands that only wait for one another in a dependency cycle cannot run.
    fn mark_live(&mut self) {
        let entries = self.commands.entries.iter_mut().flatten();
        entries.for_each(|e| e.live = e.command.state != CommandState::Scheduled && !e.orphaned);
        self.rules
            .pending
            .iter_mut()
            .for_each(|p| p.may_fire = false);
        let (mut found, mut back) = (self.mark_firable_rules(None, false), false);
        // Whether a rule may fire depends only on the commands that it mentions. Chains are usually created from one
        // end to the other, so alternating the direction reaches the fixed point in few passes.
        while !found.is_empty() {
            back = !back;
            found = self.mark_firable_rules(Some(found), back);
        }
    }

    /// Marks the rules that may still fire, among those that mention a command in `about` (`None` for all rules).
    /// Returns the commands that such a rule could start; `back` visits the rules in reverse order.
    fn mark_firable_rules(&mut self, about: Option<CommandSet>, back: bool) -> CommandSet {
        let (mut found, rules) = (CommandSet::default(), self.rules.pending.len());
        for k in 0..rules {
            let at = if back { rules - 1 - k } else { k };
            let about = about.map(|names| names.union(&found));
            let pending = &self.rules.pending[at];
            let concerns = about.is_none_or(|names| pending.mentioned.intersects(&names));
            if concerns && !pending.may_fire && self.may_fire(&pending.rule) {
                self.rules.pending[at].may_fire = true;
                self.mark_started_live(at, &mut found);
            }
        }
        found
    }

    /// Marks the commands that the pending rule with index `at` starts as able to run, and adds the newly marked ones
    /// to `found`.
    fn mark_started_live(&mut self, at: usize, found: &mut CommandSet) {
        for k in 0..self.rules.pending[at].rule.start.len() {
            let command = self.rules.pending[at].rule.start[k];
            let entry = self
                .commands
                .find(command)
                .and_then(|p| self.commands.get_mut(p));
            if let Some(entry) = entry.filter(|e| !e.live) {
                entry.live = true;
                found.add(command);
            }
        }
    }

    /// True if the condition of the rule may become true and all commands that it starts can get their resources.
    fn may_fire(&self, rule: &Rule) -> bool {
        let startable = |id: &CommandId| {
            let place = self.commands.find(*id);
            let entry = place.and_then(|p| Some((p, self.commands.get(p)?)));
            entry.is_some_and(|(place, e)| {
                let mut needs = e.command.resources();
                e.command.state == CommandState::Scheduled
                    && needs.all(|r| self.check_reachable(rule, place, r).is_ok())
            })
        };
        self.may_come_true(rule) && rule.start.iter().all(startable)
    }

    /// True if the command in slot `place` is scheduled and no pending rule starts it.
    fn is_orphan(&self, place: usize) -> bool {
        let Some(entry) = self.commands.get(place) else {
            return false;
        };
        let id = self.commands.id(place);
        let waits = entry.command.state == CommandState::Scheduled && !entry.orphaned;
        waits
            && !self
                .rules
                .pending
                .iter()
                .any(|p| p.rule.start.contains(&id))
    }

    /// Releases the resources of the command in slot `place`, which no rule can start any more. The command becomes
    /// ready again if `keep` or an earlier rule requires this; otherwise it waits to be freed outside the cycle.
    pub(crate) fn orphan(&mut self, place: usize, keep: bool) {
        let command = self.commands.id(place);
        let Some(entry) = self.commands.get_mut(place) else {
            return;
        };
        let kept = keep || entry.keep_if_orphaned;
        entry.command.apply_event(CommandEvent::Orphaned { kept });
        entry.command.set_all_held(false);
        (entry.orphaned, entry.keep_if_orphaned, entry.live) = (!kept, false, kept);
        if entry.orphaned {
            self.rules.freeze_facts(command, entry);
        }
        self.notices.push(Notice::Orphaned { command, kept });
    }

    /// Removes the pending rule with index `at` and reports its outcome.
    pub(crate) fn drop_rule(&mut self, at: usize, outcome: RuleOutcome) {
        self.rules.drop_rule(at, outcome, &mut self.notices);
    }
}
