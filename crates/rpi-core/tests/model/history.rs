//! Random histories, executed by the core and by the model side by side.

use std::collections::BTreeMap;
use std::sync::{Arc, OnceLock};

use rpi_core::{
    AbortReason, CommandError, CommandId, CommandState, Continuity, Core, IdAllocator, Notice,
    Rule, RuleId, RuleOutcome,
};
use rpi_image::Image;
use rpi_testkit::no_alloc;

use crate::cell::{self, Axes, KINDS, TICK_NS};
use crate::expr::Expr;
use crate::model::{End, Model, ModelRule};
use crate::steps::{RuleDraft, Shape, Step};

/// Capacity for commands.
const CAPACITY: usize = 8;

/// Counters of events.
#[derive(Clone, Copy, Default, Debug)]
pub(crate) struct EventCounts {
    started: u32,
    ended: u32,
    switched: u32,
    given_up: u32,
    failed_rules: u32,
    braked: u32,
    refused: u32,
    jumped: u32,
}

impl EventCounts {
    pub(crate) fn add(&mut self, other: &EventCounts) {
        self.started += other.started;
        self.ended += other.ended;
        self.switched += other.switched;
        self.given_up += other.given_up;
        self.failed_rules += other.failed_rules;
        self.braked += other.braked;
        self.refused += other.refused;
        self.jumped += other.jumped;
    }

    /// True if two hundred histories contain enough events of each kind.
    pub(crate) fn is_eventful(&self) -> bool {
        self.started > 500
            && self.ended > 300
            && self.switched > 150
            && self.given_up > 100
            && self.failed_rules > 3
            && self.braked > 100
            && self.refused > 500
            && self.jumped > 10
    }
}

/// The core and the model.
pub(crate) struct CoreAndModel {
    core: Core,
    bank: Axes,
    model: Model,
    places: IdAllocator,
    /// All commands ever created, and the tick of the first notice about each.
    ids: Vec<CommandId>,
    first: BTreeMap<CommandId, u64>,
    rules: Vec<RuleId>,
    answers: Result<(), String>,
    pub(crate) tally: EventCounts,
}

fn images() -> &'static [Arc<Image>] {
    static IMAGES: OnceLock<Vec<Arc<Image>>> = OnceLock::new();
    IMAGES.get_or_init(|| (0..KINDS.len()).map(cell::image).collect())
}

impl CoreAndModel {
    pub(crate) fn new() -> CoreAndModel {
        CoreAndModel {
            core: Core::with_capacity(CAPACITY, TICK_NS),
            bank: Axes::new(),
            model: Model::new(CAPACITY * 4),
            places: IdAllocator::new(CAPACITY),
            ids: Vec::new(),
            first: BTreeMap::new(),
            rules: Vec::new(),
            answers: Ok(()),
            tally: EventCounts::default(),
        }
    }

    /// The k-th latest command.
    fn id(&self, k: usize) -> Option<CommandId> {
        self.ids.iter().rev().nth(k).copied()
    }

    pub(crate) fn carry_out(&mut self, step: &Step) {
        match step {
            Step::Load(kind, guard) => self.load(*kind, *guard),
            Step::Schedule(draft) => self.schedule(draft),
            Step::Ticks(count) => (0..*count).for_each(|_| self.tick()),
            Step::Device { axis, failed } => {
                self.bank.failed[*axis] = *failed;
                self.model.axes.failed[*axis] = *failed;
            }
            Step::EmergencyStop => {
                no_alloc(|| self.core.emergency_stop(&mut self.bank));
                self.model.emergency_stop();
            }
            Step::Withdraw(k) => {
                if let Some(&rule) = self.rules.iter().rev().nth(*k) {
                    let got = self.core.withdraw_rule(rule);
                    let wanted = self.model.withdraw(rule);
                    self.compare(got, wanted);
                }
            }
            Step::ClientLost(parity) => self.lose_client(*parity),
            _ => self.send_request(step),
        }
        self.clear_up();
    }

