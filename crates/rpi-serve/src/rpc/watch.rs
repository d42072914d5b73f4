//! Methods that subscribe to commands, rules, sessions and devices.

use std::time::Duration;

use serde_json::json;

use super::connection::{Call, MethodResult, RpcConnection};
use super::subscriber::RpcSubscriber;
use crate::state::{ApiError, TOO_MANY_SUBSCRIPTIONS, WatchRequest};

/// JSON-RPC method `watch.command`: subscribes to the state and the exported values of a command.
pub(super) fn watch_command(front: &mut RpcConnection, call: &Call<'_>) -> MethodResult {
    let name = call.text("command")?;
    let watching = WatchRequest {
        period: call.seconds("period", 0.02)?,
        end_delay: Duration::ZERO,
        sink: front.sink(Some(("command", name)))?,
    };
    let mut state = front.state.lock();
    state.objects.commands.find(name)?;
    call.answer(json!({}));
    state.objects.commands.watch(name, watching)?;
    Ok(None)
}

/// JSON-RPC method `watch.rule`: subscribes to the state of a rule.
pub(super) fn watch_rule(front: &mut RpcConnection, call: &Call<'_>) -> MethodResult {
    let name = call.text("rule")?;
    let sink = front.sink(Some(("rule", name)))?;
    let mut state = front.state.lock();
    state.rules.ensure_rule_exists(name)?;
    call.answer(json!({}));
    state.watch_rule(name, sink)?;
    Ok(None)
}

/// JSON-RPC method `watch.session`: subscribes to a session, to be notified when it is closed.
pub(super) fn watch_session(front: &mut RpcConnection, call: &Call<'_>) -> MethodResult {
    let name = call.text("session")?;
    let sink = front.sink(Some(("session", name)))?;
    front.state.lock().objects.sessions.watch(name, sink)?;
    Ok(Some(json!({})))
}

/// JSON-RPC method `watch.devices`: subscribes to all devices: those added and removed, and their errors.
pub(super) fn watch_devices(front: &mut RpcConnection, call: &Call<'_>) -> MethodResult {
    let sink = front.sink(None)?;
    call.answer(json!({}));
    front.state.lock().devices.watch(sink);
    Ok(None)
}

impl RpcConnection {
    /// Creates a subscriber for updates about an object, given by kind and name (`None` if the updates concern no named
    /// object). Returns an error if the client has too many subscriptions.
    pub(super) fn sink(
        &self,
        about: Option<(&'static str, &str)>,
    ) -> Result<Box<RpcSubscriber>, ApiError> {
        let out = self
            .outbox
            .subscription_sender()
            .ok_or(TOO_MANY_SUBSCRIPTIONS)?;
        let about = about.map(|(kind, name)| (kind, name.to_owned()));
        Ok(Box::new(RpcSubscriber { about, out }))
    }
}
