//! Methods for tasks and the emergency stop.

use serde_json::{Value, json};

use super::connection::{Call, MethodResult, RpcConnection};
use super::subscriber;
use crate::role::Right;
use crate::state::{ApiError, ServerState, StopOrigin};

/// JSON-RPC method `task.load`: loads a task from the text of a program.
pub(super) fn load(front: &mut RpcConnection, call: &Call<'_>) -> MethodResult {
    let load = call.load("task")?;
    let answer = call.period_answer(front, load.period_ns);
    let reply = call.deferred_reply(move |name| answer("task", name));
    front.take_over_session(load.session)?;
    front.state.lock().load_task(&load, reply);
    Ok(None)
}

/// Carries out a JSON-RPC method on one task, after a check that the client may act on the task. `what` is the
/// operation, such as start or cancel; it receives the name of the task.
pub(super) fn task_op(
    front: &mut RpcConnection,
    call: &Call<'_>,
    what: fn(&mut ServerState, &str) -> Result<(), ApiError>,
) -> MethodResult {
    let task = call.text("task")?;
    front.ensure_may_act(&[task])?;
    what(&mut front.state.lock(), task)?;
    Ok(Some(json!({})))
}

/// JSON-RPC method `task.describe`: returns the progress of a task.
pub(super) fn describe(front: &mut RpcConnection, call: &Call<'_>) -> MethodResult {
    let state = front.state.lock();
    Ok(Some(subscriber::task(
        state.objects.tasks.status(call.text("task")?)?,
    )))
}

/// JSON-RPC method `watch.task`: subscribes to the progress of a task.
pub(super) fn watch(front: &mut RpcConnection, call: &Call<'_>) -> MethodResult {
    let name = call.text("task")?;
    let sink = front.sink(Some(("task", name)))?;
    let mut state = front.state.lock();
    state.objects.tasks.status(name)?;
    call.answer(json!({}));
    state.objects.tasks.watch(name, sink)?;
    Ok(None)
}

/// JSON-RPC method `tasks`: returns all tasks with their progress.
pub(super) fn list(front: &mut RpcConnection, _: &Call<'_>) -> MethodResult {
    let state = front.state.lock();
    let tasks = state.objects.tasks.all().map(|(name, title, status)| {
        let mut answer = subscriber::task(status);
        answer["task"] = json!(name);
        answer["title"] = json!(title);
        answer
    });
    Ok(Some(json!({"tasks": tasks.collect::<Value>()})))
}

/// JSON-RPC method `emergency.stop`: requests an emergency stop. Every authenticated client may use it.
pub(super) fn stop(front: &mut RpcConnection, call: &Call<'_>) -> MethodResult {
    // A malformed `by` must not prevent the stop.
    let by = call.params.get("by").and_then(Value::as_str);
    let reply = call.deferred_reply(|_| json!({}));
    let by = by.unwrap_or("a client");
    // The name of the token is certain, `by` is what the client says.
    let by = match &front.who.name {
        Some(name) => format!("{by} (client {name})"),
        None => by.to_owned(),
    };
    let by = (by.as_str(), StopOrigin::Client);
    front.state.lock().emergency_stop(by, reply);
    Ok(None)
}

/// JSON-RPC method `emergency.reset`: resets an emergency stop, so that commands can be started again.
pub(super) fn reset(front: &mut RpcConnection, _: &Call<'_>) -> MethodResult {
    let by = front.who.to_string();
    let origin = match front.who.may(Right::Release) {
        true => StopOrigin::Operator,
        false => StopOrigin::Client,
    };
    front.state.lock().reset_emergency(&by, origin)?;
    Ok(Some(json!({})))
}

/// JSON-RPC method `emergency.state`: returns whether an emergency stop is in force, and who requested it.
pub(super) fn state(front: &mut RpcConnection, _: &Call<'_>) -> MethodResult {
    let state = front.state.lock();
    Ok(Some(subscriber::emergency(state.emergency.by())))
}

/// JSON-RPC method `watch.emergency`: subscribes to requests and resets of the emergency stop.
pub(super) fn watch_emergency(front: &mut RpcConnection, call: &Call<'_>) -> MethodResult {
    let sink = front.sink(None)?;
    call.answer(json!({}));
    front.state.lock().emergency.watch(sink);
    Ok(None)
}
