//! Adding rules, and dropping rules that can no longer fire together with the commands that only they could start.

use crate::commands::{Core, Entry, Refused};
use crate::condition::{Fact, Truth};
use crate::id::{CommandId, RuleId};
use crate::lifecycle::{Event, State};
use crate::names::Names;
use crate::notice::{Notice, Outcome};
use crate::rule::{Pending, Rule};
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
    pub fn schedule_as(
        &mut self,
        id: RuleId,
        rule: Box<Rule>,
        bank: &mut dyn DeviceBank,
    ) -> Result<(), (Box<Rule>, Refused)> {
        if let Err(why) = self.may_be_made(&rule) {
            return Err((rule, why));
        }
        rule.start
            .iter()
            .for_each(|c| self.await_rule(*c, rule.kept));
        self.rules.push(Pending {
            id,
            names: rule.mentions().collect(),
            rule,
            fires: false,
            open: true,
        });
        self.settle();
        self.fire_if_true(id, bank);
        Ok(())
    }

    /// Adds a rule under an id that the core chooses; see [`Core::schedule_as`].
    ///
    /// # Errors
    /// As for [`Core::schedule_as`].
    pub fn schedule(
        &mut self,
        rule: Box<Rule>,
        bank: &mut dyn DeviceBank,
    ) -> Result<RuleId, (Box<Rule>, Refused)> {
        self.named += 1;
        let id = RuleId(self.named);
        self.schedule_as(id, rule, bank).map(|()| id)
    }

    /// Drops a rule. Commands that only this rule could start are unscheduled.
    ///
    /// # Errors
    /// The rule does not exist any more.
    pub fn withdraw(&mut self, id: RuleId) -> Result<(), Refused> {
        let at = self.rules.iter().position(|p| p.id == id);
        let at = at.ok_or(Refused::Unknown)?;
        self.drop_rule(at, Outcome::Dropped);
        self.settle();
        Ok(())
    }

    /// Evaluation cost of all rules after each change: number of condition words plus number of actions.
    #[must_use]
    pub fn weight_of_rules(&self) -> usize {
        self.rules.iter().map(|p| p.rule.weight()).sum()
    }

    /// Moves a fired or dropped rule out, to be freed outside the cycle.
    pub fn take_spent(&mut self) -> Option<(RuleId, Box<Rule>)> {
        self.spent.pop()
    }

    fn await_rule(&mut self, command: CommandId, kept: bool) {
        let place = self.find(command);
        let Some(entry) = place.and_then(|p| self.entries[p].as_mut()) else {
            return;
        };
        if entry.command.state == State::Ready {
            self.notices.push(Notice::Scheduled { command });
        }
        entry.command.happen(Event::Schedule);
        (entry.kept, entry.live) = (entry.kept | kept, true);
    }

    fn may_be_made(&self, rule: &Rule) -> Result<(), Refused> {
        if self.rules.len() + self.spent.len() >= self.most_rules {
            return Err(Refused::Full);
        }
        if !rule.condition.fits() {
            return Err(Refused::Condition);
        }
        for (k, id) in rule.start.iter().enumerate() {
            if rule.start[..k].contains(id) || rule.after.contains(id) {
                return Err(Refused::Successor);
            }
            let place = self.find(*id).ok_or(Refused::Unknown)?;
            self.fits(place, Event::Schedule)?;
        }
        self.all_within_reach(rule)?;
        match self.may_come_true(rule) {
            true => Ok(()),
            false => Err(Refused::Never),
        }
    }

    /// True if the condition may become true before the commands that the rule starts have run.
    fn may_come_true(&self, rule: &Rule) -> bool {
        let know = |id: CommandId, fact: Fact| match fact {
            Fact::Export(_) if rule.start.contains(&id) => Truth::NEVER,
            _ if rule.start.contains(&id) => Truth::fixed(false),
            _ => self.know(id, fact),
        };
        rule.condition.truth(know).may_be_true()
    }

    fn all_within_reach(&self, rule: &Rule) -> Result<(), Refused> {
        for (k, id) in rule.start.iter().enumerate() {
            let place = self.find(*id).ok_or(Refused::Unknown)?;
            for resource in self.entry(place)?.command.resources() {
                self.within_reach(rule, place, resource)?;
                let earlier = rule.start[..k].iter().filter_map(|s| self.find(*s));
                let needs = |p: &usize| self.entry(*p).is_ok_and(|e| e.command.needs(resource));
                if let Some(by) = earlier.into_iter().find(needs) {
                    return Err(self.held(resource, by));
                }
            }
        }
        Ok(())
    }

    /// Drops the rules that can no longer fire, orphans the commands that nothing can start any more, and lets the
    /// remaining scheduled commands take freed resources. Called after every change of a command's state.
    pub(crate) fn settle(&mut self) {
        // A resource taken by one command may be out of reach for another, so iterate to a fixed point. Every iteration
        // but the last takes a resource, which bounds the loop.
        while self.settle_once() {}
    }

    /// One iteration of `settle`. Returns true if a scheduled command took a free resource.
    fn settle_once(&mut self) -> bool {
        self.mark_live();
        self.drop_closed();
        for place in 0..self.entries.len() {
            if self.is_forlorn(place) {
                self.orphan(place, false);
            }
        }
        self.take_free()
    }

    /// Computes which scheduled commands may still run and which rules may still fire. This is a least fixed point, so
    /// commands that only wait for one another in a dependency cycle are orphaned.
    fn mark_live(&mut self) {
        let entries = self.entries.iter_mut().flatten();
        entries.for_each(|e| e.live = e.command.state != State::Scheduled && !e.gone);
        self.rules.iter_mut().for_each(|p| p.open = false);
        let (mut found, mut back) = (self.open_rules(None, false), false);
        // Whether a rule may fire depends only on the commands that it mentions. Chains are usually created from one
        // end to the other, so alternating the direction reaches the fixed point in few passes.
        while !found.is_empty() {
            back = !back;
            found = self.open_rules(Some(found), back);
        }
    }

    /// Marks rules that may still fire as open, among those that mention a command in `about` (`None` for all rules).
    /// Returns the commands that became live; `back` reverses the order.
    fn open_rules(&mut self, about: Option<Names>, back: bool) -> Names {
        let (mut found, rules) = (Names::default(), self.rules.len());
        for k in 0..rules {
            let at = if back { rules - 1 - k } else { k };
            let about = about.map(|names| names.with(&found));
            let pending = &self.rules[at];
            let asked = about.is_none_or(|names| pending.names.meets(&names));
            if asked && !pending.open && self.may_fire(&pending.rule) {
                self.rules[at].open = true;
                self.enliven(at, &mut found);
            }
        }
        found
    }

    /// Marks the commands that a rule starts as live and adds the newly marked ones to `found`.
    fn enliven(&mut self, at: usize, found: &mut Names) {
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
    fn drop_closed(&mut self) {
        let (notices, spent) = (&mut self.notices, &mut self.spent);
        for Pending { id, rule, .. } in self.rules.extract_if(.., |p| !p.open) {
            let outcome = Outcome::Dropped;
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
                e.command.state == State::Scheduled
                    && needs.all(|r| self.within_reach(rule, place, r).is_ok())
            })
        };
        self.may_come_true(rule) && rule.start.iter().all(startable)
    }

    fn is_forlorn(&self, place: usize) -> bool {
        let Some(entry) = self.entries[place].as_ref() else {
            return false;
        };
        let id = self.id(place);
        let waits = entry.command.state == State::Scheduled && !entry.gone;
        waits && !self.rules.iter().any(|p| p.rule.start.contains(&id))
    }

    /// Orphans a command that nothing can start any more and releases its resources.
    pub(crate) fn orphan(&mut self, place: usize, keep: bool) {
        let command = self.id(place);
        let Some(entry) = self.entries[place].as_mut() else {
            return;
        };
        let kept = keep || entry.kept;
        entry.command.happen(Event::Orphan { kept });
        entry.command.hold_all(false);
        (entry.gone, entry.kept, entry.live) = (!kept, false, kept);
        if entry.gone {
            freeze(&mut self.rules, command, entry);
        }
        self.notices.push(Notice::Orphaned { command, kept });
    }

    /// Removes a rule from the table and reports its outcome.
    pub(crate) fn drop_rule(&mut self, at: usize, outcome: Outcome) {
        let Pending { id, rule, .. } = self.rules.remove(at);
        self.notices.push(Notice::Rule { rule: id, outcome });
        // `spent` has enough capacity: both lists together never exceed the capacity of one.
        self.spent.push((id, rule));
    }
}

/// Replaces the facts about a removed command by their final values in all rules.
pub(crate) fn freeze(rules: &mut [Pending], gone: CommandId, entry: &Entry) {
    let own: Names = [gone].into_iter().collect();
    for pending in rules.iter_mut().filter(|p| p.names.meets(&own)) {
        let condition = &mut pending.rule.condition;
        condition.freeze(gone, |fact| entry.last_word(fact));
    }
}
