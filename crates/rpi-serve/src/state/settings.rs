//! Inputs of commands that clients set.

use std::collections::BTreeMap;

use rpi_image::image::InputPort;
use rpi_runtime::control::{CommandId, CommandState, InputValue};

use super::commands::Commands;
use super::types::{ApiError, Phase};

/// Value for an input of a command: name of the command, key of the input, and literal of the value.
pub(crate) type Value<'a> = (&'a str, &'a str, &'a str);

/// Returns an error if `count` is more than `limit`, the number of values that one request may set.
pub(super) fn may_set(count: usize, limit: usize) -> Result<(), ApiError> {
    match count > limit {
        true => Err(ApiError::Limit("values in one request")),
        false => Ok(()),
    }
}

/// Converts values for inputs, given by command, key and literal, to values in memory, one per input. If an input
/// occurs twice, its last value counts. `limit` is the maximum number of memory slots.
pub(super) fn settings(
    commands: &Commands,
    values: &[Value<'_>],
    limit: usize,
) -> Result<Vec<InputValue>, ApiError> {
    let mut settings: BTreeMap<(CommandId, usize), InputValue> = BTreeMap::new();
    let mut cells = 0;
    for value in values {
        let setting = setting(commands, value)?;
        cells += setting.value.len();
        let old = settings.insert((setting.command, setting.input), setting);
        cells -= old.map_or(0, |old| old.value.len());
        may_set(cells, limit)?;
    }
    Ok(settings.into_values().collect())
}

fn setting(commands: &Commands, (name, key, value): &Value<'_>) -> Result<InputValue, ApiError> {
    let (_, record) = commands.find(name)?;
    let waits = [CommandState::Ready, CommandState::Scheduled].map(Phase::Core);
    let is_taken = record.given.iter().any(|given| given.key == *key);
    if is_taken && !waits.contains(&record.status.phase) {
        return Err(ApiError::Invalid(format!(
            "{key} of {name} is taken over at its start; it cannot be set any more"
        )));
    }
    let inputs = record.image.as_ref().map_or(&[][..], |i| &i.inputs);
    let found = inputs.iter().position(|i| i.key == *key);
    let input = found.ok_or_else(|| ApiError::Unknown(format!("input {key} of {name}")))?;
    Ok(InputValue {
        command: commands.command_id(name)?,
        input,
        value: parse_slots(&inputs[input], value)?,
    })
}

fn parse_slots(input: &InputPort, text: &str) -> Result<Box<[u64]>, ApiError> {
    let ty = input.value.ty;
    let bad = |why: String| ApiError::Invalid(format!("`{text}` is not of type {ty}: {why}"));
    let value = rpi_literal::parse(text, ty).map_err(|e| bad(e.to_string()))?;
    let value = value.ok_or_else(|| bad("an input must have a value".to_owned()))?;
    Ok(value.slots().into())
}

/// Marks an input of a command as set, so that the command can start without a predecessor from which it takes the
/// value over.
pub(super) fn mark_input_set(commands: &mut Commands, (name, key, _): &Value<'_>) {
    let number = commands.find(name).map(|(number, _)| number);
    let record = number.ok().and_then(|n| commands.get_mut(n));
    let given = record.into_iter().flat_map(|r| &mut r.given);
    given
        .filter(|given| given.key == *key)
        .for_each(|given| given.is_required = false);
}
