//! Rules: when a condition holds, stop, cancel and start commands.

use std::collections::BTreeSet;

use rpi_image::{Scalar, Type};
use rpi_runtime::control::{CommandId, Condition, Fact, Rule, RuleId};

use super::commands::results;
use super::{Client, Desk, Failure, Reply, RuleState, Sink, Then, Update, number_of};
use crate::condition::{Expr, Saying};
use crate::fair::{Holder, Taken};

/// State of a rule in the server.
pub(super) struct RuleRecord {
    pub(super) state: RuleState,
    /// Commands that it stops.
    pub(super) stop: Vec<CommandId>,
    cancel: Vec<CommandId>,
    /// Commands that it starts.
    start: Vec<CommandId>,
    /// Client that made the rule.
    maker: Client,
    /// Size of the rule: facts in its condition plus commands that it acts on.
    weight: usize,
    pub(super) watchers: Vec<Box<dyn Sink>>,
}

impl RuleRecord {
    /// Returns whether the rule starts a command, which then takes over from those that it stops.
    pub(super) fn takes_over(&self) -> bool {
        !self.start.is_empty()
    }

    /// Returns all commands that the rule acts on.
    fn acts_on(&self) -> impl Iterator<Item = &CommandId> {
        self.stop.iter().chain(&self.cancel).chain(&self.start)
    }
}

/// A request to make a rule.
pub(crate) struct Make<'a> {
    pub(crate) when: &'a Expr,
    pub(crate) stop: &'a [&'a str],
    pub(crate) cancel: &'a [&'a str],
    pub(crate) start: &'a [&'a str],
    /// Client that makes the rule.
    pub(crate) maker: Client,
    /// Whether a command that can no longer be started becomes ready again instead of being unloaded.
    pub(crate) keep: bool,
}

/// Name of the limit on the total size of rules in messages.
const SAID: &str = "facts and commands in all rules";

/// Number of inactive rules that are kept, for clients that subscribe late.
const REMEMBERED: usize = 4096;

impl Desk {
    /// Makes a rule. The reply has its name.
    pub(crate) fn make_rule(&mut self, make: &Make<'_>, reply: Reply) {
        if let Err(why) = self.may_start().or_else(|why| match make.start {
            [] => Ok(()),
            _ => Err(why),
        }) {
            return reply(Err(why));
        }
        let made = self.may_ask().and_then(|()| self.rule(make));
        let made = made.and_then(|(rule, record)| {
            self.has_room_for(&record)?;
            let (id, ticket) = self.control.schedule(rule)?;
            self.rules.insert(id, record);
            Ok((id, ticket))
        });
        match made {
            Ok((id, ticket)) => {
                self.note_result(make);
                self.asked(Ok(ticket), Then::Made(id), Some(reply));
            }
            Err(why) => reply(Err(why)),
        }
    }

    /// Notes the result that ends a command: a rule that only stops a command, when one of its exports is true,
    /// declares that export as such a result.
    fn note_result(&mut self, make: &Make<'_>) {
        let (Expr::Said(command, Saying::Export(key)), [stop], [], []) =
            (make.when, make.stop, make.cancel, make.start)
        else {
            return;
        };
        let number = number_of(stop, 'n').filter(|_| command == stop);
        let record = number.and_then(|n| self.commands.get_mut(&n));
        if let Some(record) = record.filter(|r| !r.ends_by.contains(key)) {
            record.ends_by.push(key.clone());
        }
    }

    /// Returns an error if a rule names too many commands, before the names are resolved with the state locked.
    pub(crate) fn may_say(&self, make: &Make<'_>) -> Result<(), Failure> {
        let named = make.stop.len() + make.cancel.len() + make.start.len();
        match named > self.limits.facts {
            true => Err(Failure::Limit(SAID)),
            false => Ok(()),
        }
    }

