//! Methods for sessions.

use serde_json::json;

use super::connection::{Call, MethodResult, RpcConnection};
use super::params::text_type;
use crate::limits::OnLoss;
use crate::state::{ApiError, SessionPolicy};

/// Method that opens a session, to which the commands of a client belong.
pub(super) fn open_session(front: &mut RpcConnection, call: &Call<'_>) -> MethodResult {
    let on_loss = call.one_of("on_loss", &OnLoss::ALL)?;
    let name = call.optional("name", text_type())?;
    let shared = call.boolean("shared")?;
    let policy = SessionPolicy {
        on_loss,
        grace: call.optional_seconds("grace")?,
    };
    let mut state = front.state.lock();
    let session = state.open_session(name.unwrap_or_default(), policy, (front.client, shared))?;
    drop(state);
    front.sessions.push(session.clone());
    Ok(Some(json!({"session": session})))
}

/// Method that aborts all commands of a session and closes it.
pub(super) fn close_session(front: &mut RpcConnection, call: &Call<'_>) -> MethodResult {
    let session = call.text("session")?;
    front.ensure_may_act(&[session])?;
    front.state.lock().abort_session(session)?;
    front.sessions.retain(|own| own != session);
    Ok(Some(json!({})))
}

impl RpcConnection {
    /// Takes over a session whose client has disconnected. Returns an error if the session belongs to another client.
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
