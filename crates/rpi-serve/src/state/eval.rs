//! Evaluation of a net for one cycle and its exports. Clients use it to read sensors and to compute kinematics.

use rpi_runtime::control::{AbortReason, CommandState};

use super::commands::Commands;
use super::core_link::CoreLink;
use super::deferred::CommandOp;
use super::pending::OnAnswer;
use super::subscriptions::export_texts;
use super::types::{ApiError, Phase, Reply};

/// Callback for the exports of a net after its single cycle: key and literal of each.
pub(crate) type EvalCallback = Box<dyn FnOnce(Vec<(String, String)>) + Send>;

/// Request of a client to evaluate a net for a single cycle.
pub(crate) struct Eval {
    /// Callback for the error if the net is not evaluated.
    pub(super) reply: Reply,
    pub(super) callback: EvalCallback,
}

/// Reports the exports of the evaluations whose single cycle has run, and unloads their commands.
pub(super) fn finish_evals(commands: &mut Commands, core: &mut CoreLink) {
    let evals = commands.iter().filter(|(_, r)| r.eval.is_some());
    let over: Vec<u64> = evals
        .filter(|(_, r)| {
            let ran = r.snapshot.as_ref().is_some_and(|b| b.cycles() > 0);
            ran || matches!(r.status.phase, Phase::Core(CommandState::Terminated))
        })
        .map(|(number, _)| number)
        .collect();
    for number in over {
        finish_eval(commands, number, core);
    }
}

fn finish_eval(commands: &mut Commands, number: u64, core: &mut CoreLink) {
    let Some(record) = commands.get_mut(number) else {
        return;
    };
    let cells = record.snapshot.as_ref().and_then(|b| b.read_consistent());
    let exports = record.image.as_ref().map_or(&[][..], |i| &i.exports);
    let values = cells.map(|cells| export_texts(exports, &cells));
    record.unload_at_end = true;
    if let Some(eval) = record.eval.take() {
        match values {
            Some(values) => (eval.callback)(values),
            None => (eval.reply)(Err(ApiError::Invalid("the net did not run".to_owned()))),
        }
    }
    commands.defer(number, CommandOp::Abort(AbortReason::Request), core);
    commands.defer(number, CommandOp::Unload, core);
}

/// Starts the command that evaluates a net for a single cycle. `may_start` is an error during an emergency stop; then
/// only a command without actuators is started.
pub(super) fn start_eval(
    commands: &mut Commands,
    number: u64,
    may_start: Result<(), ApiError>,
    core: &mut CoreLink,
) {
    let Some(record) = commands.get(number) else {
        return;
    };
    let moves = record
        .image
        .as_ref()
        .is_some_and(|i| !i.actuators.is_empty());
    let started = match may_start {
        Err(why) if moves => Err(why),
        _ => record.id.map_or(Err(ApiError::QueueFull), |id| {
            core.control.start(id).map_err(ApiError::from)
        }),
    };
    match started {
        Ok(ticket) => drop(core.track_request(Ok(ticket), OnAnswer::Eval(number), None)),
        Err(why) => fail_eval(commands, number, why, core),
    }
}

/// Reports the error `why` to the client whose evaluation of a net cannot run, and unloads the command.
pub(super) fn fail_eval(commands: &mut Commands, number: u64, why: ApiError, core: &mut CoreLink) {
    let record = commands.get_mut(number);
    if let Some(eval) = record.and_then(|r| r.eval.take()) {
        (eval.reply)(Err(why));
    }
    commands.defer(number, CommandOp::Unload, core);
}
