//! Adding rules, and dropping rules that can no longer fire together with the commands that only they could start.

use crate::command_set::CommandSet;
use crate::condition::{Fact, Truth};
use crate::ids::{CommandId, RuleId};
use crate::lifecycle::{CommandEvent, CommandState};
use crate::notice::{Notice, RuleOutcome};
use crate::rule::{PendingRule, Rule};
use crate::table::{CommandError, Core, Entry};
use rpi_device::DeviceBank;

use alloc::boxed::Box;

impl Core {
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
        if let Err(why) = self.check_rule(&rule) {
            return Err((rule, why));
        }
        rule.start
            .iter()
            .for_each(|c| self.mark_scheduled(*c, rule.keeps_orphans));
        self.rules.push(PendingRule {
            id,
            mentioned: rule.mentioned_commands().collect(),
            rule,
            is_firing: false,
            may_fire: true,
        });
        self.propagate_changes();
        self.fire_if_true(id, bank);
        Ok(())
    }

    /// Adds a rule under an id that the core chooses; see [`Core::schedule_with_id`].
    ///
    /// # Errors
    /// As for [`Core::schedule_with_id`].
    pub fn schedule(
        &mut self,
        rule: Box<Rule>,
        bank: &mut dyn DeviceBank,
    ) -> Result<RuleId, (Box<Rule>, CommandError)> {
        self.last_rule_id += 1;
        let id = RuleId(self.last_rule_id);
        self.schedule_with_id(id, rule, bank).map(|()| id)
    }

    /// Drops a rule. Commands that only this rule could start are unscheduled.
    ///
    /// # Errors
    /// The rule does not exist any more.
    pub fn withdraw_rule(&mut self, id: RuleId) -> Result<(), CommandError> {
        let at = self.rules.iter().position(|p| p.id == id);
        let at = at.ok_or(CommandError::Unknown)?;
        self.drop_rule(at, RuleOutcome::Dropped);
        self.propagate_changes();
        Ok(())
    }

    /// Evaluation cost of all rules after each change: number of condition words plus number of actions.
    #[must_use]
    pub fn rules_cost(&self) -> usize {
        self.rules.iter().map(|p| p.rule.cost()).sum()
    }

    /// Moves a fired or dropped rule out, to be freed outside the cycle.
    pub fn take_finished_rule(&mut self) -> Option<(RuleId, Box<Rule>)> {
        self.finished_rules.pop()
    }

    fn mark_scheduled(&mut self, command: CommandId, kept: bool) {
        let place = self.find(command);
        let Some(entry) = place.and_then(|p| self.entries[p].as_mut()) else {
            return;
        };
        if entry.command.state == CommandState::Ready {
            self.notices.push(Notice::Scheduled { command });
        }
        entry.command.apply_event(CommandEvent::Schedule);
        (entry.keep_if_orphaned, entry.live) = (entry.keep_if_orphaned | kept, true);
    }

    fn check_rule(&self, rule: &Rule) -> Result<(), CommandError> {
        if self.rules.len() + self.finished_rules.len() >= self.rule_capacity {
            return Err(CommandError::TableFull);
        }
        if !rule.condition.fits_stack() {
            return Err(CommandError::ConditionTooDeep);
        }
        for (k, id) in rule.start.iter().enumerate() {
            if rule.start[..k].contains(id) || rule.predecessors.contains(id) {
                return Err(CommandError::SelfSuccessor);
            }
            let place = self.find(*id).ok_or(CommandError::Unknown)?;
            self.check_event(place, CommandEvent::Schedule)?;
        }
        self.check_all_reachable(rule)?;
        match self.may_come_true(rule) {
            true => Ok(()),
            false => Err(CommandError::NeverFires),
        }
    }

    /// True if the condition may become true before the commands that the rule starts have run.
    fn may_come_true(&self, rule: &Rule) -> bool {
        let know = |id: CommandId, fact: Fact| match fact {
            Fact::Export(_) if rule.start.contains(&id) => Truth::UNKNOWN_FOREVER,
            _ if rule.start.contains(&id) => Truth::fixed(false),
            _ => self.fact_truth(id, fact),
        };
        rule.condition.evaluate(know).may_be_true()
    }

    fn check_all_reachable(&self, rule: &Rule) -> Result<(), CommandError> {
        for (k, id) in rule.start.iter().enumerate() {
            let place = self.find(*id).ok_or(CommandError::Unknown)?;
            for resource in self.entry(place)?.command.resources() {
                self.check_reachable(rule, place, resource)?;
                let earlier = rule.start[..k].iter().filter_map(|s| self.find(*s));
                let needs = |p: &usize| self.entry(*p).is_ok_and(|e| e.command.needs(resource));
                if let Some(by) = earlier.into_iter().find(needs) {
                    return Err(self.resource_held_error(resource, by));
                }
            }
        }
        Ok(())
    }

    /// Drops the rules that can no longer fire, orphans the commands that nothing can start any more, and lets the
    /// remaining scheduled commands take freed resources. Called after every change of a command's state.
    pub(crate) fn propagate_changes(&mut self) {
        // A resource taken by one command may be out of reach for another, so iterate to a fixed point. Every iteration
        // but the last takes a resource, which bounds the loop.
        while self.propagate_once() {}
    }

    /// One iteration of `settle`. Returns true if a scheduled command took a free resource.
    fn propagate_once(&mut self) -> bool {
        self.mark_live();
        self.drop_unfirable_rules();
        for place in 0..self.entries.len() {
            if self.is_orphan(place) {
                self.orphan(place, false);
            }
        }
        self.take_free()
    }

    /// Computes which scheduled commands may still run and which rules may still fire. This is a least fixed point, so
    /// commands that only wait for one another in a dependency cycle are orphaned.
    fn mark_live(&mut self) {
        let entries = self.entries.iter_mut().flatten();
        entries.for_each(|e| e.live = e.command.state != CommandState::Scheduled && !e.orphaned);
        self.rules.iter_mut().for_each(|p| p.may_fire = false);
        let (mut found, mut back) = (self.mark_firable_rules(None, false), false);
        // Whether a rule may fire depends only on the commands that it mentions. Chains are usually created from one
        // end to the other, so alternating the direction reaches the fixed point in few passes.
        while !found.is_empty() {
            back = !back;
            found = self.mark_firable_rules(Some(found), back);
        }
    }

    /// Marks rules that may still fire as open, among those that mention a command in `about` (`None` for all rules).
    /// Returns the commands that became live; `back` reverses the order.
    fn mark_firable_rules(&mut self, about: Option<CommandSet>, back: bool) -> CommandSet {
        let (mut found, rules) = (CommandSet::default(), self.rules.len());
        for k in 0..rules {
            let at = if back { rules - 1 - k } else { k };
            let about = about.map(|names| names.union(&found));
            let pending = &self.rules[at];
            let asked = about.is_none_or(|names| pending.mentioned.intersects(&names));
            if asked && !pending.may_fire && self.may_fire(&pending.rule) {
                self.rules[at].may_fire = true;
                self.mark_started_live(at, &mut found);
            }
        }
        found
    }

    /// Marks the commands that a rule starts as live and adds the newly marked ones to `found`.
    fn mark_started_live(&mut self, at: usize, found: &mut CommandSet) {
        for k in 0..self.rules[at].rule.start.len() {
            let command = self.rules[at].rule.start[k];
            let entry = self.find(command).and_then(|p| self.entries[p].as_mut());
            if let Some(entry) = entry.filter(|e| !e.live) {
                entry.live = true;
                found.add(command);
            }
        }
    }

    /// Drops all rules that are not open, in one pass.
    fn drop_unfirable_rules(&mut self) {
        let (notices, spent) = (&mut self.notices, &mut self.finished_rules);
        for PendingRule { id, rule, .. } in self.rules.extract_if(.., |p| !p.may_fire) {
            let outcome = RuleOutcome::Dropped;
            notices.push(Notice::Rule { rule: id, outcome });
            // `spent` has enough capacity, as in `drop_rule`.
            spent.push((id, rule));
        }
    }

    /// True if the condition may become true and all commands to start can get their resources.
    fn may_fire(&self, rule: &Rule) -> bool {
        let startable = |id: &CommandId| {
            let place = self.find(*id);
            let entry = place.and_then(|p| Some((p, self.entries[p].as_ref()?)));
            entry.is_some_and(|(place, e)| {
                let mut needs = e.command.resources();
                e.command.state == CommandState::Scheduled
                    && needs.all(|r| self.check_reachable(rule, place, r).is_ok())
            })
        };
        self.may_come_true(rule) && rule.start.iter().all(startable)
    }

    fn is_orphan(&self, place: usize) -> bool {
        let Some(entry) = self.entries[place].as_ref() else {
            return false;
        };
        let id = self.id(place);
        let waits = entry.command.state == CommandState::Scheduled && !entry.orphaned;
        waits && !self.rules.iter().any(|p| p.rule.start.contains(&id))
    }

    /// Orphans a command that nothing can start any more and releases its resources.
    pub(crate) fn orphan(&mut self, place: usize, keep: bool) {
        let command = self.id(place);
        let Some(entry) = self.entries[place].as_mut() else {
            return;
        };
        let kept = keep || entry.keep_if_orphaned;
        entry.command.apply_event(CommandEvent::Orphaned { kept });
        entry.command.set_all_held(false);
        (entry.orphaned, entry.keep_if_orphaned, entry.live) = (!kept, false, kept);
        if entry.orphaned {
            freeze_facts(&mut self.rules, command, entry);
        }
        self.notices.push(Notice::Orphaned { command, kept });
    }

    /// Removes a rule from the table and reports its outcome.
    pub(crate) fn drop_rule(&mut self, at: usize, outcome: RuleOutcome) {
        let PendingRule { id, rule, .. } = self.rules.remove(at);
        self.notices.push(Notice::Rule { rule: id, outcome });
        // `spent` has enough capacity: both lists together never exceed the capacity of one.
        self.finished_rules.push((id, rule));
    }
}

/// Replaces the facts about a removed command by their final values in all rules.
pub(crate) fn freeze_facts(rules: &mut [PendingRule], gone: CommandId, entry: &Entry) {
    let own: CommandSet = [gone].into_iter().collect();
    for pending in rules.iter_mut().filter(|p| p.mentioned.intersects(&own)) {
        let condition = &mut pending.rule.condition;
        condition.freeze(gone, |fact| entry.final_value(fact));
    }
}