    /// Returns an error if there are too many rules, or if they are too large in total: the cycle evaluates all of
    /// them.
    fn has_room_for(&self, rule: &RuleRecord) -> Result<(), Failure> {
        let active = self.rules.values().filter(|r| r.state == RuleState::Active);
        let held = active.map(|r| (Holder::Is(r.maker), r.weight));
        let rules = Taken::by(Some(rule.maker), held.clone().map(|(of, _)| (of, 1)));
        let room = rules.admit(1, self.limits.rules);
        room.map_err(|full| Failure::limit(full, "rules"))?;
        let said = Taken::by(Some(rule.maker), held).admit(rule.weight, self.limits.facts);
        said.map_err(|full| Failure::limit(full, SAID))
    }

    /// Drops the rules of a disconnected client that act on no command. They only served its subscriptions.
    pub(super) fn drop_idle_rules(&mut self, client: Client) {
        let own = self.rules.iter().filter(|(_, r)| r.maker == client);
        let idle =
            own.filter(|(_, r)| r.state == RuleState::Active && r.acts_on().next().is_none());
        let idle: Vec<RuleId> = idle.map(|(id, _)| *id).collect();
        idle.into_iter().for_each(|id| self.owe_rule(id));
    }

    fn rule(&self, make: &Make<'_>) -> Result<(Rule, RuleRecord), Failure> {
        // The sets to stop and cancel may have duplicates. A duplicate to start is an error, which the core reports.
        let set = |names: &[&str]| -> Result<Vec<CommandId>, Failure> {
            let ids: Result<BTreeSet<CommandId>, Failure> =
                names.iter().map(|name| self.core_id(name)).collect();
            Ok(ids?.into_iter().collect())
        };
        let start: Result<Vec<CommandId>, Failure> =
            make.start.iter().map(|name| self.core_id(name)).collect();
        let (stop, cancel, start) = (set(make.stop)?, set(make.cancel)?, start?);
        let rule = Rule::when(self.condition(make.when)?);
        let mut rule = if make.keep { rule.keep() } else { rule };
        rule = stop.iter().copied().fold(rule, Rule::stop);
        rule = cancel.iter().copied().fold(rule, Rule::cancel);
        rule = start.iter().copied().fold(rule, Rule::start);
        let record = RuleRecord {
            state: RuleState::Active,
            maker: make.maker,
            weight: make.when.facts() + stop.len() + cancel.len() + start.len(),
            stop,
            cancel,
            start,
            watchers: Vec::new(),
        };
        Ok((rule, record))
    }

    fn condition(&self, expr: &Expr) -> Result<Condition, Failure> {
        Ok(match expr {
            Expr::True => Condition::always(),
            Expr::False => !Condition::always(),
            Expr::Not(inner) => !self.condition(inner)?,
            Expr::And(a, b) => self.condition(a)? & self.condition(b)?,
            Expr::Or(a, b) => self.condition(a)? | self.condition(b)?,
            Expr::Said(command, saying) => {
                Condition::of(self.core_id(command)?, self.fact(command, saying)?)
            }
        })
    }

    fn fact(&self, command: &str, saying: &Saying) -> Result<Fact, Failure> {
        let (_, record) = self.find(command)?;
        let image = record.image.as_deref();
        let place = |what: &str, key: &str, found: Option<usize>| {
            let index = found.and_then(|k| u32::try_from(k).ok());
            index.ok_or_else(|| Failure::Unknown(format!("{what} {key} of {command}")))
        };
        Ok(match saying {
            Saying::Export(key) => {
                let exports = image.map_or(&[][..], |i| &i.exports);
                let found = exports.iter().position(|e| e.key == *key);
                let ty = found.map(|k| exports[k].value.ty);
                if let Some(ty) = ty.filter(|ty| *ty != Type::One(Scalar::Bool)) {
                    return Err(Failure::Bad(format!(
                        "expected a Boolean export, found {key} of {command} of type {ty}"
                    )));
                }
                Fact::Export(place("export", key, found)?)
            }
            Saying::Result(name) => {
                let found = image.and_then(|i| results(i).iter().position(|r| r == name));
                Fact::Result(place("result", name, found)?)
            }
            Saying::Error(number) => Fact::Error(*number),
            Saying::Ended => Fact::Ended,
            Saying::Regular => Fact::Regular,
            Saying::Failed => Fact::Failed,
        })
    }

