//! Methods for tasks and the emergency stop.

use serde_json::{Value, json};

use super::front::{Answer, Call, RpcFront};
use super::sink;
use crate::state::{Failure, ServerState};

/// Loads a task of a program.
pub(super) fn load(front: &mut RpcFront, call: &Call<'_>) -> Answer {
    let load = call.load("task")?;
    let told = call.told_period(front, load.period_ns);
    let reply = call.later(move |name| told("task", name));
    front.take_up(load.session)?;
    front.office.desk().load_task(&load, reply);
    Ok(None)
}

/// Applies an operation to a task, after a check that the client may act on it.
pub(super) fn one(
    front: &mut RpcFront,
    call: &Call<'_>,
    what: fn(&mut ServerState, &str) -> Result<(), Failure>,
) -> Answer {
    let task = call.text("task")?;
    front.may_act(&[task])?;
    what(&mut front.office.desk(), task)?;
    Ok(Some(json!({})))
}

/// Returns the progress of a task.
pub(super) fn describe(front: &mut RpcFront, call: &Call<'_>) -> Answer {
    let state = front.office.desk();
    Ok(Some(sink::task(
        state.objects.tasks.status(call.text("task")?)?,
    )))
}

/// Subscribes to a task.
pub(super) fn watch(front: &mut RpcFront, call: &Call<'_>) -> Answer {
    let name = call.text("task")?;
    let sink = front.sink(Some(("task", name)))?;
    let mut state = front.office.desk();
    state.objects.tasks.status(name)?;
    call.answer(json!({}));
    state.objects.tasks.watch(name, sink)?;
    Ok(None)
}

/// Returns all tasks with their progress.
pub(super) fn list(front: &mut RpcFront, _: &Call<'_>) -> Answer {
    let state = front.office.desk();
    let tasks = state.objects.tasks.all().map(|(name, title, status)| {
        let mut told = sink::task(status);
        told["task"] = json!(name);
        told["title"] = json!(title);
        told
    });
    Ok(Some(json!({"tasks": tasks.collect::<Value>()})))
}

/// Emergency stop. Every authenticated client may request it.
pub(super) fn stop(front: &mut RpcFront, call: &Call<'_>) -> Answer {
    // A malformed `by` must not prevent the stop.
    let by = call.params.get("by").and_then(Value::as_str);
    let reply = call.later(|_| json!({}));
    let by = by.unwrap_or("a client");
    front.office.desk().emergency_stop(by, reply);
    Ok(None)
}

/// Resets an emergency stop.
pub(super) fn reset(front: &mut RpcFront, _: &Call<'_>) -> Answer {
    front.office.desk().reset_emergency()?;
    Ok(Some(json!({})))
}

/// Returns whether an emergency stop is in force, and who requested it.
pub(super) fn state(front: &mut RpcFront, _: &Call<'_>) -> Answer {
    Ok(Some(sink::emergency(front.office.desk().emergency.by())))
}

/// Subscribes to the emergency stop.
pub(super) fn watch_emergency(front: &mut RpcFront, call: &Call<'_>) -> Answer {
    let sink = front.sink(None)?;
    call.answer(json!({}));
    front.office.desk().emergency.watch(sink);
    Ok(None)
}
