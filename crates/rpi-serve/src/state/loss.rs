//! Loss of a client: what happens to its commands, tasks, rules and subscriptions.

use rpi_runtime::control::Why;

use super::owed::Debt;
use super::subscribers::Subscribers;
use super::types::Failure;
use super::{Client, ServerState};
use crate::limits::OnLoss;

impl ServerState {
    /// Called when a client has disconnected: ends its sessions and subscriptions.
    pub(crate) fn lose_client(&mut self, client: Client, sessions: &[String]) {
        self.rules.drop_idle(client, &mut self.core);
        for name in sessions {
            if let Some((number, on_loss)) = self.objects.sessions.lose(name, &mut self.log) {
                self.let_go_of(number, on_loss);
            }
        }
        self.objects.commands.forget_deaf();
        self.watchers().for_each(Subscribers::forget_deaf);
    }

    /// Aborts all commands of a session and closes it.
    pub(crate) fn abort_session(&mut self, name: &str) -> Result<(), Failure> {
        let number = self.objects.sessions.number(name)?;
        self.objects.sessions.close(number);
        self.let_go_of(number, OnLoss::Abort);
        Ok(())
    }

    /// Applies the loss policy to the commands and tasks of a closed session, and removes it if it owns nothing.
    fn let_go_of(&mut self, session: u64, on_loss: OnLoss) {
        if on_loss != OnLoss::RunOn {
            for number in self.jobs.forget(session) {
                self.objects.reject(number, Failure::Busy, &mut self.log);
            }
        }
        self.let_go_of_tasks(session, on_loss);
        // With `RunOn`, a running task decides about its own commands.
        let runs_on = on_loss == OnLoss::RunOn;
        let (commands, core) = (&mut self.objects.commands, &mut self.core);
        let own = commands.of_session(session);
        let own = own.filter(|(_, r)| !(runs_on && r.task.is_some()));
        let own: Vec<u64> = own.map(|(number, _)| number).collect();
        for number in own {
            match on_loss {
                OnLoss::RunOn => commands.leave(number, core),
                OnLoss::Cancel => commands.retire(number, core),
                OnLoss::Abort => {
                    commands.owe(number, Debt::Abort(Why::ClientLost), core);
                    commands.retire(number, core);
                }
            }
        }
        self.objects.close_if_empty(session);
    }

    /// Cancels the tasks of a session, unless the policy lets them run.
    fn let_go_of_tasks(&mut self, session: u64, on_loss: OnLoss) {
        for number in self.objects.tasks.of_session(session) {
            if on_loss != OnLoss::RunOn {
                self.shop(number).with_task(|task, shop| task.cancel(shop));
            }
            self.objects.tasks.abandon(number);
            self.objects.forget_task_if_abandoned(number);
        }
    }

    /// Returns all lists of subscribers to anything but commands.
    fn watchers(&mut self) -> impl Iterator<Item = &mut Subscribers> {
        let sessions = self.objects.sessions.watchers();
        let tasks = self.objects.tasks.watchers();
        let others = [&mut self.devices.watchers, &mut self.emergency.watchers];
        let rules = self.rules.watchers();
        sessions.chain(rules).chain(tasks).chain(others)
    }

    /// Returns the number of subscriptions to anything but commands.
    #[cfg(test)]
    pub(crate) fn watching(&mut self) -> usize {
        self.watchers().map(|list| list.len()).sum()
    }
}
