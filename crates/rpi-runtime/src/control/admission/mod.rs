//! Admission control: the worst-case times of commands that may run together must fit the budget of a tick.
//!
//! Two commands never run in the same tick if they share an actuator, or if one of them has ended for good when the
//! other starts. The commands that run or may still start are partitioned into groups in which this holds for any two.
//! A group takes at most the time of its most expensive command, so the sum over all groups is a bound for every
//! behaviour of the rules. All of this is computed on the host before a request is sent.

mod ways;

use std::collections::BTreeMap;
use std::fmt;

use rpi_core::{Command, CommandId, Notice, Outcome, Rule, RuleId};

use super::event::{Event, Ticket};
use crate::run::time_text;
use ways::{Order, Way};

/// Time budget of all commands in a tick.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Budget {
    /// Worst-case time of an elementary operation in nanoseconds.
    pub ns_per_operation: f64,
    /// Maximum time of all commands in a tick together, nanoseconds.
    pub granted_ns: u64,
}

/// Error: the commands would exceed their time budget in a tick.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct TooMuch {
    /// Worst-case time of the commands to be started, nanoseconds.
    pub needed_ns: u64,
    /// Worst-case time of the commands that may run at the same time, nanoseconds.
    pub taken_ns: u64,
    /// Time budget of all commands, nanoseconds.
    pub granted_ns: u64,
}

impl TooMuch {
    /// Code of the error in the table of diagnostics.
    pub const CODE: &str = "RPI7003";

    /// Returns the error message. `what` is the subject of the sentence.
    #[must_use]
    pub fn told(&self, what: &str) -> String {
        let [needed, taken, granted] =
            [self.needed_ns, self.taken_ns, self.granted_ns].map(time_text);
        let code = TooMuch::CODE;
        let beside = match self.taken_ns {
            0 => String::new(),
            _ => format!(", and concurrent commands {taken}"),
        };
        format!(
            "{code}: {what} may take {needed} per tick{beside}; the budget of all commands is {granted}"
        )
    }
}

impl fmt::Display for TooMuch {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.told("it"))
    }
}

/// Resource needs and state of a command.
#[derive(Clone, Debug)]
struct Claim {
    bound_ns: u64,
    /// Actuators of the command, in ascending order.
    actuators: Box<[u32]>,
    /// Whether the command runs or is scheduled, according to the latest events.
    is_live: bool,
    /// Whether the command runs, according to the latest events.
    runs: bool,
    /// Number of unanswered requests that may start the command.
    asked: u32,
}

impl Claim {
    /// Returns true if the command takes time now or may still do so.
    fn counts(&self) -> bool {
        self.is_live || self.asked > 0
    }

    /// Returns true if both commands need a common actuator.
    fn meets(&self, other: &Claim) -> bool {
        let has = |a: &u32| other.actuators.binary_search(a).is_ok();
        self.actuators.iter().any(has)
    }
}

/// Admission state: the resource needs of all loaded commands and the ways in which they may start.
pub(super) struct Admission {
    budget: Option<Budget>,
    claims: BTreeMap<CommandId, Claim>,
    ways: Vec<Way>,
}

impl Admission {
    pub(super) fn new(budget: Option<Budget>) -> Admission {
        Admission {
            budget,
            claims: BTreeMap::new(),
            ways: Vec::new(),
        }
    }

    /// Returns the worst-case time of a loaded command in a tick, nanoseconds.
    pub(super) fn bound_ns(&self, id: CommandId) -> u64 {
        self.claims.get(&id).map_or(0, |claim| claim.bound_ns)
    }

    fn bound_of(&self, command: &Command) -> u64 {
        self.budget.map_or(0, |budget| budget.time_of(command))
    }

    /// Returns an error if a command exceeds the budget even when it runs alone.
    pub(super) fn fits(&self, command: &Command) -> Result<(), TooMuch> {
        let fits = |budget: Budget| budget.grants(budget.time_of(command));
        self.budget.map_or(Ok(()), fits)
    }

    /// Adds a loaded command.
    pub(super) fn enter(&mut self, id: CommandId, command: &Command) {
        let mut actuators: Vec<u32> = command.resources().collect();
        actuators.sort_unstable();
        let claim = Claim {
            bound_ns: self.bound_of(command),
            actuators: actuators.into(),
            is_live: false,
            runs: false,
            asked: 0,
        };
        self.claims.insert(id, claim);
    }

    /// Checks that a command can start now together with all commands that run or may still start. Returns the [`Way`]
    /// to pass to [`Admission::ask`].
    pub(super) fn admit_start(&self, command: CommandId) -> Result<Way, TooMuch> {
        self.admit(Way::at_once(command))
    }

    /// Checks that the commands started by a rule can run together with all commands that run or may still start.
    /// Returns the [`Way`] to pass to [`Admission::ask`].
    pub(super) fn admit_rule(&self, id: RuleId, rule: &Rule) -> Result<Way, TooMuch> {
        let runs = |id: CommandId| self.claims.get(&id).is_some_and(|c| c.runs);
        self.admit(Way {
            ticket: None,
            rule: Some(id),
            start: rule.starts().to_vec(),
            after: rule.outlives(runs).collect(),
        })
    }

