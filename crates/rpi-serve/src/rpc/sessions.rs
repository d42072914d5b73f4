//! Methods for sessions.

use serde_json::json;

use super::front::{Answer, Call, RpcFront};
use super::params::a_text;
use crate::limits::OnLoss;
use crate::state::Failure;

/// Opens a session.
pub(super) fn open_session(front: &mut RpcFront, call: &Call<'_>) -> Answer {
    let on_loss = call.one_of("on_loss", &OnLoss::ALL)?;
    let name = call.optional("name", a_text())?;
    let shared = call.flag("shared")?;
    let mut state = front.office.desk();
    let session = state.open_session(name.unwrap_or_default(), on_loss, (front.client, shared))?;
    drop(state);
    front.sessions.push(session.clone());
    Ok(Some(json!({"session": session})))
}

/// Aborts all commands of a session and closes it.
pub(super) fn close_session(front: &mut RpcFront, call: &Call<'_>) -> Answer {
    let session = call.text("session")?;
    front.may_act(&[session])?;
    front.office.desk().abort_session(session)?;
    front.sessions.retain(|own| own != session);
    Ok(Some(json!({})))
}

impl RpcFront {
    /// Takes over a session whose client has disconnected. Returns an error if the session belongs to another client.
    pub(super) fn take_up(&mut self, session: &str) -> Result<(), Failure> {
        self.may_act(&[session])?;
        if self
            .office
            .desk()
            .objects
            .sessions
            .take_up(session, self.client)
        {
            self.sessions.push(session.to_owned());
        }
        Ok(())
    }
}
