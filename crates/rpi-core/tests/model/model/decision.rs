//! Decisions: starts and ends of commands, firing of rules, and what follows from both.

use std::collections::BTreeSet;

use rpi_core::{CommandId, CommandState, Fact, RuleId};

use crate::model::brake;
use crate::model::{End, EndCause, Model, ModelCommand, ModelRule, fact_holds};

impl Model {
    pub(crate) fn begin(&mut self, id: CommandId, due: u64) {
        let needs = self.commands[&id].needs();
        for cmd in self.commands.values_mut() {
            needs.iter().for_each(|r| {
                cmd.holds.remove(r);
            });
        }
        self.change(id, |c| {
            c.holds = needs.iter().copied().collect();
            (c.state, c.due, c.first) = (CommandState::Running, due, Some(due));
        });
    }

    pub(crate) fn leave(&mut self, id: CommandId, cause: EndCause, error: i64) {
        self.change(id, |c| {
            c.end = Some(End {
                cause,
                error,
                cancelled: c.state == CommandState::Cancelling,
                cycles: c.cycles,
                left_moving: false,
            });
            (c.state, c.leaving) = (CommandState::Terminated, true);
        });
    }

    /// S3 to S6: fires a rule.
    pub(crate) fn fire(&mut self, id: RuleId, next: u64) {
        let Some(at) = self.rules.iter().position(|r| r.0 == id) else {
            return;
        };
        let (_, law, before) = self.rules[at].clone();
        let startable = law.start.iter().all(|s| self.obtainable(&law, &before, *s));
        self.rules.remove(at);
        if !startable {
            return;
        }
        for stop in &law.stop {
            match self.commands.get(stop).map(|c| (c.runs(), c.state)) {
                Some((true, _)) => self.leave(*stop, EndCause::Stopped(id), 0),
                Some((_, CommandState::Scheduled)) => self.orphan(*stop),
                _ => {}
            }
        }
        for cancel in &law.cancel {
            if self.commands.get(cancel).is_some_and(ModelCommand::runs) {
                self.change(*cancel, |c| c.state = CommandState::Cancelling);
            }
        }
        let named = law
            .condition
            .mentioned_commands()
            .into_iter()
            .chain(law.stop.iter().copied());
        let ending = named
            .filter_map(|id| self.commands.get(&id))
            .filter(|c| c.leaving);
        let due = ending.map(|c| c.due).min().unwrap_or(next);
        for start in &law.start {
            self.begin(*start, due);
            self.change(*start, |c| c.joins = true);
        }
    }

    /// S3: whether a command can get its resources now.
    pub(crate) fn obtainable(
        &self,
        law: &ModelRule,
        before: &[CommandId],
        next: CommandId,
    ) -> bool {
        let Some(cmd) = self.commands.get(&next) else {
            return false;
        };
        let gives = |h: &CommandId| {
            self.commands[h].leaving || law.stop.contains(h) || self.alternative(before, *h)
        };
        cmd.state == CommandState::Scheduled
            && cmd
                .needs()
                .iter()
                .filter(|r| !cmd.holds.contains(r))
                .all(|r| self.holders(*r).iter().all(gives))
    }

    /// R7, B2, then S7: concludes a decision.
    pub(crate) fn conclude(&mut self) {
        for cmd in self.commands.values_mut().filter(|c| c.leaving) {
            cmd.leaving = false;
            for resource in std::mem::take(&mut cmd.holds) {
                if let Some(end) = cmd
                    .end
                    .as_mut()
                    .filter(|_| self.axes.moving[resource as usize])
                {
                    end.left_moving = true;
                    brake(&mut self.axes, resource);
                }
            }
        }
        self.settle();
    }

    /// S7: drops rules and orphans commands up to a fixed point.
    pub(crate) fn settle(&mut self) {
        while self.settle_once() {}
    }

    pub(crate) fn settle_once(&mut self) -> bool {
        for cmd in self.commands.values_mut() {
            cmd.live = cmd.state != CommandState::Scheduled;
        }
        let mut open: BTreeSet<RuleId> = BTreeSet::new();
        let mut grows = true;
        while grows {
            grows = false;
            for (id, law, before) in self.rules.clone() {
                if !open.contains(&id) && self.may_fire(&law, &before) {
                    open.insert(id);
                    law.start
                        .iter()
                        .for_each(|s| self.change(*s, |c| c.live = true));
                    grows = true;
                }
            }
        }
        self.rules.retain(|r| open.contains(&r.0));
        for (id, cmd) in self.commands.clone() {
            let named = self.rules.iter().any(|r| r.1.start.contains(&id));
            if cmd.state == CommandState::Scheduled && !named {
                self.orphan(id);
            }
        }
        self.take_free()
    }

    pub(crate) fn may_fire(&self, law: &ModelRule, before: &[CommandId]) -> bool {
        let reachable = |s: &CommandId| {
            self.commands.get(s).is_some_and(|c| {
                let mut needs = c.needs().iter();
                c.state == CommandState::Scheduled
                    && needs.all(|r| self.out_of_reach((before, &law.stop), *s, *r).is_none())
            })
        };
        self.may_come_true(law) && law.start.iter().all(reachable)
    }

    /// C4: removes a command.
    pub(crate) fn remove(&mut self, id: CommandId) {
        let Some(cmd) = self.commands.remove(&id) else {
            return;
        };
        let last = |fact: Fact| match (fact, cmd.end) {
            (Fact::Export(0), Some(_)) => cmd.shown,
            (Fact::Export(_), _) => None,
            (_, end) => Some(end.is_some_and(|end| fact_holds(fact, &end))),
        };
        for (_, law, _) in &mut self.rules {
            law.condition.freeze(id, &last);
        }
    }

    pub(crate) fn orphan(&mut self, id: CommandId) {
        let kept = self.commands[&id].kept;
        if kept {
            self.change(id, |c| {
                c.holds.clear();
                (c.state, c.kept, c.live) = (CommandState::Ready, false, true);
            });
        } else {
            self.remove(id);
            self.gone.insert(id);
        }
    }
}
