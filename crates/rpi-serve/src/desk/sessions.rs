//! Sessions: ownership of commands, and what happens to them when the client disconnects.

use rpi_runtime::control::{State, Why};

use super::owed::Debt;
use super::types::shortened;
use super::{Desk, Failure, Phase, Sink, Update, number_of};
use crate::fair::{Client, Holder, Taken};
use crate::limits::OnLoss;
use crate::peer::Peer;

/// A session.
pub(super) struct Session {
    /// Name given by the client, for display.
    pub(super) name: String,
    pub(super) on_loss: OnLoss,
    /// Client that opened the session or took it over.
    pub(super) client: Client,
    /// Whether every client that knows the name of the session may act on it.
    shared: bool,
    /// Whether the client has disconnected or closed the session.
    pub(super) closed: bool,
    pub(super) watchers: Vec<Box<dyn Sink>>,
}

impl Session {
    /// Returns the client that is charged for the session.
    pub(super) fn holder(&self) -> Holder {
        match self.closed {
            true => Holder::Was(self.client),
            false => Holder::Is(self.client),
        }
    }
}

impl Desk {
    /// Registers a connection as a client.
    pub(crate) fn client(&mut self, peer: Peer) -> Client {
        Client::new(self.number(), peer)
    }

    /// Returns an error if the session belongs to another connected client.
    pub(super) fn may_act_in(
        &self,
        client: Client,
        session: u64,
        what: &str,
    ) -> Result<(), Failure> {
        let session = self.sessions.get(&session);
        let owned = session.filter(|s| !s.closed && !s.shared);
        match owned.is_some_and(|s| s.client != client) {
            true => Err(Failure::NotYours(what.to_owned())),
            false => Ok(()),
        }
    }

    /// Returns an error if this command, task or session belongs to another connected client. An unknown name is no
    /// error here.
    pub(crate) fn may_act(&self, client: Client, name: &str) -> Result<(), Failure> {
        let command = number_of(name, 'n').and_then(|n| self.commands.get(&n));
        let task = number_of(name, 't').and_then(|n| self.tasks.get(&n));
        let session = command.map(|r| r.session).or(task.map(|t| t.session));
        let session = session.or(number_of(name, 's'));
        session.map_or(Ok(()), |session| self.may_act_in(client, session, name))
    }

    /// Opens a session for a client and returns its name. On a shared session, every client that knows its name may
    /// act.
    pub(crate) fn open_session(
        &mut self,
        name: &str,
        on_loss: Option<OnLoss>,
        (client, shared): (Client, bool),
    ) -> Result<String, Failure> {
        let held = self.sessions.values().map(|s| (s.holder(), 1));
        let taken = Taken::by(Some(client), held);
        taken
            .admit(1, self.limits.sessions)
            .map_err(|full| Failure::limit(full, "sessions"))?;
        let number = self.number();
        let session = Session {
            name: shortened(name, self.limits.name),
            on_loss: on_loss.unwrap_or(self.on_loss),
            client,
            shared,
            closed: false,
            watchers: Vec::new(),
        };
        self.sessions.insert(number, session);
        let of = match name {
            "" => String::new(),
            name => format!(" of {name}"),
        };
        self.journal
            .note(format_args!("session s{number}{of} was opened"));
        Ok(format!("s{number}"))
    }

    /// Returns the number of a session.
    pub(super) fn session(&self, name: &str) -> Result<u64, Failure> {
        let found = number_of(name, 's').filter(|n| self.sessions.contains_key(n));
        found.ok_or_else(|| Failure::Unknown(format!("session {name}")))
    }

    /// Lets a client take over a session whose client has disconnected. Returns whether it did.
    pub(crate) fn take_up(&mut self, name: &str, client: Client) -> bool {
        let session = number_of(name, 's').and_then(|n| self.sessions.get_mut(&n));
        session.is_some_and(|session| {
            let was_closed = std::mem::replace(&mut session.closed, false);
            if was_closed {
                session.client = client;
            }
            was_closed
        })
    }

    /// Returns the names of all sessions with the names that their clients gave.
    pub(crate) fn sessions(&self) -> impl Iterator<Item = (String, &str)> {
        let sessions = self.sessions.iter();
        sessions.map(|(number, session)| (format!("s{number}"), session.name.as_str()))
    }

