//! Allocation of resources (actuators) to commands.

use crate::error::CommandError;
use crate::lifecycle::CommandState;
use crate::rule::Rule;
use crate::schedule::Schedule;

impl Schedule {
    /// Checks that the command in slot `place`, which `rule` starts, holds the resource, can take it, or gets it from a
    /// predecessor. The error names the command that holds it.
    pub(crate) fn check_reachable(
        &self,
        rule: &Rule,
        place: usize,
        resource: u32,
    ) -> Result<(), CommandError> {
        let has = self.commands.entry(place)?.command.holds(resource);
        if has || self.comes_from_predecessor(rule, resource) {
            return Ok(());
        }
        let mut others = self.commands.holders(resource);
        match others
            .find(|h| !self.is_alternative(rule, *h) && !rule.stop.contains(&self.commands.id(*h)))
        {
            Some(by) => Err(self.commands.resource_held_error(resource, by)),
            None => Ok(()),
        }
    }

    /// True if a predecessor of the rule needs this resource and will pass it on.
    pub(crate) fn comes_from_predecessor(&self, rule: &Rule, resource: u32) -> bool {
        let before = rule
            .predecessors
            .iter()
            .filter_map(|id| self.commands.find(*id));
        before
            .filter_map(|place| self.commands.get(place))
            .any(|e| e.is_live() && e.command.needs(resource))
    }

    /// True if the command in slot `holder` waits for the end of a command for which `rule` waits too, so that at most
    /// one of both starts.
    fn is_alternative(&self, rule: &Rule, holder: usize) -> bool {
        let scheduled = self
            .commands
            .get(holder)
            .is_some_and(|e| e.command.state == CommandState::Scheduled);
        let id = self.commands.id(holder);
        let common = |other: &Rule| {
            other
                .predecessors
                .iter()
                .any(|a| rule.predecessors.contains(a))
        };
        scheduled
            && self
                .rules
                .pending
                .iter()
                .any(|p| p.rule.start.contains(&id) && common(&p.rule))
    }

    /// Checks, when `rule` fires, that the command at index `place` of the command table can be started: each of its
    /// resources is free, reserved by the command itself, or held by a command that ends now or is an alternative: of
    /// both at most one starts.
    pub(crate) fn check_obtainable(&self, rule: &Rule, place: usize) -> Result<(), CommandError> {
        let command = &self.commands.entry(place)?.command;
        let others = self.commands.entries.iter().enumerate();
        let held = others.filter_map(|(holder, entry)| {
            let entry = entry.as_ref().filter(|_| holder != place)?;
            let resource = command.first_conflict(&entry.command)?;
            let free = self.is_ending(rule, holder) || self.is_alternative(rule, holder);
            (!free).then_some((resource, holder))
        });
        match held.min() {
            Some((resource, by)) => Err(self.commands.resource_held_error(resource, by)),
            None => Ok(()),
        }
    }

    /// True if the command in slot `holder` ends in the current decision, by itself or stopped by `rule`.
    fn is_ending(&self, rule: &Rule, holder: usize) -> bool {
        let leaving = self.commands.get(holder).is_some_and(|e| e.ending);
        leaving || rule.stop.contains(&self.commands.id(holder))
    }

    /// Lets every scheduled command take its free resources, except those that a predecessor passes on. Returns true if
    /// any was taken.
    pub(crate) fn take_free(&mut self) -> bool {
        let mut took = false;
        for place in 0..self.commands.len() {
            let lacks = self.commands.get(place).is_some_and(|e| {
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

    /// Marks the resources that the scheduled command in slot `place` cannot take now: those that a predecessor passes
    /// on and those of unrelated commands.
    fn mark_unavailable(&mut self, place: usize) {
        let id = self.commands.id(place);
        for k in 0..self.need_count(place) {
            self.set_unavailable(place, k, false);
        }
        for at in 0..self.rules.pending.len() {
            if !self.rules.pending[at].rule.start.contains(&id) {
                continue;
            }
            for k in 0..self.need_count(place) {
                if self.is_unavailable(&self.rules.pending[at].rule, place, k) {
                    self.set_unavailable(place, k, true);
                }
            }
        }
    }

    fn is_unavailable(&self, rule: &Rule, place: usize, k: usize) -> bool {
        self.lacking_resource(place, k).is_some_and(|resource| {
            let mut others = self.commands.holders(resource);
            self.comes_from_predecessor(rule, resource)
                || others.any(|h| !self.is_alternative(rule, h))
        })
    }

    fn set_unavailable(&mut self, place: usize, k: usize, unavailable: bool) {
        let entry = self.commands.get_mut(place);
        if let Some(hold) = entry.and_then(|e| e.command.resource_uses.get_mut(k)) {
            hold.is_unavailable = unavailable;
        }
    }

    fn take_available(&mut self, place: usize) -> bool {
        let entry = self.commands.get_mut(place);
        let holds = entry
            .into_iter()
            .flat_map(|e| e.command.resource_uses.iter_mut());
        let free = holds.filter(|hold| !hold.is_held && !hold.is_unavailable);
        free.map(|hold| hold.is_held = true).count() > 0
    }

    fn need_count(&self, place: usize) -> usize {
        self.commands
            .get(place)
            .map_or(0, |e| e.command.resource_uses.len())
    }

    /// Returns the resource with index `k` in the needs of the command in slot `place`; `None` if the command holds it
    /// or cannot take it.
    fn lacking_resource(&self, place: usize, k: usize) -> Option<u32> {
        let entry = self.commands.get(place)?;
        let hold = entry
            .command
            .resource_uses
            .get(k)
            .filter(|h| !h.is_held && !h.is_unavailable);
        hold.map(|hold| hold.resource)
    }
}
