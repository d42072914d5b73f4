//! Loss of a client: what happens to its commands, tasks, rules and subscriptions.

use rpi_runtime::control::AbortReason;

use super::deferred::CommandOp;
use super::subscribers::Subscribers;
use super::types::ApiError;
use super::{Client, ServerState};
use crate::limits::OnLoss;

impl ServerState {
    /// Handles the disconnection of a client: applies the loss policies of its sessions, and removes its subscriptions
    /// and its rules that act on no command.
    pub(crate) fn on_client_lost(&mut self, client: Client, sessions: &[String]) {
        self.rules.drop_idle(client, &mut self.core);
        for name in sessions {
            if let Some((number, on_loss)) = self.objects.sessions.lose(name, &mut self.log) {
                self.apply_loss_policy(number, on_loss);
            }
        }
        self.objects.commands.remove_disconnected();
        self.watchers().for_each(Subscribers::remove_disconnected);
    }

    /// Aborts all commands of the session with this name and closes the session.
    pub(crate) fn abort_session(&mut self, name: &str) -> Result<(), ApiError> {
        let number = self.objects.sessions.number(name)?;
        self.objects.sessions.close(number);
        self.apply_loss_policy(number, OnLoss::Abort);
        Ok(())
    }

    /// Applies the loss policy to the commands and tasks of a closed session. Removes the session if it owns nothing.
    fn apply_loss_policy(&mut self, session: u64, on_loss: OnLoss) {
        // A command that is still being compiled would be unloaded at once, whatever the policy.
        self.jobs.cancel_session(session);
        if on_loss != OnLoss::RunOn {
            for number in self.jobs.remove_session(session) {
                self.objects
                    .reject(number, ApiError::QueueFull, &mut self.log);
            }
        }
        self.apply_loss_policy_to_tasks(session, on_loss);
        // With `RunOn`, a running task decides about its own commands.
        let runs_on = on_loss == OnLoss::RunOn;
        let (commands, core) = (&mut self.objects.commands, &mut self.core);
        let own = commands.of_session(session);
        let own = own.filter(|(_, r)| !(runs_on && r.task.is_some()));
        let own: Vec<u64> = own.map(|(number, _)| number).collect();
        for number in own {
            match on_loss {
                OnLoss::RunOn => commands.leave_running(number, core),
                OnLoss::Cancel => commands.cancel_and_unload(number, core),
                OnLoss::Abort => {
                    commands.defer(number, CommandOp::Abort(AbortReason::ClientLost), core);
                    commands.cancel_and_unload(number, core);
                }
            }
        }
        self.objects.close_if_empty(session);
    }

    /// Marks the tasks of a session to be unloaded at their end, and cancels them unless the policy lets them run.
    fn apply_loss_policy_to_tasks(&mut self, session: u64, on_loss: OnLoss) {
        for number in self.objects.tasks.of_session(session) {
            if on_loss != OnLoss::RunOn {
                self.task_core(number)
                    .with_task(|task, core| task.cancel(core));
            }
            self.objects.tasks.abandon(number);
            self.objects.remove_task_if_abandoned(number);
        }
    }

    /// Returns the lists of subscribers to sessions, rules, tasks, devices, the emergency stop and the override; those
    /// of commands are elsewhere.
    fn watchers(&mut self) -> impl Iterator<Item = &mut Subscribers> {
        let sessions = self.objects.sessions.watchers();
        let tasks = self.objects.tasks.watchers();
        let others = [
            &mut self.devices.subscribers,
            &mut self.emergency.watchers,
            &mut self.controls.watchers,
        ];
        let rules = self.rules.watchers();
        sessions.chain(rules).chain(tasks).chain(others)
    }

    /// Returns the number of subscriptions to objects other than commands.
    #[cfg(test)]
    pub(crate) fn subscriber_count(&mut self) -> usize {
        self.watchers().map(|list| list.len()).sum()
    }
}
