//! Summary of a recording: what it has, and how it ends.

use std::ops::Range;

use rpi_runtime::tick_log::LoggedTick;
use serde_json::Value;

use super::error::RecordingError;
use super::reader::Recording;

/// What a recording has.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct RecordingSummary {
    /// File name of the program that was run.
    pub program: String,
    /// Tick length in nanoseconds.
    pub tick_ns: u64,
    /// Number of the first recorded tick and number of the tick after the last one.
    pub ticks: Range<u64>,
    /// Names of the devices of the cell, in the order of the cell description.
    pub devices: Vec<String>,
    /// Commands that were started, in the order of their starts.
    pub commands: Vec<RecordedCommand>,
    /// Number of ticks that are missing in the recording.
    pub lost: u64,
    /// Reason why the recording has no end; `None` for a complete recording.
    pub cut: Option<String>,
    /// Whether the recording begins with the run, so that it can be replayed.
    pub is_replayable: bool,
}

/// Command that was started during a recording.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct RecordedCommand {
    /// Name of the command.
    pub name: String,
    /// Number of the command, which distinguishes commands with the same name.
    pub number: u64,
    /// Number of the tick in which the command was started.
    pub started: u64,
    /// Number of the tick in which it ended; `None` if it did not.
    pub ended: Option<u64>,
}

impl Recording {
    /// Returns a summary of the recording. All its ticks are read.
    ///
    /// # Errors
    /// Returns an error if a file of the recording is damaged or has changed since it was opened.
    pub fn summary(&self) -> Result<RecordingSummary, RecordingError> {
        let mut ticks: Option<Range<u64>> = None;
        self.for_each_tick(|words| {
            let tick = LoggedTick::from_words(words);
            let tick =
                tick.ok_or_else(|| RecordingError::Damaged("invalid tick in the tick log".into()))?;
            let all = ticks.get_or_insert(tick.number..tick.number);
            all.end = all.end.max(tick.number.saturating_add(1));
            Ok(true)
        })?;
        Ok(RecordingSummary {
            program: self.program.clone(),
            tick_ns: self.tick_ns,
            ticks: ticks.unwrap_or(0..0),
            devices: self
                .cell
                .devices
                .iter()
                .map(|device| device.name.clone())
                .collect(),
            commands: commands(&self.events),
            lost: self.lost,
            cut: self.cut.clone(),
            is_replayable: self.is_replayable(),
        })
    }
}

fn commands(events: &[Value]) -> Vec<RecordedCommand> {
    let mut commands: Vec<RecordedCommand> = Vec::new();
    for event in events {
        let (Some(number), Some(tick)) = (event["id"].as_u64(), event["tick"].as_u64()) else {
            continue;
        };
        match event["event"].as_str() {
            Some("started") => commands.push(RecordedCommand {
                name: event["command"].as_str().unwrap_or_default().to_owned(),
                number,
                started: tick,
                ended: None,
            }),
            Some("ended") => {
                let mut open = commands.iter_mut().rev();
                if let Some(command) = open.find(|c| c.number == number && c.ended.is_none()) {
                    command.ended = Some(tick);
                }
            }
            _ => {}
        }
    }
    commands
}
