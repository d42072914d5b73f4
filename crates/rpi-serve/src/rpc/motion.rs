//! Methods for the override and the pause of all motions.

use serde_json::json;

use super::connection::{Call, MethodResult, RpcConnection};
use super::subscriber;

/// JSON-RPC method `motion.set`: sets the speed override (a factor from 0 to 1) or the pause of all motions, or both.
pub(super) fn set(front: &mut RpcConnection, call: &Call<'_>) -> MethodResult {
    let speed_override = call.optional_share("override")?;
    let paused = call.optional_flag("paused")?;
    let reply = call.deferred_reply(|_| json!({}));
    let mut state = front.state.lock();
    state.set_controls(speed_override, paused, reply)?;
    let set = state.controls.current();
    let (share, paused) = (set.speed_override, set.paused);
    let who = &front.who;
    state
        .log
        .write(format_args!("override {share}, paused {paused}, by {who}"));
    Ok(None)
}

/// JSON-RPC method `motion.state`: returns the speed override and the pause in force.
pub(super) fn state(front: &mut RpcConnection, _: &Call<'_>) -> MethodResult {
    let controls = front.state.lock().controls.current();
    Ok(Some(subscriber::motion(controls)))
}

/// JSON-RPC method `watch.motion`: subscribes to changes of the speed override and the pause.
pub(super) fn watch(front: &mut RpcConnection, call: &Call<'_>) -> MethodResult {
    let sink = front.sink(None)?;
    call.answer(json!({}));
    front.state.lock().controls.watch(sink);
    Ok(None)
}
