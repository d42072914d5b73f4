//! Admission control: the worst-case times of commands that may run together must fit the budget of a tick.
//!
//! Two commands never run in the same tick if they share an actuator, or if one of them has ended for good when the
//! other starts. The commands that run or may still start are partitioned into groups in which this holds for any two.
//! A group takes at most the time of its most expensive command, so the sum over all groups is a bound for every
//! behaviour of the rules. All of this is computed on the host before a request is sent.

mod start_order;

use std::collections::BTreeMap;
use std::fmt;

use rpi_core::{Command, CommandId, Notice, Rule, RuleId, RuleOutcome};

use super::event::{Event, Ticket};
use crate::run::time_text;
use start_order::{StartCause, StartOrder};

/// Time budget that all commands together may use in a tick.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Budget {
    /// Worst-case time of an elementary operation in nanoseconds.
    pub ns_per_operation: f64,
    /// Maximum time of all commands together in a tick, nanoseconds.
    pub granted_ns: u64,
}

/// Error: the commands would exceed their time budget in a tick.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct BudgetExceededError {
    /// Worst-case time of the commands to be started, nanoseconds.
    pub needed_ns: u64,
    /// Worst-case time of the other commands that may run at the same time, nanoseconds.
    pub taken_ns: u64,
    /// Time budget of all commands in a tick, nanoseconds.
    pub granted_ns: u64,
}

impl BudgetExceededError {
    /// Code of the error in the table of diagnostics.
    pub const CODE: &str = "RPI7003";

    /// Returns the error message. `what` names the commands that exceed the budget and is the subject of the sentence.
    #[must_use]
    pub fn message(&self, what: &str) -> String {
        let [needed, taken, granted] =
            [self.needed_ns, self.taken_ns, self.granted_ns].map(time_text);
        let code = BudgetExceededError::CODE;
        let beside = match self.taken_ns {
            0 => String::new(),
            _ => format!(", and concurrent commands {taken}"),
        };
        format!(
            "{code}: {what} may take {needed} per tick{beside}; the budget of all commands is {granted}"
        )
    }
}

impl fmt::Display for BudgetExceededError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.message("it"))
    }
}

/// Resource needs and state of a loaded command, from which admission control decides whether further commands may
/// start.
#[derive(Clone, Debug)]
struct CommandDemand {
    bound_ns: u64,
    /// Resource numbers of the actuators that the command drives, in ascending order.
    actuators: Box<[u32]>,
    /// Whether the command runs or is scheduled, according to the latest events.
    is_live: bool,
    /// Whether the command runs, according to the latest events.
    is_running: bool,
    /// Number of requests sent to the core that may start the command and are not answered yet.
    pending_starts: u32,
}

impl CommandDemand {
    /// Returns true if the command runs, is scheduled, or may be started by a request that is not answered yet.
    fn is_active(&self) -> bool {
        self.is_live || self.pending_starts > 0
    }

    /// Returns true if both commands drive a common actuator, so that they never run in the same tick.
    fn shares_actuator(&self, other: &CommandDemand) -> bool {
        let has = |a: &u32| other.actuators.binary_search(a).is_ok();
        self.actuators.iter().any(has)
    }
}

/// Admission control: checks that the worst-case times of all commands that may run in the same tick fit the budget of
/// a tick. It has the resource needs of all loaded commands, and the requests and rules by which they may start.
pub(super) struct Admission {
    budget: Option<Budget>,
    demands: BTreeMap<CommandId, CommandDemand>,
    start_causes: Vec<StartCause>,
}

impl Admission {
    pub(super) fn new(budget: Option<Budget>) -> Admission {
        Admission {
            budget,
            demands: BTreeMap::new(),
            start_causes: Vec::new(),
        }
    }

    /// Returns the worst-case time of a loaded command in a tick, in nanoseconds; 0 if there is no budget or no such
    /// command.
    pub(super) fn bound_ns(&self, id: CommandId) -> u64 {
        self.demands.get(&id).map_or(0, |demand| demand.bound_ns)
    }

    fn bound_for(&self, command: &Command) -> u64 {
        self.budget
            .map_or(0, |budget| budget.worst_case_ns(command))
    }

