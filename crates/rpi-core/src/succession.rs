//! Who follows whom, and who holds which actuator: the decisions between two cycles.

use crate::command::Ending;
use crate::commands::{Core, Entry, Refused};
use crate::lifecycle::Event;
use rpi_device::DeviceBank;

impl Core {
    /// Checks that all a command needs is free, or will come to it from its predecessor.
    pub(crate) fn free_for(&self, place: usize, before: Option<usize>) -> Result<(), Refused> {
        for resource in self.entry(place)?.command.resources() {
            let Some(holder) = self.holder(resource) else {
                continue;
            };
            let inherited = before.is_some_and(|b| self.hands_on(b, holder, resource));
            if !inherited {
                let by = self.id(holder);
                return Err(Refused::Held { resource, by });
            }
        }
        Ok(())
    }

    fn holder(&self, resource: u32) -> Option<usize> {
        let holds = |e: &Option<Entry>| e.as_ref().is_some_and(|e| e.command.holds(resource));
        self.entries.iter().position(holds)
    }

    /// True if `place` holds a resource, or will get it from those on whom it is scheduled and needs it itself.
    fn hands_on(&self, place: usize, holder: usize, resource: u32) -> bool {
        let mut at = Some(place);
        for _ in 0..self.entries.len() {
            let Some(entry) = at.and_then(|k| self.entries.get(k)?.as_ref()) else {
                return false;
            };
            if !entry.command.needs(resource) {
                return false;
            }
            if at == Some(holder) {
                return true;
            }
            at = entry.predecessor;
        }
        false
    }

    /// Schedules `place` on `before`: takes what is free.
    pub(crate) fn join(&mut self, place: usize, before: usize, kept: bool) {
        for k in 0..self.entries[place]
            .as_ref()
            .map_or(0, |e| e.command.holds.len())
        {
            let resource = self.entries[place]
                .as_ref()
                .map_or(0, |e| e.command.holds[k].resource);
            let free = self.holder(resource).is_none();
            if let Some(entry) = self.entries[place].as_mut() {
                entry.command.holds[k].held = free;
            }
        }
        if let Some(entry) = self.entries[place].as_mut() {
            entry.command.happen(Event::Schedule);
            (entry.predecessor, entry.kept) = (Some(before), kept);
        }
        if let Some(entry) = self.entries[before].as_mut() {
            entry.successor = Some(place);
        }
    }

    /// Lets a command run from tick `due` on, holding all that it needs.
    pub(crate) fn begin(
        &mut self,
        place: usize,
        due: u64,
        event: Event,
        bank: &mut dyn DeviceBank,
    ) {
        if let Some(entry) = self.entries[place].as_mut() {
            entry.command.happen(event);
            entry.command.hold_all(true);
            (entry.due, entry.predecessor) = (due, None);
            let ticks = u32::try_from(entry.ticks).unwrap_or(u32::MAX);
            entry.command.resources().for_each(|r| bank.pace(r, ticks));
        }
    }

    /// Ends a command: its successor takes over if it may, and what then moves uncontrolled is stopped.
    pub(crate) fn end(&mut self, place: usize, ending: Ending, bank: &mut dyn DeviceBank) {
        let Some(entry) = self.entries[place].as_mut() else {
            return;
        };
        entry.command.happen(Event::End);
        entry.command.ending = Some(ending);
        let (due, result) = (entry.due, entry.command.result_id());
        let successor = entry.successor.take();
        let follows = successor.filter(|_| ending.is_regular());
        let left_moving = self.stop_uncovered(place, follows, bank);
        if let Some(entry) = self.entries[place].as_mut() {
            entry.command.hold_all(false);
            entry.command.ending = Some(Ending {
                left_moving,
                ..ending
            });
        }
        match (follows, successor) {
            (Some(next), _) => self.fire(next, due, result, bank),
            (None, Some(next)) => self.orphan(next, false),
            (None, None) => {}
        }
    }

    fn fire(&mut self, place: usize, due: u64, result: Option<i64>, bank: &mut dyn DeviceBank) {
        self.begin(place, due, Event::Fire, bank);
        if let Some(entry) = self.entries[place].as_mut() {
            entry.command.moment.predecessor = result;
        }
    }

    /// Stops every actuator of a command that moves and that its successor does not take; true if there was one.
    fn stop_uncovered(
        &mut self,
        place: usize,
        next: Option<usize>,
        bank: &mut dyn DeviceBank,
    ) -> bool {
        let next = next.and_then(|k| self.entries[k].as_ref());
        let Some(entry) = self.entries[place].as_ref() else {
            return false;
        };
        let mut any = false;
        for hold in &entry.command.holds {
            let taken = next.is_some_and(|n| n.command.needs(hold.resource));
            if hold.held && !taken && bank.moving(hold.resource) {
                bank.stop(hold.resource);
                any = true;
            }
        }
        any
    }

    /// Nothing can start this command any more: it gives back what it holds, and so does who waits for it.
    pub(crate) fn orphan(&mut self, place: usize, keep: bool) {
        let mut at = Some((place, keep));
        while let Some((k, keep)) = at {
            let Some(entry) = self.entries[k].as_mut() else {
                return;
            };
            let kept = keep || entry.kept;
            if entry.command.happen(Event::Orphan { kept }) == crate::Next::Refused {
                return;
            }
            entry.command.hold_all(false);
            entry.gone = !kept;
            let before = entry.predecessor.take();
            let after = entry.successor.take();
            if let Some(before) = before.and_then(|b| self.entries[b].as_mut()) {
                before.successor = None;
            }
            at = after.map(|next| (next, false));
        }
    }

    pub(crate) fn orphan_successor(&mut self, place: usize) {
        let successor = self.entries[place]
            .as_mut()
            .and_then(|e| e.successor.take());
        if let Some(next) = successor {
            self.orphan(next, false);
        }
    }

    /// True if a successor is scheduled that takes every actuator which moves now.
    pub(crate) fn covered(&self, place: usize, bank: &dyn DeviceBank) -> bool {
        let entry = self.entries.get(place).and_then(|e| e.as_ref());
        let next = entry.and_then(|e| self.entries.get(e.successor?)?.as_ref());
        let (Some(entry), Some(next)) = (entry, next) else {
            return false;
        };
        let mut moving = entry.command.resources().filter(|r| bank.moving(*r));
        moving.all(|r| next.command.needs(r))
    }
}
