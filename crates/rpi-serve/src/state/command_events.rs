//! Effects of the core's notices on the records of commands.

use rpi_device::Discontinuity;
use rpi_runtime::control::{AbortReason, Cause, CommandId, CommandState, Ending};
use rpi_runtime::run::actuator_discontinuity_text;

use super::commands::Commands;
use super::core_link::CoreLink;
use super::deferred::CommandOp;
use super::devices::Devices;
use super::eval::start_eval;
use super::event_log::EventLog;
use super::record::{CommandRecord, has_yielded, results};
use super::source_location::SourceLocation;
use super::types::{ApiError, Phase, cause_text, fault_text};

/// Handles the event that the core has inserted the command with this number in its table. `may_start` is an error
/// during an emergency stop.
pub(super) fn on_inserted(
    commands: &mut Commands,
    number: u64,
    may_start: Result<(), ApiError>,
    core: &mut CoreLink,
) {
    let Some(record) = commands.get_mut(number) else {
        return;
    };
    record.set_phase(Phase::Core(CommandState::Ready));
    let (eval, abandoned) = (record.eval.is_some(), record.unload_at_end);
    if eval {
        start_eval(commands, number, may_start, core);
    } else if abandoned {
        // Its client disconnected while it was loaded.
        commands.defer(number, CommandOp::Unload, core);
    }
}

/// Handles the event that the command with this id has changed its life-cycle state.
pub(super) fn set_phase(commands: &mut Commands, id: CommandId, state: CommandState) {
    if let Some(record) = commands.record_of(id) {
        record.set_phase(Phase::Core(state));
    }
}

/// Handles the event that a command has ended while a device was moving. The device brakes within its own limits; the
/// command's record lists its name.
pub(super) fn on_braked(commands: &mut Commands, id: CommandId, device: String) {
    let Some(record) = commands.record_of(id) else {
        return;
    };
    if record.status.location.is_none()
        && let Some(image) = &record.image
    {
        let place = image.location_of_device(&device);
        record.status.location =
            place.map(|p| SourceLocation::from_node(p, record.text.as_deref()));
    }
    if !record.status.braked.contains(&device) {
        record.status.braked.push(device);
    }
}

/// Handles the event that the first set-points of a command do not continue those of its predecessor. The discontinuity
/// is logged and reported to subscribers even if the policy allows it.
pub(super) fn on_discontinuity(
    commands: &mut Commands,
    id: CommandId,
    (jump, devices): (&Discontinuity, &Devices),
    log: &mut EventLog,
) {
    let jump = actuator_discontinuity_text(jump, &devices.actuator_name(jump.resource));
    let number = commands.find_by_id(id).map(|(number, _)| number);
    let Some((number, record)) = number.zip(commands.record_of(id)) else {
        return;
    };
    let line = format!(
        "{} takes over with a jump: {jump}",
        record.display_name(number)
    );
    record.subscriptions.report_discontinuity(&jump);
    record.status.discontinuity.get_or_insert(jump);
    log.write(format_args!("{line}"));
}

/// Handles the event that a command has ended. `stopped` is true if a rule has stopped the command and started a
/// successor.
pub(super) fn on_ended(
    commands: &mut Commands,
    id: CommandId,
    (ending, stopped): (Ending, bool),
    log: &mut EventLog,
) {
    let number = commands.find_by_id(id).map(|(number, _)| number);
    let Some((number, record)) = number.zip(commands.record_of(id)) else {
        return;
    };
    record_ending(record, ending, stopped);
    let how = record.status.result.clone();
    let how = how.unwrap_or_else(|| match fault_text(&ending) {
        Some(why) => format!("{}, {why}", cause_text(&ending)),
        None => cause_text(&ending).to_owned(),
    });
    log.write(format_args!(
        "{} has ended: {how}, error {}",
        record.display_name(number),
        ending.error
    ));
}

fn record_ending(record: &mut CommandRecord, ending: Ending, stopped: bool) {
    if let (Cause::Result(k), Some(image)) = (ending.cause, &record.image) {
        record.status.result = results(image).get(k).map(|name| (*name).to_owned());
    }
    if let (Cause::Fault(fault), Some(image)) = (ending.cause, &record.image) {
        let place = image.location_of(fault.slot);
        record.status.location =
            place.map(|p| SourceLocation::from_node(p, record.text.as_deref()));
    }
    if ending.cause == Cause::Aborted(AbortReason::Overrun) {
        let worst = record.overruns();
        let fragment = worst.and_then(|(_, worst)| record.fragment(worst.fragment));
        record.status.location = fragment.map(SourceLocation::from_fragment);
    }
    let yielded = record
        .image
        .as_ref()
        .is_some_and(|i| has_yielded(i, &ending));
    (record.status.ending, record.status.taken_over) = (Some(ending), stopped || yielded);
    record.set_phase(Phase::Core(CommandState::Terminated));
}