    /// Returns an error if a command exceeds the time budget even when it runs alone.
    pub(super) fn check_alone(&self, command: &Command) -> Result<(), BudgetExceededError> {
        let check = |budget: Budget| budget.check(budget.worst_case_ns(command));
        self.budget.map_or(Ok(()), check)
    }

    /// Adds the resource needs of a loaded command.
    pub(super) fn insert(&mut self, id: CommandId, command: &Command) {
        let mut actuators: Vec<u32> = command.resources().collect();
        actuators.sort_unstable();
        let demand = CommandDemand {
            bound_ns: self.bound_for(command),
            actuators: actuators.into(),
            is_live: false,
            is_running: false,
            pending_starts: 0,
        };
        self.demands.insert(id, demand);
    }

    /// Checks that a command can start now together with all commands that run or may still start. Returns a record of
    /// the start request, to be passed to [`Admission::request_sent`].
    pub(super) fn admit_start(
        &self,
        command: CommandId,
    ) -> Result<StartCause, BudgetExceededError> {
        self.admit(StartCause::immediate(command))
    }

    /// Checks that the commands started by a rule can run together with all commands that run or may still start.
    /// Returns a record of the rule, to be passed to [`Admission::request_sent`].
    pub(super) fn admit_rule(
        &self,
        id: RuleId,
        rule: &Rule,
    ) -> Result<StartCause, BudgetExceededError> {
        let runs = |id: CommandId| self.demands.get(&id).is_some_and(|c| c.is_running);
        self.admit(StartCause {
            ticket: None,
            rule: Some(id),
            start: rule.starts().to_vec(),
            predecessors: rule.finally_ended(runs).collect(),
        })
    }

    fn admit(&self, cause: StartCause) -> Result<StartCause, BudgetExceededError> {
        let Some(Budget { granted_ns, .. }) = self.budget else {
            return Ok(cause);
        };
        let counts =
            |id: &CommandId, demand: &CommandDemand| demand.is_active() || cause.start.contains(id);
        let all = self
            .demands
            .iter()
            .filter(|(id, demand)| counts(id, demand));
        let sum = all.clone().map(|(_, demand)| demand.bound_ns);
        if sum.fold(0, u64::saturating_add) <= granted_ns {
            return Ok(cause);
        }
        let order = StartOrder::from_causes(self.start_causes.iter().chain([&cause]));
        let total_ns = combined_bound_ns(all, &order);
        if total_ns <= granted_ns {
            return Ok(cause);
        }
        let before = self.demands.iter().filter(|(_, demand)| demand.is_active());
        let taken_ns =
            combined_bound_ns(before, &StartOrder::from_causes(self.start_causes.iter()));
        // A request that does not increase the bound is always admitted, even if the budget was reduced in the
        // meantime.
        if total_ns <= taken_ns {
            return Ok(cause);
        }
        let needed = self
            .demands
            .iter()
            .filter(|(id, _)| cause.start.contains(id));
        Err(BudgetExceededError {
            needed_ns: combined_bound_ns(needed, &order),
            taken_ns,
            granted_ns,
        })
    }

    /// Records that the request with this ticket was sent to the core. `cause` is the start request or rule that may
    /// start commands.
    pub(super) fn request_sent(&mut self, ticket: Ticket, mut cause: StartCause) {
        for id in &cause.start {
            if let Some(demand) = self.demands.get_mut(id) {
                demand.pending_starts += 1;
            }
        }
        cause.ticket = Some(ticket);
        self.start_causes.push(cause);
    }

    /// Updates the state of the commands from an event of the core.
    pub(super) fn handle_event(&mut self, event: &Event) {
        match event {
            Event::Answer {
                ticket, refused, ..
            } => self.handle_answer(*ticket, refused.is_none()),
            Event::Notice(notice) => self.handle_notice(notice),
            Event::Freed(_) | Event::Device { .. } => {}
        }
    }

    /// Removes the resource needs of a command that the core has freed.
    pub(super) fn remove(&mut self, id: CommandId) {
        self.demands.remove(&id);
        for cause in &mut self.start_causes {
            cause.start.retain(|start| *start != id);
        }
        self.start_causes
            .retain(|cause| cause.ticket.is_some() || !cause.start.is_empty());
    }

