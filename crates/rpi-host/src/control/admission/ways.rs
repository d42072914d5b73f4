//! How commands may yet start, and what that says about which of them never run in one tick.
//!
//! A request to start commands is a way; so is a rule. A command *outlives* those that have ended for good by whichever way it starts,
//! and those that they had outlived.

use std::collections::{BTreeMap, BTreeSet};

use rpi_core::{CommandId, RuleId};

use crate::control::event::Ticket;

/// A way in which commands may start together, or have.
#[derive(Clone, Debug)]
pub(in crate::control) struct Way {
    /// The request's, while it is under way.
    pub(super) ticket: Option<Ticket>,
    /// The rule; none if they are started at once.
    pub(super) rule: Option<RuleId>,
    pub(super) start: Vec<CommandId>,
    /// Those that never run again once these start.
    pub(super) after: Vec<CommandId>,
}

impl Way {
    /// By a request, at once.
    pub(super) fn at_once(command: CommandId) -> Way {
        Way {
            ticket: None,
            rule: None,
            start: vec![command],
            after: Vec::new(),
        }
    }
}

type Outlived = BTreeSet<CommandId>;

/// For each command those that it outlives.
pub(super) struct Order(BTreeMap<CommandId, Outlived>);

impl Order {
    pub(super) fn of<'w>(ways: impl Iterator<Item = &'w Way> + Clone) -> Order {
        let mut order = Order(BTreeMap::new());
        for command in ways.clone().flat_map(|way| &way.start) {
            order.find(*command, &ways);
        }
        order
    }

    /// Finds what a command outlives: by all of its ways. While that is looked for it outlives nothing, so that circles end.
    fn find<'w>(
        &mut self,
        command: CommandId,
        ways: &(impl Iterator<Item = &'w Way> + Clone),
    ) -> &Outlived {
        if !self.0.contains_key(&command) {
            self.0.insert(command, Outlived::new());
            let own = ways.clone().filter(|way| way.start.contains(&command));
            let by = |way: &Way| {
                let mut all: Outlived = way.after.iter().copied().collect();
                way.after
                    .iter()
                    .for_each(|a| all.extend(self.find(*a, ways)));
                all
            };
            let common = |a: Outlived, b: Outlived| a.intersection(&b).copied().collect();
            let outlived = own.map(by).reduce(common).unwrap_or_default();
            self.0.insert(command, outlived);
        }
        &self.0[&command]
    }

    /// Whether one of two commands has ended for good when the other one starts.
    pub(super) fn part(&self, a: CommandId, b: CommandId) -> bool {
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

    fn order(ways: &[(u64, &[u64])]) -> Order {
        let way = |(start, after): &(u64, &[u64])| Way {
            after: after.iter().map(|a| id(*a)).collect(),
            ..Way::at_once(id(*start))
        };
        let ways: Vec<Way> = ways.iter().map(way).collect();
        Order::of(ways.iter())
    }

    #[test]
    fn who_follows_outlives_all_before() {
        let chain = order(&[(3, &[2]), (2, &[1])]);
        assert!(chain.part(id(1), id(2)) && chain.part(id(3), id(1)));
        assert!(!chain.part(id(1), id(4)));
    }

    #[test]
    fn only_what_is_before_by_every_way_counts() {
        let two = order(&[(3, &[1, 2]), (3, &[2])]);
        assert!(two.part(id(2), id(3)) && !two.part(id(1), id(3)));
        let alone = order(&[(3, &[1, 2]), (3, &[])]);
        assert!(!alone.part(id(2), id(3)));
    }

    #[test]
    fn circles_end() {
        let circle = order(&[(1, &[2]), (2, &[1])]);
        assert!(circle.part(id(1), id(2)));
    }
}
