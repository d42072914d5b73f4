//! Replays a recording: the same requests in the same ticks, with the tick log in place of the devices.

use rpi_core::{Command, CommandId};
use rpi_runtime::tick_log::LoggedTick;

use super::error::RecordingError;
use super::reader::Recording;
use super::replay_report::ReplayReport;
use super::replay_requests::RecordedRequests;
use super::replay_run::ReplayRun;

/// Runs the core again with the requests and device answers of a recording, and compares every flow, set-point and
/// event, up to the first difference.
///
/// # Errors
/// Returns an error if the recording is not complete enough to be replayed.
pub fn replay(recording: &Recording) -> Result<ReplayReport, RecordingError> {
    replay_observed(recording, &mut |_, _, _| {})
}

/// Callback for a command in each of its cycles in a replay, after the evaluation and before the delays are stored: number
/// of the tick, id and state of the command.
pub type CycleCallback<'a> = &'a mut dyn FnMut(u64, CommandId, &Command);

/// Callback for a tick of a replay: the recorded tick, and the words of the entries about the flows of commands that the
/// replay has computed in it.
type TickCallback<'a> = &'a mut dyn FnMut(&LoggedTick<'_>, &[u64]) -> Result<(), RecordingError>;

/// Replays a recording as [`replay`] does, and passes each command to `observe` in each of its cycles.
///
/// # Errors
/// Returns an error if the recording is not complete enough to be replayed.
pub fn replay_observed(
    recording: &Recording,
    observe: CycleCallback<'_>,
) -> Result<ReplayReport, RecordingError> {
    run_replay(recording, observe, &mut |_, _| Ok(()))
}

/// Replays a recording as [`replay`] does, and passes each tick with its flows to `each`.
pub(super) fn replay_flows(
    recording: &Recording,
    each: TickCallback<'_>,
) -> Result<ReplayReport, RecordingError> {
    run_replay(recording, &mut |_, _, _| {}, each)
}

fn run_replay(
    recording: &Recording,
    observe: CycleCallback<'_>,
    each: TickCallback<'_>,
) -> Result<ReplayReport, RecordingError> {
    let mut requests = RecordedRequests::new(recording)?;
    let mut stage = ReplayRun::new(recording)?;
    stage.report.devices = requests.end();
    stage.report.lost = recording.lost;
    stage.report.cut.clone_from(&recording.cut);
    stage.report.functions =
        (recording.functions != rpi_math::REVISION).then_some(recording.functions);
    recording.for_each_tick(|words| {
        let tick = LoggedTick::from_words(words);
        let tick =
            tick.ok_or_else(|| RecordingError::Damaged("invalid tick on the tape".into()))?;
        if tick.lost > 0 || requests.is_past_end(tick.number) || stage.report.difference.is_some() {
            return Ok(false);
        }
        let requests = requests.of_tick(recording, tick.number, &mut stage.names)?;
        stage.tick(&tick, requests, observe);
        each(&tick, stage.flows())?;
        Ok(true)
    })?;
    if recording.cut.is_some() {
        stage.forgive_the_cut();
    } else if stage.report.agrees() {
        stage.check_missing_events(recording.excerpt.to.is_some());
    }
    Ok(stage.report)
}
