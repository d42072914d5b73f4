//! Requests, images and events that a cut keeps besides those of its ticks, so that readers know the commands that run in them.

use std::collections::{BTreeMap, BTreeSet};

use serde_json::Value;

use super::cut_window::{CutWindow, Place};
use crate::mcap::reader::Recording;

/// Requests and images of a recording that a cut keeps, and the commands that run at its beginning.
pub(super) struct CutSelection {
    /// Tickets of the kept requests.
    tickets: BTreeSet<u64>,
    /// New numbers of the kept images, by their numbers in the recording: readers expect numbers without gaps.
    images: BTreeMap<u64, u64>,
    /// Numbers of the commands that run at the beginning of the cut.
    running: BTreeSet<u64>,
}

impl CutSelection {
    pub(super) fn new(recording: &Recording, window: &CutWindow) -> CutSelection {
        let is_before = |event: &&Value| {
            let tick = event["tick"].as_u64();
            tick.is_some_and(|tick| window.place_of_tick(tick) == Place::Before)
        };
        let (mut running, mut freed) = (BTreeSet::new(), BTreeSet::new());
        for event in recording.events.iter().filter(is_before) {
            let Some(id) = event["id"].as_u64() else {
                continue;
            };
            match event["event"].as_str() {
                Some("started") => drop(running.insert(id)),
                Some("ended") => drop(running.remove(&id)),
                Some("freed") => drop(freed.insert(id)),
                _ => {}
            }
        }
        let answers = answers(&recording.events);
        let requests = recording.requests.iter();
        let kept: Vec<&Value> = requests
            .filter(|request| keeps(request, &answers, window, &freed))
            .collect();
        let images: BTreeSet<u64> = kept.iter().filter_map(|r| r["image"].as_u64()).collect();
        CutSelection {
            tickets: kept.iter().filter_map(|r| r["ticket"].as_u64()).collect(),
            images: images.into_iter().zip(0..).collect(),
            running,
        }
    }

    /// Returns a request as it is kept, with the new number of its image; `None` if it is left out.
    pub(super) fn request(&self, mut request: Value) -> Option<Value> {
        let ticket = request["ticket"].as_u64()?;
        if !self.tickets.contains(&ticket) {
            return None;
        }
        if let Some(image) = request["image"].as_u64() {
            request["image"] = self.images.get(&image).copied().into();
        }
        Some(request)
    }

    /// Returns the new number of an image; `None` if it is left out.
    pub(super) fn image(&self, number: u64) -> Option<u64> {
        self.images.get(&number).copied()
    }

    /// Returns whether an event before the cut is kept: the start of a command that runs at its beginning.
    pub(super) fn is_start_of_running(&self, event: &Value) -> bool {
        let id = event["id"].as_u64();
        event["event"] == "started" && id.is_some_and(|id| self.running.contains(&id))
    }
}

/// Returns the tick of the answer to each request, by ticket.
fn answers(events: &[Value]) -> BTreeMap<u64, u64> {
    let answers = events.iter().filter(|event| event["event"] == "answer");
    let answers = answers.filter_map(|e| Some((e["ticket"].as_u64()?, e["tick"].as_u64()?)));
    answers.collect()
}

/// Returns whether a request is kept: one that was carried out in the kept ticks, or one before them that loaded a command which
/// still exists.
fn keeps(
    request: &Value,
    answers: &BTreeMap<u64, u64>,
    window: &CutWindow,
    freed: &BTreeSet<u64>,
) -> bool {
    let ticket = request["ticket"].as_u64();
    let Some(answer) = ticket.and_then(|ticket| answers.get(&ticket)) else {
        // The answer is missing at the end of a recording that was cut off.
        return !window.is_early;
    };
    match window.place_of_tick(*answer) {
        Place::Within => true,
        Place::After => !window.is_early,
        Place::Before => {
            let command = request["command"].as_u64();
            request["ask"] == "load" && command.is_some_and(|id| !freed.contains(&id))
        }
    }
}
