//! Values of a recorded run by flow, for plots and tables: one column per number, over ticks.
//!
//! The columns come from the tick log, which is exact in every [profile](super::Profile). A replay of the recording
//! yields the ticks in which each fragment was active, which are not recorded.

mod activity;
mod columns;
mod watched;

use std::ops::Range;

pub use activity::FragmentActivity;
pub(super) use activity::actuated_devices;
pub(super) use columns::ColumnBuilder;
pub use columns::{Column, ColumnKind, TopicColumns};

use super::error::RecordingError;
use super::names::NameTable;
use super::profile::Profile;
use super::reader::Recording;
use super::scene::{ArmGeometry, arm_geometry};
use super::topic_table::TopicTable;
use rpi_core::CommandId;
use rpi_runtime::run::sampled_channels;
use rpi_runtime::tick_log::LoggedTick;

/// Content of a recording by flow: columns of numbers over ticks, events, and the arms of the cell.
#[derive(Clone, PartialEq, Debug, Default)]
pub struct RunData {
    /// Tick length in nanoseconds.
    pub tick_ns: u64,
    /// Number of the first recorded tick and number of the tick after the last one.
    pub ticks: Range<u64>,
    /// File name of the program that was run.
    pub program: String,
    /// Text of the program; `None` if it is not text, such as an image.
    pub source: Option<String>,
    /// Text of the cell description.
    pub cell: String,
    /// Arms of the cell, in the order of the cell description.
    pub arms: Vec<ArmGeometry>,
    /// Columns of the flows of commands and the ports of devices, by topic, in the order of their first values.
    pub topics: Vec<TopicColumns>,
    /// Ticks in which each fragment of each command was active, in the order of the first activity.
    pub activity: Vec<FragmentActivity>,
    /// Events in recorded order, each as the text of a JSON object.
    pub events: Vec<String>,
    /// Number of ticks that are missing in the recording.
    pub lost: u64,
    /// Reason why the recording has no end; `None` for a complete recording.
    pub cut: Option<String>,
}

impl Recording {
    /// Returns the values of the ticks whose numbers are in the range `ticks`, by flow, with all events.
    ///
    /// # Errors
    /// Returns an error if a file of the recording is damaged or has changed since it was opened, and an error if the
    /// range has more values than fit into memory (2²⁶).
    pub fn run_data(&self, ticks: Range<u64>) -> Result<RunData, RecordingError> {
        let mut run = self.values_by_flow(ticks)?;
        run.activity = activity::replayed(self, &run.ticks)?;
        Ok(run)
    }

    /// Returns the same as [`run_data`](Recording::run_data), without the activity of fragments, for which the recording is replayed.
    ///
    /// # Errors
    /// As [`run_data`](Recording::run_data).
    pub fn values_by_flow(&self, ticks: Range<u64>) -> Result<RunData, RecordingError> {
        let channels = sampled_channels(&self.cell, self.tick_ns);
        let mut names = NameTable::new(&self.cell, self.tick_ns);
        let mut table = TopicTable::new(Profile::Json, &channels);
        self.add_commands(&mut names, &mut table);
        let mut columns = ColumnBuilder::default();
        let mut recorded: Option<Range<u64>> = None;
        let mut add = |tick: &LoggedTick<'_>| {
            let all = recorded.get_or_insert(tick.number..tick.number);
            all.end = all.end.max(tick.number.saturating_add(1));
            match ticks.contains(&tick.number) {
                true => columns.add(&self.cell, tick.number, &table.messages(tick, &names)),
                false => Ok(()),
            }
        };
        match self.is_watched {
            true => watched::for_each_replayed_tick(self, &mut add)?,
            false => self.for_each_tick(|words| {
                let tick = LoggedTick::from_words(words);
                let tick = tick.ok_or_else(|| {
                    RecordingError::Damaged("invalid tick in the tick log".into())
                })?;
                add(&tick)?;
                Ok(tick.number < ticks.end)
            })?,
        }
        let recorded = recorded.unwrap_or(0..0);
        let within = recorded.start.max(ticks.start)..recorded.end.min(ticks.end);
        Ok(RunData {
            tick_ns: self.tick_ns,
            activity: Vec::new(),
            ticks: within,
            program: self.program.clone(),
            source: self.source.clone(),
            cell: self.cell_text.clone(),
            arms: arm_geometry(&self.cell),
            topics: columns.finish(),
            events: self.events.iter().map(ToString::to_string).collect(),
            lost: self.lost,
            cut: self.cut.clone(),
        })
    }

    /// Adds the commands of all recorded requests to `names`, and the topics of their flows and ports to `table`.
    fn add_commands(&self, names: &mut NameTable, table: &mut TopicTable) {
        let loads = self.requests.iter().filter(|r| r["ask"] == "load");
        for load in loads {
            let image = load["image"].as_u64().and_then(|k| usize::try_from(k).ok());
            let image = image.and_then(|k| self.images.get(k));
            let (Some(command), Some(image)) = (load["command"].as_u64(), image) else {
                continue;
            };
            let command = CommandId::from_number(command);
            if names.insert_command(command, image) {
                let number = names.image_index(command).unwrap_or(0);
                table.add_image(number, image, names);
            }
        }
    }
}
