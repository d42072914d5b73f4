//! Values of a run that goes on, by flow, for the page that shows it.
//!
//! The thread that writes the recording collects the values of a few ticks and hands them over when no reader has the lock, so that it
//! never waits for a reader.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use rpi_image::Image;
use rpi_runtime::run::Recorded;
use rpi_sim::Cell;
use serde_json::Value;

use super::recorder::RunSources;
use super::run_data::{ColumnBuilder, FragmentActivity, RunData, actuated_devices};
use super::scene::arm_geometry;
use super::topic_table::ViewMessage;

/// Maximum number of values that are kept, 128 MiB of memory. Then the older half is dropped.
const MAX_VALUES: usize = 1 << 24;
/// Maximum number of events that are kept. Then the older half is dropped.
const MAX_EVENTS: usize = 1 << 16;
/// Time between two handovers of values to the readers.
const HANDOVER: Duration = Duration::from_millis(20);

/// Values of a run that goes on, shared by the run and its readers.
#[derive(Clone)]
pub struct LiveRun(Arc<Mutex<RunValues>>);

/// What is known of a run.
struct RunValues {
    /// Its values. The end of a command that runs is `u64::MAX`.
    run: RunData,
    /// Number of values of the run.
    values: usize,
}

impl LiveRun {
    /// Creates the values of a run that has not begun.
    #[must_use]
    pub fn new(sources: &RunSources) -> LiveRun {
        let run = RunData {
            program: sources.program.clone(),
            source: String::from_utf8(sources.program_bytes.clone()).ok(),
            cell: sources.cell.clone(),
            ..RunData::default()
        };
        LiveRun(Arc::new(Mutex::new(RunValues { run, values: 0 })))
    }

    /// Returns what is known of the ticks from this one on. Events and the activity of commands are complete.
    #[must_use]
    pub fn since(&self, tick: u64) -> RunData {
        let known = self.lock();
        let run = &known.run;
        let mut activity = run.activity.clone();
        for span in activity.iter_mut().flat_map(|a| &mut a.spans) {
            span.end = span.end.min(run.ticks.end);
        }
        activity.retain(|a| a.spans.iter().any(|span| !span.is_empty()));
        RunData {
            activity,
            topics: run.topics.iter().map(|topic| topic.since(tick)).collect(),
            program: run.program.clone(),
            source: run.source.clone(),
            cell: run.cell.clone(),
            arms: run.arms.clone(),
            events: run.events.clone(),
            ticks: run.ticks.clone(),
            cut: None,
            ..*run
        }
    }

    fn lock(&self) -> MutexGuard<'_, RunValues> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Output of a run to the readers of its values.
pub(super) struct LiveRunOutput {
    shared: LiveRun,
    cell: Cell,
    fresh: Fresh,
    handed_over: Instant,
    /// Devices that a command drives, by its name.
    devices: BTreeMap<String, Vec<String>>,
}

/// Values that were not handed over yet.
#[derive(Default)]
struct Fresh {
    columns: ColumnBuilder,
    events: Vec<Value>,
    /// Number of the tick after the last one; 0 before the first one.
    end: u64,
}

impl LiveRunOutput {
    pub(super) fn new(run: &Recorded<'_>, shared: LiveRun) -> LiveRunOutput {
        let mut known = shared.lock();
        known.run.tick_ns = run.tick_ns;
        known.run.arms = arm_geometry(run.cell);
        drop(known);
        LiveRunOutput {
            shared,
            cell: run.cell.clone(),
            fresh: Fresh::default(),
            handed_over: Instant::now(),
            devices: BTreeMap::new(),
        }
    }

    pub(super) fn image(&mut self, image: &Image) {
        self.devices
            .insert(image.name.clone(), actuated_devices(image));
    }

    pub(super) fn event(&mut self, event: &Value) {
        self.fresh.events.push(event.clone());
    }

    /// Adds the values of a tick, and hands all new ones over from time to time.
    pub(super) fn tick(&mut self, tick: u64, messages: &[ViewMessage<'_>]) {
        if self.fresh.columns.add(&self.cell, tick, messages).is_err() {
            // A reader has had the lock for so long that there is no room. The values of this time are not shown.
            self.fresh.columns = ColumnBuilder::default();
        }
        self.fresh.end = tick.saturating_add(1);
        if self.handed_over.elapsed() >= HANDOVER
            && let Ok(mut known) = self.shared.0.try_lock()
        {
            known.add(std::mem::take(&mut self.fresh), &self.devices);
            self.handed_over = Instant::now();
        }
    }

    /// Hands over the last values.
    pub(super) fn finish(self) {
        self.shared.lock().add(self.fresh, &self.devices);
    }
}

impl RunValues {
    fn add(&mut self, fresh: Fresh, devices: &BTreeMap<String, Vec<String>>) {
        for topic in fresh.columns.finish() {
            self.values += topic.values();
            let same = self.run.topics.iter_mut().find(|own| own.is_like(&topic));
            match same {
                Some(own) => own.append(topic),
                None => self.run.topics.push(topic),
            }
        }
        self.run.ticks.end = self.run.ticks.end.max(fresh.end);
        for event in fresh.events {
            self.follow(&event, devices);
            self.run.events.push(event.to_string());
        }
        if self.values > MAX_VALUES {
            self.drop_older_half();
        }
        if self.run.events.len() > MAX_EVENTS {
            self.run.events.drain(..MAX_EVENTS / 2);
        }
    }

    /// Follows which commands run.
    fn follow(&mut self, event: &Value, devices: &BTreeMap<String, Vec<String>>) {
        let (Some(id), Some(tick)) = (event["id"].as_u64(), event["tick"].as_u64()) else {
            return;
        };
        let command = event["command"].as_str().unwrap_or_default();
        match event["event"].as_str() {
            Some("started") => self.run.activity.push(FragmentActivity {
                command: command.to_owned(),
                id,
                path: String::new(),
                devices: devices.get(command).cloned().unwrap_or_default(),
                spans: std::iter::once(tick..u64::MAX).collect(),
            }),
            Some("ended") => {
                let own = self.run.activity.iter_mut().filter(|a| a.id == id);
                let open = own.flat_map(|a| a.spans.last_mut());
                open.filter(|span| span.end == u64::MAX)
                    .for_each(|span| span.end = tick);
            }
            _ => {}
        }
    }

    fn drop_older_half(&mut self) {
        let ticks = &mut self.run.ticks;
        ticks.start += (ticks.end - ticks.start) / 2;
        let start = ticks.start;
        for topic in &mut self.run.topics {
            *topic = topic.since(start);
        }
        self.run.topics.retain(|topic| topic.values() > 0);
        self.values = self.run.topics.iter().map(|topic| topic.values()).sum();
        self.run
            .activity
            .retain(|a| a.spans.iter().any(|span| span.end > start));
    }
}
