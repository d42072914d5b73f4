//! Ticks in which the fragments of commands are active, from a replay of the recording.

use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;

use rpi_core::{Command, CommandId};
use rpi_image::Image;

use crate::mcap::error::RecordingError;
use crate::mcap::reader::Recording;
use crate::mcap::replay::replay_observed;

/// Maximum number of intervals over all fragments. A fragment that changes in every cycle would otherwise need more
/// memory than the recording.
const MAX_SPANS: usize = 1 << 17;

/// Ticks in which a fragment of a command was active.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct FragmentActivity {
    /// Name of the command.
    pub command: String,
    /// Number of the command in the recording. A command that is loaded again has a new number.
    pub id: u64,
    /// Path of the fragment in the command, such as `outer/inner`; empty for the command itself.
    pub path: String,
    /// Names of the devices with actuators that the command drives, in ascending order.
    pub devices: Vec<String>,
    /// Intervals of ticks in which the fragment was active, in ascending order.
    pub spans: Vec<Range<u64>>,
}

/// Collector of the active ticks of all fragments during a replay.
#[derive(Default)]
struct ActivityCollector {
    /// Index in `activity` of each fragment, by the numbers of its command and of the fragment in the image.
    index: BTreeMap<(u64, u32), usize>,
    activity: Vec<FragmentActivity>,
    spans: usize,
}

/// Returns the ticks in the range `ticks` in which each fragment was active. A replay that ends early, because the
/// recording lacks ticks or devices, yields the activity up to its end. A recording that does not begin with the run yields none.
pub(super) fn replayed(
    recording: &Recording,
    ticks: &Range<u64>,
) -> Result<Vec<FragmentActivity>, RecordingError> {
    let mut collector = ActivityCollector::default();
    if !recording.is_replayable() {
        return Ok(collector.activity);
    }
    replay_observed(recording, &mut |tick, id, command| {
        if ticks.contains(&tick) {
            collector.add(tick, id, command);
        }
    })?;
    Ok(collector.activity)
}

impl ActivityCollector {
    /// Adds the active fragments of a command after its cycle in the tick with the number `tick`.
    fn add(&mut self, tick: u64, id: CommandId, command: &Command) {
        let machine = command.instance();
        let image = machine.image();
        let period = (image.period_ns / image.tick_ns.max(1)).max(1);
        for (k, fragment) in (0..).zip(&image.fragments) {
            if !machine.is_active(k) {
                continue;
            }
            let next = self.activity.len();
            let at = *self.index.entry((id.to_number(), k)).or_insert(next);
            if at == next {
                self.activity.push(FragmentActivity {
                    command: image.name.clone(),
                    id: id.to_number(),
                    path: fragment.path.clone(),
                    devices: actuated_devices(image),
                    spans: Vec::new(),
                });
            }
            self.extend(at, tick..tick.saturating_add(period));
        }
    }

    fn extend(&mut self, at: usize, cycle: Range<u64>) {
        let spans = &mut self.activity[at].spans;
        match spans.last_mut().filter(|last| last.end >= cycle.start) {
            Some(last) => last.end = cycle.end,
            None if self.spans < MAX_SPANS => {
                spans.push(cycle);
                self.spans += 1;
            }
            None => {}
        }
    }
}

/// Returns the names of the devices with actuators that an image drives, in ascending order.
pub(in crate::mcap) fn actuated_devices(image: &Image) -> Vec<String> {
    let names: BTreeSet<&str> = image
        .actuators
        .iter()
        .map(|a| a.port.device.as_str())
        .collect();
    names.into_iter().map(str::to_owned).collect()
}
