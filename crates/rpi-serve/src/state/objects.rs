//! Sessions and what they own: commands and tasks. Ownership decides which client may act on an object, and whose quota
//! it counts for.

use std::time::{Duration, Instant};

use rpi_runtime::control::CommandId;

use super::commands::Commands;
use super::core_link::CoreLink;
use super::deferred::CommandOp;
use super::event_log::EventLog;
use super::parse_number;
use super::pending::answer;
use super::quota::{NO_SESSION, QuotaView};
use super::record::CommandRecord;
use super::rules::RuleRecord;
use super::sessions::{SessionPolicy, Sessions};
use super::tasks::Tasks;
use super::types::{ApiError, MEMORY_LIMIT};
use crate::fair_share::Client;
use crate::limits::{Limits, OnLoss};
use crate::role::{Identity, Right};

/// Tables of the sessions, commands and tasks. Each object has a number, unique among all objects, in the order of
/// creation.
pub(crate) struct Objects {
    pub(crate) sessions: Sessions,
    pub(crate) commands: Commands,
    pub(crate) tasks: Tasks,
    limits: Limits,
    /// Number of the newest session, command, task or client.
    last: u64,
}

impl Objects {
    /// Creates empty tables. `on_loss` and `grace` are the policies of sessions whose clients do not set them.
    pub(super) fn new(limits: Limits, on_loss: OnLoss, grace: Duration) -> Objects {
        Objects {
            sessions: Sessions::new(on_loss, grace),
            commands: Commands::default(),
            tasks: Tasks::default(),
            limits,
            last: 0,
        }
    }

    /// Returns a new number, unique among all sessions, commands, tasks and clients.
    pub(super) fn number(&mut self) -> u64 {
        self.last += 1;
        self.last
    }

    /// Registers a connection as a client and gives it a number.
    pub(crate) fn client(&mut self, who: &Identity) -> Client {
        Client::new(self.number(), who.peer).with_management(who.may(Right::Manage))
    }

    /// Returns an error if the command, task or session with this name belongs to another connected client. An unknown
    /// name is no error here.
    pub(crate) fn may_act(&self, client: Client, name: &str) -> Result<(), ApiError> {
        let command = parse_number(name, 'n').and_then(|n| self.commands.get(n));
        let task = parse_number(name, 't').and_then(|n| self.tasks.session_of(n));
        let session = command.map(|r| r.session).or(task);
        let session = session.or(parse_number(name, 's'));
        session.map_or(Ok(()), |session| {
            self.sessions.ensure_may_act_in(client, session, name)
        })
    }

    /// Returns an error if a command on which a rule acts belongs to another connected client. `name` is the name of
    /// the rule.
    pub(super) fn may_change(
        &self,
        client: Client,
        name: &str,
        rule: &RuleRecord,
    ) -> Result<(), ApiError> {
        let mut records = rule
            .acts_on()
            .filter_map(|id| self.commands.find_by_id(*id));
        records.try_for_each(|(_, r)| self.sessions.ensure_may_act_in(client, r.session, name))
    }

    /// Opens a session for the client in `owner` and returns the name of the session. The Boolean in `owner` is true
    /// for a shared session, on which every client that knows its name may act.
    pub(super) fn open_session(
        &mut self,
        name: &str,
        policy: SessionPolicy,
        owner: (Client, bool),
    ) -> Result<String, ApiError> {
        self.sessions.has_room(owner.0, &self.limits)?;
        let number = self.number();
        let shown = (name, self.limits.name_bytes);
        Ok(self.sessions.open(number, shown, policy, owner))
    }

    /// Sets the time by which the command with this id, which is being cancelled, must have ended.
    pub(super) fn set_deadline(&mut self, id: CommandId) {
        let Some(record) = self.commands.record_of(id) else {
            return;
        };
        let grace = record
            .grace
            .unwrap_or_else(|| self.sessions.grace(record.session));
        record.deadline = Instant::now().checked_add(grace);
    }

    /// Ensures that the quotas allow the session one more command or task with `text` bytes of text. Removes ended
    /// commands and tasks of the client, oldest first, if necessary.
    pub(super) fn make_room(
        &mut self,
        session: u64,
        text: usize,
        core: &mut CoreLink,
    ) -> Result<(), ApiError> {
        self.ensure_quota(session, core, |usage, limits, client| {
            let (count, bytes) = usage.usage(client);
            let room = count.admit(1, limits.commands);
            room.map_err(|full| ApiError::limit(full, "commands"))?;
            let memory = bytes.admit(text, limits.memory.commands);
            memory.map_err(|full| ApiError::limit(full, MEMORY_LIMIT))
        })
    }

