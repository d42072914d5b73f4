//! A second implementation of the control core as the manual describes it, as simple as possible.
//!
//! It shares only type names with the core. Numbers in comments are the rules of the manual's chapter.

use std::collections::{BTreeMap, BTreeSet};

use rpi_core::{
    AbortReason, Cause, CommandError, CommandId, CommandState, Continuity, Fact, RuleId,
};

use crate::cell::{Axes, KINDS, MAX_CONTINUOUS_CHANGE, end};
use crate::expr::{Expr, KnownFact};

/// The end of a command.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(crate) struct End {
    pub(crate) cause: EndCause,
    pub(crate) error: i64,
    pub(crate) cancelled: bool,
    pub(crate) cycles: u64,
    pub(crate) left_moving: bool,
}

/// A cause without the details of a fault.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(crate) enum EndCause {
    Result(usize),
    Fault,
    Aborted(AbortReason),
    Stopped(RuleId),
}

impl From<Cause> for EndCause {
    fn from(cause: Cause) -> EndCause {
        match cause {
            Cause::Result(k) => EndCause::Result(k),
            Cause::Terminate => EndCause::Result(usize::MAX),
            Cause::Fault(_) => EndCause::Fault,
            Cause::Aborted(why) => EndCause::Aborted(why),
            Cause::Stopped(rule) => EndCause::Stopped(rule),
        }
    }
}

#[derive(Clone, Debug)]
pub(crate) struct ModelCommand {
    pub(crate) kind: usize,
    pub(crate) guard: Continuity,
    /// The command was started by a rule.
    pub(crate) joins: bool,
    pub(crate) state: CommandState,
    pub(crate) holds: BTreeSet<u32>,
    pub(crate) kept: bool,
    pub(crate) cycles: u64,
    pub(crate) due: u64,
    pub(crate) first: Option<u64>,
    pub(crate) end: Option<End>,
    /// Inputs.
    pub(crate) how: i64,
    pub(crate) flag: bool,
    pub(crate) speed: f64,
    /// Export after the latest cycle.
    shown: Option<bool>,
    covered: bool,
    leaving: bool,
    live: bool,
}

impl ModelCommand {
    fn needs(&self) -> &'static [u32] {
        KINDS[self.kind].0
    }

    fn runs(&self) -> bool {
        matches!(self.state, CommandState::Running | CommandState::Cancelling)
    }
}

#[derive(Clone, Debug)]
pub(crate) struct ModelRule {
    pub(crate) condition: Expr,
    pub(crate) stop: Vec<CommandId>,
    pub(crate) cancel: Vec<CommandId>,
    pub(crate) start: Vec<CommandId>,
    pub(crate) kept: bool,
}

impl ModelRule {
    /// R3: predecessors of the rule.
    fn predecessors(&self) -> Vec<CommandId> {
        let names = self.condition.mentioned_commands().into_iter();
        let required = names.filter(|id| self.condition.requires(*id));
        required.chain(self.stop.iter().copied()).collect()
    }
}

pub(crate) struct Model {
    pub(crate) commands: BTreeMap<CommandId, ModelCommand>,
    pub(crate) rules: Vec<(RuleId, ModelRule, Vec<CommandId>)>,
    pub(crate) axes: Axes,
    pub(crate) tick: u64,
    /// A discontinuity in this tick stops all commands.
    stops: bool,
    pub(crate) room: usize,
    /// Orphaned commands that wait to be taken out.
    pub(crate) gone: BTreeSet<CommandId>,
}

type Answer = Result<(), CommandError>;

impl Model {
    pub(crate) fn new(room: usize) -> Model {
        Model {
            commands: BTreeMap::new(),
            rules: Vec::new(),
            axes: Axes::new(),
            tick: 0,
            stops: false,
            room,
            gone: BTreeSet::new(),
        }
    }

    pub(crate) fn insert(&mut self, id: CommandId, kind: usize, guard: Continuity) {
        let cmd = ModelCommand {
            kind,
            guard,
            joins: false,
            state: CommandState::Ready,
            holds: BTreeSet::new(),
            kept: false,
            cycles: 0,
            due: 0,
            first: None,
            end: None,
            how: 0,
            flag: false,
            speed: 0.0,
            shown: None,
            covered: false,
            leaving: false,
            live: true,
        };
        self.commands.insert(id, cmd);
    }

    fn cmd(&self, id: CommandId) -> Result<&ModelCommand, CommandError> {
        self.commands.get(&id).ok_or(CommandError::Unknown)
    }

    fn holders(&self, resource: u32) -> Vec<CommandId> {
        let holds = self
            .commands
            .iter()
            .filter(|(_, c)| c.holds.contains(&resource));
        // Same order as the table of the core.
        let mut all: Vec<_> = holds.map(|(id, _)| *id).collect();
        all.sort_by_key(|id| id.slot());
        all
    }