    /// Called when a client has disconnected: ends its sessions and subscriptions.
    pub(crate) fn lose_client(&mut self, client: Client, sessions: &[String]) {
        self.drop_idle_rules(client);
        sessions.iter().for_each(|name| self.lose_session(name));
        self.forget_deaf();
    }

    /// Applies the loss policy of a session whose client has disconnected.
    fn lose_session(&mut self, name: &str) {
        let Some(number) = number_of(name, 's') else {
            return;
        };
        self.journal.note(format_args!(
            "the client of session {name} has disconnected"
        ));
        if let Some(session) = self.sessions.get_mut(&number) {
            session.closed = true;
            let on_loss = session.on_loss;
            self.let_go_of(number, on_loss);
            self.close_if_empty(number);
        }
    }

    /// Aborts all commands of a session and closes it.
    pub(crate) fn abort_session(&mut self, name: &str) -> Result<(), Failure> {
        let number = self.session(name)?;
        if let Some(session) = self.sessions.get_mut(&number) {
            session.closed = true;
        }
        self.let_go_of(number, OnLoss::Abort);
        self.close_if_empty(number);
        Ok(())
    }

    /// Subscribes to a session: reports whether it is open, now and at each change.
    pub(crate) fn watch_session(
        &mut self,
        name: &str,
        mut sink: Box<dyn Sink>,
    ) -> Result<(), Failure> {
        let number = self.session(name)?;
        if let Some(session) = self.sessions.get_mut(&number)
            && sink.tell(&Update::Session(true))
        {
            session.watchers.push(sink);
        }
        Ok(())
    }

    fn let_go_of(&mut self, session: u64, on_loss: OnLoss) {
        if on_loss != OnLoss::RunOn {
            for number in self.jobs.forget(session) {
                self.reject(number, Failure::Busy);
            }
        }
        self.let_go_of_tasks(session, on_loss);
        // With `RunOn`, a running task decides about its own commands.
        let runs_on = on_loss == OnLoss::RunOn;
        let own = self.commands.iter().filter(|(_, r)| r.session == session);
        let own = own.filter(|(_, r)| !(runs_on && r.task.is_some()));
        let own: Vec<u64> = own.map(|(number, _)| *number).collect();
        for number in own {
            match on_loss {
                OnLoss::RunOn => self.leave(number),
                OnLoss::Cancel => self.retire(number),
                OnLoss::Abort => {
                    self.owe(number, Debt::Abort(Why::ClientLost));
                    self.retire(number);
                }
            }
        }
    }

    /// Lets a command run, or wait for its rule. A command that is only ready is unloaded.
    fn leave(&mut self, number: u64) {
        self.unload_at_end(number);
        let phase = self.commands.get(&number).map(|r| r.status.phase);
        if phase == Some(Phase::Is(State::Ready)) {
            self.owe(number, Debt::Unload);
        }
    }

    /// Ends a command: a running one is cancelled and then unloaded, any other one is unloaded.
    fn retire(&mut self, number: u64) {
        let phase = self.commands.get(&number).map(|r| r.status.phase);
        self.unload_at_end(number);
        match phase {
            Some(Phase::Is(State::Running)) => self.owe(number, Debt::Cancel),
            Some(Phase::Is(_)) => self.owe(number, Debt::Unload),
            _ => {}
        }
    }

    pub(super) fn unload_at_end(&mut self, number: u64) {
        if let Some(record) = self.commands.get_mut(&number) {
            record.unload_at_end = true;
        }
        let ended = self
            .commands
            .get(&number)
            .is_some_and(|r| r.status.phase == Phase::Is(State::Terminated));
        if ended {
            self.owe(number, Debt::Unload);
        }
    }

    /// Removes a closed session that owns no command or task any more.
    pub(super) fn close_if_empty(&mut self, number: u64) {
        let owns = self.commands.values().any(|r| r.session == number);
        let owns = owns || self.tasks.values().any(|t| t.session == number);
        let closed = self.sessions.get(&number).is_some_and(|s| s.closed);
        if closed
            && !owns
            && let Some(session) = self.sessions.remove(&number)
        {
            for mut sink in session.watchers {
                sink.tell(&Update::Session(false));
            }
        }
    }
}