    /// Ensures that the quotas allow `bytes` of memory for the loaded command or task with this number. Removes ended
    /// commands and tasks of the client, oldest first, if necessary.
    pub(super) fn ensure_memory(
        &mut self,
        number: u64,
        bytes: usize,
        core: &mut CoreLink,
    ) -> Result<(), ApiError> {
        self.ensure_quota(self.session_of(number), core, |usage, limits, client| {
            let memory = usage.usage(client).1.admit(bytes, limits.memory.commands);
            memory.map_err(|full| ApiError::limit(full, MEMORY_LIMIT))
        })
    }

    /// Ensures that the memory limit allows `bytes` for the next command of the task with this number. Only the total
    /// limit applies, not the share of the client, so that other clients cannot stop a running task.
    pub(super) fn ensure_total_memory(
        &mut self,
        number: u64,
        bytes: usize,
        core: &mut CoreLink,
    ) -> Result<(), ApiError> {
        self.ensure_quota(self.session_of(number), core, |usage, limits, _| {
            let memory = usage.usage(None).1.admit(bytes, limits.memory.commands);
            memory.map_err(|full| ApiError::limit(full, MEMORY_LIMIT))
        })
    }

    fn session_of(&self, number: u64) -> u64 {
        let command = self.commands.get(number).map(|r| r.session);
        let session = command.or(self.tasks.session_of(number));
        session.unwrap_or(NO_SESSION)
    }

    fn usage(&self) -> QuotaView<'_> {
        QuotaView {
            sessions: &self.sessions,
            commands: &self.commands,
            tasks: &self.tasks,
        }
    }

    /// Removes ended commands and tasks of the session's client, oldest first, until `admit` succeeds. Returns the
    /// error of `admit` if none is left to remove.
    fn ensure_quota(
        &mut self,
        session: u64,
        core: &mut CoreLink,
        admit: impl Fn(&QuotaView<'_>, &Limits, Option<Client>) -> Result<(), ApiError>,
    ) -> Result<(), ApiError> {
        let client = self.sessions.client_of(session);
        while let Err(why) = admit(&self.usage(), &self.limits, client) {
            let Some(oldest) = self.usage().oldest_ended(session, client) else {
                return Err(why);
            };
            match self.tasks.contains(oldest) {
                true => self.tasks.forget(oldest),
                false => self.evict_command(oldest, core),
            }
        }
        Ok(())
    }

    fn evict_command(&mut self, command: u64, core: &mut CoreLink) {
        self.commands.defer(command, CommandOp::Unload, core);
        if let Some(record) = self.commands.get_mut(command) {
            // Its quota is free from now on; its table entry is freed once the cycle has returned it.
            (record.session, record.bytes) = (NO_SESSION, 0);
        }
    }

    /// Removes the command or task with this number, whose loading failed, and reports the error to its client.
    pub(super) fn reject(&mut self, number: u64, why: ApiError, log: &mut EventLog) {
        if let Some((called, session, reply)) = self.tasks.remove(number) {
            log.write(format_args!("{called} cannot be loaded: {why}"));
            answer(reply, Err(why));
            self.close_if_empty(session);
        } else if let Some(record) = self.commands.remove(number) {
            let called = record.display_name(number);
            log.write(format_args!("{called} cannot be loaded: {why}"));
            let reply = record.eval.map(|e| e.reply).or(record.loading);
            answer(reply, Err(why));
            self.close_if_empty(record.session);
        }
    }

    /// Removes the session with this number if it is closed and owns no command or task.
    pub(super) fn close_if_empty(&mut self, number: u64) {
        let owns = self.commands.of_session(number).next().is_some();
        if !owns && !self.tasks.any_of_session(number) {
            self.sessions.remove_closed(number);
        }
    }

    /// Removes the task with this number if it is marked to be unloaded and has ended or was never started.
    pub(super) fn remove_task_if_abandoned(&mut self, number: u64) {
        if let Some(session) = self.tasks.abandoned(number) {
            self.tasks.forget(number);
            self.close_if_empty(session);
        }
    }

    /// Reports to subscribers that a command is unloaded, after the core has freed it and its record was removed.
    pub(super) fn forget_command(&mut self, mut record: CommandRecord) {
        record.set_phase(super::Phase::Unloaded);
        if let Some(eval) = record.eval.take() {
            (eval.reply)(Err(ApiError::QueueFull));
        }
        self.close_if_empty(record.session);
    }
}
