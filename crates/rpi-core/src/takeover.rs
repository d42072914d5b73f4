//! Prediction of takeovers: whether a command that ends in this cycle certainly has a successor.

use crate::command::Cause;
use crate::condition::{Fact, Truth};
use crate::facts::fact_holds;
use crate::ids::CommandId;
use crate::rule::Rule;
use crate::schedule::Schedule;
use rpi_device::DeviceBank;

impl Schedule {
    /// Computes, for each `yield` of the command in slot `place` or for its port `terminate`, whether ending now would
    /// certainly start a successor that takes every moving actuator. Returns true if this holds for any of them.
    pub(crate) fn latch_takeover(&mut self, place: usize, bank: &dyn DeviceBank) -> bool {
        let results = self
            .commands
            .get(place)
            .map_or(0, |e| e.command.has_successor.len());
        if results == 0 {
            return self.has_certain_successor(place, Cause::Terminate, bank);
        }
        let mut any = false;
        for k in 0..results {
            let yields = self
                .commands
                .get(place)
                .is_some_and(|e| e.command.yields(k));
            let covered = yields && self.has_certain_successor(place, Cause::Result(k), bank);
            if let Some(entry) = self.commands.get_mut(place) {
                entry.command.has_successor[k] = covered;
            }
            any |= covered;
        }
        any
    }

    fn has_certain_successor(&self, place: usize, cause: Cause, bank: &dyn DeviceBank) -> bool {
        let Some(entry) = self.commands.get(place) else {
            return false;
        };
        let (id, ending) = (self.commands.id(place), entry.command.make_ending(cause, 0));
        let know = |of: CommandId, fact: Fact| match fact {
            Fact::Export(_) if of == id => Truth::UNKNOWN,
            _ if of == id => Truth::fixed(fact_holds(fact, &ending)),
            // Values that may change later in this cycle must not promise a takeover.
            _ => self.commands.fact_truth(of, fact).fixed_part(),
        };
        self.rules.pending.iter().any(|p| {
            let after = p.rule.predecessors.contains(&id);
            after
                && p.rule.condition.evaluate(know).is_true()
                && self.takes_all_moving(&p.rule, place, bank)
        })
    }

    /// True if the commands that `rule` starts take every moving actuator of the command in slot `place`.
    fn takes_all_moving(&self, rule: &Rule, place: usize, bank: &dyn DeviceBank) -> bool {
        let takes = |resource: u32| {
            let mut starts = rule.start.iter().filter_map(|id| self.commands.find(*id));
            starts.any(|p| {
                self.commands
                    .entry(p)
                    .is_ok_and(|e| e.command.needs(resource))
            })
        };
        let entry = self.commands.get(place);
        let mut moving = entry
            .into_iter()
            .flat_map(|e| e.command.resources())
            .filter(|r| bank.is_moving(*r));
        moving.all(takes)
    }
}