    fn send_request(&mut self, step: &Step) {
        let (Step::Start(k)
        | Step::Unschedule(k)
        | Step::Cancel(k)
        | Step::Abort(k)
        | Step::Unload(k)
        | Step::Behave { command: k, .. }) = step
        else {
            return;
        };
        let Some(id) = self.id(*k) else {
            return;
        };
        let (core, bank, model) = (&mut self.core, &mut self.bank, &mut self.model);
        let (got, wanted) = match step {
            Step::Start(_) => (no_alloc(|| core.start(id, bank)), model.start(id)),
            Step::Unschedule(_) => (no_alloc(|| core.unschedule(id)), model.unschedule(id)),
            Step::Cancel(_) => (no_alloc(|| core.cancel(id)), model.cancel(id)),
            Step::Abort(_) => {
                let got = no_alloc(|| core.abort(id, AbortReason::Request, bank));
                (got, model.abort(id, AbortReason::Request))
            }
            Step::Unload(_) => return self.unload(id),
            Step::Behave {
                end, flag, speed, ..
            } => {
                behave(core, model, id, (*end, *flag, f64::from(*speed)));
                return;
            }
            _ => return,
        };
        self.compare(got, wanted);
    }

    fn unload(&mut self, id: CommandId) {
        let (got, back) = match no_alloc(|| self.core.remove(id)) {
            Ok(command) => (Ok(()), Some(command)),
            Err(why) => (Err(why), None),
        };
        if back.is_some() {
            self.places.release(id);
        }
        let wanted = self.model.unload(id);
        self.compare(got, wanted);
    }

    fn lose_client(&mut self, parity: usize) {
        let mine: Vec<CommandId> = self.ids.iter().copied().skip(parity).step_by(2).collect();
        for id in mine {
            let got = self.core.abort(id, AbortReason::ClientLost, &mut self.bank);
            let wanted = self.model.abort(id, AbortReason::ClientLost);
            self.compare(got, wanted);
            self.unload(id);
        }
    }

    fn load(&mut self, kind: usize, guard: Continuity) {
        let Some(id) = self.places.allocate() else {
            return;
        };
        let command = cell::load(&images()[kind], guard, &mut self.bank);
        assert!(self.core.insert_with_id(id, command).is_ok());
        self.model.insert(id, kind, guard);
        self.ids.push(id);
    }

    fn schedule(&mut self, draft: &RuleDraft) {
        let Some(law) = self.law(draft) else {
            return;
        };
        let id = self.places.allocate_rule();
        let mut rule = Rule::when(law.condition.condition());
        rule = law.stop.iter().fold(rule, |r, c| r.stop(*c));
        rule = law.cancel.iter().fold(rule, |r, c| r.cancel(*c));
        rule = law.start.iter().fold(rule, |r, c| r.start(*c));
        let rule = Box::new(if law.kept { rule.keep_orphans() } else { rule });
        let made = no_alloc(|| self.core.schedule_with_id(id, rule, &mut self.bank));
        let got = made.map_err(|refused| refused.1);
        let wanted = self.model.schedule(id, &law);
        self.rules.push(id);
        self.compare(got, wanted);
    }

    fn law(&self, draft: &RuleDraft) -> Option<ModelRule> {
        let all = |them: &[usize]| them.iter().map(|k| self.id(*k)).collect::<Option<Vec<_>>>();
        Some(ModelRule {
            condition: self.expr(&draft.condition)?,
            stop: all(&draft.stop)?,
            cancel: all(&draft.cancel)?,
            start: all(&draft.start)?,
            kept: draft.kept,
        })
    }

    fn expr(&self, shape: &Shape) -> Option<Expr> {
        let boxed = |shape: &Shape| self.expr(shape).map(Box::new);
        Some(match shape {
            Shape::Fact(k, fact) => Expr::Fact(self.id(*k)?, *fact),
            Shape::Not(a) => Expr::Not(boxed(a)?),
            Shape::And(a, b) => Expr::And(boxed(a)?, boxed(b)?),
            Shape::Or(a, b) => Expr::Or(boxed(a)?, boxed(b)?),
        })
    }

    fn tick(&mut self) {
        no_alloc(|| self.core.tick(&mut self.bank, 0, &mut ()));
        self.model.run_tick();
        self.clear_up();
    }

