//! Causes by which commands may start, and the order that these causes imply between commands.
//!
//! A cause is a request or a rule that starts commands. A command *outlives* all commands that have ended for good by
//! every cause by which it may start, and the commands that those outlive.

use std::collections::{BTreeMap, BTreeSet};

use rpi_core::{CommandId, RuleId};

use crate::control::event::Ticket;

/// Cause by which one or more commands start together: a start request or a rule.
#[derive(Clone, Debug)]
pub(in crate::control) struct StartCause {
    /// Ticket of the request to the core; `None` once the request is answered.
    pub(super) ticket: Option<Ticket>,
    /// Rule that starts the commands; `None` if a request starts them directly.
    pub(super) rule: Option<RuleId>,
    pub(super) start: Vec<CommandId>,
    /// Commands that never run again once the commands in `start` run, because the rule requires that they have ended.
    pub(super) predecessors: Vec<CommandId>,
}

impl StartCause {
    /// Returns the cause for a request that starts a command directly.
    pub(super) fn immediate(command: CommandId) -> StartCause {
        StartCause {
            ticket: None,
            rule: None,
            start: vec![command],
            predecessors: Vec::new(),
        }
    }
}

type Outlived = BTreeSet<CommandId>;

/// For each command, the set of commands that have ended for good before it starts. From these sets, admission control
/// derives which commands never run in the same tick.
pub(super) struct StartOrder(BTreeMap<CommandId, Outlived>);

impl StartOrder {
    pub(super) fn from_causes<'w>(
        causes: impl Iterator<Item = &'w StartCause> + Clone,
    ) -> StartOrder {
        let mut order = StartOrder(BTreeMap::new());
        for command in causes.clone().flat_map(|cause| &cause.start) {
            order.compute_outlived(*command, &causes);
        }
        order
    }

    /// Computes and stores the commands that have ended for good before a command starts: those for which this holds
    /// for every cause by which the command may start.
    ///
    /// During the computation the set of the command is empty, so the recursion ends for cyclic rules.
    fn compute_outlived<'w>(
        &mut self,
        command: CommandId,
        causes: &(impl Iterator<Item = &'w StartCause> + Clone),
    ) -> &Outlived {
        if !self.0.contains_key(&command) {
            self.0.insert(command, Outlived::new());
            let own = causes
                .clone()
                .filter(|cause| cause.start.contains(&command));
            let by = |cause: &StartCause| {
                let mut all: Outlived = cause.predecessors.iter().copied().collect();
                cause
                    .predecessors
                    .iter()
                    .for_each(|a| all.extend(self.compute_outlived(*a, causes)));
                all
            };
            let common = |a: Outlived, b: Outlived| a.intersection(&b).copied().collect();
            let outlived = own.map(by).reduce(common).unwrap_or_default();
            self.0.insert(command, outlived);
        }
        &self.0[&command]
    }

    /// Returns true if one of the two commands has ended for good when the other one starts, so that they never run in
    /// the same tick.
    pub(super) fn are_exclusive(&self, a: CommandId, b: CommandId) -> bool {
        let outlives = |a, b| self.0.get(&a).is_some_and(|o| o.contains(&b));
        outlives(a, b) || outlives(b, a)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn id(number: u64) -> CommandId {
        CommandId::from_number(number)
    }

    fn order(causes: &[(u64, &[u64])]) -> StartOrder {
        let cause = |(start, after): &(u64, &[u64])| StartCause {
            predecessors: after.iter().map(|a| id(*a)).collect(),
            ..StartCause::immediate(id(*start))
        };
        let causes: Vec<StartCause> = causes.iter().map(cause).collect();
        StartOrder::from_causes(causes.iter())
    }

    #[test]
    fn who_follows_outlives_all_before() {
        let chain = order(&[(3, &[2]), (2, &[1])]);
        assert!(chain.are_exclusive(id(1), id(2)) && chain.are_exclusive(id(3), id(1)));
        assert!(!chain.are_exclusive(id(1), id(4)));
    }

    #[test]
    fn only_what_is_before_by_every_way_counts() {
        let two = order(&[(3, &[1, 2]), (3, &[2])]);
        assert!(two.are_exclusive(id(2), id(3)) && !two.are_exclusive(id(1), id(3)));
        let alone = order(&[(3, &[1, 2]), (3, &[])]);
        assert!(!alone.are_exclusive(id(2), id(3)));
    }

    #[test]
    fn circles_end() {
        let circle = order(&[(1, &[2]), (2, &[1])]);
        assert!(circle.are_exclusive(id(1), id(2)));
    }
}
