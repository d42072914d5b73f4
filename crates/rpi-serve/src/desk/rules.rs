//! Rules: when this holds, stop these, cancel those, start others.

use rpi_host::control::{CommandId, Condition, Fact, Rule, RuleId};
use rpi_image::{Scalar, Type};

use super::commands::results;
use super::{Desk, Failure, Reply, RuleState, Sink, Then, Update, number_of};
use crate::condition::{Expr, Saying};

/// A rule as the desk knows it.
pub(super) struct RuleRecord {
    pub(super) state: RuleState,
    /// What it stops.
    pub(super) stop: Vec<CommandId>,
    /// What it starts.
    start: Vec<CommandId>,
    watchers: Vec<Box<dyn Sink>>,
}

impl RuleRecord {
    /// Whether something that it starts takes the place of something that it stops.
    pub(super) fn takes_over(&self) -> bool {
        !self.start.is_empty()
    }
}

/// A rule to be made.
pub(crate) struct Make<'a> {
    pub(crate) when: &'a Expr,
    pub(crate) stop: &'a [&'a str],
    pub(crate) cancel: &'a [&'a str],
    pub(crate) start: &'a [&'a str],
    /// What nothing can start any more is ready again, instead of unloaded.
    pub(crate) keep: bool,
}

/// Rules that are over and still remembered, for those who ask late.
const REMEMBERED: usize = 4096;

impl Desk {
    /// Makes a rule; the reply has its name.
    pub(crate) fn make_rule(&mut self, make: &Make<'_>, reply: Reply) {
        if let Err(why) = self.may_start().or_else(|why| match make.start {
            [] => Ok(()),
            _ => Err(why),
        }) {
            return reply(Err(why));
        }
        let active = self.rules.values().filter(|r| r.state == RuleState::Active);
        if active.count() >= self.limits.rules {
            return reply(Err(Failure::Limit("rules")));
        }
        let made = self.rule(make).and_then(|(rule, record)| {
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

    /// A rule that stops a command when one of its exports is up, and does nothing else, tells by what the command ends.
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

    fn rule(&self, make: &Make<'_>) -> Result<(Rule, RuleRecord), Failure> {
        let ids = |names: &[&str]| -> Result<Vec<CommandId>, Failure> {
            names.iter().map(|name| self.core_id(name)).collect()
        };
        let (stop, cancel, start) = (ids(make.stop)?, ids(make.cancel)?, ids(make.start)?);
        let rule = Rule::when(self.condition(make.when)?);
        let mut rule = if make.keep { rule.keep() } else { rule };
        rule = stop.iter().copied().fold(rule, Rule::stop);
        rule = cancel.into_iter().fold(rule, Rule::cancel);
        rule = start.iter().copied().fold(rule, Rule::start);
        let record = RuleRecord {
            state: RuleState::Active,
            stop,
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
                        "rules ask for Booleans, and {key} of {command} is {ty}"
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

    /// Drops a rule.
    pub(crate) fn withdraw(&mut self, name: &str, reply: Reply) {
        match number_of(name, 'r').map(RuleId) {
            Some(id) if self.rules.contains_key(&id) => {
                let ticket = self.control.withdraw(id);
                self.asked(ticket, Then::Nothing, Some(reply));
            }
            _ => reply(Err(Failure::Unknown(format!("rule {name}")))),
        }
    }

    /// Fails if there is no such rule.
    pub(crate) fn find_rule(&self, name: &str) -> Result<(), Failure> {
        let known = number_of(name, 'r').is_some_and(|n| self.rules.contains_key(&RuleId(n)));
        known
            .then_some(())
            .ok_or_else(|| Failure::Unknown(format!("rule {name}")))
    }

    /// Tells somebody what has become of a rule, now and when it changes.
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

    /// A rule has fired: told once it can be understood.
    pub(super) fn rule_fired(&mut self, id: RuleId) {
        self.note_takeover(id);
        self.tell_fired(id);
    }

    /// Tells that rules have fired that could not be told before.
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

    /// A rule is over.
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

    /// Somebody knows what has become of a rule: what it started is held back no longer.
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

    /// A rule that was refused is not remembered.
    pub(super) fn forget_rule(&mut self, id: RuleId) {
        self.rules.remove(&id);
    }
}
