//! The requests of a recording, by the tick in which they were carried out.

use std::collections::{BTreeMap, BTreeSet};

use rpi_runtime::control::{Request, Ticket};
use rpi_sim::SimBank;

use super::error::RecordingError;
use super::names::NameTable;
use super::reader::Recording;
use super::request_json::RequestDecoder;

/// Requests of a recording. They are decoded, and their commands loaded, when a replay comes to their tick: the second time, too,
/// if it has returned to an earlier one.
pub(super) struct RecordedRequests {
    /// For each tick with requests, their indices in the recording in the order of execution.
    by_tick: BTreeMap<u64, Vec<usize>>,
    /// Number of the first tick in which a device was inserted or removed; `None` if there is none. The recording does not store
    /// the inserted device, so that a replay ends before it.
    devices: Option<u64>,
    /// Device bank with which the device names in the images are resolved.
    bank: SimBank,
}

impl RecordedRequests {
    /// Finds the requests that were carried out.
    ///
    /// # Errors
    /// Returns an error if an answer is invalid, or has no request.
    pub(super) fn new(recording: &Recording) -> Result<RecordedRequests, RecordingError> {
        let requests = recording.requests.iter().enumerate();
        let by_ticket: BTreeMap<u64, usize> = requests
            .filter_map(|(k, object)| Some((object["ticket"].as_u64()?, k)))
            .collect();
        let mut by_tick = BTreeMap::<u64, Vec<usize>>::new();
        for answer in answers(recording) {
            let (ticket, tick) = answer?;
            let index = by_ticket.get(&ticket);
            let index =
                index.ok_or_else(|| RecordingError::Missing(format!("request {ticket}")))?;
            by_tick.entry(tick).or_default().push(*index);
        }
        Ok(RecordedRequests {
            by_tick,
            devices: first_device_change(recording),
            bank: SimBank::new(&recording.cell, recording.tick_ns as f64 * 1e-9),
        })
    }

    /// Returns the number of the first tick that cannot be replayed because a device was inserted or removed; `None` if there is
    /// none.
    pub(super) fn end(&self) -> Option<u64> {
        self.devices
    }

    /// Returns whether a tick cannot be replayed because a device was inserted or removed.
    pub(super) fn is_past_end(&self, tick: u64) -> bool {
        self.devices.is_some_and(|from| tick >= from)
    }

    /// Returns the requests that were carried out in a tick, and adds their commands to `names`.
    ///
    /// # Errors
    /// Returns an error if a request is damaged.
    pub(super) fn of_tick(
        &mut self,
        recording: &Recording,
        tick: u64,
        names: &mut NameTable,
    ) -> Result<Vec<(Ticket, Request<()>)>, RecordingError> {
        let mut decoder = RequestDecoder {
            images: &recording.images,
            bank: &mut self.bank,
            continuity: recording.continuity,
        };
        let mut requests = Vec::new();
        for index in self.by_tick.get(&tick).into_iter().flatten() {
            let object = &recording.requests[*index];
            let request = decoder.decode(object);
            let request = request
                .ok_or_else(|| RecordingError::Damaged(format!("invalid request: {object}")))?;
            if let Request::Insert(id, command, _) = &request.1 {
                names.insert_command(*id, command.instance().image());
            }
            requests.push(request);
        }
        Ok(requests)
    }
}

/// Returns the ticket number of each answered request in the recording, with the number of the tick of the answer.
fn answers(recording: &Recording) -> impl Iterator<Item = Result<(u64, u64), RecordingError>> {
    let answers = recording.events.iter().filter(|e| e["event"] == "answer");
    answers.map(|answer| {
        let ids = answer["ticket"].as_u64().zip(answer["tick"].as_u64());
        ids.ok_or_else(|| RecordingError::Damaged(format!("invalid answer: {answer}")))
    })
}

/// Returns the number of the first tick in which a device was inserted or removed; `None` if there is none.
fn first_device_change(recording: &Recording) -> Option<u64> {
    let changes = recording.requests.iter().filter(|r| r["ask"] == "device");
    let tickets: BTreeSet<u64> = changes.filter_map(|r| r["ticket"].as_u64()).collect();
    let mut answers = answers(recording).flatten();
    answers
        .find(|(ticket, _)| tickets.contains(ticket))
        .map(|(_, tick)| tick)
}
