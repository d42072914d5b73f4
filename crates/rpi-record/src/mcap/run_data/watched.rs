//! Flows that were not recorded: their values come from a replay with images that export them.

use std::sync::Arc;

use rpi_image::Image;
use rpi_runtime::tick_log::LoggedTick;

use crate::mcap::error::RecordingError;
use crate::mcap::reader::Recording;
use crate::mcap::replay::replay_flows;

impl Recording {
    /// Replaces images of the recording by images of the same commands that export more flows. Then
    /// [`run_data`](Recording::run_data) has these flows, too: it replays the recording. Each pair in `images` is an image as it was
    /// recorded, and the one that replaces it. Returns the indices of the pairs whose images are in the recording.
    pub fn watch(&mut self, images: &[(Image, Arc<Image>)]) -> Vec<usize> {
        let mut replaced = Vec::new();
        for recorded in &mut self.images {
            let found = images.iter().position(|(plain, _)| *plain == **recorded);
            if let Some(index) = found {
                *recorded = Arc::clone(&images[index].1);
                replaced.push(index);
            }
        }
        replaced.sort_unstable();
        replaced.dedup();
        self.is_watched |= !replaced.is_empty();
        replaced
    }

    /// Returns the flows that the recorded commands export: the name of the command and that of the flow.
    pub fn exported_flows(&self) -> impl Iterator<Item = (&str, &str)> {
        let images = self.images.iter();
        images.flat_map(|image| {
            let exports = image.exports.iter();
            exports.map(|export| (image.name.as_str(), export.key.as_str()))
        })
    }

    /// Returns the text of the program that was run; `None` if the recording has none.
    #[must_use]
    pub fn source(&self) -> Option<&str> {
        self.source.as_deref()
    }

    /// Returns the number of axes that all arms of the cell have; `None` without arms, or with different ones.
    #[must_use]
    pub fn arm_axes(&self) -> Option<u32> {
        self.cell.arm_axes()
    }
}

/// Replays a recording and passes each tick to `each` twice: with the flows of the replay, and as it was recorded. The second
/// time adds the ports of the devices.
///
/// # Errors
/// Returns an error if the replay sets other set-points than were recorded.
pub(super) fn for_each_replayed_tick(
    recording: &Recording,
    each: &mut dyn FnMut(&LoggedTick<'_>) -> Result<(), RecordingError>,
) -> Result<(), RecordingError> {
    let report = replay_flows(recording, &mut |tick, flows| {
        let replayed = LoggedTick {
            observations: flows,
            ..*tick
        };
        each(&replayed)?;
        each(tick)
    })?;
    match report.difference {
        Some(difference) => Err(RecordingError::Damaged(format!(
            "its replay differs: {difference}"
        ))),
        None => Ok(()),
    }
}