    // ---------------------------------------------------------------- requests

    /// R2: starts a command.
    pub(crate) fn start(&mut self, id: CommandId) -> Answer {
        let cmd = self.cmd(id)?;
        if cmd.state != CommandState::Ready {
            return Err(CommandError::InvalidState(cmd.state));
        }
        for &resource in cmd.needs() {
            if let Some(&by) = self.holders(resource).first() {
                return Err(CommandError::ResourceHeld { resource, by });
            }
        }
        self.begin(id, self.tick);
        self.conclude();
        Ok(())
    }

    pub(crate) fn cancel(&mut self, id: CommandId) -> Answer {
        let cmd = self.cmd(id)?;
        if !cmd.runs() {
            return Err(CommandError::InvalidState(cmd.state));
        }
        self.change(id, |c| c.state = CommandState::Cancelling);
        self.settle();
        Ok(())
    }

    pub(crate) fn abort(&mut self, id: CommandId, why: AbortReason) -> Answer {
        let cmd = self.cmd(id)?;
        if !cmd.runs() {
            return Err(CommandError::InvalidState(cmd.state));
        }
        self.leave(id, EndCause::Aborted(why), -1);
        self.conclude();
        Ok(())
    }

    pub(crate) fn unschedule(&mut self, id: CommandId) -> Answer {
        let cmd = self.cmd(id)?;
        if cmd.state != CommandState::Scheduled {
            return Err(CommandError::InvalidState(cmd.state));
        }
        self.change(id, |c| c.kept = true);
        self.orphan(id);
        self.settle();
        Ok(())
    }

    /// L: the last row but one of the lifecycle; C4.
    pub(crate) fn unload(&mut self, id: CommandId) -> Answer {
        let cmd = self.cmd(id)?;
        if cmd.runs() {
            return Err(CommandError::InvalidState(cmd.state));
        }
        if cmd.state == CommandState::Scheduled {
            self.unschedule(id)?;
        }
        self.remove(id);
        self.settle();
        Ok(())
    }

    pub(crate) fn withdraw(&mut self, rule: RuleId) -> Answer {
        let at = self
            .rules
            .iter()
            .position(|r| r.0 == rule)
            .ok_or(CommandError::Unknown)?;
        self.rules.remove(at);
        self.settle();
        Ok(())
    }

    /// B5: aborts all commands.
    pub(crate) fn emergency_stop(&mut self) {
        self.stop_all(AbortReason::EmergencyStop);
    }

    fn stop_all(&mut self, why: AbortReason) {
        self.rules.clear();
        for id in self.running() {
            self.leave(id, EndCause::Aborted(why), -1);
        }
        self.conclude();
    }

    /// R4, S8: adds a rule.
    pub(crate) fn schedule(&mut self, id: RuleId, law: &ModelRule) -> Answer {
        let before = law.predecessors();
        if self.rules.len() >= self.room {
            return Err(CommandError::TableFull);
        }
        for (k, next) in law.start.iter().enumerate() {
            if law.start[..k].contains(next) || before.contains(next) {
                return Err(CommandError::SelfSuccessor);
            }
            let state = self.cmd(*next)?.state;
            if !matches!(state, CommandState::Ready | CommandState::Scheduled) {
                return Err(CommandError::InvalidState(state));
            }
        }
        for (k, next) in law.start.iter().enumerate() {
            for &resource in self.cmd(*next)?.needs() {
                if let Some(by) = self.out_of_reach((&before, &law.stop), *next, resource) {
                    return Err(CommandError::ResourceHeld { resource, by });
                }
                let needs = |id: &&CommandId| self.commands[id].needs().contains(&resource);
                if let Some(&by) = law.start[..k].iter().find(needs) {
                    return Err(CommandError::ResourceHeld { resource, by });
                }
            }
        }
        if !self.may_come_true(law) {
            return Err(CommandError::NeverFires);
        }
        for next in &law.start {
            self.change(*next, |c| {
                (c.state, c.live) = (CommandState::Scheduled, true);
                c.kept |= law.kept;
            });
        }
        self.rules.push((id, law.clone(), before));
        self.settle();
        let made = self.rules.iter().any(|r| r.0 == id);
        if made && self.is_true(law) {
            self.fire(id, self.tick);
            self.conclude();
        }
        Ok(())
    }

    // ---------------------------------------------------------------- conditions

