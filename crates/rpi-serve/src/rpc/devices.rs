//! Methods for devices.

use std::collections::BTreeMap;

use serde_json::{Value, json};

use super::connection::{Call, MethodResult, RpcConnection, suggestion};
use super::params::{literal, object_type};
use super::subscriber;
use crate::state::{ApiError, NewDevice, PARAMETERS};

/// Method `device.list`: returns name, type and state of each device of the cell.
pub(super) fn list_devices(front: &mut RpcConnection, _: &Call<'_>) -> MethodResult {
    let state = front.state.lock();
    let devices: Value = state.devices.all().map(subscriber::device).collect();
    Ok(Some(json!({"devices": devices})))
}

/// JSON-RPC method `device.add`: adds a simulated device.
pub(super) fn add_device(front: &mut RpcConnection, call: &Call<'_>) -> MethodResult {
    let parameters = call.optional("parameters", object_type())?;
    let parameters = parameters.into_iter().flatten();
    for (key, _) in parameters.clone() {
        if !PARAMETERS.contains(&key.as_str()) {
            let meant = suggestion(key, PARAMETERS.into_iter());
            let known = PARAMETERS.join(", ");
            return Err(ApiError::Invalid(format!(
                "parameters: unknown parameter {key}, expected one of {known}{meant}"
            )));
        }
    }
    let parameters: BTreeMap<String, String> = parameters
        .map(|(key, value)| (key.clone(), literal(value)))
        .collect();
    let new = NewDevice {
        peer: front.client.peer(),
        name: call.text("name")?,
        kind: call.text("type")?,
        parameters: &parameters,
    };
    let reply = call.deferred_reply(|name| json!({"device": name}));
    front.state.lock().add_device(&new, reply);
    Ok(None)
}

/// JSON-RPC method `device.remove`: removes a simulated device that a client has added.
pub(super) fn remove_device(front: &mut RpcConnection, call: &Call<'_>) -> MethodResult {
    let reply = call.deferred_reply(|_| json!({}));
    front.state.lock().remove_device(call.text("name")?, reply);
    Ok(None)
}
