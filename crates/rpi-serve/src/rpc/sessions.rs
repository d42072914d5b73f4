//! Methods for sessions.

use serde_json::json;

use super::connection::{Call, MethodResult, RpcConnection};
use super::params::text_type;
use crate::limits::OnLoss;
use crate::state::{ApiError, SessionPolicy};

/// JSON-RPC method `session.open`: opens a session, which owns the commands and tasks that a client loads.
pub(super) fn open_session(front: &mut RpcConnection, call: &Call<'_>) -> MethodResult {
    let on_loss = call.one_of("on_loss", &OnLoss::ALL)?;
    let name = call.optional("name", text_type())?;
    let shared = call.boolean("shared")?;
    let policy = SessionPolicy {
        on_loss,
        grace: call.optional_seconds("grace")?,
    };
    let mut state = front.state.lock();
    let session = state.open_session(
        name.unwrap_or_default(),
        policy,
        (front.client, shared),
        &front.who,
    )?;
    drop(state);
    front.sessions.push(session.clone());
    Ok(Some(json!({"session": session})))
}

/// JSON-RPC method `session.close`: aborts all commands of a session and closes the session.
pub(super) fn close_session(front: &mut RpcConnection, call: &Call<'_>) -> MethodResult {
    let session = call.text("session")?;
    front.ensure_may_act(&[session])?;
    front.state.lock().abort_session(session)?;
    front.sessions.retain(|own| own != session);
    Ok(Some(json!({})))
}

/// JSON-RPC method `client.describe`: returns the identity of the calling client: name of its token, role and rights.
pub(super) fn describe_client(front: &mut RpcConnection, _: &Call<'_>) -> MethodResult {
    let who = &front.who;
    let rights = who.role.rights().iter().filter(|right| who.may(**right));
    let rights: Vec<&str> = rights.map(|right| right.name()).collect();
    Ok(Some(json!({
        "name": who.name.as_deref(), "role": who.role.name(), "rights": rights,
    })))
}

impl RpcConnection {
    /// Assigns a session to this client if the session's client has disconnected. Returns an error if the session
    /// belongs to another connected client.
    pub(super) fn take_over_session(&mut self, session: &str) -> Result<(), ApiError> {
        self.ensure_may_act(&[session])?;
        if self
            .state
            .lock()
            .objects
            .sessions
            .take_over_session(session, self.client)
        {
            self.sessions.push(session.to_owned());
        }
        Ok(())
    }
}