    /// C2 to C4: knowledge about a fact.
    fn know(&self, id: CommandId, fact: Fact) -> KnownFact {
        let Some(cmd) = self.commands.get(&id) else {
            return KnownFact::NEVER;
        };
        let hopeless = cmd.state == CommandState::Scheduled && !cmd.live;
        if let Fact::Export(index) = fact {
            let now = cmd.shown.filter(|_| index == 0);
            return match cmd.state {
                _ if hopeless => KnownFact::NEVER,
                CommandState::Terminated => KnownFact { now, settled: true },
                _ => KnownFact {
                    now,
                    settled: false,
                },
            };
        }
        let Some(end) = cmd.end else {
            let dead = fact == Fact::Regular && cmd.state == CommandState::Cancelling;
            return KnownFact {
                now: Some(false),
                settled: hopeless || dead,
            };
        };
        KnownFact {
            now: Some(fact_holds(fact, &end)),
            settled: true,
        }
    }

    /// S8: the commands that a rule starts have not run when it fires.
    fn may_come_true(&self, law: &ModelRule) -> bool {
        let know = |id: CommandId, fact: Fact| match fact {
            Fact::Export(_) if law.start.contains(&id) => KnownFact::NEVER,
            _ if law.start.contains(&id) => KnownFact {
                now: Some(false),
                settled: true,
            },
            _ => self.know(id, fact),
        };
        law.condition.may_be(true, &know)
    }

    fn is_true(&self, law: &ModelRule) -> bool {
        law.condition.value(&|id, fact| self.know(id, fact)) == Some(true)
    }

    // ---------------------------------------------------------------- resources

    /// R4: the commands that keep a resource out of reach of a command to start, given the predecessors of its rule.
    fn out_of_reach(
        &self,
        (before, stop): (&[CommandId], &[CommandId]),
        next: CommandId,
        resource: u32,
    ) -> Option<CommandId> {
        if self.commands[&next].holds.contains(&resource) || self.will_hand_on(before, resource) {
            return None;
        }
        let holders = self.holders(resource);
        holders
            .into_iter()
            .find(|h| !self.alternative(before, *h) && !stop.contains(h))
    }

    fn will_hand_on(&self, before: &[CommandId], resource: u32) -> bool {
        before
            .iter()
            .filter_map(|id| self.commands.get(id))
            .any(|c| {
                let hopeless = c.state == CommandState::Scheduled && !c.live;
                c.end.is_none() && !hopeless && c.needs().contains(&resource)
            })
    }

    /// R5: whether another scheduled command is an alternative.
    fn alternative(&self, before: &[CommandId], other: CommandId) -> bool {
        self.commands[&other].state == CommandState::Scheduled
            && self.rules.iter().any(|(_, law, theirs)| {
                law.start.contains(&other) && theirs.iter().any(|b| before.contains(b))
            })
    }

    /// R6: scheduled commands take their free resources.
    fn take_free(&mut self) -> bool {
        let mut took = false;
        let mut ids: Vec<_> = self.commands.keys().copied().collect();
        ids.sort_by_key(|id| id.slot());
        for id in ids {
            for &resource in self.commands[&id].needs() {
                let mine: Vec<&[CommandId]> = self
                    .rules
                    .iter()
                    .filter(|r| r.1.start.contains(&id))
                    .map(|r| &r.2[..])
                    .collect();
                let waits = mine
                    .iter()
                    .any(|before| self.will_hand_on(before, resource));
                let free = mine.iter().all(|before| {
                    self.holders(resource)
                        .into_iter()
                        .all(|h| self.alternative(before, h))
                });
                if self.commands[&id].state == CommandState::Scheduled && !waits && free {
                    self.change(id, |c| took |= c.holds.insert(resource));
                }
            }
        }
        took
    }

    // ---------------------------------------------------------------- decision

