//! Sessions: who owns which commands, and what becomes of them when the owner is gone.

use rpi_host::control::{State, Why};

use super::owed::Debt;
use super::types::shortened;
use super::{Desk, Failure, Phase, Sink, Update, number_of};
use crate::fair::{Client, Holder, Taken};
use crate::limits::OnLoss;
use crate::peer::Peer;

/// A session.
pub(super) struct Session {
    /// What its client calls itself.
    pub(super) name: String,
    pub(super) on_loss: OnLoss,
    /// The client that has opened it, or taken it up.
    pub(super) client: Client,
    /// Whoever knows its name may act for it.
    shared: bool,
    /// Its client is gone, or has closed it.
    pub(super) closed: bool,
    pub(super) watchers: Vec<Box<dyn Sink>>,
}

impl Session {
    /// Whose places it takes.
    pub(super) fn holder(&self) -> Holder {
        match self.closed {
            true => Holder::Was(self.client),
            false => Holder::Is(self.client),
        }
    }
}

impl Desk {
    /// A name for a connection.
    pub(crate) fn client(&mut self, peer: Peer) -> Client {
        Client::new(self.number(), peer)
    }

    /// Fails if a session belongs to another client that is still there.
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

    /// Fails if a command or task, by its name, is not this client's to start, to end or to change. What there is none of is
    /// another failure.
    pub(crate) fn may_act(&self, client: Client, name: &str) -> Result<(), Failure> {
        let command = number_of(name, 'n').and_then(|n| self.commands.get(&n));
        let task = number_of(name, 't').and_then(|n| self.tasks.get(&n));
        let session = command.map(|r| r.session).or(task.map(|t| t.session));
        let session = session.or(number_of(name, 's'));
        session.map_or(Ok(()), |session| self.may_act_in(client, session, name))
    }

    /// Opens a session for a client and gives its name. For one that is shared, whoever knows the name may act.
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
            .note(format_args!("session s{number}{of} is opened"));
        Ok(format!("s{number}"))
    }

    /// The number of a session.
    pub(super) fn session(&self, name: &str) -> Result<u64, Failure> {
        let found = number_of(name, 's').filter(|n| self.sessions.contains_key(n));
        found.ok_or_else(|| Failure::Unknown(format!("session {name}")))
    }

    /// A session whose client was lost is taken up again by whoever knows its name, and is lost with them: true if it was.
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

    /// Names of the sessions and of those who opened them.
    pub(crate) fn sessions(&self) -> impl Iterator<Item = (String, &str)> {
        let sessions = self.sessions.iter();
        sessions.map(|(number, session)| (format!("s{number}"), session.name.as_str()))
    }

    /// A client is gone: its sessions have nobody, and nobody tells it anything.
    pub(crate) fn lose_client(&mut self, client: Client, sessions: &[String]) {
        self.drop_idle_rules(client);
        sessions.iter().for_each(|name| self.lose_session(name));
        self.forget_deaf();
    }

    /// The client of a session is gone: what it has asked for in that case is done.
    fn lose_session(&mut self, name: &str) {
        let Some(number) = number_of(name, 's') else {
            return;
        };
        self.journal
            .note(format_args!("the client of session {name} is gone"));
        if let Some(session) = self.sessions.get_mut(&number) {
            session.closed = true;
            let on_loss = session.on_loss;
            self.let_go_of(number, on_loss);
            self.close_if_empty(number);
        }
    }

    /// Ends all commands of a session by force, and the session with them.
    pub(crate) fn abort_session(&mut self, name: &str) -> Result<(), Failure> {
        let number = self.session(name)?;
        if let Some(session) = self.sessions.get_mut(&number) {
            session.closed = true;
        }
        self.let_go_of(number, OnLoss::Abort);
        self.close_if_empty(number);
        Ok(())
    }

    /// Tells somebody whether a session is open, now and whenever that changes.
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
        // A task lets go of its own commands.
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

    /// Lets a command run on, or wait for what will start it; one that nobody has started is unloaded.
    fn leave(&mut self, number: u64) {
        self.unload_at_end(number);
        let phase = self.commands.get(&number).map(|r| r.status.phase);
        if phase == Some(Phase::Is(State::Ready)) {
            self.owe(number, Debt::Unload);
        }
    }

    /// Lets a command end: what runs is asked to, what waits is unloaded, and so is the rest once it has ended.
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

    /// A session that is closed and owns nothing any more is forgotten.
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
