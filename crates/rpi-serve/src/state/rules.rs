//! Rules: when a condition holds, stop, cancel and start commands.

use std::collections::BTreeMap;

use rpi_runtime::control::{CommandId, RuleId, Ticket};

use super::commands::Commands;
use super::completion::{is_early, note_takeover, tell_completions};
use super::core_link::CoreLink;
use super::journal::Journal;
use super::number_of;
use super::rule_request::{Make, built};
use super::subscribers::Subscribers;
use super::types::{Failure, RuleState, Sink, Update};
use crate::fair::{Client, Holder, Taken};
use crate::limits::Limits;

/// State of a rule in the server.
pub(super) struct RuleRecord {
    pub(super) state: RuleState,
    /// Commands that it stops.
    pub(super) stop: Vec<CommandId>,
    pub(super) cancel: Vec<CommandId>,
    /// Commands that it starts.
    pub(super) start: Vec<CommandId>,
    /// Client that made the rule.
    pub(super) maker: Client,
    /// Size of the rule: facts in its condition plus commands that it acts on.
    pub(super) weight: usize,
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
const SAID: &str = "facts and commands in all rules";

/// Number of inactive rules that are kept, for clients that subscribe late.
const REMEMBERED: usize = 4096;

/// The rules, and those of them whose outcome is being reported.
pub(crate) struct Rules {
    records: BTreeMap<RuleId, RuleRecord>,
    /// Rules whose outcome was reported to a subscriber in this round.
    told: Vec<RuleId>,
    /// Rules that have fired before the commands they stopped are known to have run. Reported later.
    early: Vec<RuleId>,
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
            told: Vec::new(),
            early: Vec::new(),
            most: limits.rules,
            facts: limits.facts,
        }
    }

    /// Makes a rule and sends it to the core.
    pub(super) fn make(
        &mut self,
        make: &Make<'_>,
        commands: &Commands,
        core: &mut CoreLink,
    ) -> Result<(RuleId, Ticket), Failure> {
        let (rule, record) = built(make, commands)?;
        self.has_room_for(&record)?;
        let (id, ticket) = core.control.schedule(rule)?;
        self.records.insert(id, record);
        Ok((id, ticket))
    }

    /// Returns an error if a rule names too many commands, before the names are resolved with the state locked.
    pub(crate) fn may_say(&self, make: &Make<'_>) -> Result<(), Failure> {
        let named = make.stop.len() + make.cancel.len() + make.start.len();
        match named > self.facts {
            true => Err(Failure::Limit(SAID)),
            false => Ok(()),
        }
    }

    /// Returns an error if there are too many rules, or if they are too large in total: the cycle evaluates all of
    /// them.
    fn has_room_for(&self, rule: &RuleRecord) -> Result<(), Failure> {
        let records = self.records.values();
        let active = records.filter(|r| r.state == RuleState::Active);
        let held = active.map(|r| (Holder::Is(r.maker), r.weight));
        let rules = Taken::by(Some(rule.maker), held.clone().map(|(of, _)| (of, 1)));
        let room = rules.admit(1, self.most);
        room.map_err(|full| Failure::limit(full, "rules"))?;
        let said = Taken::by(Some(rule.maker), held).admit(rule.weight, self.facts);
        said.map_err(|full| Failure::limit(full, SAID))
    }

    /// Drops the rules of a disconnected client that act on no command. They only served its subscriptions.
    pub(super) fn drop_idle(&self, client: Client, core: &mut CoreLink) {
        let own = self.records.iter().filter(|(_, r)| r.maker == client);
        let idle =
            own.filter(|(_, r)| r.state == RuleState::Active && r.acts_on().next().is_none());
        idle.for_each(|(id, _)| core.owe_rule(*id));
    }

    /// Returns a rule and its id by name.
    pub(super) fn find(&self, name: &str) -> Result<(RuleId, &RuleRecord), Failure> {
        let found = number_of(name, 'r').map(RuleId);
        let found = found.and_then(|id| Some((id, self.records.get(&id)?)));
        found.ok_or_else(|| Failure::Unknown(format!("rule {name}")))
    }

    /// Returns an error if the rule is unknown.
    pub(crate) fn find_rule(&self, name: &str) -> Result<(), Failure> {
        self.find(name).map(drop)
    }

    /// Subscribes to a rule: reports its state now and when it changes.
    pub(super) fn watch(
        &mut self,
        name: &str,
        mut sink: Box<dyn Sink>,
        commands: &mut Commands,
    ) -> Result<(), Failure> {
        let (id, _) = self.find(name)?;
        let Some(rule) = self.records.get_mut(&id) else {
            return Ok(());
        };
        let listens = sink.tell(&Update::Rule(rule.state));
        if listens && rule.state == RuleState::Active {
            rule.watchers.push(sink);
        } else {
            self.release_started(id, commands);
        }
        Ok(())
    }

    /// Returns the lists of subscribers.
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

    /// Called when a rule has fired. The report is delayed until the order of updates is correct.
    pub(super) fn fired(&mut self, id: RuleId, commands: &mut Commands, log: &mut Journal) {
        note_takeover(commands, &self.stopped_by(id), log);
        self.tell_fired(id, commands);
    }

    /// Reports rules that have fired and could not be reported earlier.
    pub(super) fn tell_early(&mut self, commands: &mut Commands) {
        let early = std::mem::take(&mut self.early);
        early
            .into_iter()
            .for_each(|id| self.tell_fired(id, commands));
    }

    fn tell_fired(&mut self, id: RuleId, commands: &mut Commands) {
        let stopped = self.stopped_by(id);
        match is_early(commands, &stopped) {
            true => self.early.push(id),
            false => {
                tell_completions(commands, &stopped);
                self.over(id, RuleState::Fired);
            }
        }
    }

    /// Called when a rule has become inactive.
    pub(super) fn over(&mut self, id: RuleId, state: RuleState) {
        let Some(rule) = self.records.get_mut(&id) else {
            return;
        };
        rule.state = state;
        let mut watchers = std::mem::take(&mut rule.watchers);
        self.told.extend(Some(id).filter(|_| !watchers.is_empty()));
        watchers.tell(&Update::Rule(state));
        self.forget_oldest();
    }

    /// Ends withholding the values of the commands that were started by rules whose outcome was reported.
    pub(super) fn release_told(&mut self, commands: &mut Commands) {
        for rule in std::mem::take(&mut self.told) {
            self.release_started(rule, commands);
        }
    }

    /// Called when the outcome of a rule was reported: values of the commands that it started are no longer withheld.
    fn release_started(&self, id: RuleId, commands: &mut Commands) {
        let started = self.records.get(&id).map(|r| &r.start);
        for command in started.into_iter().flatten() {
            if let Some(record) = commands.record_of(*command) {
                record.subscriptions.release();
            }
        }
    }

    fn forget_oldest(&mut self) {
        while self.records.len() > REMEMBERED + self.most {
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