    fn begin(&mut self, id: CommandId, due: u64) {
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

    fn leave(&mut self, id: CommandId, cause: EndCause, error: i64) {
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
    fn fire(&mut self, id: RuleId, next: u64) {
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
    fn obtainable(&self, law: &ModelRule, before: &[CommandId], next: CommandId) -> bool {
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
    fn conclude(&mut self) {
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
    fn settle(&mut self) {
        while self.settle_once() {}
    }

    fn settle_once(&mut self) -> bool {
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

    fn may_fire(&self, law: &ModelRule, before: &[CommandId]) -> bool {
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
    fn remove(&mut self, id: CommandId) {
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

    fn orphan(&mut self, id: CommandId) {
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

    // ---------------------------------------------------------------- cycle

    fn running(&self) -> Vec<CommandId> {
        let mut all: Vec<_> = self.commands.keys().copied().collect();
        all.retain(|id| self.commands[id].runs());
        all.sort_by_key(|id| id.slot());
        all
    }

    pub(crate) fn run_tick(&mut self) {
        let mut due = self.running();
        due.retain(|id| self.commands[id].due == self.tick);
        for id in &due {
            let covered = self.covered(*id);
            self.change(*id, |c| c.covered = covered);
        }
        let accepted = self.axes.failed.map(|failed| !failed);
        for id in &due {
            self.cycle(*id, accepted);
        }
        for id in &due {
            self.ends(*id);
        }
        if std::mem::take(&mut self.stops) {
            self.stop_all(AbortReason::Discontinuity);
        }
        let fires: Vec<RuleId> = self
            .rules
            .iter()
            .filter(|r| self.is_true(&r.1))
            .map(|r| r.0)
            .collect();
        let next = self.tick + 1;
        fires.into_iter().for_each(|id| self.fire(id, next));
        self.conclude();
        self.tick += 1;
    }

    /// T1, for the only `yield` of the test commands.
    fn covered(&self, id: CommandId) -> bool {
        let cmd = &self.commands[&id];
        let end = End {
            cause: EndCause::Result(1),
            error: 0,
            cancelled: cmd.state == CommandState::Cancelling,
            cycles: 0,
            left_moving: false,
        };
        let know = |of: CommandId, fact: Fact| match fact {
            Fact::Export(_) if of == id => KnownFact {
                now: None,
                settled: false,
            },
            _ if of == id => KnownFact {
                now: Some(fact_holds(fact, &end)),
                settled: true,
            },
            _ => {
                let known = self.know(of, fact);
                KnownFact {
                    now: known.now.filter(|_| known.settled),
                    ..known
                }
            }
        };
        let moving = |r: &&u32| self.axes.moving[**r as usize];
        self.rules.iter().any(|(_, law, before)| {
            before.contains(&id)
                && law.condition.value(&know) == Some(true)
                && cmd.needs().iter().filter(moving).all(|r| {
                    let starts = law.start.iter().filter_map(|s| self.commands.get(s));
                    starts.into_iter().any(|c| c.needs().contains(r))
                })
        })
    }

    /// One cycle up to the hand-over of set-points: B3, B4.
    fn cycle(&mut self, id: CommandId, accepted: [bool; 4]) {
        let cmd = self.commands[&id].clone();
        let jumps = self.jumps(&cmd);
        self.stops |= jumps && cmd.guard == Continuity::AbortAll;
        let fault = cmd.how == end::FAULT || jumps && cmd.guard != Continuity::Allow;
        let mut lost = false;
        for &r in cmd.needs() {
            let axis = r as usize;
            if !fault && accepted[axis] {
                let target = self.axes.positions[axis] + cmd.speed;
                self.axes.moving[axis] = target != self.axes.positions[axis];
                self.axes.steps[axis] = target - self.axes.positions[axis];
                self.axes.positions[axis] = target;
            } else if self.axes.moving[axis] {
                brake(&mut self.axes, r);
                lost = true;
            }
        }
        self.change(id, |c| {
            c.cycles += 1;
            c.shown = Some(c.flag);
            c.due += KINDS[c.kind].1;
        });
        let ends = self.verdict(id).is_some();
        if fault || (lost && !ends) {
            // Marked here; the end follows in the decision.
            self.change(id, |c| c.how = end::FAULT);
        }
    }

    /// J1: whether the set-points of this cycle are discontinuous.
    fn jumps(&self, cmd: &ModelCommand) -> bool {
        let change = |r: &u32| cmd.speed - self.axes.steps[*r as usize];
        let joining = cmd.joins && cmd.cycles < 2;
        joining
            && cmd
                .needs()
                .iter()
                .any(|r| change(r).abs() > MAX_CONTINUOUS_CHANGE)
    }

    fn verdict(&self, id: CommandId) -> Option<(EndCause, i64)> {
        let cmd = &self.commands[&id];
        match cmd.how {
            end::FAULT => Some((EndCause::Fault, -1)),
            end::FAIL => Some((EndCause::Result(2), 1)),
            end::FINISH => Some((EndCause::Result(0), 0)),
            end::YIELD if cmd.covered => Some((EndCause::Result(1), 0)),
            _ => None,
        }
    }

    fn ends(&mut self, id: CommandId) {
        if let Some((how, error)) = self.verdict(id) {
            self.leave(id, how, error);
        }
    }

    fn change(&mut self, id: CommandId, change: impl FnOnce(&mut ModelCommand)) {
        if let Some(cmd) = self.commands.get_mut(&id) {
            change(cmd);
        }
    }
}

fn brake(axes: &mut Axes, resource: u32) {
    axes.moving[resource as usize] = false;
    axes.steps[resource as usize] = 0.0;
    axes.stops[resource as usize] += 1;
}

/// C2 and L6: whether a fact is true of an ended command.
fn fact_holds(fact: Fact, end: &End) -> bool {
    let by_result = matches!(end.cause, EndCause::Result(_));
    match fact {
        Fact::Export(_) => false,
        Fact::Ended => true,
        Fact::Regular => by_result && end.error == 0 && !end.cancelled,
        Fact::Failed => end.error != 0,
        Fact::Result(k) => end.cause == EndCause::Result(k as usize),
        Fact::Error(number) => end.error == number,
    }
}
