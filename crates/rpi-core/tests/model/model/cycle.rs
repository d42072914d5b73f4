//! The cycle of the model: set-points, prediction of takeovers, ends.

use rpi_core::{AbortReason, CommandId, CommandState, Continuity, Fact, RuleId};

use crate::cell::{KINDS, MAX_CONTINUOUS_CHANGE, end};
use crate::expr::KnownFact;
use crate::model::brake;
use crate::model::{End, EndCause, Model, ModelCommand, fact_holds};

impl Model {
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
    pub(crate) fn covered(&self, id: CommandId) -> bool {
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
    pub(crate) fn cycle(&mut self, id: CommandId, accepted: [bool; 4]) {
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
    pub(crate) fn jumps(&self, cmd: &ModelCommand) -> bool {
        let change = |r: &u32| cmd.speed - self.axes.steps[*r as usize];
        let joining = cmd.joins && cmd.cycles < 2;
        joining
            && cmd
                .needs()
                .iter()
                .any(|r| change(r).abs() > MAX_CONTINUOUS_CHANGE)
    }

    pub(crate) fn verdict(&self, id: CommandId) -> Option<(EndCause, i64)> {
        let cmd = &self.commands[&id];
        match cmd.how {
            end::FAULT => Some((EndCause::Fault, -1)),
            end::FAIL => Some((EndCause::Result(2), 1)),
            end::FINISH => Some((EndCause::Result(0), 0)),
            end::YIELD if cmd.covered => Some((EndCause::Result(1), 0)),
            _ => None,
        }
    }

    pub(crate) fn ends(&mut self, id: CommandId) {
        if let Some((how, error)) = self.verdict(id) {
            self.leave(id, how, error);
        }
    }
}
