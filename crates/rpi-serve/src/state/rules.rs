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

/// Record of a rule in the server: what it acts on, who made it, and who subscribes to it.
pub(super) struct RuleRecord {
    pub(super) state: RuleState,
    /// Commands that the rule stops.
    pub(super) stop: Vec<CommandId>,
    pub(super) cancel: Vec<CommandId>,
    /// Commands that the rule starts.
    pub(super) start: Vec<CommandId>,
    /// Client that made the rule.
    pub(super) client: Client,
    /// Size of the rule: facts in its condition plus commands that it acts on.
    pub(super) size: usize,
    pub(super) watchers: Subscribers,
}

impl RuleRecord {
    /// Returns whether the rule starts a command, which then takes over from those that it stops.
    pub(super) fn takes_over(&self) -> bool {
        !self.start.is_empty()
    }

    /// Returns all commands that the rule acts on.
    pub(super) fn acts_on(&self) -> impl Iterator<Item = &CommandId> {
        self.stop.iter().chain(&self.cancel).chain(&self.start)
    }
}

/// Name of the limit on the total size of rules in messages.
const RULE_SIZE_LIMIT: &str = "facts and commands in all rules";

/// Number of inactive rules that are kept, for clients that subscribe late.
const MAX_INACTIVE_RULES: usize = 4096;

/// Table of the rules, with those whose outcome is being reported.
pub(crate) struct Rules {
    records: BTreeMap<RuleId, RuleRecord>,
    /// Rules whose outcome was reported to a subscriber in this round.
    reported_rules: Vec<RuleId>,
    /// Rules that have fired before the commands they stopped are known to have run. Reported later.
    delayed_rules: Vec<RuleId>,
    /// Maximum number of active rules.
    most: usize,
    /// Maximum total size of active rules.
    facts: usize,
}

impl Rules {
    /// Creates an empty table.
    pub(super) fn new(limits: &Limits) -> Rules {
        Rules {
            records: BTreeMap::new(),
            reported_rules: Vec::new(),
            delayed_rules: Vec::new(),
            most: limits.rules,
            facts: limits.rule_size,
        }
    }

    /// Makes a rule and sends it to the core.
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

    /// Returns an error if a rule names too many commands, before the names are resolved with the state locked.
    pub(crate) fn ensure_rule_size(&self, make: &RuleRequest<'_>) -> Result<(), ApiError> {
        let named = make.stop.len() + make.cancel.len() + make.start.len();
        match named > self.facts {
            true => Err(ApiError::Limit(RULE_SIZE_LIMIT)),
            false => Ok(()),
        }
    }

    /// Returns an error if there are too many rules, or if they are too large in total: the cycle evaluates all of
    /// them.
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

    /// Drops the rules of a disconnected client that act on no command. They only served its subscriptions.
    pub(super) fn drop_idle(&self, client: Client, core: &mut CoreLink) {
        let own = self.records.iter().filter(|(_, r)| r.client == client);
        let idle =
            own.filter(|(_, r)| r.state == RuleState::Active && r.acts_on().next().is_none());
        idle.for_each(|(id, _)| core.defer_withdrawal(*id));
    }

    /// Finds a rule by the name that its client gave it. Returns the core's id and the record; an error if there is
    /// none.
    pub(super) fn find(&self, name: &str) -> Result<(RuleId, &RuleRecord), ApiError> {
        let found = parse_number(name, 'r').map(RuleId);
        let found = found.and_then(|id| Some((id, self.records.get(&id)?)));
        found.ok_or_else(|| ApiError::Unknown(format!("rule {name}")))
    }

    /// Returns an error if the rule is unknown.
    pub(crate) fn ensure_rule_exists(&self, name: &str) -> Result<(), ApiError> {
        self.find(name).map(drop)
    }

    /// Subscribes to a rule: reports its state now and when it changes.
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

    /// Returns for each rule the clients that are subscribed to it.
    pub(super) fn watchers(&mut self) -> impl Iterator<Item = &mut Subscribers> {
        self.records.values_mut().map(|r| &mut r.watchers)
    }

    /// Returns whether a rule starts a command, which then takes over from those that the rule stops.
    pub(super) fn takes_over(&self, id: RuleId) -> bool {
        self.records.get(&id).is_some_and(RuleRecord::takes_over)
    }

    /// Returns the commands that a rule stops, if it also starts one.
    fn stopped_by(&self, id: RuleId) -> Vec<CommandId> {
        let rule = self.records.get(&id).filter(|r| r.takes_over());
        rule.map(|r| r.stop.clone()).unwrap_or_default()
    }

    /// Handles the event that a rule has fired. The report is delayed until the order of updates is correct.
    pub(super) fn on_fired(&mut self, id: RuleId, commands: &mut Commands, log: &mut EventLog) {
        record_takeover(commands, &self.stopped_by(id), log);
        self.report_fired(id, commands);
    }

    /// Reports rules that have fired and could not be reported earlier.
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

    /// Handles the event that a rule has become inactive.
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

    /// Ends withholding the values of the commands that were started by rules whose outcome was reported.
    pub(super) fn release_reported(&mut self, commands: &mut Commands) {
        for rule in std::mem::take(&mut self.reported_rules) {
            self.release_started(rule, commands);
        }
    }

    /// Ends withholding the values of the commands that a rule started. The outcome of the rule must have been
    /// reported.
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

    /// Removes a rule that the core refused.
    pub(super) fn forget(&mut self, id: RuleId) {
        self.records.remove(&id);
    }
}
