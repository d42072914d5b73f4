//! Rules: when a condition holds, stop, cancel and start commands.

use std::collections::BTreeMap;

use rpi_runtime::control::{CommandId, RuleId, Ticket};

use super::commands::Commands;
use super::completion::{must_delay_report, record_takeover, report_completions};
use super::core_link::CoreLink;
use super::event_log::EventLog;
use super::parse_number;
use super::rule_request::{RuleRequest, build_rule};
use super::subscribers::Subscribers;
use super::types::{ApiError, RuleState, Subscriber, Update};
use crate::fair_share::{Client, Holder, Usage};
use crate::limits::Limits;

/// Record of a rule in the server: its state, the commands that it acts on, the client that made it, and the
/// subscribers to it.
pub(super) struct RuleRecord {
    pub(super) state: RuleState,
    /// Ids of the commands that the rule stops.
    pub(super) stop: Vec<CommandId>,
    pub(super) cancel: Vec<CommandId>,
    /// Ids of the commands that the rule starts.
    pub(super) start: Vec<CommandId>,
    /// Client that made the rule.
    pub(super) client: Client,
    /// Size of the rule: number of facts in its condition plus number of commands that it acts on.
    pub(super) size: usize,
    pub(super) watchers: Subscribers,
}

impl RuleRecord {
    /// Returns whether the rule starts a command, which then takes over from the commands that the rule stops.
    pub(super) fn takes_over(&self) -> bool {
        !self.start.is_empty()
    }

    /// Returns the ids of all commands that the rule stops, cancels or starts.
    pub(super) fn acts_on(&self) -> impl Iterator<Item = &CommandId> {
        self.stop.iter().chain(&self.cancel).chain(&self.start)
    }
}

/// Name of the limit on the total size of all rules, for messages.
const RULE_SIZE_LIMIT: &str = "facts and commands in all rules";

/// Number of inactive rules (fired, failed or dropped) whose records remain, for clients that subscribe late.
const MAX_INACTIVE_RULES: usize = 4096;

/// Table of the rules of all clients, with the rules whose outcome is being reported.
pub(crate) struct Rules {
    records: BTreeMap<RuleId, RuleRecord>,
    /// Rules whose outcome was reported to a subscriber since the last call of [`Rules::release_reported`].
    reported_rules: Vec<RuleId>,
    /// Rules that have fired, but whose firing is reported later, because values of the commands that they stopped are
    /// still withheld from subscribers.
    delayed_rules: Vec<RuleId>,
    /// Maximum number of active rules.
    most: usize,
    /// Maximum total size of the active rules: facts in their conditions plus commands that they act on.
    facts: usize,
}

impl Rules {
    /// Creates an empty table with the limits of the server.
    pub(super) fn new(limits: &Limits) -> Rules {
        Rules {
            records: BTreeMap::new(),
            reported_rules: Vec::new(),
            delayed_rules: Vec::new(),
            most: limits.rules,
            facts: limits.rule_size,
        }
    }

    /// Makes a rule and sends it to the core. Returns the id of the rule and the ticket of the request to the core.
    pub(super) fn make(
        &mut self,
        make: &RuleRequest<'_>,
        commands: &Commands,
        core: &mut CoreLink,
    ) -> Result<(RuleId, Ticket), ApiError> {
        let (rule, record) = build_rule(make, commands)?;
        self.ensure_rule_quota(&record)?;
        let (id, ticket) = core.control.schedule(rule)?;
        self.records.insert(id, record);
        Ok((id, ticket))
    }

    /// Returns an error if a requested rule names more commands than the total size of rules allows. Called before the
    /// names are resolved, so that a huge request does not occupy the locked state.
    pub(crate) fn ensure_rule_size(&self, make: &RuleRequest<'_>) -> Result<(), ApiError> {
        let named = make.stop.len() + make.cancel.len() + make.start.len();
        match named > self.facts {
            true => Err(ApiError::Limit(RULE_SIZE_LIMIT)),
            false => Ok(()),
        }
    }

    /// Returns an error if with this rule there were too many active rules, or if their total size were too large; the
    /// cycle evaluates all of them in each tick.
    fn ensure_rule_quota(&self, rule: &RuleRecord) -> Result<(), ApiError> {
        let records = self.records.values();
        let active = records.filter(|r| r.state == RuleState::Active);
        let held = active.map(|r| (Holder::Connected(r.client), r.size));
        let rules = Usage::for_client(Some(rule.client), held.clone().map(|(of, _)| (of, 1)));
        let room = rules.admit(1, self.most);
        room.map_err(|full| ApiError::limit(full, "rules"))?;
        let admitted = Usage::for_client(Some(rule.client), held).admit(rule.size, self.facts);
        admitted.map_err(|full| ApiError::limit(full, RULE_SIZE_LIMIT))
    }

