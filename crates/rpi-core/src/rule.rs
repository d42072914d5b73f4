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
    /// Predecessors in ascending order: commands that have ended when the rule fires, or that the rule stops. The
    /// started commands can take over their resources.
    pub(crate) predecessors: Vec<CommandId>,
    pub(crate) stop: Vec<CommandId>,
    pub(crate) cancel: Vec<CommandId>,
    pub(crate) start: Vec<CommandId>,
    pub(crate) keeps_orphans: bool,
    /// Values that the rule copies from exports of ended commands to inputs of the commands that it starts.
    pub(crate) transfers: Vec<ValueTransfer>,
}

/// A value to copy from an export of one command to an input of its successor.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) struct ValueTransfer {
    pub(crate) from: CommandId,
    pub(crate) export: u32,
    pub(crate) to: CommandId,
    pub(crate) input: u32,
}

impl Rule {
    /// Creates a rule with this condition and no actions.
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

    /// Creates a rule that fires when a command has ended regularly: by a result, without an error and without a
    /// cancel.
    #[must_use]
    pub fn follow(predecessor: CommandId) -> Rule {
        Rule::when(Condition::from_fact(predecessor, Fact::Regular))
    }

    /// Creates a rule that fires when the command `predecessor` has ended regularly by one of these results, given by
    /// their indices. Without any result the rule never fires.
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

    /// Adds an action: copies an export of a predecessor's last cycle to an input of a command that this rule starts.
    /// Each pair is a command and the index of its export or input. An absent value or one of the wrong size leaves the
    /// input unchanged.
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

    /// Makes the commands of the rule ready again, instead of removing them, if no rule can start them any more.
    #[must_use]
    pub fn keep_orphans(mut self) -> Rule {
        self.keeps_orphans = true;
        self
    }

    /// Cost of one evaluation: number of words of the condition plus number of actions.
    pub(crate) fn cost(&self) -> usize {
        let acts_on = self.stop.len() + self.cancel.len() + self.start.len();
        self.condition.words().count() + acts_on + self.transfers.len()
    }

    /// Returns the commands that the rule starts.
    #[must_use]
    pub fn starts(&self) -> &[CommandId] {
        &self.start
    }

    /// Returns the commands that never run again once the rule has fired: its predecessors, and the commands that it
    /// stops while they run. `runs` returns whether a command is running already. Other stopped commands are included
    /// only if the condition requires their first cycle.
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

    /// Returns all commands in the condition, then those that the rule stops, with duplicates.
    pub(crate) fn mentioned_commands(&self) -> impl Iterator<Item = CommandId> + '_ {
        self.condition
            .mentioned_commands()
            .chain(self.stop.iter().copied())
    }
}
