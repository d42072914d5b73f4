//! Making rules, and dropping those that can no longer fire together with the commands that only they could start.

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
    /// Makes a rule. The commands that it starts are scheduled and take at once what is free of what they need, unless
    /// somebody who ends before will hand it on. If its condition holds already, it fires at once.
    ///
    /// # Errors
    /// Gives it back, and nothing has changed, if a command that it starts is neither ready nor scheduled, needs what
    /// somebody else holds, or is asked to follow itself; or if the rule could never fire.
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

    /// As [`Core::schedule_as`], with a name that the core chooses.
    ///
    /// # Errors
    /// See there.
    pub fn schedule(
        &mut self,
        rule: Box<Rule>,
        bank: &mut dyn DeviceBank,
    ) -> Result<RuleId, (Box<Rule>, Refused)> {
        self.named += 1;
        let id = RuleId(self.named);
        self.schedule_as(id, rule, bank).map(|()| id)
    }

    /// Drops a rule; commands that only it could start are unscheduled.
    ///
    /// # Errors
    /// If there is no such rule any more.
    pub fn withdraw(&mut self, id: RuleId) -> Result<(), Refused> {
        let at = self.rules.iter().position(|p| p.id == id);
        let at = at.ok_or(Refused::Unknown)?;
        self.drop_rule(at, Outcome::Dropped);
        self.settle();
        Ok(())
    }

    /// How much all rules give to look at, whenever something has changed: see [`Core::schedule_as`].
    #[must_use]
    pub fn weight_of_rules(&self) -> usize {
        self.rules.iter().map(|p| p.rule.weight()).sum()
    }

    /// Moves out a rule that is over, to be freed off the cycle.
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

    /// True if a rule's condition may hold while what it starts has not run yet.
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

    /// Drops the rules that can no longer fire, gives up the commands that nothing can start any more, and lets those
    /// that still wait take what has become free. Called whenever a command's state has changed.
    pub(crate) fn settle(&mut self) {
        // What one takes may be out of reach for another from then on: each round but the last takes something.
        while self.settle_once() {}
    }

    /// True if a scheduled command took something that was free.
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

    /// Finds out which scheduled commands may still run and which rules may still fire: the least set that supports
    /// itself, so that commands which wait for one another in a circle are given up.
    fn mark_live(&mut self) {
        let entries = self.entries.iter_mut().flatten();
        entries.for_each(|e| e.live = e.command.state != State::Scheduled && !e.gone);
        self.rules.iter_mut().for_each(|p| p.open = false);
        let (mut found, mut back) = (self.open_rules(None, false), false);
        // Whether a rule may fire depends on the commands that it speaks of alone. Chains are mostly made from one end to the other.
        while !found.is_empty() {
            back = !back;
            found = self.open_rules(Some(found), back);
        }
    }

    /// Looks for rules that may still fire, among those that speak of one of these commands; which commands may run by them.
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

    /// What a rule starts may run; those of which that was not known are added to `found`.
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
            // There is room, as in `drop_rule`.
            spent.push((id, rule));
        }
    }

    /// True if a rule's condition may become true and all that it starts can be had then.
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

    /// Nothing can start this command any more: it gives back what it holds.
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

    /// Takes a rule out of the table and says what became of it.
    pub(crate) fn drop_rule(&mut self, at: usize, outcome: Outcome) {
        let Pending { id, rule, .. } = self.rules.remove(at);
        self.notices.push(Notice::Rule { rule: id, outcome });
        // There is room: both lists together never hold more rules than one of them has room for.
        self.spent.push((id, rule));
    }
}

/// Settles what rules ask about a command that is no more as it stands.
pub(crate) fn freeze(rules: &mut [Pending], gone: CommandId, entry: &Entry) {
    let own: Names = [gone].into_iter().collect();
    for pending in rules.iter_mut().filter(|p| p.names.meets(&own)) {
        let condition = &mut pending.rule.condition;
        condition.freeze(gone, |fact| entry.last_word(fact));
    }
}