    /// Withdraws the active rules of a disconnected client that act on no command. Such rules only served its
    /// subscriptions.
    pub(super) fn drop_idle(&self, client: Client, core: &mut CoreLink) {
        let own = self.records.iter().filter(|(_, r)| r.client == client);
        let idle =
            own.filter(|(_, r)| r.state == RuleState::Active && r.acts_on().next().is_none());
        idle.for_each(|(id, _)| core.defer_withdrawal(*id));
    }

    /// Returns the id and the record of the rule with this name, such as `r3`; an error if there is none.
    pub(super) fn find(&self, name: &str) -> Result<(RuleId, &RuleRecord), ApiError> {
        let found = parse_number(name, 'r').map(RuleId);
        let found = found.and_then(|id| Some((id, self.records.get(&id)?)));
        found.ok_or_else(|| ApiError::Unknown(format!("rule {name}")))
    }

    /// Returns an error if there is no rule with this name.
    pub(crate) fn ensure_rule_exists(&self, name: &str) -> Result<(), ApiError> {
        self.find(name).map(drop)
    }

    /// Subscribes to the rule with this name: reports its state now and when it changes.
    pub(super) fn watch(
        &mut self,
        name: &str,
        mut sink: Box<dyn Subscriber>,
        commands: &mut Commands,
    ) -> Result<(), ApiError> {
        let (id, _) = self.find(name)?;
        let Some(rule) = self.records.get_mut(&id) else {
            return Ok(());
        };
        let listens = sink.notify(&Update::Rule(rule.state));
        if listens && rule.state == RuleState::Active {
            rule.watchers.push(sink);
        } else {
            self.release_started(id, commands);
        }
        Ok(())
    }

    /// Returns the list of subscribers of each rule.
    pub(super) fn watchers(&mut self) -> impl Iterator<Item = &mut Subscribers> {
        self.records.values_mut().map(|r| &mut r.watchers)
    }

    /// Returns whether a rule starts a command, which then takes over from those that the rule stops.
    pub(super) fn takes_over(&self, id: RuleId) -> bool {
        self.records.get(&id).is_some_and(RuleRecord::takes_over)
    }

    /// Returns the commands that a rule stops in favour of a successor; an empty list if the rule starts no command.
    fn stopped_by(&self, id: RuleId) -> Vec<CommandId> {
        let rule = self.records.get(&id).filter(|r| r.takes_over());
        rule.map(|r| r.stop.clone()).unwrap_or_default()
    }

    /// Handles the event that a rule has fired. The report to subscribers is delayed while values of a command that the
    /// rule stopped are withheld from a subscriber.
    pub(super) fn on_fired(&mut self, id: RuleId, commands: &mut Commands, log: &mut EventLog) {
        record_takeover(commands, &self.stopped_by(id), log);
        self.report_fired(id, commands);
    }

    /// Reports the rules that have fired and whose report was delayed, if it can be made now.
    pub(super) fn report_delayed_rules(&mut self, commands: &mut Commands) {
        let early = std::mem::take(&mut self.delayed_rules);
        early
            .into_iter()
            .for_each(|id| self.report_fired(id, commands));
    }

    fn report_fired(&mut self, id: RuleId, commands: &mut Commands) {
        let stopped = self.stopped_by(id);
        match must_delay_report(commands, &stopped) {
            true => self.delayed_rules.push(id),
            false => {
                report_completions(commands, &stopped);
                self.on_ended(id, RuleState::Fired);
            }
        }
    }

    /// Handles the event that a rule has become inactive: stores its new state and reports it to the subscribers.
    pub(super) fn on_ended(&mut self, id: RuleId, state: RuleState) {
        let Some(rule) = self.records.get_mut(&id) else {
            return;
        };
        rule.state = state;
        let mut watchers = std::mem::take(&mut rule.watchers);
        self.reported_rules
            .extend(Some(id).filter(|_| !watchers.is_empty()));
        watchers.notify(&Update::Rule(state));
        self.forget_oldest();
    }

    /// Lets the values of commands be reported that were withheld because the commands were started by rules. Done for
    /// all rules whose outcome was reported since the last call.
    pub(super) fn release_reported(&mut self, commands: &mut Commands) {
        for rule in std::mem::take(&mut self.reported_rules) {
            self.release_started(rule, commands);
        }
    }

    /// Lets the values of the commands be reported that the rule with this id has started. Their values are withheld
    /// until the outcome of the rule was reported.
    fn release_started(&self, id: RuleId, commands: &mut Commands) {
        let started = self.records.get(&id).map(|r| &r.start);
        for command in started.into_iter().flatten() {
            if let Some(record) = commands.record_of(*command) {
                record.subscriptions.stop_withholding();
            }
        }
    }

    fn forget_oldest(&mut self) {
        while self.records.len() > MAX_INACTIVE_RULES + self.most {
            let mut records = self.records.iter();
            let over = records.find(|(_, r)| r.state != RuleState::Active);
            let Some(id) = over.map(|(id, _)| *id) else {
                return;
            };
            self.records.remove(&id);
        }
    }

    /// Removes the record of a rule that the core refused.
    pub(super) fn forget(&mut self, id: RuleId) {
        self.records.remove(&id);
    }
}
