//! Methods for devices.

use std::collections::BTreeMap;

use serde_json::{Value, json};

use super::front::{Answer, Call, RpcFront, meant};
use super::params::{an_object, literal};
use super::sink;
use crate::state::{Failure, NewDevice, PARAMETERS};

/// Returns all devices.
pub(super) fn list_devices(front: &mut RpcFront, _: &Call<'_>) -> Answer {
    let state = front.office.desk();
    let devices: Value = state.devices.all().map(sink::device).collect();
    Ok(Some(json!({"devices": devices})))
}

/// Adds a simulated device.
pub(super) fn add_device(front: &mut RpcFront, call: &Call<'_>) -> Answer {
    let parameters = call.optional("parameters", an_object())?;
    let parameters = parameters.into_iter().flatten();
    for (key, _) in parameters.clone() {
        if !PARAMETERS.contains(&key.as_str()) {
            let meant = meant(key, PARAMETERS.into_iter());
            let known = PARAMETERS.join(", ");
            return Err(Failure::Bad(format!(
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
    let reply = call.later(|name| json!({"device": name}));
    front.office.desk().add_device(&new, reply);
    Ok(None)
}

/// Removes a simulated device.
pub(super) fn remove_device(front: &mut RpcFront, call: &Call<'_>) -> Answer {
    let reply = call.later(|_| json!({}));
    front.office.desk().remove_device(call.text("name")?, reply);
    Ok(None)
}
