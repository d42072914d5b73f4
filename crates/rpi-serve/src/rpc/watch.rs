//! Methods that subscribe to commands, rules, sessions and devices.

use std::time::Duration;

use serde_json::json;

use super::front::{Answer, Call, RpcFront};
use super::sink::RpcSink;
use crate::state::{Failure, TOO_CURIOUS, Watching};

/// Subscribes to a command.
pub(super) fn watch_command(front: &mut RpcFront, call: &Call<'_>) -> Answer {
    let name = call.text("command")?;
    let watching = Watching {
        period: call.seconds("period", 0.02)?,
        settle: Duration::ZERO,
        sink: front.sink(Some(("command", name)))?,
    };
    let mut state = front.office.desk();
    state.objects.commands.find(name)?;
    call.answer(json!({}));
    state.objects.commands.watch(name, watching)?;
    Ok(None)
}

/// Subscribes to a rule.
pub(super) fn watch_rule(front: &mut RpcFront, call: &Call<'_>) -> Answer {
    let name = call.text("rule")?;
    let sink = front.sink(Some(("rule", name)))?;
    let mut state = front.office.desk();
    state.rules.find_rule(name)?;
    call.answer(json!({}));
    state.watch_rule(name, sink)?;
    Ok(None)
}

/// Subscribes to a session.
pub(super) fn watch_session(front: &mut RpcFront, call: &Call<'_>) -> Answer {
    let name = call.text("session")?;
    let sink = front.sink(Some(("session", name)))?;
    front.office.desk().objects.sessions.watch(name, sink)?;
    Ok(Some(json!({})))
}

/// Subscribes to all devices.
pub(super) fn watch_devices(front: &mut RpcFront, call: &Call<'_>) -> Answer {
    let sink = front.sink(None)?;
    call.answer(json!({}));
    front.office.desk().devices.watch(sink);
    Ok(None)
}

impl RpcFront {
    /// Creates a subscriber for updates about an object, given by kind and name.
    pub(super) fn sink(
        &self,
        about: Option<(&'static str, &str)>,
    ) -> Result<Box<RpcSink>, Failure> {
        let out = self.out.post().ok_or(TOO_CURIOUS)?;
        let about = about.map(|(kind, name)| (kind, name.to_owned()));
        Ok(Box::new(RpcSink { about, out }))
    }
}
