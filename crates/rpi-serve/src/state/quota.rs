//! Use of the quotas for commands, tasks and their memory.

use super::commands::Commands;
use super::record::CommandRecord;
use super::sessions::Sessions;
use super::tasks::Tasks;
use crate::fair_share;
use crate::fair_share::Client;

/// Session number of commands that belong to no session: those that evaluate a net for a single cycle, and those that
/// only wait until the core has freed them.
pub(super) const NO_SESSION: u64 = 0;

/// Read-only view of all commands, tasks and sessions, from which the use of the quotas is computed.
pub(super) struct QuotaView<'a> {
    pub(super) sessions: &'a Sessions,
    pub(super) commands: &'a Commands,
    pub(super) tasks: &'a Tasks,
}

impl QuotaView<'_> {
    /// Returns the usage of two quotas, as seen by a client: the number and the memory in bytes of all commands and
    /// tasks. Commands that only wait until the core has freed them do not count.
    pub(super) fn usage(&self, client: Option<Client>) -> (fair_share::Usage, fair_share::Usage) {
        let stays = |(_, r): &(u64, &CommandRecord)| r.session != NO_SESSION || r.eval.is_some();
        let commands = self.commands.iter().filter(stays);
        let commands = commands.map(|(_, r)| (r.session, r.bytes));
        let held = commands.chain(self.tasks.sizes());
        let held = held.map(|(session, bytes)| (self.sessions.holder(session), bytes));
        (
            fair_share::Usage::for_client(client, held.clone().map(|(holder, _)| (holder, 1))),
            fair_share::Usage::for_client(client, held),
        )
    }

    /// Returns the number of the oldest ended command or task of this session or of another session of its client;
    /// `None` if there is none.
    pub(super) fn oldest_ended(&self, session: u64, client: Option<Client>) -> Option<u64> {
        let is_own = |other: u64| {
            other == session || client.is_some() && self.sessions.client_of(other) == client
        };
        let mut commands = self.commands.iter();
        let command = commands.find(|(_, r)| r.has_ended() && is_own(r.session));
        let mut tasks = self.tasks.ended();
        let task = tasks.find(|(_, session)| is_own(*session));
        // Numbers are given in the order of loading.
        let command = command.map(|(number, _)| number);
        command
            .into_iter()
            .chain(task.map(|(number, _)| number))
            .min()
    }
}
