//! Allocation of resources (actuators) to commands.

use crate::lifecycle::CommandState;
use crate::rule::Rule;
use crate::table::{CommandError, Core};

impl Core {
    /// Slot indices of all commands that hold a resource: one running command, or several scheduled alternatives.
    pub(crate) fn holders(&self, resource: u32) -> impl Iterator<Item = usize> + '_ {
        let holds = move |(place, entry): (usize, &Option<crate::table::Entry>)| {
            let holds = entry.as_ref().is_some_and(|e| e.command.holds(resource));
            holds.then_some(place)
        };
        self.entries.iter().enumerate().filter_map(holds)
    }

    /// Checks that all resources of a command are free.
    pub(crate) fn check_resources_free(&self, place: usize) -> Result<(), CommandError> {
        let mut needs = self.entry(place)?.command.resources();
        needs.try_for_each(|resource| match self.holders(resource).next() {
            Some(by) => Err(self.resource_held_error(resource, by)),
            None => Ok(()),
        })
    }

    pub(crate) fn resource_held_error(&self, resource: u32, by: usize) -> CommandError {
        CommandError::ResourceHeld {
            resource,
            by: self.id(by),
        }
    }

    /// Checks that a command started by a rule has a resource, can take it, or gets it from a predecessor.
    pub(crate) fn check_reachable(
        &self,
        rule: &Rule,
        place: usize,
        resource: u32,
    ) -> Result<(), CommandError> {
        let has = self.entry(place)?.command.holds(resource);
        if has || self.comes_from_predecessor(rule, resource) {
            return Ok(());
        }
        let mut others = self.holders(resource);
        match others.find(|h| !self.is_alternative(rule, *h) && !rule.stop.contains(&self.id(*h))) {
            Some(by) => Err(self.resource_held_error(resource, by)),
            None => Ok(()),
        }
    }

    /// True if a predecessor of the rule needs this resource and will pass it on.
    pub(crate) fn comes_from_predecessor(&self, rule: &Rule, resource: u32) -> bool {
        let before = rule.predecessors.iter().filter_map(|id| self.find(*id));
        before
            .filter_map(|place| self.entries[place].as_ref())
            .any(|e| e.is_live() && e.command.needs(resource))
    }

    /// True if the holder is scheduled after the same command as this rule, so that both are alternatives.
    fn is_alternative(&self, rule: &Rule, holder: usize) -> bool {
        let scheduled = self.entries[holder]
            .as_ref()
            .is_some_and(|e| e.command.state == CommandState::Scheduled);
        let id = self.id(holder);
        let common = |other: &Rule| {
            other
                .predecessors
                .iter()
                .any(|a| rule.predecessors.contains(a))
        };
        scheduled
            && self
                .rules
                .iter()
                .any(|p| p.rule.start.contains(&id) && common(&p.rule))
    }

    /// Checks at firing time that a command's resources are its own, or free, or held by commands that end now or are
    /// alternatives.
    pub(crate) fn check_obtainable(&self, rule: &Rule, place: usize) -> Result<(), CommandError> {
        let command = &self.entry(place)?.command;
        let others = self.entries.iter().enumerate();
        let held = others.filter_map(|(holder, entry)| {
            let entry = entry.as_ref().filter(|_| holder != place)?;
            let resource = command.first_conflict(&entry.command)?;
            let free = self.is_ending(rule, holder) || self.is_alternative(rule, holder);
            (!free).then_some((resource, holder))
        });
        match held.min() {
            Some((resource, by)) => Err(self.resource_held_error(resource, by)),
            None => Ok(()),
        }
    }

    /// True if the holder ends in the current decision, on its own or by this rule.
    fn is_ending(&self, rule: &Rule, holder: usize) -> bool {
        let leaving = self.entries[holder].as_ref().is_some_and(|e| e.ending);
        leaving || rule.stop.contains(&self.id(holder))
    }

    /// Assigns all needed resources to a command and takes them from every other command.
    pub(crate) fn take_all(&mut self, place: usize) {
        let Some(entry) = self.entries[place].as_mut() else {
            return;
        };
        // Moved out for the loop: the command itself then has no holds that `yield_to` could release.
        let mut holds = core::mem::take(&mut entry.command.resource_uses);
        for other in self.entries.iter_mut().flatten() {
            other.command.release_to(&holds);
        }
        holds.iter_mut().for_each(|hold| hold.is_held = true);
        if let Some(entry) = self.entries[place].as_mut() {
            entry.command.resource_uses = holds;
        }
    }

    /// Lets every scheduled command take its free resources, except those that a predecessor passes on. Returns true if
    /// any was taken.
    pub(crate) fn take_free(&mut self) -> bool {
        let mut took = false;
        for place in 0..self.entries.len() {
            let lacks = self.entries[place].as_ref().is_some_and(|e| {
                let waits = e.command.state == CommandState::Scheduled && !e.orphaned;
                waits && e.command.resource_uses.iter().any(|hold| !hold.is_held)
            });
            if lacks {
                self.mark_unavailable(place);
                took |= self.take_available(place);
            }
        }
        took
    }

    /// Marks the resources that a scheduled command cannot take now: those from a predecessor and those of unrelated
    /// commands.
    fn mark_unavailable(&mut self, place: usize) {
        let id = self.id(place);
        for k in 0..self.need_count(place) {
            self.set_unavailable(place, k, false);
        }
        for at in 0..self.rules.len() {
            if !self.rules[at].rule.start.contains(&id) {
                continue;
            }
            for k in 0..self.need_count(place) {
                if self.is_unavailable(&self.rules[at].rule, place, k) {
                    self.set_unavailable(place, k, true);
                }
            }
        }
    }

    fn is_unavailable(&self, rule: &Rule, place: usize, k: usize) -> bool {
        self.lacking_resource(place, k).is_some_and(|resource| {
            let mut others = self.holders(resource);
            self.comes_from_predecessor(rule, resource)
                || others.any(|h| !self.is_alternative(rule, h))
        })
    }

    fn set_unavailable(&mut self, place: usize, k: usize, unfree: bool) {
        let entry = self.entries[place].as_mut();
        if let Some(hold) = entry.and_then(|e| e.command.resource_uses.get_mut(k)) {
            hold.is_unavailable = unfree;
        }
    }

    fn take_available(&mut self, place: usize) -> bool {
        let entry = self.entries[place].as_mut();
        let holds = entry
            .into_iter()
            .flat_map(|e| e.command.resource_uses.iter_mut());
        let free = holds.filter(|hold| !hold.is_held && !hold.is_unavailable);
        free.map(|hold| hold.is_held = true).count() > 0
    }

    fn need_count(&self, place: usize) -> usize {
        self.entries[place]
            .as_ref()
            .map_or(0, |e| e.command.resource_uses.len())
    }

    /// The k-th needed resource, if it is neither held nor marked as unfree.
    fn lacking_resource(&self, place: usize, k: usize) -> Option<u32> {
        let entry = self.entries.get(place)?.as_ref()?;
        let hold = entry
            .command
            .resource_uses
            .get(k)
            .filter(|h| !h.is_held && !h.is_unavailable);
        hold.map(|hold| hold.resource)
    }
}
