//! Which commands hold, reserve and pass on resources.

use rpi_core::{CommandId, CommandState};

use crate::model::Model;

impl Model {
    /// R4: the commands that keep a resource out of reach of a command to start, given the predecessors of its rule.
    pub(crate) fn out_of_reach(
        &self,
        (before, stop): (&[CommandId], &[CommandId]),
        next: CommandId,
        resource: u32,
    ) -> Option<CommandId> {
        if self.commands[&next].holds.contains(&resource) || self.will_hand_on(before, resource) {
            return None;
        }
        let holders = self.holders(resource);
        holders
            .into_iter()
            .find(|h| !self.alternative(before, *h) && !stop.contains(h))
    }

    pub(crate) fn will_hand_on(&self, before: &[CommandId], resource: u32) -> bool {
        before
            .iter()
            .filter_map(|id| self.commands.get(id))
            .any(|c| {
                let hopeless = c.state == CommandState::Scheduled && !c.live;
                c.end.is_none() && !hopeless && c.needs().contains(&resource)
            })
    }

    /// R5: whether another scheduled command is an alternative.
    pub(crate) fn alternative(&self, before: &[CommandId], other: CommandId) -> bool {
        self.commands[&other].state == CommandState::Scheduled
            && self.rules.iter().any(|(_, law, theirs)| {
                law.start.contains(&other) && theirs.iter().any(|b| before.contains(b))
            })
    }

    /// R6: scheduled commands take their free resources.
    pub(crate) fn take_free(&mut self) -> bool {
        let mut took = false;
        let mut ids: Vec<_> = self.commands.keys().copied().collect();
        ids.sort_by_key(|id| id.slot());
        for id in ids {
            for &resource in self.commands[&id].needs() {
                let mine: Vec<&[CommandId]> = self
                    .rules
                    .iter()
                    .filter(|r| r.1.start.contains(&id))
                    .map(|r| &r.2[..])
                    .collect();
                let waits = mine
                    .iter()
                    .any(|before| self.will_hand_on(before, resource));
                let free = mine.iter().all(|before| {
                    self.holders(resource)
                        .into_iter()
                        .all(|h| self.alternative(before, h))
                });
                if self.commands[&id].state == CommandState::Scheduled && !waits && free {
                    self.change(id, |c| took |= c.holds.insert(resource));
                }
            }
        }
        took
    }
}
