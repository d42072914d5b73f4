//! Methods for commands.

use serde_json::{Value, json};

use super::connection::{Call, MethodResult, RpcConnection};
use super::params::{literal, object_type};
use super::subscriber;
use crate::message_size::wait_for_answer_turn;
use crate::state::{CommandRecord, Reply, ServerState};

/// JSON-RPC method `command.load`: loads a command from the text of a program or net.
pub(super) fn load(front: &mut RpcConnection, call: &Call<'_>) -> MethodResult {
    let load = call.load("command")?;
    let answer = call.period_answer(front, load.period_ns);
    let reply = call.deferred_reply(move |name| answer("command", name));
    front.take_over_session(load.session)?;
    front.state.lock().load(&load, reply);
    Ok(None)
}

/// Carries out a JSON-RPC method on one command, after a check that the client may act on the command. `what` is the
/// operation, such as start or abort; it receives the name of the command and the callback for the answer.
pub(super) fn one(
    front: &mut RpcConnection,
    call: &Call<'_>,
    what: fn(&mut ServerState, &str, Reply),
) -> MethodResult {
    let reply = call.deferred_reply(|_| json!({}));
    let command = call.text("command")?;
    front.ensure_may_act(&[command])?;
    what(&mut front.state.lock(), command, reply);
    Ok(None)
}

/// JSON-RPC method `command.cancel`: cancels a command, which is aborted if it has not ended after a grace time.
pub(super) fn cancel(front: &mut RpcConnection, call: &Call<'_>) -> MethodResult {
    let reply = call.deferred_reply(|_| json!({}));
    let command = call.text("command")?;
    let grace = call.optional_seconds("grace")?;
    front.ensure_may_act(&[command])?;
    front.state.lock().cancel(command, grace, reply);
    Ok(None)
}

/// JSON-RPC method `command.set`: sets inputs of a command, all of them between the same two cycles.
pub(super) fn set(front: &mut RpcConnection, call: &Call<'_>) -> MethodResult {
    let command = call.text("command")?;
    front.ensure_may_act(&[command])?;
    let values = call.required("values", object_type())?;
    let texts = values
        .iter()
        .map(|(key, value)| (key.as_str(), literal(value)));
    let texts: Vec<(&str, String)> = texts.collect();
    let values = texts
        .iter()
        .map(|(key, text)| (command, *key, text.as_str()));
    let values: Vec<_> = values.collect();
    front
        .state
        .lock()
        .set(&values, call.deferred_reply(|_| json!({})));
    Ok(None)
}

/// JSON-RPC method `command.describe`: returns the state, the ports and the values of a command.
pub(super) fn describe(front: &mut RpcConnection, call: &Call<'_>) -> MethodResult {
    let name = call.text("command")?;
    let bytes = front.state.lock().objects.commands.find(name)?.1.bytes();
    // Until the answer is queued: the queue has a limit for all clients.
    let _turn = wait_for_answer_turn(bytes);
    let state = front.state.lock();
    let (_, record) = state.objects.commands.find(name)?;
    let mut description = description(record);
    if let Some(bound_ns) = state.core.bound_ns(record) {
        description["bound"] = json!(seconds(bound_ns));
    }
    drop(state);
    call.answer(description);
    Ok(None)
}

/// JSON-RPC method `commands`: returns all commands with their states.
pub(super) fn list_commands(front: &mut RpcConnection, _: &Call<'_>) -> MethodResult {
    let state = front.state.lock();
    let commands = state.objects.commands.all().map(|(name, record)| {
        let mut answer = subscriber::status(&record.status);
        answer["command"] = json!(name);
        answer["title"] = json!(record.title);
        answer
    });
    Ok(Some(json!({"commands": commands.collect::<Value>()})))
}

fn description(record: &CommandRecord) -> Value {
    let mut answer = subscriber::status(&record.status);
    answer["title"] = json!(record.title);
    answer["cycles"] = json!(record.cycles());
    answer["period"] = json!(seconds(record.period_ns()));
    answer["values"] = subscriber::values(&record.values());
    if let Some((count, worst)) = record.overruns() {
        answer["overruns"] = json!({
            "count": count,
            "tick": worst.tick,
            "took": seconds(worst.took_ns),
            "late": seconds(worst.late_ns),
            "fragment": record.fragment(worst.fragment),
        });
    }
    if let Some(image) = &record.image {
        let port = |key: &str, ty: rpi_image::Type, unit: &str| json!({"key": key, "type": ty.to_string(), "unit": unit});
        let inputs = image.inputs.iter();
        let inputs = inputs.map(|i| port(&i.key, i.value.ty, &i.unit));
        answer["inputs"] = inputs.collect();
        let exports = image.exports.iter();
        let exports = exports.map(|e| port(&e.key, e.value.ty, &e.unit));
        answer["exports"] = exports.collect();
        answer["results"] = json!(crate::state::results(image));
    }
    answer
}

fn seconds(ns: u64) -> f64 {
    ns as f64 * 1e-9
}
