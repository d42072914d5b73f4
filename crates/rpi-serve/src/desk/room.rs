//! How much sessions may keep: commands and tasks, and the memory that these take. Whoever has no room for more gives up what has
//! ended longest ago.

use rpi_host::control::State;

use super::owed::Debt;
use super::types::MEMORY;
use super::{Desk, Failure, Phase, Record};

/// Who has given up what is only waiting to be freed.
const NOBODY: u64 = 0;

impl Desk {
    /// Makes room for a command or a task with so many bytes of text.
    pub(super) fn has_room(&mut self, session: u64, text: usize) -> Result<(), Failure> {
        let full = self.commands.len() + self.tasks.len() >= self.limits.commands;
        if full && !self.give_up_ended(session) {
            return Err(Failure::Limit("commands"));
        }
        self.fits(session, 1, text)
    }

    /// Makes room for the memory that a command or task of this number takes, now that it is loaded.
    pub(super) fn has_memory(&mut self, number: u64, bytes: usize) -> Result<(), Failure> {
        let command = self.commands.get(&number).map(|r| r.session);
        let session = command.or(self.tasks.get(&number).map(|t| t.session));
        session.map_or(Ok(()), |session| self.fits(session, 0, bytes))
    }

    fn fits(&mut self, session: u64, more: usize, bytes: usize) -> Result<(), Failure> {
        loop {
            let (count, used) = self.takes(session);
            let lacks = if count + more > self.limits.session_commands {
                "commands"
            } else if used.saturating_add(bytes) > self.limits.session_memory {
                MEMORY
            } else {
                return Ok(());
            };
            if !self.give_up_ended(session) {
                return Err(Failure::Limit(lacks));
            }
        }
    }

    /// How many commands and tasks a session has, and their bytes.
    fn takes(&self, session: u64) -> (usize, usize) {
        let commands = self.commands.values().map(|r| (r.session, r.bytes));
        let tasks = self.tasks.values().map(|t| (t.session, t.bytes));
        let own = commands.chain(tasks).filter(|(of, _)| *of == session);
        own.fold((0, 0), |(n, all), (_, bytes)| (n + 1, all + bytes))
    }

    /// Lets go of what has ended longest ago in a session: false if there is nothing.
    fn give_up_ended(&mut self, session: u64) -> bool {
        let ended = |r: &Record| r.status.phase == Phase::Is(State::Terminated);
        let mut commands = self.commands.iter();
        let command = commands.find(|(_, r)| r.session == session && ended(r));
        let mut tasks = self.tasks.iter();
        let task = tasks.find(|(_, t)| t.session == session && t.has_ended());
        let (command, task) = (command.map(|(n, _)| *n), task.map(|(n, _)| *n));
        // They are numbered in the order in which they were loaded.
        let Some(oldest) = command.into_iter().chain(task).min() else {
            return false;
        };
        match task == Some(oldest) {
            true => drop(self.tasks.remove(&oldest)),
            false => self.give_up(oldest),
        }
        true
    }

    fn give_up(&mut self, command: u64) {
        self.owe(command, Debt::Unload);
        if let Some(record) = self.commands.get_mut(&command) {
            // Its room counts as free from now on: its place does once it has come back.
            (record.session, record.bytes) = (NOBODY, 0);
        }
    }
}
