//! Rules: when this holds, stop these, cancel those, start others, all between the same two cycles.

use crate::condition::{Condition, Fact};
use crate::id::{CommandId, RuleId};
use crate::names::Names;

use alloc::boxed::Box;
use alloc::vec::Vec;

/// A rule, made beside the cycle. It fires once.
///
/// `Rule::follow(a).start(b)` schedules command `b` on command `a`; `Rule::follow_by(a, &[0])` only for its first result.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Rule {
    pub(crate) condition: Condition,
    /// Commands that have ended, or are stopped, by the time it fires: what they held may be taken over.
    pub(crate) after: Vec<CommandId>,
    pub(crate) stop: Vec<CommandId>,
    pub(crate) cancel: Vec<CommandId>,
    pub(crate) start: Vec<CommandId>,
    pub(crate) kept: bool,
    /// What those that it starts are given of those that have ended.
    pub(crate) handed: Vec<Handed>,
}

/// A value that a command leaves to one that follows it.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) struct Handed {
    pub(crate) from: CommandId,
    pub(crate) export: u32,
    pub(crate) to: CommandId,
    pub(crate) input: u32,
}

impl Rule {
    /// A rule that does nothing yet when this holds.
    #[must_use]
    pub fn when(condition: Condition) -> Rule {
        Rule {
            after: condition.requires(),
            condition,
            stop: Vec::new(),
            cancel: Vec::new(),
            start: Vec::new(),
            kept: false,
            handed: Vec::new(),
        }
    }

    /// When a command has ended by itself without an error and was not cancelled.
    #[must_use]
    pub fn follow(predecessor: CommandId) -> Rule {
        Rule::when(Condition::of(predecessor, Fact::Regular))
    }

    /// As [`Rule::follow`], but only for these results (by index). Without any it never fires.
    #[must_use]
    pub fn follow_by(predecessor: CommandId, results: &[u32]) -> Rule {
        let one = |k: &u32| Condition::of(predecessor, Fact::Result(*k));
        let any = results.iter().map(one).reduce(|a, b| a | b);
        let regular = Condition::of(predecessor, Fact::Regular);
        Rule::when(match any {
            Some(any) => regular & any,
            None => !Condition::always(),
        })
    }

    /// Ends this command, or takes it off the schedule.
    #[must_use]
    pub fn stop(mut self, command: CommandId) -> Rule {
        self.stop.push(command);
        if let Err(place) = self.after.binary_search(&command) {
            self.after.insert(place, command);
        }
        self
    }

    /// Asks this command to end.
    #[must_use]
    pub fn cancel(mut self, command: CommandId) -> Rule {
        self.cancel.push(command);
        self
    }

    /// Starts this command.
    #[must_use]
    pub fn start(mut self, command: CommandId) -> Rule {
        self.start.push(command);
        self
    }

    /// Hands what a command has exported in its last cycle (by index) to an input of one that this rule starts. A value that is
    /// absent or of another size leaves the input as it is.
    #[must_use]
    pub fn hand(mut self, (from, export): (CommandId, u32), (to, input): (CommandId, u32)) -> Rule {
        self.handed.push(Handed {
            from,
            export,
            to,
            input,
        });
        self
    }

    /// Commands that nothing can start any more are ready again instead of gone.
    #[must_use]
    pub fn keep(mut self) -> Rule {
        self.kept = true;
        self
    }

    /// How much there is to look at: words of its condition, and commands that it does something to.
    pub(crate) fn weight(&self) -> usize {
        let acts_on = self.stop.len() + self.cancel.len() + self.start.len();
        self.condition.words().count() + acts_on + self.handed.len()
    }

    /// The commands that it starts.
    #[must_use]
    pub fn starts(&self) -> &[CommandId] {
        &self.start
    }

    /// The commands that will never run again once it has fired: those that must have ended, and those that it stops and that run
    /// then. `runs` tells which run already; others do if the condition cannot hold before their first cycle.
    pub fn outlives<'a>(
        &'a self,
        runs: impl Fn(CommandId) -> bool + 'a,
    ) -> impl Iterator<Item = CommandId> + 'a {
        let after = self.after.iter().copied();
        after.filter(move |c| {
            let stopped = self.stop.contains(c);
            !stopped || runs(*c) || self.condition.requires_begin_of(*c)
        })
    }

    /// All commands that its condition or its stop set names.
    pub(crate) fn mentions(&self) -> impl Iterator<Item = CommandId> + '_ {
        self.condition.commands().chain(self.stop.iter().copied())
    }
}

/// A rule in the table.
pub(crate) struct Pending {
    pub(crate) id: RuleId,
    pub(crate) rule: Box<Rule>,
    /// The commands that its condition or its stop set names.
    pub(crate) names: Names,
    /// Its condition holds at the decision of this tick.
    pub(crate) fires: bool,
    /// Its condition can still become true.
    pub(crate) open: bool,
}
