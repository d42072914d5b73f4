//! Rules: when a condition is true, stop, cancel and start commands, all between the same two cycles.

use crate::condition::{Condition, Fact};
use crate::ids::CommandId;

use alloc::vec::Vec;

/// A rule, built outside the cycle. It fires once.
///
/// `Rule::follow(a).start(b)` schedules command `b` after command `a`; `Rule::follow_by(a, &[0])` only after its first
/// result.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Rule {
    pub(crate) condition: Condition,
    /// Predecessors in ascending order: commands that have ended or are stopped when the rule fires. Their resources
    /// can be taken over.
    pub(crate) predecessors: Vec<CommandId>,
    pub(crate) stop: Vec<CommandId>,
    pub(crate) cancel: Vec<CommandId>,
    pub(crate) start: Vec<CommandId>,
    pub(crate) keeps_orphans: bool,
    /// Values passed from ended commands to the commands that the rule starts.
    pub(crate) transfers: Vec<ValueTransfer>,
}

/// A value passed from an export of one command to an input of its successor.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) struct ValueTransfer {
    pub(crate) from: CommandId,
    pub(crate) export: u32,
    pub(crate) to: CommandId,
    pub(crate) input: u32,
}

impl Rule {
    /// A rule with this condition and no actions.
    #[must_use]
    pub fn when(condition: Condition) -> Rule {
        Rule {
            predecessors: condition.required_ends(),
            condition,
            stop: Vec::new(),
            cancel: Vec::new(),
            start: Vec::new(),
            keeps_orphans: false,
            transfers: Vec::new(),
        }
    }

    /// A rule that fires when a command has ended regularly; see [`Fact::Regular`].
    #[must_use]
    pub fn follow(predecessor: CommandId) -> Rule {
        Rule::when(Condition::from_fact(predecessor, Fact::Regular))
    }

    /// As [`Rule::follow`], but only for these results (by index). Without any result the rule never fires.
    #[must_use]
    pub fn follow_by(predecessor: CommandId, results: &[u32]) -> Rule {
        let one = |k: &u32| Condition::from_fact(predecessor, Fact::Result(*k));
        let any = results.iter().map(one).reduce(|a, b| a | b);
        let regular = Condition::from_fact(predecessor, Fact::Regular);
        Rule::when(match any {
            Some(any) => regular & any,
            None => !Condition::always(),
        })
    }

    /// Adds an action: stops this command, or unschedules it if it has not started.
    #[must_use]
    pub fn stop(mut self, command: CommandId) -> Rule {
        self.stop.push(command);
        if let Err(place) = self.predecessors.binary_search(&command) {
            self.predecessors.insert(place, command);
        }
        self
    }

    /// Adds an action: cancels this command.
    #[must_use]
    pub fn cancel(mut self, command: CommandId) -> Rule {
        self.cancel.push(command);
        self
    }

    /// Adds an action: starts this command.
    #[must_use]
    pub fn start(mut self, command: CommandId) -> Rule {
        self.start.push(command);
        self
    }

    /// Adds an action: copies an export (by index) of a predecessor's last cycle to an input of a command that this
    /// rule starts. An absent value or one of the wrong size leaves the input unchanged.
    #[must_use]
    pub fn transfer(
        mut self,
        (from, export): (CommandId, u32),
        (to, input): (CommandId, u32),
    ) -> Rule {
        self.transfers.push(ValueTransfer {
            from,
            export,
            to,
            input,
        });
        self
    }

    /// If nothing can start the rule's commands any more, they become ready again instead of being removed.
    #[must_use]
    pub fn keep_orphans(mut self) -> Rule {
        self.keeps_orphans = true;
        self
    }

    /// Evaluation cost: number of condition words plus number of actions.
    pub(crate) fn cost(&self) -> usize {
        let acts_on = self.stop.len() + self.cancel.len() + self.start.len();
        self.condition.words().count() + acts_on + self.transfers.len()
    }

    /// The commands that the rule starts.
    #[must_use]
    pub fn starts(&self) -> &[CommandId] {
        &self.start
    }

    /// Commands that never run again once the rule has fired: its predecessors, and the commands that it stops while
    /// they run. `runs` returns whether a command is running already. Other stopped commands are included only if the
    /// condition requires their first cycle.
    pub fn finally_ended<'a>(
        &'a self,
        runs: impl Fn(CommandId) -> bool + 'a,
    ) -> impl Iterator<Item = CommandId> + 'a {
        let after = self.predecessors.iter().copied();
        after.filter(move |c| {
            let stopped = self.stop.contains(c);
            !stopped || runs(*c) || self.condition.requires_start_of(*c)
        })
    }

    /// All commands in the condition and in the stop set, with duplicates.
    pub(crate) fn mentioned_commands(&self) -> impl Iterator<Item = CommandId> + '_ {
        self.condition
            .mentioned_commands()
            .chain(self.stop.iter().copied())
    }
}