    /// Takes finished commands and rules out of the core, as the host does.
    fn clear_up(&mut self) {
        while let Some((id, _)) = self.core.take_orphan() {
            self.places.release(id);
            if !self.model.gone.remove(&id) {
                self.answers = Err(format!("{id:?} is gone in the core only"));
            }
        }
        while self.core.take_finished_rule().is_some() {}
        while let Some(notice) = self.core.next_notice() {
            self.count(&notice);
        }
    }

    fn count(&mut self, notice: &Notice) {
        let tally = &mut self.tally;
        match notice {
            Notice::Started { command, tick } => {
                self.first.insert(*command, *tick);
                tally.started += 1;
            }
            Notice::Ended { .. } => tally.ended += 1,
            Notice::Orphaned { .. } => tally.given_up += 1,
            Notice::Braked { .. } => tally.braked += 1,
            Notice::Discontinuity { .. } => tally.jumped += 1,
            Notice::Rule {
                outcome: RuleOutcome::Fired,
                ..
            } => tally.switched += 1,
            Notice::Rule {
                outcome: RuleOutcome::Failed(_),
                ..
            } => tally.failed_rules += 1,
            _ => {}
        }
    }

    fn compare(&mut self, got: Result<(), CommandError>, wanted: Result<(), CommandError>) {
        self.tally.refused += u32::from(got.is_err());
        if got != wanted && self.answers.is_ok() {
            self.answers = Err(format!("the core says {got:?}, the model {wanted:?}"));
        }
    }

    /// Checks that the core and the model are in the same state.
    pub(crate) fn agree(&self) -> Result<(), String> {
        self.answers.clone()?;
        if let Some(left) = self.model.gone.first() {
            return Err(format!("{left:?} is gone in the model only"));
        }
        if self.bank != self.model.axes {
            return Err(format!("axes {:?}\nmodel {:?}", self.bank, self.model.axes));
        }
        let rules: Vec<RuleId> = self.core.rules().map(|r| r.0).collect();
        let wanted: Vec<RuleId> = self.model.rules.iter().map(|r| r.0).collect();
        if rules != wanted {
            return Err(format!("rules {rules:?}\nmodel {wanted:?}"));
        }
        let count = self.core.commands().count();
        if count != self.model.commands.len() || self.core.notices_lost() != 0 {
            return Err(format!(
                "{count} commands, model {}",
                self.model.commands.len()
            ));
        }
        self.model
            .commands
            .keys()
            .try_for_each(|id| self.agree_on(*id))
    }

    fn agree_on(&self, id: CommandId) -> Result<(), String> {
        let wanted = &self.model.commands[&id];
        let command = self
            .core
            .command(id)
            .ok_or_else(|| format!("the core has no {id:?}"))?;
        let end = command.ending().map(|e| End {
            cause: e.cause.into(),
            error: e.error,
            cancelled: e.cancelled,
            cycles: e.cycles,
            left_moving: e.left_moving,
        });
        let held: Vec<u32> = command.held().collect();
        let first = self.first.get(&id).copied();
        let got = (
            command.state(),
            held,
            command.instance().cycle(),
            first,
            end,
        );
        let holds = wanted.holds.iter().copied().collect();
        let model = (wanted.state, holds, wanted.cycles, wanted.first, wanted.end);
        match got == model {
            true => Ok(()),
            false => Err(format!("{id:?}: core {got:?}\nmodel {model:?}")),
        }
    }
}

fn behave(core: &mut Core, model: &mut Model, id: CommandId, (end, flag, speed): (i64, bool, f64)) {
    let (Some(command), Some(puppet)) = (core.command_mut(id), model.commands.get_mut(&id)) else {
        return;
    };
    if matches!(puppet.state, CommandState::Terminated) {
        return;
    }
    cell::set(command, cell::END, end.cast_unsigned());
    cell::set(command, cell::FLAG, u64::from(flag));
    cell::set(command, cell::SPEED, speed.to_bits());
    (puppet.how, puppet.flag, puppet.speed) = (end, flag, speed);
}