    /// Withdraws a rule, if the client may act on all commands of the rule.
    pub(crate) fn withdraw(&mut self, client: Client, name: &str, reply: Reply) {
        let may = self
            .may_ask()
            .and_then(|()| self.may_withdraw(client, name));
        match may {
            Ok(id) => {
                let ticket = self.control.withdraw(id);
                self.asked(ticket, Then::Nothing, Some(reply));
            }
            Err(why) => reply(Err(why)),
        }
    }

    fn may_withdraw(&self, client: Client, name: &str) -> Result<RuleId, Failure> {
        let found = number_of(name, 'r').map(RuleId);
        let found = found.and_then(|id| Some((id, self.rules.get(&id)?)));
        let (id, rule) = found.ok_or_else(|| Failure::Unknown(format!("rule {name}")))?;
        let commands = rule.acts_on().filter_map(|id| self.by_id.get(id));
        let mut records = commands.filter_map(|number| self.commands.get(number));
        records.try_for_each(|r| self.may_act_in(client, r.session, name))?;
        Ok(id)
    }

    /// Returns an error if the rule is unknown.
    pub(crate) fn find_rule(&self, name: &str) -> Result<(), Failure> {
        let known = number_of(name, 'r').is_some_and(|n| self.rules.contains_key(&RuleId(n)));
        known
            .then_some(())
            .ok_or_else(|| Failure::Unknown(format!("rule {name}")))
    }

    /// Subscribes to a rule: reports its state now and when it changes.
    pub(crate) fn watch_rule(
        &mut self,
        name: &str,
        mut sink: Box<dyn Sink>,
    ) -> Result<(), Failure> {
        let id = number_of(name, 'r').map(RuleId);
        let rule = id.and_then(|id| self.rules.get_mut(&id));
        let rule = rule.ok_or_else(|| Failure::Unknown(format!("rule {name}")))?;
        let listens = sink.tell(&Update::Rule(rule.state));
        if listens && rule.state == RuleState::Active {
            rule.watchers.push(sink);
        } else if let Some(id) = id {
            self.rule_told(id);
        }
        Ok(())
    }

    /// Called when a rule has fired. The report is delayed until the order of updates is correct.
    pub(super) fn rule_fired(&mut self, id: RuleId) {
        self.note_takeover(id);
        self.tell_fired(id);
    }

    /// Reports rules that have fired and could not be reported earlier.
    pub(super) fn tell_early(&mut self) {
        let early = std::mem::take(&mut self.early);
        early.into_iter().for_each(|id| self.tell_fired(id));
    }

    fn tell_fired(&mut self, id: RuleId) {
        match self.is_early(id) {
            true => self.early.push(id),
            false => {
                self.tell_completions(id);
                self.rule_over(id, RuleState::Fired);
            }
        }
    }

    /// Called when a rule has become inactive.
    pub(super) fn rule_over(&mut self, id: RuleId, state: RuleState) {
        let Some(rule) = self.rules.get_mut(&id) else {
            return;
        };
        rule.state = state;
        let watchers = std::mem::take(&mut rule.watchers);
        let told = !watchers.is_empty();
        for mut sink in watchers {
            sink.tell(&Update::Rule(state));
        }
        self.told.extend(Some(id).filter(|_| told));
        self.forget_rules();
    }

    /// Called when the outcome of a rule was reported: values of the commands that it started are no longer withheld.
    pub(super) fn rule_told(&mut self, id: RuleId) {
        let started = self.rules.get(&id).map(|r| r.start.clone());
        for command in started.into_iter().flatten() {
            if let Some(record) = self.record_of(command) {
                record.release();
            }
        }
    }

    fn forget_rules(&mut self) {
        while self.rules.len() > REMEMBERED + self.limits.rules {
            let over = self
                .rules
                .iter()
                .find(|(_, r)| r.state != RuleState::Active);
            let Some(id) = over.map(|(id, _)| *id) else {
                return;
            };
            self.rules.remove(&id);
        }
    }

    /// Removes a rule that the core refused.
    pub(super) fn forget_rule(&mut self, id: RuleId) {
        self.rules.remove(&id);
    }
}
