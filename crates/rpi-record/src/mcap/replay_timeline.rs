//! A replay that goes to any tick, forwards and backwards.

use std::sync::Arc;

use rpi_image::Image;
use rpi_runtime::tick_log::LoggedTick;

use super::error::RecordingError;
use super::reader::Recording;
use super::replay::CycleCallback;
use super::replay_report::ReplayReport;
use super::replay_requests::RecordedRequests;
use super::replay_run::{ReplayCheckpoint, ReplayRun};
use super::tick_reader::{TickPosition, TickReader};

/// Memory for checkpoints in bytes. When it is used up, every second one is dropped, and further ones are twice as far apart.
const MAX_MEMORY: usize = 256 << 20;

/// Number of ticks between two checkpoints at first.
const FIRST_SPACING: u64 = 1000;

/// Replay of a recording that can return to earlier ticks. It keeps checkpoints of the core, from which it goes on.
pub struct ReplayTimeline {
    recording: Arc<Recording>,
    run: ReplayRun,
    requests: RecordedRequests,
    ticks: TickReader,
    /// Checkpoints in the order of their ticks, each with the position of its next tick in the files.
    checkpoints: Vec<(ReplayCheckpoint, TickPosition)>,
    /// Number of ticks between two checkpoints.
    spacing: u64,
    /// Memory of the checkpoints in bytes.
    memory: usize,
    /// Number of the next tick.
    now: u64,
    /// Number of ticks of the recording, once its end was reached.
    end: Option<u64>,
}

impl ReplayTimeline {
    /// Prepares the replay of a recording. It is before the first tick.
    ///
    /// # Errors
    /// Returns an error if the recording is not complete enough to be replayed.
    pub fn new(recording: Arc<Recording>) -> Result<ReplayTimeline, RecordingError> {
        let mut timeline = ReplayTimeline {
            run: ReplayRun::new(&recording)?,
            requests: RecordedRequests::new(&recording)?,
            ticks: TickReader::new(recording.parts.clone(), recording.cut.is_some()),
            recording,
            checkpoints: Vec::new(),
            spacing: FIRST_SPACING,
            memory: 0,
            now: 0,
            end: None,
        };
        timeline.add_checkpoint();
        Ok(timeline)
    }

    /// Returns the number of the tick that is replayed next.
    #[must_use]
    pub fn now(&self) -> u64 {
        self.now
    }

    /// Returns the number of ticks that can be replayed, if the end was reached before.
    #[must_use]
    pub fn end(&self) -> Option<u64> {
        self.end
    }

    /// Returns what the replay has found: with a difference, the values after it are not those of the run.
    #[must_use]
    pub fn report(&self) -> &ReplayReport {
        &self.run.report
    }

    /// Returns the sensors that commands have read so far although the recording has no values for them, which count as 0.
    pub fn unrecorded(&mut self) -> Vec<String> {
        self.run.unrecorded()
    }

    /// Returns the images of the commands of the recording.
    #[must_use]
    pub fn images(&self) -> &[Arc<Image>] {
        &self.recording.images
    }

    /// Replays the next tick, and passes each command to `observe` after the evaluation of its cycle. Returns the number of the tick;
    /// `None` at the end of what can be replayed.
    ///
    /// # Errors
    /// Returns an error if the recording is damaged.
    pub fn step(&mut self, observe: CycleCallback<'_>) -> Result<Option<u64>, RecordingError> {
        if self.end.is_some_and(|end| self.now >= end) {
            return Ok(None);
        }
        let Some(words) = self.ticks.next()? else {
            return Ok(self.finish());
        };
        let tick = LoggedTick::from_words(&words);
        let tick =
            tick.ok_or_else(|| RecordingError::Damaged("invalid tick on the tape".into()))?;
        if tick.lost > 0 || self.requests.is_past_end(tick.number) {
            return Ok(self.finish());
        }
        let requests = self
            .requests
            .of_tick(&self.recording, tick.number, &mut self.run.names)?;
        self.run.tick(&tick, requests, observe);
        self.now = tick.number + 1;
        let last = self.checkpoints.last();
        if last.is_none_or(|(last, _)| self.now >= last.now() + self.spacing) {
            self.add_checkpoint();
        }
        Ok(Some(tick.number))
    }

    /// Goes to the place before the tick with this number, or to the end of what can be replayed. Takes the time for the ticks since
    /// the last checkpoint before it.
    ///
    /// # Errors
    /// Returns an error if the recording is damaged.
    pub fn seek(&mut self, tick: u64) -> Result<(), RecordingError> {
        let after = self.checkpoints.partition_point(|(c, _)| c.now() <= tick);
        let nearest = after.checked_sub(1).map(|k| &self.checkpoints[k]);
        if let Some((checkpoint, position)) = nearest
            && (tick < self.now || checkpoint.now() > self.now)
        {
            self.run.restore(checkpoint);
            self.now = checkpoint.now();
            self.ticks.seek(*position)?;
        }
        while self.now < tick && self.step(&mut |_, _, _| {})?.is_some() {}
        Ok(())
    }

    fn finish(&mut self) -> Option<u64> {
        self.end = Some(self.now);
        None
    }

    fn add_checkpoint(&mut self) {
        let checkpoint = self.run.checkpoint();
        self.memory += checkpoint.memory();
        self.checkpoints.push((checkpoint, self.ticks.position()));
        if self.memory > MAX_MEMORY && self.checkpoints.len() > 2 {
            let mut k = 0;
            self.checkpoints.retain(|_| {
                k += 1;
                k % 2 == 1
            });
            self.spacing *= 2;
            let kept = self.checkpoints.iter();
            self.memory = kept.map(|(checkpoint, _)| checkpoint.memory()).sum();
        }
    }
}
