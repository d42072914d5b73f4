//! Sessions: who owns commands and tasks.

use std::collections::BTreeMap;
use std::time::Duration;

use super::event_log::EventLog;
use super::parse_number;
use super::subscribers::Subscribers;
use super::types::{ApiError, Subscriber, Update, truncated};
use crate::fair_share::{Client, Holder, Usage};
use crate::limits::{Limits, OnLoss};

/// Session of a client, which owns commands and tasks: its name, and the policy for them when the connection is lost.
struct Session {
    /// Name of the session given by the client, for display.
    name: String,
    on_loss: OnLoss,
    /// Time within which a cancelled command of the session must end.
    grace: Duration,
    /// Client that opened the session or took it over.
    client: Client,
    /// Whether every client that knows the name of the session may act on its commands and tasks.
    shared: bool,
    /// Whether the client has disconnected or closed the session.
    closed: bool,
    watchers: Subscribers,
}

impl Session {
    /// Returns the client whose quotas the commands and tasks of the session count for.
    fn holder(&self) -> Holder {
        match self.closed {
            true => Holder::Disconnected(self.client),
            false => Holder::Connected(self.client),
        }
    }
}

/// Table of the sessions by number. A closed session stays in the table until it owns no command or task.
pub(crate) struct Sessions {
    records: BTreeMap<u64, Session>,
    /// Policy for the commands of a session whose client has disconnected, unless the client has set another one.
    on_loss: OnLoss,
    /// Time within which a cancelled command must end, unless the client has set another one.
    grace: Duration,
}

/// Policy for the commands of a session. A field with `None` means the default of the server.
#[derive(Clone, Copy, Default)]
pub(crate) struct SessionPolicy {
    /// Policy for the commands when the client has disconnected.
    pub(crate) on_loss: Option<OnLoss>,
    /// Time within which a cancelled command of the session must end.
    pub(crate) grace: Option<Duration>,
}

impl Sessions {
    /// Creates the table of sessions with the default policies.
    pub(super) fn new(on_loss: OnLoss, grace: Duration) -> Sessions {
        Sessions {
            records: BTreeMap::new(),
            on_loss,
            grace,
        }
    }

    /// Returns an error if the session with this number belongs to another connected client and is not shared. `what`
    /// is the name of the object in the error.
    pub(super) fn ensure_may_act_in(
        &self,
        client: Client,
        session: u64,
        what: &str,
    ) -> Result<(), ApiError> {
        let session = self.records.get(&session);
        let owned = session.filter(|s| !s.closed && !s.shared && !client.manages());
        match owned.is_some_and(|s| s.client != client) {
            true => Err(ApiError::NotOwner(what.to_owned())),
            false => Ok(()),
        }
    }

    /// Returns an error if the client may not open another session without exceeding the limit or its share.
    pub(super) fn has_room(&self, client: Client, limits: &Limits) -> Result<(), ApiError> {
        let held = self.records.values().map(|s| (s.holder(), 1));
        let taken = Usage::for_client(Some(client), held);
        taken
            .admit(1, limits.sessions)
            .map_err(|full| ApiError::limit(full, "sessions"))
    }

    /// Opens the session with this number for a client and returns its name, such as `s5`. On a shared session, every
    /// client that knows its name may act. `most` is the maximum length of the display name in bytes.
    pub(super) fn open(
        &mut self,
        number: u64,
        (name, most): (&str, usize),
        policy: SessionPolicy,
        (client, shared): (Client, bool),
    ) -> String {
        let session = Session {
            name: truncated(name, most),
            on_loss: policy.on_loss.unwrap_or(self.on_loss),
            grace: policy.grace.unwrap_or(self.grace),
            client,
            shared,
            closed: false,
            watchers: Subscribers::default(),
        };
        self.records.insert(number, session);
        format!("s{number}")
    }

    /// Returns the time within which a cancelled command of the session with this number must end.
    pub(super) fn grace(&self, session: u64) -> Duration {
        self.records
            .get(&session)
            .map_or(self.grace, |session| session.grace)
    }

    /// Returns the number of the session with this name, or an error if there is none.
    pub(super) fn number(&self, name: &str) -> Result<u64, ApiError> {
        let found = parse_number(name, 's').filter(|n| self.records.contains_key(n));
        found.ok_or_else(|| ApiError::Unknown(format!("session {name}")))
    }

    /// Assigns a session whose client has disconnected to another client. Returns whether the session was free to be
    /// taken over.
    pub(crate) fn take_over_session(&mut self, name: &str, client: Client) -> bool {
        let session = parse_number(name, 's').and_then(|n| self.records.get_mut(&n));
        session.is_some_and(|session| {
            let was_closed = std::mem::replace(&mut session.closed, false);
            if was_closed {
                session.client = client;
            }
            was_closed
        })
    }

    /// Returns the names of all sessions, each with the display name that the client gave.
    pub(crate) fn all(&self) -> impl Iterator<Item = (String, &str)> {
        let sessions = self.records.iter();
        sessions.map(|(number, session)| (format!("s{number}"), session.name.as_str()))
    }

    /// Handles the disconnection of the client of a session: closes the session. Returns the number of the session and
    /// its policy for such a loss; `None` if there is no such session.
    pub(super) fn lose(&mut self, name: &str, log: &mut EventLog) -> Option<(u64, OnLoss)> {
        let number = parse_number(name, 's')?;
        log.write(format_args!(
            "the client of session {name} has disconnected"
        ));
        let session = self.records.get_mut(&number)?;
        session.closed = true;
        Some((number, session.on_loss))
    }

    /// Closes the session with this number. The session is removed once it owns nothing.
    pub(super) fn close(&mut self, number: u64) {
        if let Some(session) = self.records.get_mut(&number) {
            session.closed = true;
        }
    }

    /// Subscribes to the session with this name: reports that the session is open now, and later that it was closed.
    pub(crate) fn watch(&mut self, name: &str, sink: Box<dyn Subscriber>) -> Result<(), ApiError> {
        let number = self.number(name)?;
        if let Some(session) = self.records.get_mut(&number) {
            session.watchers.add(sink, &Update::Session(true));
        }
        Ok(())
    }

    /// Returns the client of the session with this number; `None` if there is no such session.
    pub(super) fn client_of(&self, session: u64) -> Option<Client> {
        self.records.get(&session).map(|s| s.client)
    }

    /// Returns the client whose quotas the commands and tasks of the session with this number count for.
    pub(super) fn holder(&self, session: u64) -> Holder {
        let session = self.records.get(&session);
        session.map_or(Holder::Unowned, Session::holder)
    }

    /// Removes the session with this number, which owns nothing any more, if it is closed. Notifies its subscribers.
    pub(super) fn remove_closed(&mut self, number: u64) {
        let closed = self.records.get(&number).is_some_and(|s| s.closed);
        if closed && let Some(mut session) = self.records.remove(&number) {
            session.watchers.notify(&Update::Session(false));
        }
    }

    /// Returns the list of subscribers of each session.
    pub(super) fn watchers(&mut self) -> impl Iterator<Item = &mut Subscribers> {
        self.records.values_mut().map(|s| &mut s.watchers)
    }
}
