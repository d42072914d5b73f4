//! Quotas for commands, tasks and their memory. When a quota is reached, the oldest ended command or task of the client
//! is removed.

use super::owed::Debt;
use super::types::MEMORY;
use super::{Desk, Failure, Phase, Record};
use crate::fair::{Client, Holder, Taken};
use rpi_runtime::control::State;

/// Session number of commands that are only waiting to be freed.
const NOBODY: u64 = 0;

impl Desk {
    /// Makes room for a command or task with this many bytes of text.
    pub(super) fn has_room(&mut self, session: u64, text: usize) -> Result<(), Failure> {
        self.fits(session, |desk, client| {
            let (count, bytes) = desk.taken(client);
            let room = count.admit(1, desk.limits.commands);
            room.map_err(|full| Failure::limit(full, "commands"))?;
            let memory = bytes.admit(text, desk.limits.memory);
            memory.map_err(|full| Failure::limit(full, MEMORY))
        })
    }

    /// Makes room for the memory of a loaded command or task.
    pub(super) fn has_memory(&mut self, number: u64, bytes: usize) -> Result<(), Failure> {
        self.fits(self.session_of(number), |desk, client| {
            let memory = desk.taken(client).1.admit(bytes, desk.limits.memory);
            memory.map_err(|full| Failure::limit(full, MEMORY))
        })
    }

    /// Makes room for the memory of the next command of a task. Only the total limit applies, not the share of the
    /// client, so that other clients cannot stop a running task.
    pub(super) fn has_memory_left(&mut self, number: u64, bytes: usize) -> Result<(), Failure> {
        self.fits(self.session_of(number), |desk, _| {
            let memory = desk.taken(None).1.admit(bytes, desk.limits.memory);
            memory.map_err(|full| Failure::limit(full, MEMORY))
        })
    }

    fn session_of(&self, number: u64) -> u64 {
        let command = self.commands.get(&number).map(|r| r.session);
        let session = command.or(self.tasks.get(&number).map(|t| t.session));
        session.unwrap_or(NOBODY)
    }

    fn fits(
        &mut self,
        session: u64,
        admit: impl Fn(&Desk, Option<Client>) -> Result<(), Failure>,
    ) -> Result<(), Failure> {
        let client = self.client_of(session);
        while let Err(why) = admit(self, client) {
            if !self.give_up_ended(session, client) {
                return Err(why);
            }
        }
        Ok(())
    }

    /// Returns the client that is charged for a session; `None` for commands that are only waiting to be freed.
    pub(super) fn client_of(&self, session: u64) -> Option<Client> {
        self.sessions.get(&session).map(|s| s.client)
    }

    /// Returns the number and memory of all commands and tasks, as seen by a client. Commands that are only waiting to
    /// be freed do not count.
    fn taken(&self, client: Option<Client>) -> (Taken, Taken) {
        let stays = |r: &&Record| r.session != NOBODY || r.eval.is_some();
        let commands = self.commands.values().filter(stays);
        let commands = commands.map(|r| (r.session, r.bytes));
        let tasks = self.tasks.values().map(|t| (t.session, t.bytes));
        let held = commands.chain(tasks).map(|(session, bytes)| {
            let session = self.sessions.get(&session);
            (session.map_or(Holder::Nobody, |s| s.holder()), bytes)
        });
        (
            Taken::by(client, held.clone().map(|(holder, _)| (holder, 1))),
            Taken::by(client, held),
        )
    }

    /// Removes the oldest ended command or task of this session or of another session of its client. Returns false if
    /// there is none.
    fn give_up_ended(&mut self, session: u64, client: Option<Client>) -> bool {
        let is_own =
            |other: u64| other == session || client.is_some() && self.client_of(other) == client;
        let ended = |r: &Record| r.status.phase == Phase::Is(State::Terminated);
        let mut commands = self.commands.iter();
        let command = commands.find(|(_, r)| ended(r) && is_own(r.session));
        let mut tasks = self.tasks.iter();
        let task = tasks.find(|(_, t)| t.has_ended() && is_own(t.session));
        let (command, task) = (command.map(|(n, _)| *n), task.map(|(n, _)| *n));
        // Numbers are given in the order of loading.
        let Some(oldest) = command.into_iter().chain(task).min() else {
            return false;
        };
        match task == Some(oldest) {
            true => self.forget_task(oldest),
            false => self.give_up(oldest),
        }
        true
    }

    fn give_up(&mut self, command: u64) {
        self.owe(command, Debt::Unload);
        if let Some(record) = self.commands.get_mut(&command) {
            // Its quota is free from now on; its table entry is freed once the cycle has returned it.
            (record.session, record.bytes) = (NOBODY, 0);
        }
    }
}
