//! Effects of the core's notices on the records of commands.

use rpi_device::Jump;
use rpi_runtime::control::{Cause, CommandId, Ending, State, Why};
use rpi_runtime::run::jump_text;

use super::commands::Commands;
use super::core_link::CoreLink;
use super::devices::Devices;
use super::eval::start_eval;
use super::journal::Journal;
use super::owed::Debt;
use super::place::Place;
use super::record::{Record, results, yields};
use super::types::{Failure, Phase, cause, why};

/// A command is in the core's table. `may_start` is an error during an emergency stop.
pub(super) fn inserted(
    commands: &mut Commands,
    number: u64,
    may_start: Result<(), Failure>,
    core: &mut CoreLink,
) {
    let Some(record) = commands.get_mut(number) else {
        return;
    };
    record.set_phase(Phase::Is(State::Ready));
    let (eval, abandoned) = (record.eval.is_some(), record.unload_at_end);
    if eval {
        start_eval(commands, number, may_start, core);
    } else if abandoned {
        // Its client disconnected while it was loaded.
        commands.owe(number, Debt::Unload, core);
    }
}

/// A command has changed its state.
pub(super) fn phase(commands: &mut Commands, id: CommandId, state: State) {
    if let Some(record) = commands.record_of(id) {
        record.set_phase(Phase::Is(state));
    }
}

/// A command has left a device moving, which brakes on its own.
pub(super) fn braked(commands: &mut Commands, id: CommandId, device: String) {
    let Some(record) = commands.record_of(id) else {
        return;
    };
    if record.status.place.is_none()
        && let Some(image) = &record.image
    {
        let place = image.place_of_device(&device);
        record.status.place = place.map(|p| Place::of_node(p, record.text.as_deref()));
    }
    if !record.status.braked.contains(&device) {
        record.status.braked.push(device);
    }
}

/// The first set-points of a command do not continue those of its predecessor. Reported even if the policy allows it.
pub(super) fn jumped(
    commands: &mut Commands,
    id: CommandId,
    (jump, devices): (&Jump, &Devices),
    log: &mut Journal,
) {
    let jump = jump_text(jump, &devices.actuator(jump.resource));
    let number = commands.numbered(id).map(|(number, _)| number);
    let Some((number, record)) = number.zip(commands.record_of(id)) else {
        return;
    };
    let line = format!("{} takes over with a jump: {jump}", record.called(number));
    record.subscriptions.tell_jump(&jump);
    record.status.jump.get_or_insert(jump);
    log.note(format_args!("{line}"));
}

/// A command has ended. `stopped` says that a rule has stopped it and started a successor.
pub(super) fn ended(
    commands: &mut Commands,
    id: CommandId,
    (ending, stopped): (Ending, bool),
    log: &mut Journal,
) {
    let number = commands.numbered(id).map(|(number, _)| number);
    let Some((number, record)) = number.zip(commands.record_of(id)) else {
        return;
    };
    note_ending(record, ending, stopped);
    let how = record.status.result.clone();
    let how = how.unwrap_or_else(|| match why(&ending) {
        Some(why) => format!("{}, {why}", cause(&ending)),
        None => cause(&ending).to_owned(),
    });
    log.note(format_args!(
        "{} has ended: {how}, error {}",
        record.called(number),
        ending.error
    ));
}

fn note_ending(record: &mut Record, ending: Ending, stopped: bool) {
    if let (Cause::Result(k), Some(image)) = (ending.cause, &record.image) {
        record.status.result = results(image).get(k).map(|name| (*name).to_owned());
    }
    if let (Cause::Fault(fault), Some(image)) = (ending.cause, &record.image) {
        let place = image.place_of(fault.cell);
        record.status.place = place.map(|p| Place::of_node(p, record.text.as_deref()));
    }
    if ending.cause == Cause::Aborted(Why::Overrun) {
        let worst = record.overruns();
        let fragment = worst.and_then(|(_, worst)| record.fragment(worst.fragment));
        record.status.place = fragment.map(Place::of_fragment);
    }
    let yielded = record.image.as_ref().is_some_and(|i| yields(i, &ending));
    (record.status.ending, record.status.taken_over) = (Some(ending), stopped || yielded);
    record.set_phase(Phase::Is(State::Terminated));
}