    fn admit(&self, way: Way) -> Result<Way, TooMuch> {
        let Some(Budget { granted_ns, .. }) = self.budget else {
            return Ok(way);
        };
        let counts = |id: &CommandId, claim: &Claim| claim.counts() || way.start.contains(id);
        let all = self.claims.iter().filter(|(id, claim)| counts(id, claim));
        let sum = all.clone().map(|(_, claim)| claim.bound_ns);
        if sum.fold(0, u64::saturating_add) <= granted_ns {
            return Ok(way);
        }
        let order = Order::of(self.ways.iter().chain([&way]));
        let total_ns = together(all, &order);
        if total_ns <= granted_ns {
            return Ok(way);
        }
        let before = self.claims.iter().filter(|(_, claim)| claim.counts());
        let taken_ns = together(before, &Order::of(self.ways.iter()));
        // A request that does not increase the bound is always admitted, even if the budget was reduced in the
        // meantime.
        if total_ns <= taken_ns {
            return Ok(way);
        }
        let needed = self.claims.iter().filter(|(id, _)| way.start.contains(id));
        Err(TooMuch {
            needed_ns: together(needed, &order),
            taken_ns,
            granted_ns,
        })
    }

    /// Records that a request that may start commands was sent.
    pub(super) fn ask(&mut self, ticket: Ticket, mut way: Way) {
        for id in &way.start {
            if let Some(claim) = self.claims.get_mut(id) {
                claim.asked += 1;
            }
        }
        way.ticket = Some(ticket);
        self.ways.push(way);
    }

    /// Updates the state from an event.
    pub(super) fn hear(&mut self, event: &Event) {
        match event {
            Event::Answer {
                ticket, refused, ..
            } => self.answered(*ticket, refused.is_none()),
            Event::Notice(notice) => self.note(notice),
            Event::Freed(_) | Event::Device { .. } => {}
        }
    }

    /// Removes a freed command.
    pub(super) fn forget(&mut self, id: CommandId) {
        self.claims.remove(&id);
        for way in &mut self.ways {
            way.start.retain(|start| *start != id);
        }
        self.ways
            .retain(|way| way.ticket.is_some() || !way.start.is_empty());
    }

    fn answered(&mut self, ticket: Ticket, accepted: bool) {
        let Some(at) = self.ways.iter().position(|w| w.ticket == Some(ticket)) else {
            return;
        };
        self.ways[at].ticket = None;
        for id in &self.ways[at].start {
            if let Some(claim) = self.claims.get_mut(id) {
                claim.asked = claim.asked.saturating_sub(1);
                claim.is_live |= accepted;
            }
        }
        if !accepted || self.ways[at].start.is_empty() {
            self.ways.remove(at);
        }
    }

    fn note(&mut self, notice: &Notice) {
        let (id, is_live, runs) = match *notice {
            Notice::Scheduled { command } => (command, true, false),
            Notice::Started { command, .. } | Notice::Cancelling { command } => {
                (command, true, true)
            }
            Notice::Ended { command, .. } | Notice::Orphaned { command, .. } => {
                (command, false, false)
            }
            Notice::Rule { rule, outcome } => return self.rule_over(rule, outcome),
            Notice::Braked { .. } | Notice::Jumped { .. } => return,
        };
        if let Some(claim) = self.claims.get_mut(&id) {
            (claim.is_live, claim.runs) = (is_live, runs);
        }
    }

    /// Handles the end of a rule. A rule that fired has started its commands; any other rule will never start them.
    fn rule_over(&mut self, rule: RuleId, outcome: Outcome) {
        if outcome != Outcome::Fired {
            self.ways.retain(|way| way.rule != Some(rule));
        }
    }
}

impl Budget {
    /// Default share of a tick that all commands may take together.
    pub const SHARE: f64 = 0.8;
    /// Default time of an elementary operation in nanoseconds.
    ///
    /// An operation takes twice as long with cold caches, but the bound of a generated net is far too high: nothing
    /// shows which of its fragments exclude one another. The largest net of the authors, of which at most a tenth is
    /// active at a time, fits a tick with this value, but not with twice as much.
    pub const NS_PER_OPERATION: f64 = 2.5;

    /// Returns the budget for a share of a tick, from 0 to 1.
    #[must_use]
    pub fn of(tick_ns: u64, share: f64, ns_per_operation: f64) -> Budget {
        Budget {
            ns_per_operation,
            granted_ns: (tick_ns as f64 * share) as u64,
        }
    }

    /// Returns the worst-case time of a command in a tick, nanoseconds.
    pub(crate) fn time_of(&self, command: &Command) -> u64 {
        (command.work() as f64 * self.ns_per_operation) as u64
    }

    /// Returns an error if the time exceeds the budget on its own.
    pub(crate) fn grants(&self, needed_ns: u64) -> Result<(), TooMuch> {
        match needed_ns > self.granted_ns {
            true => Err(TooMuch {
                needed_ns,
                taken_ns: 0,
                granted_ns: self.granted_ns,
            }),
            false => Ok(()),
        }
    }
}

/// Returns a bound for the time of these commands in one tick: the sum over all groups of mutually exclusive commands
/// of the most expensive member.
// The greedy partition, most expensive command first, is not optimal, but any partition gives a valid bound.
fn together<'a>(claims: impl Iterator<Item = (&'a CommandId, &'a Claim)>, order: &Order) -> u64 {
    let mut claims: Vec<_> = claims.collect();
    claims.sort_by_key(|(id, claim)| (u64::MAX - claim.bound_ns, **id));
    let mut groups: Vec<Vec<(&CommandId, &Claim)>> = Vec::new();
    let mut total = 0_u64;
    for (id, claim) in claims {
        let apart =
            |(other, its): &(&CommandId, &Claim)| its.meets(claim) || order.part(*id, **other);
        match groups.iter_mut().find(|group| group.iter().all(apart)) {
            Some(group) => group.push((id, claim)),
            None => {
                total = total.saturating_add(claim.bound_ns);
                groups.push(vec![(id, claim)]);
            }
        }
    }
    total
}

#[cfg(test)]
mod tests;
