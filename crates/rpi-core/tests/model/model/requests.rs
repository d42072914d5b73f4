//! Requests to the model between two ticks: start, cancel, abort, unload, rules.

use rpi_core::{AbortReason, CommandError, CommandId, CommandState, RuleId};

use crate::model::{Answer, EndCause, Model, ModelRule};

impl Model {
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

    pub(crate) fn stop_all(&mut self, why: AbortReason) {
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
}