    fn handle_answer(&mut self, ticket: Ticket, accepted: bool) {
        let Some(at) = self
            .start_causes
            .iter()
            .position(|w| w.ticket == Some(ticket))
        else {
            return;
        };
        self.start_causes[at].ticket = None;
        for id in &self.start_causes[at].start {
            if let Some(demand) = self.demands.get_mut(id) {
                demand.pending_starts = demand.pending_starts.saturating_sub(1);
                demand.is_live |= accepted;
            }
        }
        if !accepted || self.start_causes[at].start.is_empty() {
            self.start_causes.remove(at);
        }
    }

    fn handle_notice(&mut self, notice: &Notice) {
        let (id, is_live, runs) = match *notice {
            Notice::Scheduled { command } => (command, true, false),
            Notice::Started { command, .. } | Notice::Cancelling { command } => {
                (command, true, true)
            }
            Notice::Ended { command, .. } | Notice::Orphaned { command, .. } => {
                (command, false, false)
            }
            Notice::Rule { rule, outcome } => return self.handle_rule_end(rule, outcome),
            Notice::Braked { .. } | Notice::Discontinuity { .. } => return,
        };
        if let Some(demand) = self.demands.get_mut(&id) {
            (demand.is_live, demand.is_running) = (is_live, runs);
        }
    }

    /// Handles the end of a rule. A rule that fired has started its commands; any other rule will never start them.
    fn handle_rule_end(&mut self, rule: RuleId, outcome: RuleOutcome) {
        if outcome != RuleOutcome::Fired {
            self.start_causes.retain(|cause| cause.rule != Some(rule));
        }
    }
}

impl Budget {
    /// Default share of the time of a tick that all commands together may use.
    pub const SHARE: f64 = 0.8;
    /// Default time of an elementary operation in nanoseconds.
    ///
    /// An operation takes twice as long with cold caches, but the bound of a generated net is far too high: nothing
    /// shows which of its fragments exclude one another. The largest net of the authors, of which at most a tenth is
    /// active at a time, fits a tick with this value, but not with twice as much.
    pub const NS_PER_OPERATION: f64 = 2.5;

    /// Returns the budget of the commands in one tick: a share of the tick (0 to 1). `ns_per_operation` is the time of
    /// one operation.
    #[must_use]
    pub fn from_share(tick_ns: u64, share: f64, ns_per_operation: f64) -> Budget {
        Budget {
            ns_per_operation,
            granted_ns: (tick_ns as f64 * share) as u64,
        }
    }

    /// Returns the worst-case time of one cycle of a command, in nanoseconds: its bound on elementary operations times
    /// the time of an operation.
    pub(crate) fn worst_case_ns(&self, command: &Command) -> u64 {
        (command.work() as f64 * self.ns_per_operation) as u64
    }

    /// Returns an error if a time, in nanoseconds, exceeds the budget of all commands.
    pub(crate) fn check(&self, needed_ns: u64) -> Result<(), BudgetExceededError> {
        match needed_ns > self.granted_ns {
            true => Err(BudgetExceededError {
                needed_ns,
                taken_ns: 0,
                granted_ns: self.granted_ns,
            }),
            false => Ok(()),
        }
    }
}

/// Returns an upper bound, in nanoseconds, on the time of these commands in one tick. Commands that never run in the
/// same tick, because they share an actuator or because of `order`, form groups that count with their most expensive
/// command.
// The greedy partition, most expensive command first, is not optimal, but any partition gives a valid bound.
fn combined_bound_ns<'a>(
    demands: impl Iterator<Item = (&'a CommandId, &'a CommandDemand)>,
    order: &StartOrder,
) -> u64 {
    let mut demands: Vec<_> = demands.collect();
    demands.sort_by_key(|(id, demand)| (u64::MAX - demand.bound_ns, **id));
    let mut groups: Vec<Vec<(&CommandId, &CommandDemand)>> = Vec::new();
    let mut total = 0_u64;
    for (id, demand) in demands {
        let apart = |(other, its): &(&CommandId, &CommandDemand)| {
            its.shares_actuator(demand) || order.are_exclusive(*id, **other)
        };
        match groups.iter_mut().find(|group| group.iter().all(apart)) {
            Some(group) => group.push((id, demand)),
            None => {
                total = total.saturating_add(demand.bound_ns);
                groups.push(vec![(id, demand)]);
            }
        }
    }
    total
}

#[cfg(test)]
mod tests;
